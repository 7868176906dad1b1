#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "engine/core/error.hpp"
#include "segmentation/convex_patches.hpp"
#include "segmentation/motion_segmenter.hpp"
#include "segmentation/view_history.hpp"
#include "tests/segmentation/scene.hpp"

// What moves and is no person: found whole, whatever it is; what parallax uncovers is not taken for it.
namespace posefusion {
namespace {

using test::Box;
using test::Frame;
using test::Scene;

constexpr int kFramesPerSecond = 30;

/// A box of 0.5 m on the floor, its centre at (x, z).
Box box_at(float x, float z) {
    return {{x - 0.25f, test::kFloor - 0.9f, z - 0.25f}, {x + 0.25f, test::kFloor, z + 0.25f}};
}

class Motion : public testing::Test {
protected:
    const Intrinsics camera = test::camera_of(160, 120);
    Eigen::Vector3f step = Eigen::Vector3f::Zero();  ///< of the camera per frame
    std::unique_ptr<MotionJudge> judge = make_motion_segmenter(camera, {});
    Frame frame;
    int time = 0;

    /// Renders the next frame and judges it.
    LabelImage next(const std::vector<Box>& boxes, const LabelImage& people = {}) {
        frame = test::render({.boxes = boxes, .camera = static_cast<float>(time++) * step}, camera);
        Eigen::Isometry3f T_previous_current = Eigen::Isometry3f::Identity();
        T_previous_current.translation() = step;
        (void)judge->begin(frame.color, frame.depth, people);
        LabelImage movers = judge->find(T_previous_current);
        judge->end(T_previous_current);
        return movers;
    }
    double share_of(const LabelImage& labels, test::Part part) const {
        return labels.empty() ? 0 : test::labelled_share(labels, frame.parts, part);
    }
    void expect_found(const LabelImage& movers) const {
        EXPECT_GT(share_of(movers, test::kBoxPart), 0.85) << "frame " << time;
        EXPECT_LT(share_of(movers, test::kWallPart), 0.01) << "frame " << time;
        EXPECT_LT(share_of(movers, test::kFloorPart), 0.02) << "frame " << time;
    }
};

TEST_F(Motion, NothingMovesInAStaticRoomWhateverTheCameraUncovers) {
    for (const Eigen::Vector3f& way : {Eigen::Vector3f(0.03f, 0, 0), Eigen::Vector3f(-0.02f, 0.01f, 0.03f)}) {
        step = way;
        time = 0;
        judge->restart();
        for (int i = 0; i < kFramesPerSecond; ++i) {
            const LabelImage movers = next({box_at(-0.4f, 2.2f), box_at(0.7f, 3.2f)});
            EXPECT_TRUE(movers.empty()) << "frame " << i;
        }
    }
}

TEST_F(Motion, AThingThatCrossesTheViewIsFoundWhole) {
    step = {0.01f, 0, 0};
    for (int i = 0; i < kFramesPerSecond; ++i) {
        const LabelImage movers = next({box_at(-0.8f + 0.03f * static_cast<float>(i), 2.4f)});
        if (i >= 10) expect_found(movers);
    }
}

TEST_F(Motion, TheTopOfASideboardDoesNotMoveWithItsSlidingDoor) {
    // top and door meet in a convex edge
    const float top = test::kFloor - 0.6f;
    const Box slab{{-0.8f, top, 2.2f}, {0.8f, top + 0.03f, 3.2f}}, back{{-0.8f, top, 3.1f}, {0.8f, test::kFloor, 3.2f}};
    LabelImage movers;
    for (int i = 0; i < 24; ++i) {
        const float x = -0.5f + 0.03f * static_cast<float>(i);
        movers = next({slab, back, {{x - 0.3f, top + 0.03f, 2.2f}, {x + 0.3f, test::kFloor, 2.23f}}});
    }
    ASSERT_FALSE(movers.empty());
    int of_top = 0, top_moves = 0, of_door = 0, door_moves = 0;
    for (int v = 0; v < camera.height; ++v)
        for (int u = 0; u < camera.width; ++u) {
            if (frame.parts(u, v) != test::kBoxPart) continue;
            const float z = frame.depth(u, v);
            const bool is_top = (static_cast<float>(v) - camera.cy) / camera.fy * z < top + 0.01f;
            const bool is_door = !is_top && z < 2.21f;
            of_top += is_top, top_moves += is_top && movers(u, v) != 0;
            of_door += is_door, door_moves += is_door && movers(u, v) != 0;
        }
    ASSERT_GT(of_top, 300);
    EXPECT_LT(top_moves, of_top / 5);
    EXPECT_GT(door_moves, of_door / 2);
}

TEST_F(Motion, AThingThatComesNearerIsFound) {
    for (int i = 0; i < kFramesPerSecond; ++i) {
        const LabelImage movers = next({box_at(0.2f, 3.4f - 0.03f * static_cast<float>(i))});
        if (i >= 12) expect_found(movers);
    }
}

TEST_F(Motion, AThingThatMovesAwayFromTheCameraIsFound) {
    // its front has never been free space: the views have seen a surface there that is gone
    for (int i = 0; i < 25; ++i) {
        const LabelImage movers = next({box_at(0.1f, 1.8f + 0.03f * static_cast<float>(i))});
        if (i >= 12) {
            EXPECT_GT(share_of(movers, test::kBoxPart), 0.7) << "frame " << i;
        }
    }
}

TEST_F(Motion, AThingThatStoodStillIsFoundSoonAfterItBeginsToMove) {
    for (int i = 0; i < 60; ++i) EXPECT_TRUE(next({box_at(0, 2.4f)}).empty());
    LabelImage movers;
    for (int i = 1; i <= 12; ++i) movers = next({box_at(0.03f * static_cast<float>(i), 2.4f)});
    expect_found(movers);
}

TEST_F(Motion, AThingThatStopsBelongsToTheStaticSceneTwoSecondsLater) {
    LabelImage movers;
    for (int i = 0; i < 20; ++i) movers = next({box_at(-0.6f + 0.03f * static_cast<float>(i), 2.4f)});
    expect_found(movers);
    for (int i = 0; i < 2 * kFramesPerSecond; ++i) movers = next({box_at(0, 2.4f)});
    EXPECT_TRUE(movers.empty());
}

TEST_F(Motion, WhatAThingUncoversIsStatic) {
    // a box moves from before another one, which stands closely behind it
    const Box behind = box_at(0, 2.9f);
    LabelImage movers;
    for (int i = 0; i < 24; ++i) movers = next({behind, box_at(0.04f * static_cast<float>(i), 2.35f)});
    ASSERT_FALSE(movers.empty());
    int uncovered = 0;
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            const bool is_behind = frame.parts(u, v) == test::kBoxPart && frame.depth(u, v) > 2.6f;
            if (is_behind) {
                EXPECT_EQ(movers(u, v), 0) << u << ' ' << v;
                ++uncovered;
            }
        }
    }
    EXPECT_GT(uncovered, 300);
}

