#include <algorithm>
#include <array>
#include <cmath>

#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// A camera changes its exposure and white balance: poses and colours of the map are as if it did not.
namespace posefusion::test {
namespace {

/// Per frame and channel; the first frame's is 1.
Vector3d exposure_at(std::size_t frame) {
    const auto t = static_cast<double>(frame);
    return {1 - 0.20 * std::sin(0.5 * t), 1 - 0.15 * std::sin(0.5 * t), 1 - 0.25 * std::sin(0.5 * t)};
}

class ChangingExposure : public SlamTest {
protected:
    const std::vector<Isometry3d> path = path_to(motion({0.12, -0.06, 0.08}, {1, 2, -1}, 8), 14);

    struct Run {
        std::vector<FrameResult> results;
        std::vector<Surfel> surfels;
    };
    [[nodiscard]] Run run(bool changing) const {
        Slam slam(kSmall, test_config());
        Run result;
        for (std::size_t k = 0; k < path.size(); ++k) {
            Frame frame = render_room(kSmall, path[k]);
            const Vector3d factor = changing ? exposure_at(k) : Vector3d::Ones();
            for (auto& pixel : frame.color) {
                const auto seen = [](std::uint8_t c, double f) {
                    return static_cast<std::uint8_t>(std::min(255.0, std::round(c * f)));
                };
                pixel = {seen(pixel.r, factor.x()), seen(pixel.g, factor.y()), seen(pixel.b, factor.z())};
            }
            result.results.push_back(slam.process(frame.color, frame.depth));
        }
        result.surfels = slam.surfels(false);
        return result;
    }
};

TEST_F(ChangingExposure, IsFoundPerChannelAndDoesNotMoveThePose) {
    const Run constant = run(false), changing = run(true);
    for (std::size_t k = 1; k < path.size(); ++k) {
        const auto& result = changing.results[k];
        ASSERT_EQ(result.tracking, TrackingState::Ok) << k;
        const double error = (path[k].inverse() * result.T_world_camera).translation().norm();
        const double least = (path[k].inverse() * constant.results[k].T_world_camera).translation().norm();
        EXPECT_LT(error, least + 5e-4) << k;
        const Vector3d expected = exposure_at(k).cwiseInverse();
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(result.exposure[static_cast<std::size_t>(c)], expected(c), 0.02 * expected(c)) << k << ' ' << c;
            EXPECT_NEAR(constant.results[k].exposure[static_cast<std::size_t>(c)], 1, 0.01) << k << ' ' << c;
        }
    }
}

TEST_F(ChangingExposure, LeavesTheMapInOneExposure) {
    // the walls' texture is the same all over: so is the mean colour of new surfels and of old ones
    const Run constant = run(false), changing = run(true);
    const auto mean = [](const std::vector<Surfel>& surfels) {
        Vector3d sum = Vector3d::Zero();
        for (const auto& s : surfels) sum += Vector3d(s.color.r, s.color.g, s.color.b) / 255.0;
        return (sum / static_cast<double>(surfels.size())).eval();
    };
    EXPECT_LT((mean(changing.surfels) - mean(constant.surfels)).cwiseAbs().maxCoeff(), 0.01);
}

}  // namespace
}  // namespace posefusion::test
