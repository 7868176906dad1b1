#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "engine/core/error.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/synth/floor_plan.hpp"
#include "hosts/synth/room.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"

/// The walks through the large room: loops that close, lenses that are covered, people where they should be.
namespace posefusion {
namespace {

SynthConfig config_of(SynthScenario scenario, std::uint64_t seed, int people = 0) {
    SynthConfig config;
    config.scenario = scenario;
    config.seed = seed;
    config.people = people;
    config.frames = 300;
    config.width = 80;
    config.height = 60;
    return config;
}

double angle(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}
double distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
    return (a.translation() - b.translation()).norm();
}

double mean_grey(const ColorImage& image) {
    double sum = 0;
    for (const Rgb8 c : image) sum += c.g;
    return sum / static_cast<double>(image.size());
}

TEST(SynthScenario, AWalkOfUsualLengthIsBackWhenItsStartHasBecomeOldMap) {
    constexpr int kTimeWindow = 200;  // LoopConfig
    for (const SynthScenario scenario : {SynthScenario::Loop, SynthScenario::LoopPeople}) {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            SynthConfig config = config_of(scenario, seed);
            config.frames = usual_frames(scenario);
            const SynthWorld world(config);
            int left = 0;  // the start is behind the camera, or at least a quarter of a turn aside
            while (angle(world.camera_pose(0), world.camera_pose(left)) < 1.57) ++left;
            ASSERT_TRUE(world.events().revisit_from.has_value());
            EXPECT_GT(*world.events().revisit_from, left + kTimeWindow) << "seed " << seed;
            EXPECT_LT(*world.events().revisit_from, config.frames - 30) << "seed " << seed;
        }
    }
}

TEST(SynthScenario, ALoopGoesFarRoundAndComesBack) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const SynthWorld world(config_of(SynthScenario::Loop, seed));
        const int last = world.config().frames - 1;
        double length = 0, farthest = 0, fastest = 0;
        for (int i = 1; i <= last; ++i) {
            const double step = distance(world.camera_pose(i - 1), world.camera_pose(i));
            length += step;
            fastest = std::max(fastest, step);
            farthest = std::max(farthest, distance(world.camera_pose(0), world.camera_pose(i)));
            EXPECT_GT(world.clearance(world.camera_pose(i).translation()), 0.15) << "seed " << seed << " frame " << i;
            EXPECT_LT(angle(world.camera_pose(i - 1), world.camera_pose(i)), 0.10) << "seed " << seed << " frame " << i;
        }
        EXPECT_GT(length, 11);
        EXPECT_GT(farthest, 3);
        EXPECT_LT(fastest, 0.10) << "metres per frame";
        ASSERT_TRUE(world.events().revisit_from.has_value());
        const int back = *world.events().revisit_from;
        EXPECT_GT(back, 200) << "later than a usual time window";
        EXPECT_LT(back, last - 20);
        for (int i = back; i <= last; ++i) {
            EXPECT_LT(distance(world.camera_pose(0), world.camera_pose(i)), 1.0);
            EXPECT_LT(angle(world.camera_pose(0), world.camera_pose(i)), 0.9);
        }
        EXPECT_TRUE(world.events().covered.empty());
    }
}

TEST(SynthScenario, HalfwayNothingOfTheStartIsInView) {
    const SynthWorld world(config_of(SynthScenario::Loop, 2));
    const Eigen::Isometry3d start = world.camera_pose(0);
    const Eigen::Vector3d seen = start * Eigen::Vector3d(0, 0, 2);
    for (int i = 110; i < 200; ++i) {
        const Eigen::Vector3d p = world.camera_pose(i).inverse() * seen;
        EXPECT_TRUE(p.z() < 0 || std::abs(p.x()) > 0.6 * p.z() || p.z() > 5) << "frame " << i;
    }
}

TEST(SynthScenario, TheKidnappedCameraWakesUpWhereItHasNearlyBeen) {
    std::set<int> places;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const SynthWorld world(config_of(SynthScenario::Kidnap, seed));
        const auto& covered = world.events().covered;
        ASSERT_GT(covered.size(), 20u);
        EXPECT_EQ(covered.back() - covered.front() + 1, static_cast<int>(covered.size())) << "covered once";
        ASSERT_EQ(world.events().revisit_from, covered.back() + 1);
        const Eigen::Isometry3d before = world.camera_pose(covered.front()),
                                after = world.camera_pose(*world.events().revisit_from);
        EXPECT_GT(distance(before, after), 0.8) << "seed " << seed;
        double nearest = 100, turned = 0;
        int place = 0;
        for (int i = 0; i < covered.front(); ++i)
            if (distance(world.camera_pose(i), after) < nearest) {
                nearest = distance(world.camera_pose(i), after);
                turned = angle(world.camera_pose(i), after);
                place = i;
            }
        EXPECT_LT(nearest, 0.35) << "seed " << seed;
        EXPECT_GT(std::max(nearest, turned), 0.03) << "not the very same view";
        EXPECT_LT(turned, 0.6) << "seed " << seed;
        places.insert(place / 10);
    }
    EXPECT_GT(places.size(), 3u) << "the seed decides where";
}

