#include "hosts/texture/texturing.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "engine/core/error.hpp"
#include "engine/core/pinhole.hpp"
#include "hosts/texture/charts.hpp"
#include "hosts/texture/exposure.hpp"
#include "hosts/texture/triangle_raster.hpp"
#include "hosts/texture/view_choice.hpp"

/// A corner of a painted room, seen from a few places: what the texture shows is known.
namespace posefusion::test {
namespace {

constexpr Rgb8 kPerson{255, 0, 255}, kUnseen{10, 200, 10};
constexpr float kWall = 2, kFloor = 0.6f, kHalf = 0.8f;  // m: the wall is at z = 2, the floor at y = 0.6
constexpr float kStep = 0.05f;                           // between vertices

/// The paint of the room.
Eigen::Vector3f paint(const Eigen::Vector3f& p) {
    const auto wave = [](float phase) { return 110 + 70 * std::sin(phase); };
    return {wave(9 * p.x()), wave(8 * (p.y() + p.z())), wave(5 * (p.x() - p.y() + p.z()))};
}

Rgb8 rounded(const Eigen::Vector3f& c) {
    const auto byte = [](float value) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, 255.0f)));
    };
    return {byte(c.x()), byte(c.y()), byte(c.z())};
}

/// Adds a square grid. @param side, down  its edges; their cross product faces the room
void add_grid(Mesh& mesh, const Eigen::Vector3f& corner, const Eigen::Vector3f& side, const Eigen::Vector3f& down,
              float step = kStep) {
    const auto columns = static_cast<std::uint32_t>(std::lround(side.norm() / step));
    const auto rows = static_cast<std::uint32_t>(std::lround(down.norm() / step));
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::uint32_t r = 0; r <= rows; ++r) {
        for (std::uint32_t c = 0; c <= columns; ++c) {
            const Eigen::Vector3f p = corner + side * static_cast<float>(c) / static_cast<float>(columns) +
                                      down * static_cast<float>(r) / static_cast<float>(rows);
            mesh.vertices.push_back({p, rounded(paint(p))});
        }
    }
    const auto at = [&](std::uint32_t r, std::uint32_t c) { return first + r * (columns + 1) + c; };
    for (std::uint32_t r = 0; r < rows; ++r) {
        for (std::uint32_t c = 0; c < columns; ++c) {
            mesh.faces.push_back({at(r, c), at(r, c + 1), at(r + 1, c)});
            mesh.faces.push_back({at(r, c + 1), at(r + 1, c + 1), at(r + 1, c)});
        }
    }
}

Mesh room(float step = kStep) {
    Mesh mesh;
    add_grid(mesh, {-kHalf, -0.6f, kWall}, {0, 1.2f, 0}, {2 * kHalf, 0, 0}, step);    // faces -z
    add_grid(mesh, {-kHalf, kFloor, 1}, {2 * kHalf, 0, 0}, {0, 0, kWall - 1}, step);  // faces -y
    return mesh;
}

class Texturing : public ::testing::Test {
protected:
    Texturing() {
        views_.camera = {130, 130, 79.5f, 59.5f, 160, 120};
        views_.count = 4;
        views_.load = [this](std::size_t i) {
            ++loaded_;
            return view(i);
        };
    }