TEST_F(Motion, PeopleAreLeftToOthers) {
    LabelImage movers;
    for (int i = 0; i < 20; ++i) {
        const Box box = box_at(-0.6f + 0.03f * static_cast<float>(i), 2.4f);
        const Frame now = test::render({.boxes = {box}}, camera);
        LabelImage people(camera.width, camera.height);
        for (std::size_t k = 0; k < people.size(); ++k) people[k] = now.parts[k] == test::kBoxPart;
        movers = next({box}, people);
        EXPECT_TRUE(movers.empty()) << "frame " << i;
    }
}

TEST_F(Motion, TheStateContinuesWithTheSameLabels) {
    const auto box = [](int i) { return box_at(-0.6f + 0.03f * static_cast<float>(i), 2.4f); };
    for (int i = 0; i < 15; ++i) (void)next({box(i)});
    const ByteArray state = judge->state();
    std::vector<LabelImage> expected;
    for (int i = 15; i < 22; ++i) expected.push_back(next({box(i)}));
    judge = make_motion_segmenter(camera, {});
    judge->restore(state);
    for (int i = 15; i < 22; ++i) {
        const LabelImage movers = next({box(i)});
        const LabelImage& same = expected[static_cast<std::size_t>(i - 15)];
        EXPECT_TRUE(std::equal(movers.begin(), movers.end(), same.begin(), same.end())) << "frame " << i;
    }
}