TEST(SynthScenario, BehindTheCoverFramesAreReadableButUseless) {
    const test::TempFolder folder;
    SynthConfig config = config_of(SynthScenario::Kidnap, 3, 2);
    config.frames = 100;
    config.width = 160;
    config.height = 120;
    const SynthWorld world(config);
    const auto& covered = world.events().covered;
    ASSERT_GE(covered.size(), 5u);
    const SynthFrame open = world.render(covered.front() - 1);
    for (const int frame : {covered[covered.size() / 2 - 1], covered[covered.size() / 2]}) {
        const SynthFrame f = world.render(frame);
        EXPECT_LT(mean_grey(f.color), 30);
        EXPECT_GT(mean_grey(f.color), 8) << "dark, not black";
        const auto measured = std::count_if(f.depth.begin(), f.depth.end(), [](float d) { return d > 0; });
        EXPECT_GT(measured, 0) << "without any depth a frame is skipped as broken";
        EXPECT_LT(measured, 0.05 * static_cast<double>(f.depth.size()));
        EXPECT_TRUE(std::all_of(f.labels.begin(), f.labels.end(), [](std::uint8_t l) { return l == 0; }));
        for (const SynthPerson& person : f.people) {
            EXPECT_EQ(person.pixels, 0);
            for (const SynthJoint& joint : person.joints) EXPECT_EQ(joint.visibility, JointVisibility::Hidden);
        }
    }
    EXPECT_GT(mean_grey(open.color), 60);
}

TEST(SynthScenario, PeopleGatherWhereTheLoopCloses) {
    int before = 0, after = 0;
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        const SynthWorld world(config_of(SynthScenario::LoopPeople, seed, 3));
        const auto pixels = [&](int frame) {
            int sum = 0;
            for (const SynthPerson& person : world.render(frame).people) sum += person.pixels;
            return sum;
        };
        for (const int i : {0, 10}) before += pixels(i);
        for (const int i : {250, 290}) {
            const int here = pixels(i);
            EXPECT_GT(here, 200) << "seed " << seed << " frame " << i;
            after += here;
        }
    }
    EXPECT_EQ(before, 0) << "the start was seen without people";
    EXPECT_GT(after, 4 * 400);
}

TEST(SynthScenario, PeopleKeepOutOfTheCamerasWay) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const SynthWorld world(config_of(SynthScenario::Loop, seed, 4));
        for (int i = 0; i < world.config().frames; i += 3)
            for (const Eigen::Vector2d& p : world.people_on_floor(i))
                EXPECT_GT((p - world.camera_pose(i).translation().head<2>()).norm(), 0.45) << "frame " << i;
    }
}

TEST(SynthScenario, EveryPlaceOfTheLargeRoomCanBeReached) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const synth::Room room(seed, synth::RoomKind::Large);
        const synth::FloorPlan floor(room);
        std::vector<synth::Vector2f> places = room.spots;
        for (const auto* more : {&room.exits, &room.beside_loop, &room.in_front_of_loop})
            places.insert(places.end(), more->begin(), more->end());
        for (const synth::Vector2f& to : places) {
            EXPECT_GT(floor.clearance(to), 0.12f) << "seed " << seed << ": " << to.transpose();
            if (to == places.front()) continue;
            EXPECT_FALSE(floor.route(places.front(), to).empty()) << to.transpose();
        }
    }
}

TEST(SynthScenario, EventsAreWrittenBesideTheRecording) {
    const test::TempFolder folder;
    SynthConfig config = config_of(SynthScenario::Kidnap, 1);
    config.out = folder / "made";
    config.frames = 60;
    synthesize(config);
    EXPECT_EQ(Recording(config.out).size(), 60u);
    const auto events = nlohmann::json::parse(test::read_all(folder / "made/events.json"));
    const SynthWorld world(config);
    EXPECT_EQ(events.at("scenario"), "kidnap");
    ASSERT_EQ(events.at("covered").size(), world.events().covered.size());
    EXPECT_EQ(events.at("covered")[0].at("frame"), world.events().covered[0]);
    EXPECT_EQ(events.at("revisit_from").at("frame"), *world.events().revisit_from);
    EXPECT_NEAR(std::stod(events.at("revisit_from").at("stamp").get<std::string>()),
                world.stamp(*world.events().revisit_from), 1e-6);
    config.out = folder / "short";
    synthesize(config, [](int done, int) { return done < 5; });
    const auto stopped = nlohmann::json::parse(test::read_all(folder / "short/events.json"));
    EXPECT_TRUE(stopped.at("covered").empty());
    EXPECT_TRUE(stopped.at("revisit_from").is_null());
}

TEST(SynthScenario, TheEasyWalkIsTheSameInBetterLight) {
    SynthConfig config = config_of(SynthScenario::Loop, 1);
    config.noise = false;
    const SynthWorld hard(config);
    config.easy = true;
    const SynthWorld easy(config);
    const SynthFrame a = hard.render(140), b = easy.render(140);  // at the bare wall
    EXPECT_TRUE(a.T_world_camera.isApprox(b.T_world_camera));
    EXPECT_TRUE(std::equal(a.depth.begin(), a.depth.end(), b.depth.begin()));
    const auto roughness = [](const ColorImage& image) {
        double sum = 0;
        for (int v = 0; v < image.height(); ++v)
            for (int u = 1; u < image.width(); ++u) sum += std::abs(image(u, v).g - image(u - 1, v).g);
        return sum;
    };
    EXPECT_GT(roughness(b.color), 1.3 * roughness(a.color));
}

TEST(SynthScenario, AWalkCannotStandStill) {
    SynthConfig config = config_of(SynthScenario::Loop, 1);
    config.still_camera = true;
    EXPECT_THROW(SynthWorld{config}, Error);
}

}  // namespace
}  // namespace posefusion