    /// The cameras stand beside each other, each with an exposure of its own. In view 1 is a person with a mask, in
    /// view 2 one without, whose depth was measured.
    [[nodiscard]] View view(std::size_t number) const {
        constexpr std::array kExposure{0.8f, 1.0f, 1.15f, 1.05f};
        const Intrinsics& K = views_.camera;
        View view;
        view.T_world_camera.translation().x() = 0.15 * (static_cast<double>(number) - 1.5);
        view.color = ColorImage(K.width, K.height);
        view.depth = DepthImage(K.width, K.height);
        view.people = LabelImage(K.width, K.height);
        const Eigen::Vector3f origin = view.T_world_camera.translation().cast<float>();
        for (int v = 0; v < K.height; ++v) {
            for (int u = 0; u < K.width; ++u) {
                const Eigen::Vector3f ray = pixel_ray(static_cast<float>(u), static_cast<float>(v), K);
                const float z = ray.y() > 0 ? std::min(kWall, kFloor / ray.y()) : kWall;
                view.color(u, v) = rounded(kExposure[number] * paint(origin + z * ray));
                view.depth(u, v) = z;
                const bool person = (number == 1 || number == 2) && std::abs(u - 80) < 15 && v > 30;
                if (!person) continue;
                view.color(u, v) = kPerson;
                view.depth(u, v) = number == 2 ? 1.0f : 0.0f;
                if (number == 1) view.people(u, v) = 1;
            }
        }
        return view;
    }

    [[nodiscard]] TexturedMesh textured(const Mesh& mesh, int size = 1024) {
        return make_texture(mesh, views_, {size},
                            {[](const std::string&, std::size_t, std::size_t) {},
                             [this](const std::string& text) { warnings_.push_back(text); }});
    }

    static Eigen::Vector3f color_at(const ColorImage& texture, const Eigen::Vector2f& uv) {
        const int u = static_cast<int>(uv.x() * static_cast<float>(texture.width()));
        const int v = static_cast<int>(uv.y() * static_cast<float>(texture.height()));
        const Rgb8 c = texture(u, v);
        return {static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)};
    }

    /// Calls visit(centre of a face, its colour in the texture).
    template <class Visit>
    static void for_each_face(const TexturedMesh& mesh, Visit&& visit) {
        for (const auto& face : mesh.faces) {
            Eigen::Vector3f p = Eigen::Vector3f::Zero();
            Eigen::Vector2f uv = Eigen::Vector2f::Zero();
            for (const std::uint32_t corner : face) {
                p += mesh.vertices[corner].position / 3;
                uv += mesh.vertices[corner].uv / 3;
            }
            visit(p, color_at(mesh.texture, uv));
        }
    }

    TextureViews views_;
    std::size_t loaded_ = 0;
    std::vector<std::string> warnings_;
};

TEST_F(Texturing, ShowsTheRoomWithoutPeopleInOneExposure) {
    const TexturedMesh result = textured(room());
    ASSERT_EQ(result.faces.size(), room().faces.size());
    EXPECT_TRUE(warnings_.empty());
    double sum = 0, signed_sum = 0;
    std::size_t count = 0;
    for_each_face(result, [&](const Eigen::Vector3f& p, const Eigen::Vector3f& color) {
        const Eigen::Vector3f difference = color - paint(p);
        EXPECT_LT(difference.cwiseAbs().maxCoeff(), 25) << p.transpose() << ": " << difference.transpose();
        sum += static_cast<double>(difference.cwiseAbs().mean());
        signed_sum += static_cast<double>(difference.mean());
        ++count;
    });
    EXPECT_LT(sum / static_cast<double>(count), 5);
    EXPECT_LT(std::abs(signed_sum) / static_cast<double>(count), 4);
}

TEST_F(Texturing, ShowsWhatIsBetweenTheVertices) {
    Mesh coarse;
    add_grid(coarse, {-kHalf, -0.6f, kWall}, {0, 1.2f, 0}, {2 * kHalf, 0, 0}, 0.4f);  // all views show all of it
    const TexturedMesh result = textured(coarse);
    EXPECT_LT(result.texel, 0.02f);
    EXPECT_LE(loaded_, 2 * views_.count);
    double by_texture = 0, by_vertices = 0;
    for_each_face(result, [&](const Eigen::Vector3f& p, const Eigen::Vector3f& color) {
        by_texture += static_cast<double>((color - paint(p)).cwiseAbs().mean());
    });
    for (const auto& face : coarse.faces) {
        Eigen::Vector3f p = Eigen::Vector3f::Zero(), color = p;
        for (const std::uint32_t corner : face) {
            const Rgb8 c = coarse.vertices[corner].color;
            p += coarse.vertices[corner].position / 3;
            color += Eigen::Vector3f(c.r, c.g, c.b) / 3;
        }
        by_vertices += static_cast<double>((color - paint(p)).cwiseAbs().mean());
    }
    EXPECT_LT(by_texture, by_vertices / 3);
}

