#include "hosts/synth/surface_nets.hpp"

#include <cmath>

namespace posefusion::synth {
namespace {

/// Samples of the field on a lattice. Whole blocks far from the surface are filled from one sample at their middle.
struct Lattice {
    Vector3f low;
    float cell;
    Eigen::Vector3i size;
    std::vector<float> values;

    [[nodiscard]] std::size_t index(int x, int y, int z) const {
        return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y()) + static_cast<std::size_t>(y)) *
                   static_cast<std::size_t>(size.x()) +
               static_cast<std::size_t>(x);
    }
    [[nodiscard]] Vector3f point(int x, int y, int z) const {
        return low + cell * Eigen::Vector3i(x, y, z).cast<float>();
    }
};

constexpr int kBlock = 8;

Lattice sample(const DistanceField& field, const Vector3f& low, const Vector3f& high, float cell) {
    Lattice lattice{low, cell, ((high - low) / cell).array().ceil().cast<int>() + 2, {}};
    lattice.values.resize(static_cast<std::size_t>(lattice.size.prod()));
    const float reach = 2.0f * cell * kBlock * std::sqrt(3.0f) / 2;  // twice the half diagonal: fields are not exact
    for (int z0 = 0; z0 < lattice.size.z(); z0 += kBlock)
        for (int y0 = 0; y0 < lattice.size.y(); y0 += kBlock)
            for (int x0 = 0; x0 < lattice.size.x(); x0 += kBlock) {
                const Vector3f middle = lattice.point(x0, y0, z0) + Vector3f::Constant(0.5f * cell * (kBlock - 1));
                const float far = field(middle);
                const bool skip = std::abs(far) > reach;
                for (int z = z0; z < std::min(z0 + kBlock, lattice.size.z()); ++z)
                    for (int y = y0; y < std::min(y0 + kBlock, lattice.size.y()); ++y)
                        for (int x = x0; x < std::min(x0 + kBlock, lattice.size.x()); ++x)
                            lattice.values[lattice.index(x, y, z)] = skip ? far : field(lattice.point(x, y, z));
            }
    return lattice;
}

Vector3f gradient(const DistanceField& field, const Vector3f& p, float h) {
    return Vector3f(field(p + Vector3f(h, 0, 0)) - field(p - Vector3f(h, 0, 0)),
                    field(p + Vector3f(0, h, 0)) - field(p - Vector3f(0, h, 0)),
                    field(p + Vector3f(0, 0, h)) - field(p - Vector3f(0, 0, h))) /
           (2 * h);
}

/// Mean of the points where the surface crosses the edges of a cell; false if it does not.
bool cell_vertex(const Lattice& lattice, int x, int y, int z, Vector3f& vertex) {
    float value[8];
    for (int c = 0; c < 8; ++c) value[c] = lattice.values[lattice.index(x + (c & 1), y + ((c >> 1) & 1), z + (c >> 2))];
    Vector3f sum = Vector3f::Zero();
    int crossings = 0;
    for (int a = 0; a < 8; ++a)
        for (int axis = 0; axis < 3; ++axis) {
            const int b = a | (1 << axis);
            if (b == a || (value[a] < 0) == (value[b] < 0)) continue;
            Vector3f p(static_cast<float>(a & 1), static_cast<float>((a >> 1) & 1), static_cast<float>(a >> 2));
            p[axis] = value[a] / (value[a] - value[b]);
            sum += p;
            ++crossings;
        }
    if (crossings == 0) return false;
    vertex = lattice.point(x, y, z) + lattice.cell * sum / static_cast<float>(crossings);
    return true;
}

void add_face(Surface& surface, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, bool flip) {
    if (flip) std::swap(b, d);
    surface.triangles.push_back({a, b, c});
    surface.triangles.push_back({a, c, d});
}

}  // namespace

Surface surface_nets(const DistanceField& field, const Vector3f& low, const Vector3f& high, float cell) {
    const Lattice lattice = sample(field, low, high, cell);
    constexpr std::uint32_t kNone = ~0u;
    std::vector<std::uint32_t> vertex_of(lattice.values.size(), kNone);
    Surface surface;
    for (int z = 0; z + 1 < lattice.size.z(); ++z)
        for (int y = 0; y + 1 < lattice.size.y(); ++y)
            for (int x = 0; x + 1 < lattice.size.x(); ++x) {
                Vector3f p;
                if (!cell_vertex(lattice, x, y, z, p)) continue;
                for (int i = 0; i < 2; ++i) {
                    const Vector3f g = gradient(field, p, 0.25f * cell);
                    const Vector3f step = -field(p) * g / std::max(g.squaredNorm(), 0.25f);
                    p += step.norm() > cell ? Vector3f(step * (cell / step.norm())) : step;
                }
                vertex_of[lattice.index(x, y, z)] = static_cast<std::uint32_t>(surface.positions.size());
                surface.positions.push_back(p);
                surface.normals.push_back(gradient(field, p, 0.5f * cell).normalized());
            }
    // Every lattice edge with a change of sign is shared by four cells: one quadrilateral.
    for (int z = 1; z + 1 < lattice.size.z(); ++z)
        for (int y = 1; y + 1 < lattice.size.y(); ++y)
            for (int x = 1; x + 1 < lattice.size.x(); ++x) {
                const bool inside = lattice.values[lattice.index(x, y, z)] < 0;
                const auto cell_at = [&](int dx, int dy, int dz) {
                    return vertex_of[lattice.index(x - dx, y - dy, z - dz)];
                };
                if (inside != (lattice.values[lattice.index(x + 1, y, z)] < 0))
                    add_face(surface, cell_at(0, 0, 0), cell_at(0, 1, 0), cell_at(0, 1, 1), cell_at(0, 0, 1), !inside);
                if (inside != (lattice.values[lattice.index(x, y + 1, z)] < 0))
                    add_face(surface, cell_at(0, 0, 0), cell_at(0, 0, 1), cell_at(1, 0, 1), cell_at(1, 0, 0), !inside);
                if (inside != (lattice.values[lattice.index(x, y, z + 1)] < 0))
                    add_face(surface, cell_at(0, 0, 0), cell_at(1, 0, 0), cell_at(1, 1, 0), cell_at(0, 1, 0), !inside);
            }
    return surface;
}

}  // namespace posefusion::synth
