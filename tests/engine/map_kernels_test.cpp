#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"

// The kernels of the surfel map against plain C++ written from their header comments.
namespace posefusion::test {
namespace {

using gpu::MapRecord;
using gpu::Params;
using gpu::TrackingRecord;
using gpu::vec4;
using std::size_t;
using uint = std::uint32_t;

constexpr uint kScale = 2;                                    // cells per pixel and axis, the default
constexpr double kUnorm16 = 1.0 / 65535, kHalf = 1.0 / 1024;  // steps of a stored colour, of a stored weight (relative)

uint owner_key(uint distance2, size_t pixel) { return distance2 << gpu::OWNER_PIXEL_BITS | static_cast<uint>(pixel); }
size_t owner_pixel(uint key) { return key % gpu::MAX_PIXELS; }

struct Appearance {
    uint red_green, blue_weight, created, last_seen;
};

/// The value of a 16-bit float.
double half_value(uint bits) {
    const int exponent = static_cast<int>(bits >> 10 & 31u), mantissa = static_cast<int>(bits & 1023u);
    return exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25);
}
/// The nearest 16-bit float of a positive number within range.
uint half_bits(double value) {
    const int exponent = std::clamp(static_cast<int>(std::floor(std::log2(value))), -14, 15);
    return static_cast<uint>(exponent + 15) * 1024u +
           static_cast<uint>(std::lround(std::ldexp(value, 10 - exponent)) - 1024);
}
Vector3d color_of(const Appearance& a) {
    return {(a.red_green & 0xffffu) * kUnorm16, (a.red_green >> 16) * kUnorm16, (a.blue_weight & 0xffffu) * kUnorm16};
}
double weight_of(const Appearance& a) { return half_value(a.blue_weight >> 16); }
Appearance make_appearance(const Vector3d& color, double weight, uint created, uint last_seen) {
    const auto unorm = [](double x) { return static_cast<uint>(std::lround(x * 65535)); };
    return {unorm(color.x()) | unorm(color.y()) << 16, unorm(color.z()) | half_bits(weight) << 16, created, last_seen};
}

struct Surfels {
    std::vector<vec4> positions, normals;
    std::vector<Appearance> appearances;
    uint count = 0;
};

/// Surfels around the camera: most in view on wavy layers, some behind it, beside it, dead, unstable, seen from behind.
Surfels make_surfels(const Camera& c, const Isometry3d& world_live, uint count, unsigned seed) {
    Random random(seed);
    Surfels s;
    s.count = count;
    for (uint i = 0; i < std::max(count, 1u); ++i) {
        const double u = random.uniform(-12, c.width + 12), v = random.uniform(-12, c.height + 12);
        const double z = random.chance(0.05) ? random.uniform(-2, 7) : random.uniform(0.6, 3) + 0.2 * std::sin(0.1 * u);
        const Vector3d p = world_live * c.back_project(u, v, z);
        Vector3d n = Vector3d(random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), -1).normalized();
        if (random.chance(0.05)) n = -n;
        const double confidence = random.chance(0.1) ? 0.0 : random.uniform(0.1, 20);
        s.positions.push_back(vec4_of(p, confidence));
        s.normals.push_back(vec4_of(world_live.linear() * n, std::abs(z) / c.fx * random.uniform(0.7, 2.5)));
        const Vector3d color(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
        s.appearances.push_back(make_appearance(color, random.uniform(0.01, 90), random.below(40), random.below(60)));
    }
    return s;
}

class MapKernel : public DeviceTest, public testing::WithParamInterface<size_t> {
protected:
    Params params = [] {
        Params p = make_params(test_cameras()[GetParam()]);
        p.frame = 63;
        return p;
    }();
    const Camera camera = camera_at(params);
    const size_t n = static_cast<size_t>(camera.pixels());
    const Isometry3d world_live = motion({0.3, -0.2, 0.5}, {1, 2, 0.3}, 25), camera_world = world_live.inverse();
    const TrackingRecord record = [this] {
        TrackingRecord r{};
        r.world_live = to_device(world_live);
        r.exposure = {1.1f, 0.9f, 1.3f, 0};
        r.fusion_weight = 0.8f;
        return r;
    }();
    [[nodiscard]] double static_depth_at(const std::vector<float>& depth, int u, int v) const {
        return static_cast<double>(depth[static_cast<size_t>(camera.index(u, v))]);
    }
};

INSTANTIATE_TEST_SUITE_P(Sizes, MapKernel, testing::Range(size_t{0}, test_cameras().size()), [](const auto& test) {
    const auto camera = test_cameras()[test.param];
    return std::to_string(camera.width) + "x" + std::to_string(camera.height);
});

/// 0, 1, just below, at and above one workgroup, several.
const uint kCounts[] = {0, 1, gpu::SURFELS_PER_GROUP - 1, gpu::SURFELS_PER_GROUP, gpu::SURFELS_PER_GROUP + 1, 6000};

// ---------------------------------------------------------------------------------------------------- depth test

/// Result of a depth test: key and index of each cell, gpu::EMPTY_CELL where empty.
struct Cells {
    std::vector<uint> keys, indices;
};

uint least_groups(uint count) { return std::max(vulkan::ceil_div(count, gpu::SURFELS_PER_GROUP), 1u); }

/// index_map or splat by one 64-bit pass. `bind` gives all buffers but the cells.
template <class Bind>
Cells depth_test_64(const std::string& shader, size_t cells, uint count, const vulkan::NamedValues& constants,
                    Bind bind) {
    Launch launch(shader + ".int64", constants);
    bind(launch);
    launch.inout("cells", std::vector<uint>(2 * cells, gpu::EMPTY_CELL)).run(least_groups(count), {{"pass", 0}});
    const auto words = launch.read<uint>("cells");
    Cells result;
    for (size_t i = 0; i < cells; ++i) result.indices.push_back(words[2 * i]), result.keys.push_back(words[2 * i + 1]);
    return result;
}

/// ... by two 32-bit passes.
template <class Bind>
Cells depth_test_32(const std::string& shader, size_t cells, uint count, const vulkan::NamedValues& constants,
                    Bind bind) {
    Cells result{std::vector<uint>(cells, gpu::EMPTY_CELL), std::vector<uint>(cells, gpu::EMPTY_CELL)};
    for (uint pass = 0; pass < 2; ++pass) {
        Launch launch(shader, constants, false);
        bind(launch);
        launch.inout("cell_keys", result.keys).inout("cell_indices", result.indices);
        launch.run(least_groups(count), {{"pass", pass}});
        result = {launch.read<uint>("cell_keys"), launch.read<uint>("cell_indices")};
    }
    return result;
}

void expect_mostly_equal(const std::vector<uint>& actual, const std::vector<uint>& expected, size_t may_differ,
                         const char* what) {
    ASSERT_EQ(actual.size(), expected.size());
    size_t differing = 0;
    for (size_t i = 0; i < actual.size(); ++i) differing += actual[i] != expected[i];
    EXPECT_LE(differing, may_differ) << "of " << actual.size() << ' ' << what;
}

TEST_P(MapKernel, IndexMapKeepsTheNearestActiveSurfelOfEachCell) {
    params.active_since = 15;  // of last_seen 0..59
    const auto width = static_cast<size_t>(camera.width) * kScale;
    const size_t cells = n * kScale * kScale;
    for (const uint count : kCounts) {
        const auto surfels = make_surfels(camera, world_live, count, 50 + count);
        const auto bind = [&](Launch& launch) {
            launch.input("params", params).input("record", record).input("counters", MapRecord{count});
            launch.input("position_confidence", surfels.positions).input("appearance", surfels.appearances);
        };
        const auto wide = depth_test_64("map/index_map", cells, count, {{"INDEX_SCALE", kScale}}, bind);
        const auto narrow = depth_test_32("map/index_map", cells, count, {{"INDEX_SCALE", kScale}}, bind);
        EXPECT_EQ(wide.indices, narrow.indices);
        EXPECT_EQ(wide.keys, narrow.keys);

        std::vector<uint> expected(cells, gpu::EMPTY_CELL);
        std::vector<double> depths(cells, 1e9);
        for (uint i = 0; i < count; ++i) {
            const Vector3d p = camera_world * xyz(surfels.positions[i]);
            if (surfels.positions[i].w <= 0 || p.z() < gpu::INDEX_NEARER * params.depth_min ||
                p.z() > gpu::INDEX_FARTHER * params.depth_max)
                continue;
            if (surfels.appearances[i].last_seen < params.active_since) continue;
            const Vector2d at = (camera.project(p) + Vector2d(0.5, 0.5)) * kScale;
            const auto u = std::floor(at.x()), v = std::floor(at.y());
            if (u < 0 || v < 0 || u >= camera.width * static_cast<int>(kScale) ||
                v >= camera.height * static_cast<int>(kScale))
                continue;
            const size_t cell = static_cast<size_t>(v) * width + static_cast<size_t>(u);
            if (p.z() < depths[cell]) depths[cell] = p.z(), expected[cell] = i;
        }
        // a surfel within 1e-5 cells of a border may fall on either side: at most one in 10,000, two cells each
        expect_mostly_equal(wide.indices, expected, 1 + count / 2000, "cells");
        std::vector<float> found;
        std::vector<double> found_expected;
        for (size_t i = 0; i < cells; ++i) {
            if (wide.indices[i] != expected[i] || expected[i] == gpu::EMPTY_CELL) continue;
            found.push_back(std::bit_cast<float>(wide.keys[i]));
            found_expected.push_back(depths[i]);
        }
        expect_near(found, found_expected, 2e-6);  // rounding of a transform of coordinates of a few metres
    }
}

// ------------------------------------------------------------------------------------------------------- association

TEST_P(MapKernel, AssociateTakesTheNearestAgreeingCellAndOneOwnerPerSurfel) {
    const uint count = 700;
    const auto surfels = make_surfels(camera, world_live, count, 61);
    auto depth = rough_depth(camera, 62);
    for (auto& z : depth) z = z > params.depth_max || z < params.depth_min ? 0.0f : z;
    const auto geometry = rough_geometry(camera, depth, 63);
    for (const uint scale : {1u, 2u, 3u, 4u}) {
        const int s = static_cast<int>(scale), width = camera.width * s, height = camera.height * s;
        const size_t cells = n * scale * scale;
        Random random(64);
        Cells map{std::vector<uint>(cells, gpu::EMPTY_CELL), std::vector<uint>(cells, gpu::EMPTY_CELL)};
        for (size_t i = 0; i < cells; ++i) {
            if (random.chance(0.75)) continue;
            const int u = static_cast<int>(i) % width / s, v = static_cast<int>(i) / width / s;
            const float z =
                depth[static_cast<size_t>(camera.index(u, v))] * static_cast<float>(random.uniform(0.93, 1.07)) +
                0.001f;
            map.keys[i] = std::bit_cast<uint>(z);
            map.indices[i] = random.below(count);
        }
        std::vector<uint> interleaved;
        for (size_t i = 0; i < cells; ++i) interleaved.push_back(map.indices[i]), interleaved.push_back(map.keys[i]);

        std::vector<std::vector<uint>> associations, owners;
        for (const bool wide : {true, false}) {
            Launch launch("map/associate", {{"CELL_STRIDE", wide ? 2 : 1}, {"INDEX_SCALE", scale}}, wide);
            launch.input("params", params).input("record", record);
            launch.input("static_depth", depth).input("live_geometry", geometry);
            if (wide)
                launch.input("cell_keys", interleaved).same("cell_indices", "cell_keys");
            else
                launch.input("cell_keys", map.keys).input("cell_indices", map.indices);
            launch.input("normal_radius", surfels.normals).output<uint>("association", n);
            launch.inout("owner", std::vector<uint>(count, gpu::NO_OWNER)).run_over(n);
            associations.push_back(launch.read<uint>("association"));
            owners.push_back(launch.read<uint>("owner"));
        }
        EXPECT_EQ(associations[0], associations[1]);
        EXPECT_EQ(owners[0], owners[1]);

        std::vector<uint> expected(n), expected_owner(count, gpu::NO_OWNER);
        for (int v = 0; v < camera.height; ++v) {
            for (int u = 0; u < camera.width; ++u) {
                const auto i = static_cast<size_t>(camera.index(u, v));
                const double z = static_cast<double>(depth[i]);
                if (z <= 0 || xyz(geometry[i]).squaredNorm() < 0.5) {
                    expected[i] = gpu::NO_SURFEL;
                    continue;
                }
                const double gate = std::max(static_cast<double>(params.association_depth),
                                             params.association_sigmas * depth_sigma(params, z)) /
                                    camera.back_project(u, v, 1).norm();
                // cells whose centre is at most one pixel from the pixel's, along either axis; distance in half cells
                int best = 1 << 20;
                size_t best_cell = cells;
                for (int row = std::max(v * s - s, 0); row < std::min(v * s + 2 * s, height); ++row) {
                    for (int column = std::max(u * s - s, 0); column < std::min(u * s + 2 * s, width); ++column) {
                        const int du = 2 * column + 1 - (2 * u + 1) * s, dv = 2 * row + 1 - (2 * v + 1) * s;
                        const auto cell = static_cast<size_t>(row * width + column);
                        if (std::abs(du) > 2 * s || std::abs(dv) > 2 * s || map.keys[cell] == gpu::EMPTY_CELL) continue;
                        const double there = static_cast<double>(std::bit_cast<float>(map.keys[cell]));
                        if (std::abs(there - z) < gate && du * du + dv * dv < best)
                            best = du * du + dv * dv, best_cell = cell;
                    }
                }
                expected[i] = gpu::NEW_SURFEL;
                if (best_cell == cells) continue;
                const uint surfel = map.indices[best_cell];
                const Vector3d normal = camera_world.linear() * xyz(surfels.normals[surfel]);
                if (std::abs(normal.z()) < gpu::MIN_JUDGED_COSINE ||
                    normal.dot(xyz(geometry[i])) > static_cast<double>(params.association_cosine)) {
                    expected[i] = surfel;
                    expected_owner[surfel] = std::min(expected_owner[surfel], owner_key(static_cast<uint>(best), i));
                }
            }
        }
        // gates are compared in float: ties, see IndexMap
        expect_mostly_equal(associations[0], expected, 1 + n / 2000, "pixels");
        expect_mostly_equal(owners[0], expected_owner, 1 + n / 2000, "owners");
    }
}

TEST_P(MapKernel, AssociateFindsNothingWhenTrackingHasFailed) {
    TrackingRecord failed = record;
    failed.failed = 1;
    const auto depth = rough_depth(camera, 62);
    Launch launch("map/associate", {{"CELL_STRIDE", 2}, {"INDEX_SCALE", kScale}});
    launch.input("params", params).input("record", failed);
    launch.input("static_depth", depth).input("live_geometry", rough_geometry(camera, depth, 63));
    launch.input("cell_keys", std::vector<uint>(2 * n * kScale * kScale, 0u)).same("cell_indices", "cell_keys");
    launch.input("normal_radius", std::vector<vec4>(1)).output<uint>("association", n);
    launch.inout("owner", std::vector<uint>(1, gpu::NO_OWNER)).run_over(n);
    EXPECT_EQ(launch.read<uint>("association"), std::vector<uint>(n, gpu::NO_SURFEL));
    EXPECT_EQ(launch.read<uint>("owner")[0], gpu::NO_OWNER);
}

// ------------------------------------------------------------------------------------------------------------ fusion

struct Observation {
    Vector3d position, normal, color;
    double radius, confidence, weight;
};

Observation observe(const Params& params, const TrackingRecord& record, const Isometry3d& world_live, size_t i,
                    const std::vector<float>& depth, const std::vector<vec4>& geometry,
                    const std::vector<uint>& colors) {
    const Camera c = camera_at(params);
    const auto u = static_cast<double>(i % static_cast<size_t>(c.width)),
               v = static_cast<double>(i / static_cast<size_t>(c.width));
    const double z = static_cast<double>(depth[i]), f = 0.5 * (c.fx + c.fy);
    const Vector3d normal = xyz(geometry[i]);
    Observation o;
    o.position = world_live * c.back_project(u, v, z);
    o.normal = world_live.linear() * normal;
    o.color = in_map_exposure(record, colors[i]);
    const double r = gpu::PIXEL_DIAGONAL * z / f;
    o.radius = std::min(gpu::MAX_SLANT_GROWTH * r, r / std::max<double>(std::abs(normal.z()), gpu::MIN_SLANT_COSINE));
    const double from_centre = Vector2d(u - c.cx, v - c.cy).norm() / (0.5 * std::hypot(c.width, c.height));
    o.confidence = record.fusion_weight * std::exp(-0.5 * std::pow(from_centre / gpu::CENTRALITY_SIGMA, 2));
    o.weight = o.confidence * std::pow(depth_sigma(params, 1) / depth_sigma(params, z), 2);
    return o;
}

void expect_surfels(const Launch& launch, const std::vector<Eigen::Vector4d>& positions,
                    const std::vector<Eigen::Vector4d>& normals, const std::vector<std::array<double, 6>>& looks) {
    expect_near(launch.read<vec4>("position_confidence"), positions, 4e-6, 0,
                "position");  // metres, sums of a few floats
    expect_near(launch.read<vec4>("normal_radius"), normals, 2e-6, 0, "normal");
    const auto appearances = launch.read<Appearance>("appearance");
    ASSERT_EQ(appearances.size(), looks.size());
    for (size_t i = 0; i < looks.size(); ++i) {
        const auto& a = appearances[i];
        ASSERT_LT((color_of(a) - Vector3d(looks[i][0], looks[i][1], looks[i][2])).cwiseAbs().maxCoeff(),
                  1.01 * kUnorm16)
            << i;
        ASSERT_NEAR(weight_of(a), looks[i][3], kHalf * looks[i][3]) << i;
        ASSERT_EQ(a.created, static_cast<uint>(looks[i][4])) << i;
        ASSERT_EQ(a.last_seen, static_cast<uint>(looks[i][5])) << i;
    }
}

Eigen::Vector4d with(const Vector3d& v, double w) { return {v.x(), v.y(), v.z(), w}; }

TEST_P(MapKernel, MergeFusesOwnersByTheirWeights) {
    const uint count = static_cast<uint>(n / 3);
    auto surfels = make_surfels(camera, world_live, count, 71);
    const auto depth = rough_depth(camera, 72);
    const auto geometry = rough_geometry(camera, depth, 73);
    const auto colors = smooth_colors(camera, 74);
    Random random(75);
    std::vector<uint> association(n), owner(count, gpu::NO_OWNER);
    for (size_t i = 0; i < n; ++i) {
        const bool usable = depth[i] > 0 && xyz(geometry[i]).squaredNorm() > 0.5;
        association[i] = !usable || random.chance(0.1) ? gpu::NO_SURFEL
                         : random.chance(0.2)          ? gpu::NEW_SURFEL
                                                       : random.below(count);
        if (association[i] >= gpu::NEW_SURFEL) continue;
        const uint key = owner_key(random.below(19), i);
        owner[association[i]] = std::min(owner[association[i]], key);
        // the surfel's normal agrees, as association sees to
        if (owner_pixel(owner[association[i]]) == i) {
            const Vector3d near_normal =
                (world_live.linear() * xyz(geometry[i]) + 0.2 * random.direction()).normalized();
            surfels.normals[association[i]] = vec4_of(near_normal, depth[i] / camera.fx * random.uniform(0.5, 2.5));
        }
    }
    Launch launch("map/fuse");
    launch.input("params", params).input("record", record);
    launch.input("static_depth", depth).input("live_geometry", geometry).input("color", colors);
    launch.input("association", association).input("owner", owner);
    launch.inout("position_confidence", surfels.positions).inout("normal_radius", surfels.normals);
    launch.inout("appearance", surfels.appearances).run_over(n);

    std::vector<Eigen::Vector4d> positions, normals;
    std::vector<std::array<double, 6>> looks;
    size_t fused = 0, confirmed = 0;
    for (uint s = 0; s < count; ++s) {
        const auto& a = surfels.appearances[s];
        Vector3d position = xyz(surfels.positions[s]), normal = xyz(surfels.normals[s]), color = color_of(a);
        double confidence = surfels.positions[s].w, radius = surfels.normals[s].w, weight = weight_of(a);
        uint last_seen = a.last_seen;
        if (owner[s] != gpu::NO_OWNER) {
            const auto o = observe(params, record, world_live, owner_pixel(owner[s]), depth, geometry, colors);
            if (o.radius < gpu::MUCH_COARSER * radius) {
                const double t = o.weight / (weight + o.weight);
                position += t * (o.position - position);
                normal = (normal + t * (o.normal - normal)).normalized();
                radius += t * (o.radius - radius);
                color += t * (o.color - color);
                weight = std::min(weight + o.weight, static_cast<double>(params.max_weight));
                ++fused;
            } else {
                ++confirmed;
            }
            confidence += o.confidence;
            last_seen = params.frame;
        }
        positions.push_back(with(position, confidence));
        normals.push_back(with(normal, radius));
        looks.push_back(
            {color.x(), color.y(), color.z(), weight, static_cast<double>(a.created), static_cast<double>(last_seen)});
    }
    EXPECT_GT(fused, count / 8);
    EXPECT_GT(confirmed, count / 50);
    expect_surfels(launch, positions, normals, looks);
}

TEST_P(MapKernel, FindDuplicatesMarksTheCoarserOfTwoStableSurfelsOfOneSurface) {
    const auto depth = rough_depth(camera, 76);
    for (const uint scale : {1u, 2u, 3u}) {
        Random random(77 + scale);
        const size_t cells = n * scale * scale;
        std::vector<uint> association(n), indices(cells, gpu::EMPTY_CELL);
        Surfels surfels;
        const auto add = [&](const Vector3d& p, const Vector3d& normal, double radius) {
            surfels.positions.push_back(
                vec4_of(p, random.chance(0.2) ? random.uniform(1, 10) : random.uniform(10, 30)));
            surfels.normals.push_back(vec4_of(normal, radius));
            surfels.appearances.push_back(make_appearance(
                {0.5, 0.5, 0.5}, 1, random.chance(0.3) ? random.below(params.duplicate_age) : 1000 * random.below(5),
                9000));
            return surfels.count++;
        };
        // in every pixel a surfel, and around it in the pixel's cells others at distances on both sides of the limits
        for (size_t i = 0; i < n; ++i) {
            association[i] = random.chance(0.1) ? gpu::NEW_SURFEL : random.chance(0.1) ? gpu::NO_SURFEL : 0;
            const Vector3d centre = random.direction() * random.uniform(0.5, 4), normal = random.direction();
            const double radius = random.uniform(0.003, 0.03);
            const uint first = add(centre, normal, radius);
            if (association[i] == 0) association[i] = first;
            const size_t row = i / static_cast<size_t>(camera.width) * scale,
                         column = i % static_cast<size_t>(camera.width) * scale;
            for (size_t k = 0; k < scale * scale; ++k) {
                const Vector3d across = normal.cross(random.direction()).normalized();
                const Vector3d p =
                    centre + random.uniform(0, 1) * radius * across + random.uniform(-0.03, 0.03) * normal;
                const Vector3d tilted = (normal + random.uniform(0, 0.8) * across).normalized();
                const size_t cell = (row + k / scale) * static_cast<size_t>(camera.width) * scale + column + k % scale;
                if (random.chance(0.2))
                    indices[cell] = first;
                else if (random.chance(0.7))
                    indices[cell] = add(p, tilted, radius * (random.chance(0.2) ? 1.0 : random.uniform(0.6, 1.6)));
            }
        }
        std::vector<uint> interleaved;
        for (const uint index : indices) interleaved.push_back(index), interleaved.push_back(0);
        const std::vector<uint> owner(surfels.count, gpu::NO_OWNER);
        std::vector<std::vector<uint>> found;
        for (const bool wide : {true, false}) {
            Launch launch("map/find_duplicates", {{"CELL_STRIDE", wide ? 2 : 1}, {"INDEX_SCALE", scale}}, wide);
            launch.input("params", params).input("static_depth", depth).input("association", association);
            launch.input("cell_indices", wide ? interleaved : indices);
            launch.input("position_confidence", surfels.positions).input("normal_radius", surfels.normals);
            launch.input("appearance", surfels.appearances).inout("owner", owner).run_over(n);
            found.push_back(launch.read<uint>("owner"));
        }
        EXPECT_EQ(found[0], found[1]);

        std::vector<uint> expected(surfels.count, gpu::NO_OWNER);
        const auto stable = [&](uint s) { return surfels.positions[s].w >= params.stable_confidence; };
        for (size_t i = 0; i < n; ++i) {
            const uint a = association[i];
            if (a >= gpu::NEW_SURFEL || !stable(a)) continue;
            const Vector3d normal = xyz(surfels.normals[a]);
            const double gate = std::max(static_cast<double>(params.duplicate_depth),
                                         params.duplicate_sigmas * depth_sigma(params, static_cast<double>(depth[i])));
            for (size_t k = 0; k < scale * scale; ++k) {
                const size_t row = i / static_cast<size_t>(camera.width) * scale + k / scale,
                             column = i % static_cast<size_t>(camera.width) * scale + k % scale;
                const uint b = indices[row * static_cast<size_t>(camera.width) * scale + column];
                if (b == gpu::EMPTY_CELL || b == a || !stable(b)) continue;
                const Vector3d offset = xyz(surfels.positions[b]) - xyz(surfels.positions[a]);
                const double height = normal.dot(offset), across = (offset - height * normal).norm();
                const float radius_a = surfels.normals[a].w, radius_b = surfels.normals[b].w;
                const uint created_a = surfels.appearances[a].created, created_b = surfels.appearances[b].created;
                const double spacing = static_cast<double>(params.duplicate_spacing * std::min(radius_a, radius_b));
                if (std::abs(height) >= gate || across >= spacing ||
                    normal.dot(xyz(surfels.normals[b])) <= static_cast<double>(params.association_cosine))
                    continue;
                if (std::max(created_a, created_b) - std::min(created_a, created_b) < params.duplicate_age) continue;
                if (std::max(radius_a, radius_b) >= gpu::MUCH_COARSER * std::min(radius_a, radius_b)) continue;
                const bool b_goes = radius_b != radius_a ? radius_b > radius_a : created_b > created_a;
                expected[b_goes ? b : a] = gpu::DUPLICATE_SURFEL;
            }
        }
        const auto marked = static_cast<size_t>(std::count(expected.begin(), expected.end(), gpu::DUPLICATE_SURFEL));
        EXPECT_GT(marked, n / 100);
        EXPECT_LT(marked, surfels.count / 2);
        expect_mostly_equal(found[0], expected, 1 + surfels.count / 2000, "surfels");  // limits are compared in float
    }
}

TEST_P(MapKernel, FindDuplicatesIsOffAtSpacingZero) {
    params.duplicate_spacing = 0;
    Launch launch("map/find_duplicates", {{"CELL_STRIDE", 2}, {"INDEX_SCALE", 1}});
    launch.input("params", params).input("static_depth", std::vector<float>(n, 1.0f));
    launch.input("association", std::vector<uint>(n, 0u)).input("cell_indices", std::vector<uint>(2 * n, 1u));
    launch.input("position_confidence", std::vector<vec4>(2, vec4{0, 0, 1, 50}));
    launch.input("normal_radius", std::vector<vec4>(2, vec4{0, 0, -1, 0.01f}));
    launch.input("appearance", std::vector<Appearance>{{0, 0, 0, 0}, {0, 0, 1000, 0}});
    launch.inout("owner", std::vector<uint>(2, gpu::NO_OWNER)).run_over(n);
    EXPECT_EQ(launch.read<uint>("owner"), std::vector<uint>(2, gpu::NO_OWNER));
}

TEST_P(MapKernel, CountNewCountsTheNewPixelsOfEachChunk) {
    Random random(81);
    std::vector<uint> association(n);
    for (auto& a : association)
        a = random.chance(0.4) ? gpu::NEW_SURFEL : random.chance(0.5) ? gpu::NO_SURFEL : random.below(100);
    const size_t chunks = (n + gpu::CHUNK - 1) / gpu::CHUNK;
    Launch launch("map/count_new");
    launch.input("params", params).input("association", association);
    launch.output<uint>("chunk_counts", chunks).run_over(chunks);
    std::vector<uint> expected(chunks, 0);
    for (size_t i = 0; i < n; ++i) expected[i / gpu::CHUNK] += association[i] == gpu::NEW_SURFEL;
    EXPECT_EQ(launch.read<uint>("chunk_counts"), expected);
}

TEST_P(MapKernel, AppendWritesNewSurfelsInThePixelsOrder) {
    const auto depth = rough_depth(camera, 82);
    const auto geometry = rough_geometry(camera, depth, 83);
    const auto colors = smooth_colors(camera, 84);
    Random random(85);
    const uint old = 37;
    std::vector<uint> association(n), offsets((n + gpu::CHUNK - 1) / gpu::CHUNK);
    std::vector<size_t> fresh;
    for (size_t i = 0; i < n; ++i) {
        if (i % gpu::CHUNK == 0) offsets[i / gpu::CHUNK] = static_cast<uint>(fresh.size());
        const bool usable = depth[i] > 0 && xyz(geometry[i]).squaredNorm() > 0.5;
        association[i] = usable && random.chance(0.3) ? gpu::NEW_SURFEL
                         : random.chance(0.5)         ? gpu::NO_SURFEL
                                                      : random.below(old);
        if (association[i] == gpu::NEW_SURFEL) fresh.push_back(i);
    }
    const auto before = make_surfels(camera, world_live, old, 86);
    auto room = before;
    room.positions.resize(old + fresh.size());
    room.normals.resize(old + fresh.size());
    room.appearances.resize(old + fresh.size());
    Launch launch("map/append");
    launch.input("params", params).input("record", record).input("counters", MapRecord{old, 0, 0, 0});
    launch.input("static_depth", depth).input("live_geometry", geometry).input("color", colors);
    launch.input("association", association).input("chunk_offsets", offsets);
    launch.inout("position_confidence", room.positions).inout("normal_radius", room.normals);
    launch.inout("appearance", room.appearances).run_over(offsets.size());

    std::vector<Eigen::Vector4d> positions, normals;
    std::vector<std::array<double, 6>> looks;
    for (uint s = 0; s < old; ++s) {  // untouched
        positions.push_back(with(xyz(before.positions[s]), before.positions[s].w));
        normals.push_back(with(xyz(before.normals[s]), before.normals[s].w));
        const auto& a = before.appearances[s];
        const Vector3d color = color_of(a);
        looks.push_back({color.x(), color.y(), color.z(), weight_of(a), static_cast<double>(a.created),
                         static_cast<double>(a.last_seen)});
    }
    for (const size_t i : fresh) {
        const auto o = observe(params, record, world_live, i, depth, geometry, colors);
        positions.push_back(with(o.position, std::max<double>(o.confidence, gpu::MIN_NEW_CONFIDENCE)));
        normals.push_back(with(o.normal, o.radius));
        looks.push_back(
            {o.color.x(), o.color.y(), o.color.z(), std::max<double>(o.weight, gpu::MIN_NEW_CONFIDENCE), 63, 63});
    }
    expect_surfels(launch, positions, normals, looks);
}

// -------------------------------------------------------------------------------------- counting, prefix sum,
// compaction

class MapBookkeeping : public DeviceTest {};

TEST_F(MapBookkeeping, PrefixSumIsExclusiveAndInPlace) {
    for (const uint items : {0u, 1u, 16u, 17u, 4095u, 4096u, 4097u, 76800u}) {
        Random random(items);
        const size_t chunks = (items + gpu::CHUNK - 1) / gpu::CHUNK;
        std::vector<uint> counts(std::max<size_t>(chunks, 1));
        for (auto& count : counts) count = random.below(17);
        std::vector<uint> expected(counts);
        uint total = 0;
        for (size_t i = 0; i < chunks; ++i) {
            expected[i] = total;
            total += counts[i];
        }
        for (const uint counts_of : {gpu::COUNTS_OF_PIXELS, gpu::COUNTS_OF_SLOTS}) {
            const bool of_pixels = counts_of == gpu::COUNTS_OF_PIXELS;
            const MapRecord before = of_pixels ? MapRecord{999, 7, 5, 3} : MapRecord{items, 7, 5, 3};
            Launch launch("map/prefix_sum");
            launch.inout("counters", before).inout("chunk_counts", counts);
            launch.run(1, {{"counts_of", counts_of}, {"pixels", of_pixels ? items : 0u}});
            EXPECT_EQ(launch.read<uint>("chunk_counts"), expected) << items;
            const auto map = launch.read<MapRecord>("counters")[0];
            EXPECT_EQ(map.appended, of_pixels ? total : 7u);
            EXPECT_EQ(map.count, of_pixels ? 999u : total);
        }
    }
}

TEST_F(MapBookkeeping, GrowTakesTheAppendedInAndCoversAllSurfels) {
    for (const auto& [count, appended, groups] :
         {std::array{0u, 0u, 0u}, {0u, 1u, 1u}, {1000u, 24u, 1u}, {1000u, 25u, 2u}, {5000000u, 0u, 4883u}}) {
        Launch launch("map/grow");
        launch.inout("counters", MapRecord{count, appended, 9, 9}).output<gpu::DispatchArguments>("arguments", 1);
        launch.run(1);
        const auto map = launch.read<MapRecord>("counters")[0];
        EXPECT_EQ(map.count, count + appended);
        EXPECT_EQ(map.appended + map.alive + map.stable, 0u);
        const auto arguments = launch.read<gpu::DispatchArguments>("arguments")[0];
        EXPECT_EQ(arguments.x, groups);
        EXPECT_EQ(arguments.y * arguments.z, 1u);
    }
}

TEST_F(MapBookkeeping, CompactionKeepsTheLiveSurfelsInTheirOrder) {
    const Camera camera = camera_at(make_params(test_cameras()[0]));
    for (const uint slots : {1u, 15u, 16u, 1025u, 6000u}) {
        for (const double dead : {0.0, 0.5, 1.0}) {
            auto surfels = make_surfels(camera, Isometry3d::Identity(), slots, slots);
            Random random(slots + 1);
            std::vector<uint> live;
            for (uint i = 0; i < slots; ++i) {
                surfels.positions[i].w = random.chance(dead) ? 0.0f : 1.0f;
                if (surfels.positions[i].w > 0) live.push_back(i);
            }
            const size_t chunks = (slots + gpu::CHUNK - 1) / gpu::CHUNK;
            Launch count("map/count_live");
            count.input("counters", MapRecord{slots}).input("position_confidence", surfels.positions);
            count.output<uint>("chunk_counts", chunks).run_over(chunks);
            auto offsets = count.read<uint>("chunk_counts");
            std::vector<uint> expected_counts(chunks, 0);
            for (const uint i : live) ++expected_counts[i / gpu::CHUNK];
            ASSERT_EQ(offsets, expected_counts);
            std::exclusive_scan(offsets.begin(), offsets.end(), offsets.begin(), 0u);

            const size_t room = std::max<size_t>(live.size(), 1);
            Launch compact("map/compact");
            compact.input("chunk_offsets", offsets).input("position_confidence", surfels.positions);
            compact.input("normal_radius", surfels.normals).input("appearance", surfels.appearances);
            compact.output<vec4>("new_position_confidence", room).output<vec4>("new_normal_radius", room);
            compact.output<Appearance>("new_appearance", room).run_over(chunks, {{"slots", slots}});
            const auto positions = compact.read<vec4>("new_position_confidence"),
                       normals = compact.read<vec4>("new_normal_radius");
            const auto appearances = compact.read<Appearance>("new_appearance");
            for (size_t i = 0; i < live.size(); ++i) {
                ASSERT_EQ(std::memcmp(&positions[i], &surfels.positions[live[i]], sizeof(vec4)), 0);
                ASSERT_EQ(std::memcmp(&normals[i], &surfels.normals[live[i]], sizeof(vec4)), 0);
                ASSERT_EQ(std::memcmp(&appearances[i], &surfels.appearances[live[i]], sizeof(Appearance)), 0);
            }
        }
    }
}

// ------------------------------------------------------------------------------------------------------------- clean

TEST_P(MapKernel, CleanRemovesWhatDoesNotBelongToTheStaticScene) {
    params.active_since = 25;  // of last_seen 0..59
    const size_t row_words = (static_cast<size_t>(camera.width) + gpu::MASK_WORD - 1) / gpu::MASK_WORD;
    const auto labels = blobs(camera, 91);
    const auto measured = rough_depth(camera, 92);
    std::vector<uint> mask(row_words * static_cast<size_t>(camera.height), 0);
    std::vector<float> depth = measured;
    for (size_t i = 0; i < n; ++i) {
        const size_t u = i % static_cast<size_t>(camera.width), v = i / static_cast<size_t>(camera.width);
        if (labels[i]) mask[v * row_words + u / gpu::MASK_WORD] |= 1u << (u % gpu::MASK_WORD), depth[i] = 0;
        if (depth[i] > params.depth_max || depth[i] < params.depth_min) depth[i] = 0;
    }
    // half of the masked pixels are of people, the others of a thing that moves
    params.first_mover_label = 101;
    std::vector<uint> color(n, 0);
    Random of_label(95);
    for (size_t i = 0; i < n; ++i)
        if (labels[i]) color[i] = (of_label.chance(0.5) ? 100u : 101u) << 24;
    const auto moves = [&](size_t i) { return (color[i] >> 24) >= params.first_mover_label; };
    for (const bool failed : {false, true}) {
        TrackingRecord r = record;
        r.failed = failed;
        for (const uint count : kCounts) {
            auto surfels = make_surfels(camera, world_live, count, 93 + count);
            Random random(94);
            for (uint i = 0; i < count; ++i) {  // near measured depth: on it, before it, behind it
                if (i % 3 == 0) surfels.positions[i].w *= 0.05f;
                if (random.chance(0.6)) surfels.appearances[i].last_seen = params.frame - 1;
                if (random.chance(0.2)) continue;
                const int u = static_cast<int>(random.below(static_cast<uint>(camera.width))),
                          v = static_cast<int>(random.below(static_cast<uint>(camera.height)));
                const double z = static_cast<double>(measured[static_cast<size_t>(camera.index(u, v))]);
                if (z <= 0) continue;
                const double factors[] = {1, 1.002, 0.7, 0.9, 1.3};
                const Vector3d p = camera.back_project(u + random.uniform(-0.4, 0.4), v + random.uniform(-0.4, 0.4),
                                                       z * factors[random.below(5)]);
                surfels.positions[i] = vec4_of(world_live * p, surfels.positions[i].w);
            }
            Launch launch("map/clean");
            launch.input("params", params).input("record", r).inout("counters", MapRecord{count});
            launch.input("static_depth", depth).input("depth", measured).input("mask", mask);
            launch.input("color", color);
            std::vector<uint> owner(std::max(count, 1u));
            for (auto& key : owner)
                key = random.chance(0.1)   ? gpu::DUPLICATE_SURFEL
                      : random.chance(0.5) ? gpu::NO_OWNER
                                           : random.below(1000);
            launch.inout("position_confidence", surfels.positions).input("appearance", surfels.appearances);
            launch.input("owner", owner).run(least_groups(count));

            const auto evidence = [&](int u, int v, double z) {
                const double d = static_depth_at(depth, u, v);
                if (d <= 0) return 0;
                const double margin = std::max(static_cast<double>(params.free_space_margin),
                                               params.free_space_sigmas * depth_sigma(params, d));
                return d - z > margin ? 1 : -1;
            };
            std::vector<float> confidences;
            std::vector<double> expected;
            uint inactive = 0, in_view = 0, seen_through = 0;
            for (uint i = 0; i < count; ++i) {
                const bool active = surfels.appearances[i].last_seen >= params.active_since;
                double confidence = surfels.positions[i].w;
                const bool stable = confidence >= static_cast<double>(params.stable_confidence);
                const Vector3d p = camera_world * xyz(surfels.positions[i]);
                if (confidence > 0 && p.z() > gpu::NEAR_PLANE) {
                    const Vector2d at = camera.project(p);
                    const int u = static_cast<int>(std::floor(at.x() + 0.5)),
                              v = static_cast<int>(std::floor(at.y() + 0.5));
                    constexpr int kFar = gpu::FREE_SPACE_NEIGHBOUR;
                    if (camera.contains(u - kFar, v - kFar) && camera.contains(u + kFar, v + kFar)) {
                        const double d = static_depth_at(depth, u, v);
                        inactive += !active && stable && d > 0 && std::abs(d - p.z()) < gpu::INACTIVE_NEAR;
                        const int here = failed || !active ? 0 : evidence(u, v, p.z());
                        const int all = here + evidence(u + kFar, v, p.z()) + evidence(u - kFar, v, p.z()) +
                                        evidence(u, v + kFar, p.z()) + evidence(u, v - kFar, p.z());
                        in_view += here != 0;
                        seen_through += here > 0 && all >= gpu::MIN_FREE_VOTES;
                        if (here > 0 && all >= gpu::MIN_FREE_VOTES) {
                            confidence *= static_cast<double>(params.free_space_decay);
                            if (confidence < gpu::MIN_CONFIDENCE) confidence = 0;
                        }
                        const double margin =
                            params.free_space_margin + gpu::PERSON_SIGMAS * depth_sigma(params, p.z());
                        const auto pixel = static_cast<size_t>(camera.index(u, v));
                        if (!failed && active && labels[pixel] && (!stable || moves(pixel)) &&
                            std::abs(static_depth_at(measured, u, v) - p.z()) < margin) {
                            confidence = 0;
                        }
                    }
                }
                if (!failed && !stable && params.frame - surfels.appearances[i].last_seen > params.unstable_timeout)
                    confidence = 0;
                if (owner[i] == gpu::DUPLICATE_SURFEL) confidence = 0;
                expected.push_back(confidence);
            }
            const auto positions = launch.read<vec4>("position_confidence");
            uint alive = 0, stable = 0;
            for (uint i = 0; i < count; ++i) {
                confidences.push_back(positions[i].w);
                ASSERT_EQ(xyz(positions[i]), xyz(surfels.positions[i]));
                alive += positions[i].w > 0;
                stable += positions[i].w > 0 && positions[i].w >= params.stable_confidence;
            }
            expect_near(confidences, expected, 2e-6 * 20, 1 + count / 2000, "surfel");  // ties: see IndexMap
            const auto map = launch.read<MapRecord>("counters")[0];
            EXPECT_EQ(map.alive, alive);
            EXPECT_EQ(map.stable, stable);
            EXPECT_NEAR(map.inactive_in_view, inactive, 1 + count / 2000);  // ties, likewise
            EXPECT_NEAR(map.in_view, in_view, 1 + count / 2000);
            EXPECT_NEAR(map.seen_through, seen_through, 1 + count / 2000);
            EXPECT_EQ(map.count, count);
        }
    }
}

// -------------------------------------------------------------------------------------------------------- prediction

struct Hit {
    double z = 0, distance2 = 0;  ///< depth; squared distance from the disc's centre in radii
};

/// Where the ray of pixel (u, v) meets the disc of a surfel, in the camera frame; z = 0: nowhere.
Hit disc_hit(const Camera& c, int u, int v, const Vector3d& centre, const Vector3d& normal, double radius) {
    const Vector3d ray = c.back_project(u, v, 1);
    const double slope = normal.dot(ray);
    if (slope >= -gpu::MIN_DISC_SLOPE) return {};
    const double z = normal.dot(centre) / slope, distance2 = (z * ray - centre).squaredNorm() / (radius * radius);
    return z > gpu::NEAR_PLANE && distance2 <= 1 ? Hit{z, distance2} : Hit{};
}

/// The nearest depth, counted as farther towards the rim of the disc.
uint disc_key(const Params& params, const Hit& hit) {
    return std::bit_cast<uint>(
        static_cast<float>(hit.z + gpu::DISC_DEPTH_SIGMAS * depth_sigma(params, hit.z) * hit.distance2));
}

class Prediction : public MapKernel {
protected:
    [[nodiscard]] Cells splat(const Surfels& surfels, bool wide) const {
        const auto bind = [&](Launch& launch) {
            launch.input("params", params).input("record", record).input("counters", MapRecord{surfels.count});
            launch.input("position_confidence", surfels.positions).input("normal_radius", surfels.normals);
            launch.input("appearance", surfels.appearances);
        };
        return wide ? depth_test_64("map/splat", n, surfels.count, {}, bind)
                    : depth_test_32("map/splat", n, surfels.count, {}, bind);
    }
};

INSTANTIATE_TEST_SUITE_P(Sizes, Prediction, testing::Range(size_t{0}, test_cameras().size()), [](const auto& test) {
    const auto camera = test_cameras()[test.param];
    return std::to_string(camera.width) + "x" + std::to_string(camera.height);
});

TEST_P(Prediction, SplatDrawsEveryConfidentSurfelOfTheActiveOrInactiveModelAsADisc) {
    params.active_since = 20;  // of last_seen 0..59
    for (const uint count : kCounts) {
        params.inactive_only = count % 2;
        const auto surfels = make_surfels(camera, world_live, count, 100 + count);
        const auto wide = splat(surfels, true), narrow = splat(surfels, false);
        EXPECT_EQ(wide.indices, narrow.indices);
        EXPECT_EQ(wide.keys, narrow.keys);

        std::vector<uint> keys(n, gpu::EMPTY_CELL), indices(n, gpu::EMPTY_CELL);
        for (uint i = 0; i < count; ++i) {
            const Vector3d p = camera_world * xyz(surfels.positions[i]),
                           normal = camera_world.linear() * xyz(surfels.normals[i]);
            const double confidence = surfels.positions[i].w, radius = surfels.normals[i].w;
            if (confidence < static_cast<double>(params.predict_confidence) || p.z() < gpu::NEAR_PLANE ||
                normal.dot(p) >= 0)
                continue;
            const Vector2d at = camera.project(p);
            const double kMost = gpu::MAX_DISC_EXTENT;
            const double extent = std::min(radius * std::max(camera.fx, camera.fy) / p.z(), kMost);
            if ((surfels.appearances[i].last_seen < params.active_since) != (params.inactive_only != 0)) continue;
            if (at.x() < -kMost || at.y() < -kMost || at.x() > camera.width + kMost || at.y() > camera.height + kMost)
                continue;
            for (int v = static_cast<int>(std::ceil(at.y() - extent));
                 v <= static_cast<int>(std::floor(at.y() + extent)); ++v) {
                for (int u = static_cast<int>(std::ceil(at.x() - extent));
                     u <= static_cast<int>(std::floor(at.x() + extent)); ++u) {
                    if (!camera.contains(u, v)) continue;
                    const Hit hit = disc_hit(camera, u, v, p, normal, radius);
                    if (hit.z <= 0) continue;
                    const auto pixel = static_cast<size_t>(camera.index(u, v));
                    const uint key = disc_key(params, hit);
                    if (key < keys[pixel]) keys[pixel] = key, indices[pixel] = i;
                }
            }
        }
        // rims of discs and borders of layers are decided by rounding: of ~10 discs per pixel, 1e-5 of each
        expect_mostly_equal(wide.indices, indices, 1 + n / 500, "pixels");
    }
}

TEST_P(Prediction, SplatShowsOfOneSurfaceTheDiscClosestToTheRayAndOfTwoTheNearer) {
    // three discs on the ray of one pixel: two noisy ones of one surface, one of a surface half a metre behind
    const int u = camera.width / 2, v = camera.height / 2;
    const Vector3d normal = world_live.linear() * Vector3d(0, 0, -1);
    const double z = 1.5, radius = 3 * z / camera.fx;
    Surfels s;
    s.count = 3;
    s.positions = {vec4_of(world_live * camera.back_project(u + 0.9, v, z), 20),
                   vec4_of(world_live * camera.back_project(u + 0.1, v, z + 1e-5), 20),
                   vec4_of(world_live * camera.back_project(u, v, z + 0.5), 20)};
    s.normals = std::vector<vec4>(3, vec4_of(normal, radius));
    s.appearances = std::vector<Appearance>(3, make_appearance({0.5, 0.5, 0.5}, 1, 0, 0));
    const auto cells = splat(s, true);
    EXPECT_EQ(cells.indices[static_cast<size_t>(camera.index(u, v))], 1u);
}

TEST_P(Prediction, ResolveShowsTheWinnerAndFillsInFromTheLiveFrame) {
    const auto surfels = make_surfels(camera, world_live, 6000, 111);
    const auto depth = rough_depth(camera, 112);
    const auto geometry = rough_geometry(camera, depth, 113);
    const auto colors = smooth_colors(camera, 114);
    const auto cells = splat(surfels, true);
    std::vector<uint> interleaved;
    for (size_t i = 0; i < n; ++i) interleaved.push_back(cells.indices[i]), interleaved.push_back(cells.keys[i]);

    for (const auto& [wide, fill_in, failed] :
         {std::array{true, true, false}, {false, true, false}, {true, false, false}, {true, true, true}}) {
        TrackingRecord r = record;
        r.failed = failed;
        Launch launch("map/resolve", {{"CELL_STRIDE", wide ? 2 : 1}}, wide);
        launch.input("params", params).input("record", r).input("cell_indices", wide ? interleaved : cells.indices);
        launch.input("position_confidence", surfels.positions).input("normal_radius", surfels.normals);
        launch.input("appearance", surfels.appearances);
        launch.input("live_geometry", geometry).input("color", colors);
        launch.output<vec4>("model_geometry", n).output<float>("model_intensity", n);
        launch.output<float>("model_depth", n).output<uint>("model_color", n);
        launch.run_over(n, {{"fill_in", fill_in}});

        std::vector<Eigen::Vector4d> expected;
        std::vector<double> expected_intensity, expected_depth;
        const auto looks = launch.read<uint>("model_color");
        size_t drawn = 0;
        for (size_t i = 0; i < n; ++i) {
            const int u = static_cast<int>(i) % camera.width, v = static_cast<int>(i) / camera.width;
            Eigen::Vector4d shape = Eigen::Vector4d::Zero();
            double shade = -1;
            uint rgb = 0, source = gpu::SOURCE_NONE;
            if (const uint s = cells.indices[i]; s != gpu::EMPTY_CELL) {
                const Vector3d normal = camera_world.linear() * xyz(surfels.normals[s]);
                const Vector3d centre = camera_world * xyz(surfels.positions[s]);
                shape = with(normal, normal.dot(centre) / normal.dot(camera.back_project(u, v, 1)));
                const Vector3d color = color_of(surfels.appearances[s]);
                shade = luma(color), rgb = pack(color);
                source = gpu::SOURCE_MAP;
                ++drawn;
            } else if (fill_in && !failed) {
                shape = with(xyz(geometry[i]), geometry[i].w);
                if (geometry[i].w > 0) {
                    const Vector3d color = in_map_exposure(record, colors[i]);
                    shade = luma(color), rgb = pack(color), source = gpu::SOURCE_LIVE;
                }
            }
            expected.push_back(shape);
            expected_depth.push_back(shape(3));
            expected_intensity.push_back(shade);
            ASSERT_EQ(looks[i] >> 24, source) << i;
            for (const int shift : {0, 8, 16}) {
                ASSERT_NEAR(static_cast<double>(looks[i] >> shift & 255u), static_cast<double>(rgb >> shift & 255u),
                            1.0)
                    << i;
            }
        }
        EXPECT_GT(drawn, n / 4);
        // grazing discs: the depth along the ray is rounding divided by the slope
        expect_near(launch.read<vec4>("model_geometry"), expected, 2e-5, n / 500);
        expect_near(launch.read<float>("model_depth"), expected_depth, 2e-5, n / 500);
        expect_near(launch.read<float>("model_intensity"), expected_intensity, 1e-6);
        const auto shapes = launch.read<vec4>("model_geometry");
        for (size_t i = 0; i < n; ++i) {
            ASSERT_EQ(looks[i] >> 24 != 0, shapes[i].w > 0)
                << "pixel " << i << " shows a colour but no depth, or the other way round";
        }
    }
}

}  // namespace
}  // namespace posefusion::test