TEST_F(Texturing, KeepsTheVertexColoursOfWhatNobodySaw) {
    Mesh mesh = room();
    const std::size_t seen = mesh.faces.size();
    const std::size_t first = mesh.vertices.size();
    add_grid(mesh, {-kHalf, -0.6f, kWall + 0.5f}, {0, 1.2f, 0}, {2 * kHalf, 0, 0});  // behind the wall
    for (std::size_t i = first; i < mesh.vertices.size(); ++i) mesh.vertices[i].color = kUnseen;
    const TexturedMesh result = textured(mesh);
    std::size_t hidden = 0;
    for (const auto& face : result.faces) {
        const Eigen::Vector3f& p = result.vertices[face[0]].position;
        if (p.z() < kWall + 0.4f) continue;
        const Eigen::Vector3f color = color_at(result.texture, result.vertices[face[0]].uv);
        EXPECT_EQ(rounded(color), kUnseen);
        ++hidden;
    }
    EXPECT_EQ(hidden, result.faces.size() - seen);
}

TEST_F(Texturing, StaysWithinItsSizeAndIsTheSameEveryTime) {
    const TexturedMesh a = textured(room(), 64), b = textured(room(), 64);
    EXPECT_EQ(a.texture.width(), 64);
    EXPECT_GT(a.texel, textured(room()).texel);
    EXPECT_TRUE(std::equal(a.texture.begin(), a.texture.end(), b.texture.begin()));
    for (const TexturedVertex& vertex : a.vertices) {
        EXPECT_GT(vertex.uv.minCoeff(), 0);
        EXPECT_LT(vertex.uv.maxCoeff(), 1);
    }
}

TEST_F(Texturing, AViewThatCannotBeReadIsLeftOut) {
    views_.load = [this](std::size_t i) {
        if (i == 3) throw Error("view 3 is damaged");
        return view(i);
    };
    EXPECT_GT(textured(room()).views, 0u);
    ASSERT_FALSE(warnings_.empty());
    EXPECT_EQ(warnings_.front(), "view 3 is damaged");
    Mesh elsewhere = room();
    for (MeshVertex& vertex : elsewhere.vertices) vertex.position.z() -= 50;
    EXPECT_THROW((void)textured(elsewhere), Error);
}

/// Two turns of a spiral staircase without steps: seen from above the second lies over the first.
Mesh spiral() {
    constexpr std::uint32_t kPerTurn = 40;
    Mesh mesh;
    for (std::uint32_t i = 0; i <= 2 * kPerTurn; ++i) {
        const float turn = static_cast<float>(i) / kPerTurn, angle = 2 * std::numbers::pi_v<float> * turn;
        for (const float radius : {0.4f, 0.7f})
            mesh.vertices.push_back({{radius * std::cos(angle), radius * std::sin(angle), 0.3f * turn}, {}});
    }
    for (std::uint32_t i = 0; i < 2 * kPerTurn; ++i) {
        mesh.faces.push_back({2 * i, 2 * i + 1, 2 * i + 2});
        mesh.faces.push_back({2 * i + 1, 2 * i + 3, 2 * i + 2});
    }
    return mesh;
}

