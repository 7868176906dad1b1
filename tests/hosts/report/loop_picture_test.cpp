#include "hosts/report/loop_picture.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "hosts/report/upright.hpp"

namespace posefusion {
namespace {

/// A grey floor of 4 x 4 m, 1 m below a camera that goes round on it, and nothing else.
ReportData walk() {
    ReportData data;
    for (int i = 0; i < 40000; ++i) {
        Surfel surfel;
        surfel.position = {0.02f * static_cast<float>(i % 200) - 2, 1, 0.02f * static_cast<float>(i / 200) - 2};
        surfel.normal = {0, -1, 0};
        surfel.color = {128, 128, 128};
        surfel.radius = 0.02f;
        data.map.push_back(surfel);
    }
    for (int i = 0; i < 80; ++i) {
        StampedPose pose;
        pose.stamp = stamp_of(i / 30.0);
        pose.T_world_camera.translation() = Eigen::Vector3d(1.2 * std::sin(0.075 * i), 0, 1.2 * std::cos(0.075 * i));
        data.trajectory.push_back(pose);
    }
    data.frames.resize(80);
    data.keyframes = {20, 40};
    LoopEvent event;
    event.frame = 79, event.model_frame = 10, event.accepted = true, event.nodes = 3;
    data.frames[79].loops = {event};
    return data;
}

LoopGraph some_graph() {
    return {79,
            {{{-0.3, 1, 0}, {0, 0, 0}},
             {{0.3, 1, 0}, {0.02, 0, 0}},
             {{0, 1, 0.4}, {0, 0, 0.04}},
             {{0, 0, -1.6}, {0, 0, 9}}},
            3,
            {{0, 1}, {1, 2}, {2, 3}}};
}

class LoopPictures : public testing::Test {
protected:
    [[nodiscard]] LoopPicture picture() const { return loop_picture(data_, upright_axes(data_.map, data_.trajectory)); }
    static Eigen::Vector2i pixel(const LoopPicture& picture, const Eigen::Vector3d& point) {
        const Eigen::Vector3d p = picture.T_world_camera.inverse() * point;
        return {static_cast<int>(std::lround(picture.camera.fx * p.x() / p.z() + picture.camera.cx)),
                static_cast<int>(std::lround(picture.camera.fy * p.y() / p.z() + picture.camera.cy))};
    }
    static Rgb8 at(const LoopPicture& picture, const Eigen::Vector3d& point) {
        const Eigen::Vector2i p = pixel(picture, point);
        return picture.image.contains(p.x(), p.y()) ? picture.image(p.x(), p.y()) : Rgb8{};
    }
    /// In the picture, not in its legend.
    static int count(const LoopPicture& picture, Rgb8 color) {
        int pixels = 0;
        for (int v = 0; v < picture.camera.height; ++v)
            for (int u = 0; u < picture.camera.width; ++u) pixels += picture.image(u, v) == color ? 1 : 0;
        return pixels;
    }
    [[nodiscard]] Eigen::Vector3d camera(std::size_t i) const {
        return data_.trajectory[i].T_world_camera.translation();
    }

    ReportData data_ = walk();
};

TEST_F(LoopPictures, NodesAndEdgesLieWhereTheyAreProjected) {
    data_.loop_graph = some_graph();
    const LoopPicture with = picture();
    const auto nodes = data_.loop_graph->nodes;
    const double longest = nodes[2].moved.norm();
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(at(with, nodes[static_cast<std::size_t>(i)].position),
                  displacement_color(nodes[static_cast<std::size_t>(i)].moved.norm() / longest))
            << i;
    const Eigen::Vector3d on_edge = (nodes[0].position + nodes[1].position) / 2,
                          no_edge = (nodes[0].position + nodes[2].position) / 2;
    const Rgb8 edge = at(with, on_edge), floor = at(with, no_edge);
    EXPECT_GT(edge.b, edge.r + 30) << "blue like the node that did not move, mixed with the floor";
    EXPECT_EQ(floor.r, floor.g) << "no edge, grey floor";
    EXPECT_NE(at(with, nodes[3].position), displacement_color(1)) << "cameras have their own line";

    data_.loop_graph.reset();
    for (int i = 0; i < 3; ++i) {
        const Rgb8 bare = at(picture(), nodes[static_cast<std::size_t>(i)].position);
        EXPECT_EQ(bare.r, bare.g) << "without a graph there is the map";
    }
}

TEST_F(LoopPictures, TrajectoryKeyframesAndLoopsLieOverTheMap) {
    const LoopPicture all = picture();
    EXPECT_EQ(at(all, camera(20)), kLoopColors.keyframe);
    EXPECT_EQ(at(all, camera(40)), kLoopColors.keyframe);
    EXPECT_EQ(at(all, camera(30)), kLoopColors.trajectory);
    EXPECT_EQ(at(all, (camera(79) + camera(10)) / 2), kLoopColors.loop) << "the two ends are joined";
    EXPECT_EQ(count(all, kLoopColors.lost), 0);
    EXPECT_EQ(count(all, kLoopColors.relocalised), 0);
    const Rgb8 floor = at(all, {0.5, 1, 0.1});
    EXPECT_GT(floor.r, 128) << "faded";
    EXPECT_LT(floor.r, 230) << "but there";

    data_.frames[79].loops[0].accepted = false;
    EXPECT_EQ(count(picture(), kLoopColors.loop), 0);
}

TEST_F(LoopPictures, WhereTheCameraWasLostAndFoundAgainIsMarked) {
    data_.lost = {{50, 59, true}};
    LoopEvent found;
    found.frame = found.model_frame = 60, found.kind = LoopKind::Relocalisation, found.accepted = true;
    data_.frames[60].loops = {found};
    const LoopPicture marked = picture();
    EXPECT_EQ(at(marked, camera(55)), kLoopColors.lost);
    EXPECT_EQ(at(marked, camera(45)), kLoopColors.trajectory);
    EXPECT_GT(count(marked, kLoopColors.relocalised), 10);
}

TEST_F(LoopPictures, EverythingIsInView) {
    data_.loop_graph = some_graph();
    data_.map.resize(200);  // a strip: most of the walk is outside of the map
    const LoopPicture all = picture();
    for (std::size_t i = 0; i < data_.trajectory.size(); ++i) {
        const Eigen::Vector2i p = pixel(all, camera(i));
        EXPECT_TRUE(p.x() >= 0 && p.y() >= 0 && p.x() < all.camera.width && p.y() < all.camera.height) << i;
    }
    EXPECT_GT(all.image.height(), all.camera.height) << "the legend is below";
}

TEST_F(LoopPictures, ThereIsOneOnlyIfThereIsSomethingToShow) {
    EXPECT_TRUE(has_loop_picture(data_));
    data_.frames[79].loops[0].accepted = false;
    EXPECT_FALSE(has_loop_picture(data_)) << "keyframes alone do not make one";
    data_.loop_graph = some_graph();
    EXPECT_TRUE(has_loop_picture(data_));
}

}  // namespace
}  // namespace posefusion
