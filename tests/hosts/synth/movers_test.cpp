#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <new>
#include <nlohmann/json.hpp>
#include <set>

#include "hosts/io/trajectory.hpp"
#include "hosts/synth/mover_staging.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"

/// Things that move, and what synth says about them.
namespace posefusion {
namespace {

using namespace synth;

constexpr std::uint64_t kSeeds = 16;
constexpr double kDuration = 4;  // seconds

SynthConfig small(std::uint64_t seed, int people) {
    SynthConfig config;
    config.scenario = SynthScenario::Movers;
    config.seed = seed;
    config.people = people;
    config.width = 80;
    config.height = 60;
    config.noise = false;
    return config;
}

/// What moves in a room, without pictures of it. Without people the box glides, and the chair is pulled by somebody who
/// is not asked what he looks like.
struct Stage {
    explicit Stage(std::uint64_t seed) : room(seed, RoomKind::Cleared), floor(room) {
        const MoverCast cast(seed, 1);
        const InView everywhere = [](const Vector3f&, double) { return true; };
        if (cast.chair) pull = plan_chair_pull(floor, room, Proportions(), everywhere, kDuration, seed);
        movers = stage_movers(cast, room, floor, {}, {}, pull, std::nullopt, everywhere, kDuration, seed);
    }
    /// Largest way of any point of a mover between two times, metres.
    static float way(const Mover& mover, double from, double to) {
        const Isometry3f a = mover.at(from).T_world_object, b = mover.at(to).T_world_object;
        float most = 0;
        for (const RoomVertex& v : mover.mesh.vertices) most = std::max(most, (a * v.position - b * v.position).norm());
        return most;
    }
    Room room;
    FloorPlan floor;
    std::optional<ChairPull> pull;
    std::vector<Mover> movers;
};

TEST(SynthMovers, SeedsVaryWhatMovesAndWhen) {
    std::set<SynthObjectKind> kinds;
    int at_once = 0, later = 0, stopped = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Stage stage(seed);
        int label = kFirstMoverLabel;
        for (const Mover& mover : stage.movers) {
            kinds.insert(mover.kind);
            if (mover.kind == SynthObjectKind::Screen) continue;
            EXPECT_EQ(mover.label, label++);
            (Stage::way(mover, 0, 0.3) > 0.01f ? at_once : later) += 1;
            stopped += Stage::way(mover, kDuration - 0.3, kDuration) < 0.005f ? 1 : 0;
        }
        EXPECT_GE(label, kFirstMoverLabel + 2) << "seed " << seed;
    }
    EXPECT_EQ(kinds.size(), 6u) << "all kinds occur";
    EXPECT_GT(at_once, 3);
    EXPECT_GT(later, 3);
    EXPECT_GT(stopped, 3);
}

TEST(SynthMovers, MoveThroughNothing) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Stage stage(seed);
        for (const Mover& mover : stage.movers) {
            if (mover.kind == SynthObjectKind::Screen) continue;
            float most = 0;
            for (double t = 0; t < kDuration; t += 0.2) {
                most = std::max(most, Stage::way(mover, 0, t));
                if (mover.kind == SynthObjectKind::Door) continue;  // hangs beside its wardrobe
                const Isometry3f T = mover.at(t).T_world_object;
                for (const RoomVertex& v : mover.mesh.vertices)
                    EXPECT_GT(stage.floor.clearance(Vector2f((T * v.position).head<2>())), 0.02f)
                        << "seed " << seed << " " << object_name(mover.kind) << " at " << t << " s";
            }
            EXPECT_GT(most, 0.15f) << "seed " << seed << " " << object_name(mover.kind);
        }
    }
}

TEST(SynthMovers, ABallRollsWithoutSliding) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
        for (const Mover& mover : Stage(seed).movers) {
            if (mover.kind != SynthObjectKind::Ball) continue;
            for (double t = 0; t < kDuration; t += 0.3) {
                // The lowest point of the ball stands still while it touches the floor.
                const Isometry3f now = mover.at(t).T_world_object, soon = mover.at(t + 1e-2).T_world_object;
                const Vector3f touching = now.translation().cwiseProduct(Vector3f(1, 1, 0));
                EXPECT_LT((soon * now.inverse() * touching - touching).norm(), 2e-3f);
            }
        }
}