TEST_F(Motion, ADamagedStateIsAnError) {
    for (int i = 0; i < 8; ++i) (void)next({box_at(0, 2.4f)});
    const ByteArray state = judge->state();
    EXPECT_THROW(judge->restore(std::span(state).first(state.size() / 2)), Error);
    const auto larger = make_motion_segmenter(test::camera_of(320, 200), {});
    EXPECT_THROW(larger->restore(state), Error);
}

TEST_F(Motion, WhatIsAccusedMovesUntilItIsSeenToStand) {
    for (int i = 0; i < 6; ++i) EXPECT_TRUE(next({box_at(0, 2.4f)}).empty()) << "frame " << i;
    LabelImage accused(camera.width, camera.height);
    for (std::size_t i = 0; i < accused.size(); ++i) accused[i] = frame.parts[i] == test::kBoxPart;
    (void)judge->begin(frame.color, frame.depth, {});
    judge->accuse(accused);
    const LabelImage movers = judge->find(Eigen::Isometry3f::Identity());
    judge->end(Eigen::Isometry3f::Identity());
    EXPECT_GT(test::labelled_share(movers, frame.parts, test::kBoxPart), 0.9);
    EXPECT_LT(test::labelled_share(movers, frame.parts, test::kWallPart), 0.02);
    EXPECT_FALSE(next({box_at(0, 2.4f)}).empty()) << "not forgotten at once";
    for (int i = 0; i < 20; ++i) (void)next({box_at(0, 2.4f)});
    EXPECT_TRUE(next({box_at(0, 2.4f)}).empty());
}

TEST_F(Motion, ASuspectIsNearAndNamedWhereTrackingFitsWorseThanUsual) {
    const TrackingFit usual{1.05f, 0.03f}, bad{1.3f, 0.03f}, dark{1.05f, 0.04f};
    const Box near{{-0.3f, -0.3f, 0.9f}, {0.3f, 0.3f, 1.2f}}, far{{-0.75f, -0.75f, 3.6f}, {0.75f, 0.75f, 3.8f}};
    const auto suspect = [&](const TrackingFit& fit, const Box& box) {
        (void)next({box});
        (void)judge->begin(frame.color, frame.depth, {});
        return judge->suspect(fit);
    };
    const LabelImage first = suspect(usual, near);
    ASSERT_FALSE(first.empty()) << "in the first frames nothing is usual";
    EXPECT_GT(test::labelled_share(first, frame.parts, test::kBoxPart), 0.9);
    EXPECT_LT(test::labelled_share(first, frame.parts, test::kWallPart), 0.02);
    for (int i = 0; i < 10; ++i) (void)suspect(usual, near);
    EXPECT_TRUE(suspect(usual, near).empty());
    EXPECT_FALSE(suspect(bad, near).empty());
    EXPECT_FALSE(suspect(dark, near).empty());
    EXPECT_TRUE(suspect(bad, far).empty()) << "the wall says more";
}

TEST(ViewHistory, TellsFreeSpaceFromSurfacesAndFromWhatIsHidden) {
    const Intrinsics camera = test::camera_of(160, 120);
    const auto grid_of = [&](const std::vector<Box>& boxes) {
        const Frame frame = test::render({.boxes = boxes}, camera);
        return make_node_grid(frame.color, frame.depth, camera, {}, 1);
    };
    const auto depths = [](const NodeGrid& grid) {
        std::vector<float> values;
        for (const Node& node : grid.nodes) values.push_back(node.depth);
        return values;
    };
    const NodeGrid before = grid_of({box_at(-0.6f, 2.4f)}), now = grid_of({box_at(0.6f, 2.4f)});
    ViewHistory history({});
    history.add(before, depths(before), Eigen::Isometry3f::Identity());
    const std::vector<Sightings> seen = history.look_back(now, depths(now), Eigen::Isometry3f::Identity());
    const auto at = [&](float x) {  // in the middle of the front of a box there
        return seen[now.index(static_cast<int>(x / 2.15f * camera.fx + camera.cx),
                              static_cast<int>((test::kFloor - 0.45f) / 2.15f * camera.fy + camera.cy))];
    };
    EXPECT_EQ(at(0.6f).free, 1) << "the box has come where the wall was seen through it";
    EXPECT_EQ(at(0.6f).there, 0);
    EXPECT_EQ(at(-0.6f).free, 0) << "what the box hid before cannot be known";
    EXPECT_EQ(at(-0.6f).there, 0);
    EXPECT_EQ(at(0).free, 0);
    EXPECT_EQ(at(0).there, 1) << "the wall between them was there";
}