TEST(Charts, HaveEveryTriangleOnceAndDoNotOverlap) {
    const Mesh mesh = spiral();
    constexpr float kTexel = 0.01f;
    const std::vector<Chart> charts = cut_into_charts(mesh, kTexel, 10);
    std::vector<int> times(mesh.faces.size());
    for (const Chart& chart : charts) {
        Image<std::uint8_t> taken(300, 300);
        for (const std::uint32_t face : chart.faces) {
            ++times[face];
            Triangle2 triangle;
            for (std::size_t k = 0; k < 3; ++k)
                triangle[k] = chart.place_of(mesh.vertices[mesh.faces[face][k]].position) / kTexel;
            rasterise(triangle, 300, 300, [&](int u, int v, const Eigen::Vector3f&) { ++taken(u, v); });
        }
        EXPECT_EQ(std::count_if(taken.begin(), taken.end(), [](int count) { return count > 1; }), 0);
    }
    EXPECT_EQ(charts.size(), 2u);
    EXPECT_EQ(std::count(times.begin(), times.end(), 1), static_cast<std::ptrdiff_t>(times.size()));
    for (const Chart& chart : cut_into_charts(mesh, kTexel, 0.4f)) EXPECT_LT(chart.size.maxCoeff(), 0.6f);
}

TEST(Exposure, FactorsUndoTheGainsOfTheViews) {
    constexpr std::array kGains{0.7f, 1.0f, 1.3f};
    std::vector<ColorSample> samples;
    std::vector<Eigen::Vector3f> map;
    for (std::uint32_t place = 0; place < 200; ++place) {
        map.push_back(Eigen::Vector3f(60, 90, 120) + Eigen::Vector3f::Constant(static_cast<float>(place % 50)));
        for (std::uint32_t view = 0; view < 3; ++view) {
            const bool reflection = place % 20 == 0 && view == 1;
            samples.push_back({place, view, reflection ? Eigen::Vector3f(240, 240, 240) : kGains[view] * map[place]});
        }
    }
    const auto factors = level_exposure(samples, map, 4);
    for (Eigen::Index channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR(factors[0][channel] * kGains[0] / (factors[1][channel] * kGains[1]), 1, 0.03);
        EXPECT_NEAR(factors[2][channel] * kGains[2] / (factors[1][channel] * kGains[1]), 1, 0.03);
        EXPECT_NEAR(factors[1][channel], 1, 0.15) << "the level of the map";
    }
    EXPECT_EQ(factors[3], Eigen::Vector3f::Ones()) << "nothing is known about it";
}

TEST(ViewChoice, NeighboursOutvoteASmallGain) {
    Mesh strip;  // a row of squares
    for (int i = 0; i <= 10; ++i)
        for (int k = 0; k < 2; ++k)
            strip.vertices.push_back({Eigen::Vector3f(static_cast<float>(i), static_cast<float>(k), 0), {}});
    for (std::uint32_t i = 0; i < 10; ++i) {
        strip.faces.push_back({2 * i, 2 * i + 2, 2 * i + 1});
        strip.faces.push_back({2 * i + 2, 2 * i + 3, 2 * i + 1});
    }
    ViewCandidates candidates(strip.vertices.size());
    for (std::size_t i = 0; i < strip.vertices.size(); ++i) {
        if (i == 21) continue;  // nobody sees it
        candidates.add(i, 0, 100);
        candidates.add(i, 1, i == 8 ? 110.0f : (i < 16 ? 50.0f : 1000.0f));
    }
    const auto weights = choose_views(strip, candidates);
    ASSERT_EQ(weights[8].size(), 1u);
    EXPECT_EQ(weights[8][0].view, 0u) << "its neighbours have view 0";
    EXPECT_EQ(weights[19][0].view, 1u) << "much better";
    EXPECT_EQ(weights[15].size(), 2u) << "at the seam both have a share";
    EXPECT_TRUE(weights[21].empty());
    for (std::size_t i = 0; i < 21; ++i) {
        float sum = 0;
        for (const ViewWeight& w : weights[i]) sum += w.weight;
        EXPECT_NEAR(sum, 1, 1e-5);
    }
}

}  // namespace
}  // namespace posefusion::test
