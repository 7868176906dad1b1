// A recording seen through a lens: the device undoes its distortion, and nobody can tell it from the CPU.
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/recorders/recorder.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/io/trajectory.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

struct Ray {
    double x, y;
};

class Distortion : public Cli {
protected:
    /// A barrel: the corners are moved by 14 pixels of 160 x 120.
    static constexpr std::array<float, 5> kLens{-0.24f, 0.07f, 0.004f, -0.003f, -0.008f};

    /// Brown's model, written down once more on purpose.
    static Ray bent(Ray r) {
        const auto [k1, k2, p1, p2, k3] = kLens;
        const double r2 = r.x * r.x + r.y * r.y, radial = 1 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
        return {r.x * radial + 2 * p1 * r.x * r.y + p2 * (r2 + 2 * r.x * r.x),
                r.y * radial + p1 * (r2 + 2 * r.y * r.y) + 2 * p2 * r.x * r.y};
    }

    /// Where the ideal camera sees what pixel (u, v) behind the lens sees.
    static Ray ideal_place(const Intrinsics& K, int u, int v) {
        const double cx = K.cx, cy = K.cy;
        const Ray seen{(u - cx) / K.fx, (v - cy) / K.fy};
        Ray ideal = seen;
        for (int i = 0; i < 100; ++i) {
            const Ray again = bent(ideal);
            ideal = {ideal.x + seen.x - again.x, ideal.y + seen.y - again.y};
        }
        return {K.fx * ideal.x + cx, K.fy * ideal.y + cy};
    }

    /// The frame as the lens shows it: colour between pixels, depth of the nearest one, black and nothing beyond.
    static RawFrame through_lens(const RawFrame& ideal, const Intrinsics& K) {
        RawFrame frame = ideal;
        for (int v = 0; v < K.height; ++v) {
            for (int u = 0; u < K.width; ++u) {
                const Ray place = ideal_place(K, u, v);
                const int u0 = static_cast<int>(std::floor(place.x)), v0 = static_cast<int>(std::floor(place.y));
                const double a = place.x - u0, b = place.y - v0;
                const auto mean = [&](auto channel) {
                    double sum = 0;
                    for (const auto& [du, dv, weight] :
                         {std::tuple{0, 0, (1 - a) * (1 - b)}, {1, 0, a * (1 - b)}, {0, 1, (1 - a) * b}, {1, 1, a * b}})
                        if (ideal.color.contains(u0 + du, v0 + dv))
                            sum += weight * (ideal.color(u0 + du, v0 + dv).*channel);
                    return static_cast<std::uint8_t>(std::lround(sum));
                };
                frame.color(u, v) = {mean(&Rgb8::r), mean(&Rgb8::g), mean(&Rgb8::b)};
                const int near_u = static_cast<int>(std::lround(place.x)),
                          near_v = static_cast<int>(std::lround(place.y));
                frame.depth(u, v) =
                    ideal.depth.contains(near_u, near_v) ? ideal.depth(near_u, near_v) : std::uint16_t{0};
            }
        }
        return frame;
    }

    /// The recording behind the lens, as a folder whose camera.yaml says so.
    fs::path distorted() const {
        const auto source = open_source(recording());
        Camera camera = source->camera();
        std::copy(kLens.begin(), kLens.end(), camera.distortion.begin());
        const auto recorder = make_recorder(temp_ / "lens", camera);
        for (std::size_t i = 0; i < source->size(); ++i)
            recorder->add(through_lens(source->read(i), camera.intrinsics));
        recorder->finish(source->groundtruth());
        return temp_ / "lens";
    }

    /// That recording, with the lens undone by the CPU.
    fs::path undistorted(const fs::path& folder) const {
        const Recording recording(folder);
        Camera camera = recording.camera();
        camera.distortion = {};
        const auto recorder = make_recorder(temp_ / "cpu", camera);
        for (std::size_t i = 0; i < recording.size(); ++i) {
            const Frame frame = recording.load(i);
            RawFrame raw;
            raw.stamp = frame.stamp;
            raw.stamp_text = frame.stamp_text;
            raw.color = frame.color;
            raw.depth = RawDepth(frame.depth.width(), frame.depth.height());
            for (std::size_t p = 0; p < raw.depth.size(); ++p)
                raw.depth[p] = static_cast<std::uint16_t>(std::lround(frame.depth[p] * camera.depth_scale));
            recorder->add(raw);
        }
        recorder->finish(recording.groundtruth());
        return temp_ / "cpu";
    }

    struct Outcome {
        std::string trajectory, map;
        nlohmann::json stats;
        [[nodiscard]] Trajectory poses(const fs::path& folder) const {
            std::ofstream(folder / "poses.txt") << trajectory;
            return read_trajectory(folder / "poses.txt");
        }
    };
    Outcome track(const fs::path& recording, std::vector<std::string> more = {}) const {
        more.insert(more.end(), {"--no-people", "--all-surfels"});
        const Result result = execute(run_of(recording, more));
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return {read_all(out() / "trajectory.txt"), read_all(out() / "map.ply"),
                nlohmann::json::parse(read_all(out() / "stats.json"))};
    }
};

TEST_F(Distortion, IsUndoneByTheDeviceWithTheBytesOfTheCpu) {
    const fs::path lens = distorted();
    const Outcome device = track(lens);
    const Outcome cpu = track(undistorted(lens));
    EXPECT_EQ(device.trajectory, cpu.trajectory);
    EXPECT_TRUE(device.map == cpu.map);
    EXPECT_GT(device.map.size(), 100'000u) << "a map with surfels in it";
    EXPECT_GE(device.stats["stages"]["gpu"]["undistort"]["frames"], kFrames - 2)
        << "all but those that compiled shaders";
    EXPECT_GT(device.stats["frames"][3]["gpu_ms"]["undistort"], 0);
    EXPECT_FALSE(cpu.stats["stages"]["gpu"].contains("undistort"));

    const Outcome again = track(lens, {"--sequential"});
    EXPECT_EQ(again.trajectory, device.trajectory) << "one stage after the other";
    EXPECT_TRUE(again.map == device.map);
}

TEST_F(Distortion, UndoneGivesTheTrajectoryOfTheIdealCamera) {
    const fs::path lens = distorted();
    const Trajectory ideal = track(recording()).poses(temp_.path());
    const fs::path pretended = recording() / "camera.yaml";  // the same without distortion
    /// Farthest from the ideal camera: metres, radians.
    const auto apart = [&](const Outcome& outcome) {
        const Trajectory poses = outcome.poses(temp_.path());
        std::array<double, 2> farthest{};
        for (std::size_t i = 0; i < ideal.size(); ++i) {
            const Eigen::Isometry3d T = ideal[i].T_world_camera.inverse() * poses.at(i).T_world_camera;
            farthest = {std::max(farthest[0], T.translation().norm()),
                        std::max(farthest[1], Eigen::AngleAxisd(T.linear()).angle())};
        }
        return farthest;
    };
    const auto undone = apart(track(lens)), ignored = apart(track(lens, {"--camera", pretended.string()}));
    // A third of a pixel, 5 mm at 2 m and 0.0025 rad: each image was sampled twice.
    EXPECT_LT(undone[0], 0.006) << "metres";
    EXPECT_LT(undone[1], 0.0025) << "radians";
    EXPECT_GT(ignored[0], 3 * undone[0]) << "a lens that does not matter tests nothing";
    EXPECT_GT(ignored[1], 3 * undone[1]);
}

}  // namespace
}  // namespace posefusion::test