TEST(ConvexPatches, ConsistOfSmoothFaces) {
    const Intrinsics camera = test::camera_of(160, 120);
    const Frame frame = test::render({.boxes = {box_at(0, 2.4f)}}, camera);
    const NodeGrid grid = make_node_grid(frame.color, frame.depth, camera, {}, 1);
    const ConvexPatches patches = find_convex_patches(grid);
    EXPECT_GT(patches.face_count, patches.count);
    std::vector<int> patch_of(static_cast<std::size_t>(patches.face_count), -1);
    for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
        ASSERT_EQ(patches.face[i] < 0, patches.patch[i] < 0);
        if (patches.face[i] < 0) continue;
        int& patch = patch_of[static_cast<std::size_t>(patches.face[i])];
        if (patch < 0) patch = patches.patch[i];
        ASSERT_EQ(patch, patches.patch[i]) << "a face belongs to one patch";
    }
}

/// Normals need two nodes on each side: without its rims a surface would be four nodes narrower.
TEST(ConvexPatches, GoOnToTheRimsOfSurfaces) {
    const Intrinsics camera = test::camera_of(160, 120);
    const Frame frame = test::render({.boxes = {box_at(0, 2.4f)}}, camera);
    const NodeGrid grid = make_node_grid(frame.color, frame.depth, camera, {}, 1);
    const ConvexPatches patches = find_convex_patches(grid);
    const int row = static_cast<int>((test::kFloor - 0.45f) / 2.15f * camera.fy + camera.cy);  // across the box
    std::set<int> of_box, of_others;
    int without_normal = 0;
    for (int x = 0; x < grid.width; ++x) {
        const std::size_t i = grid.index(x, row);
        const bool box = frame.parts[i] == test::kBoxPart;
        if (box) EXPECT_GE(patches.patch[i], 0) << "column " << x;
        if (patches.patch[i] >= 0) (box ? of_box : of_others).insert(patches.patch[i]);
        without_normal += box && grid.nodes[i].normal.isZero();
    }
    EXPECT_EQ(without_normal, 2 * kNormalReach);
    for (const int patch : of_box) EXPECT_FALSE(of_others.contains(patch)) << "patch " << patch;
}

TEST(ConvexPatches, SeparateABoxFromTheFloorAndTheWall) {
    const Intrinsics camera = test::camera_of(160, 120);
    const Frame frame = test::render({.boxes = {box_at(0, 2.4f)}}, camera);
    const NodeGrid grid = make_node_grid(frame.color, frame.depth, camera, {}, 1);
    const ConvexPatches patches = find_convex_patches(grid);
    // the largest patch of each part holds most of it, and nothing of another part
    std::vector<std::vector<int>> count(3, std::vector<int>(static_cast<std::size_t>(patches.count), 0));
    std::vector<int> total(3, 0);
    for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
        if (patches.patch[i] < 0) continue;
        ++count[frame.parts[i]][static_cast<std::size_t>(patches.patch[i])];
        ++total[frame.parts[i]];
    }
    const auto largest = [&](int part) {
        const auto& of = count[static_cast<std::size_t>(part)];
        return static_cast<std::size_t>(std::max_element(of.begin(), of.end()) - of.begin());
    };
    const std::size_t box = largest(test::kBoxPart);
    EXPECT_GT(count[test::kBoxPart][box], total[test::kBoxPart] / 2);
    EXPECT_LT(count[test::kFloorPart][box] + count[test::kWallPart][box], total[test::kBoxPart] / 20);
}

}  // namespace
}  // namespace posefusion