TEST(SynthMovers, AScreenStandsStillWhileItsPictureChanges) {
    int screens = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
        for (const Mover& mover : Stage(seed).movers) {
            if (mover.kind != SynthObjectKind::Screen) continue;
            ++screens;
            EXPECT_EQ(mover.label, 0) << "what stands still is static";
            EXPECT_EQ(Stage::way(mover, 0, 2), 0);
            EXPECT_GT((mover.at(1).picture - mover.at(0.9).picture).norm(), 0.01f);
        }
    EXPECT_GT(screens, 3);
}

TEST(SynthMovers, OnlyAScreenChangesItsPicture) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed)
        for (const Mover& mover : Stage(seed).movers) {
            if (mover.kind == SynthObjectKind::Screen) continue;
            alignas(MoverPose) std::array<unsigned char, sizeof(MoverPose)> memory{};
            memory.fill(0xff);  // what is not written stays NaN
            const MoverPose* pose = new (memory.data()) MoverPose(mover.at(1));
            EXPECT_EQ(pose->picture, Vector2f(Vector2f::Zero())) << object_name(mover.kind);
        }
}

TEST(SynthMovers, MasksAndDepthShowTheObjectsWhereTheirPosesSay) {
    const SynthWorld world(small(3, 1));
    const Intrinsics& k = world.camera();
    for (const int frame : {0, 60}) {
        const SynthFrame image = world.render(frame);
        ASSERT_EQ(image.T_world_object.size(), world.objects().size());
        for (std::size_t i = 0; i < world.objects().size(); ++i) {
            const SynthObject& object = world.objects()[i];
            if (object.label == 0) continue;
            Eigen::AlignedBox3d box;
            for (const Eigen::Vector3f& p : object.surface.vertices) box.extend(p.cast<double>());
            int pixels = 0;
            for (int v = 0; v < k.height; ++v)
                for (int u = 0; u < k.width; ++u) {
                    if (image.labels(u, v) != object.label) continue;
                    ++pixels;
                    const auto z = static_cast<double>(image.depth(u, v));
                    const Eigen::Vector3d seen(z * (u - static_cast<double>(k.cx)) / static_cast<double>(k.fx),
                                               z * (v - static_cast<double>(k.cy)) / static_cast<double>(k.fy), z);
                    const Eigen::Vector3d p = image.T_world_object[i].inverse() * image.T_world_camera * seen;
                    EXPECT_LT(box.exteriorDistance(p), 0.001) << object_name(object.kind);
                }
            EXPECT_GT(pixels, 5) << object_name(object.kind) << " in frame " << frame;
        }
    }
}

TEST(SynthMovers, TheRecordingHoldsTheObjects) {
    const test::TempFolder folder;
    SynthConfig config = small(3, 0);
    config.out = folder / "made";
    config.frames = 3;
    synthesize(config);
    const SynthWorld world(config);
    const auto info = nlohmann::json::parse(std::ifstream(config.out / "info.json"));
    ASSERT_EQ(info["objects"].size(), world.objects().size());
    for (std::size_t i = 0; i < world.objects().size(); ++i) {
        const auto& entry = info["objects"][i];
        EXPECT_EQ(entry["kind"], object_name(world.objects()[i].kind));
        EXPECT_EQ(entry["label"], world.objects()[i].label);
        EXPECT_TRUE(std::filesystem::is_regular_file(config.out / entry["mesh"].get<std::string>()));
        const Trajectory poses = read_trajectory(config.out / entry["trajectory"].get<std::string>());
        ASSERT_EQ(poses.size(), 3u);
        EXPECT_LT((poses[2].T_world_camera.matrix() - world.object_pose(i, 2).matrix()).norm(), 1e-6);
    }
}

}  // namespace
}  // namespace posefusion
