#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <sstream>

#include "engine/core/number_text.hpp"
#include "hosts/config/config_file.hpp"
#include "hosts/config/option_table.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/evaluate/map_evaluation.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/frame_source.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/io/recorders/recorder.hpp"
#include "hosts/mesh/cloud_file.hpp"
#include "hosts/mesh/mesh_file.hpp"
#include "hosts/report/report.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/german_locale.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::GermanLocale;
using test::read_all;
using test::TempFolder;
namespace fs = std::filesystem;

/// Whatever has numbers in it, by a name.
using Texts = std::map<std::string, std::string>;

Camera some_camera() { return {{517.25f, 516.5f, 15.75f, 11.125f, 32, 24}, 1234.5f, {0.25f, -0.5f, 0.001f, 0, 1.5f}}; }

Trajectory some_trajectory() {
    Trajectory trajectory;
    for (int i = 0; i < 90; ++i) {
        StampedPose pose;
        pose.stamp = std::chrono::microseconds(1341846315698114 + 33333LL * i);
        pose.T_world_camera.translation() = Eigen::Vector3d(1234.5 + 0.01 * i, 0.001 * i * i, -0.5);
        trajectory.push_back(pose);
    }
    return trajectory;
}

std::vector<Surfel> some_map() {
    std::vector<Surfel> map(1500);
    for (std::size_t i = 0; i < map.size(); ++i) {
        map[i].position = {0.01f * static_cast<float>(i % 40), 0.01f * static_cast<float>(i / 40), 2};
        map[i].normal = {0, 0, -1};
        map[i].radius = 0.005f;
    }
    return map;
}

ReportData some_run() {
    ReportData data;
    data.trajectory = some_trajectory();
    data.groundtruth = data.trajectory;
    for (StampedPose& pose : *data.groundtruth) pose.T_world_camera.translation().x() *= 1.0001;
    data.evaluation = evaluate(*data.groundtruth, data.trajectory);
    data.host_stages = {{"read", {1.5, 2.25, 1234.5}}};
    data.frames.resize(data.trajectory.size());
    data.frames[5].loops.resize(1);
    data.frames[5].loops[0].milliseconds = 12.5;
    data.map = some_map();
    data.camera = some_camera().intrinsics;
    return data;
}

Texts everything_written(const fs::path& folder) {
    Texts texts;
    const auto file = [&](const fs::path& name) { texts[name.string()] = read_all(folder / name); };
    write_camera_file(folder / "camera.yaml", some_camera());
    write_trajectory(folder / "trajectory.txt", some_trajectory());
    write_ply(folder / "map.ply", some_map(), {"of 1234.5 m"});
    write_cloud(folder / "map.pcd", some_map());
    write_cloud(folder / "map.xyz", some_map());
    write_cloud(folder / "text.pcd", some_map(), CloudEncoding::Text);
    write_trajectory(folder / "trajectory.csv", some_trajectory(), TrajectoryFormat::Asl);
    Mesh mesh;
    mesh.vertices.assign(1234, {{0.5f, 1.25f, 1234.5f}, {1, 2, 3}});
    mesh.faces.assign(2345, {0, 1, 1233});
    write_mesh(folder / "mesh.ply", mesh);
    write_mesh(folder / "mesh.obj", mesh);
    write_mesh(folder / "mesh.glb", mesh);
    for (const char* name : {"camera.yaml", "trajectory.txt", "map.ply", "map.pcd", "map.xyz", "text.pcd",
                             "trajectory.csv", "mesh.ply", "mesh.obj", "mesh.glb"})
        file(name);

    const ReportData run = some_run();
    texts["evaluation"] = evaluation_table(*run.evaluation) + evaluation_json(*run.evaluation);
    MapEvaluation map_evaluation;
    map_evaluation.max_distance = 0.0625;
    texts["map evaluation"] = map_evaluation_table(map_evaluation) + map_evaluation_json(map_evaluation);
    fs::create_directories(folder / "report");
    (void)write_report(folder / "report", run, "no chart library");
    file("report/report.html");
    file("report/trajectory.png");

    SynthConfig synth;
    synth.out = folder / "synth";
    synth.frames = 2;
    synth.width = 64;
    synth.height = 48;
    synth.people = 1;
    synthesize(synth);
    for (const auto& entry : fs::directory_iterator(synth.out))
        if (entry.is_regular_file()) file(fs::path("synth") / entry.path().filename());

    RunConfig config;
    const std::vector<Option> options = option_table(config);
    find_option(options, "scale").set("0.25");
    texts["options"] = config_yaml(options);
    return texts;
}

/// Without the time of day and the folder.
TEST(Locale, ChangesNothingThatIsWritten) {
    const TempFolder folder;
    for (const char* part : {"point", "comma", "locale"}) fs::create_directories(folder / part);
    const Texts expected = everything_written(folder / "point");
    const GermanLocale german(folder / "locale");
    if (!german.there()) GTEST_SKIP() << "needs the locale de_DE.UTF-8, or the package locales to make it of";
    std::ostringstream stream;
    stream << 1234.5;
    char text[16];
    std::snprintf(text, sizeof text, "%.1f", 1234.5);
    ASSERT_EQ(stream.str() + " " + text, "1.234,5 1234,5") << "the locale does what it should";
    for (const auto& [name, written] : everything_written(folder / "comma"))
        EXPECT_TRUE(written == expected.at(name)) << name << ":\n"
                                                  << (name.ends_with(".png") ? "" : written.substr(0, 2000));
}

TEST(Locale, ChangesNothingThatIsRead) {
    const TempFolder folder;
    for (const char* part : {"recording", "locale"}) fs::create_directories(folder / part);
    (void)everything_written(folder.path());
    const GermanLocale german(folder / "locale");
    if (!german.there()) GTEST_SKIP() << "needs the locale de_DE.UTF-8, or the package locales to make it of";
    const Camera camera = read_camera_file(folder / "camera.yaml");
    EXPECT_EQ(camera.intrinsics.fx, 517.25f);
    EXPECT_EQ(camera.depth_scale, 1234.5f);
    EXPECT_EQ(camera.distortion, some_camera().distortion);
    const Trajectory trajectory = read_trajectory(folder / "trajectory.txt");
    EXPECT_EQ(trajectory.back().stamp, some_trajectory().back().stamp);
    EXPECT_DOUBLE_EQ(trajectory[1].T_world_camera.translation().x(), 1234.51);
    const auto source = open_source(folder / "synth");
    EXPECT_EQ(source->size(), 2u);
    EXPECT_TRUE(source->groundtruth());
    (void)source->read(1);
    EXPECT_EQ(read_ply(folder / "map.ply").size(), 1500u);
    RunConfig config;
    const std::vector<Option> options = option_table(config);
    load_config(folder.write("c.yaml", "scale: 0.25\ntracking:\n  icp_max_distance: 0.0625\n"), options);
    EXPECT_EQ(config.scale, 0.25f);
    EXPECT_EQ(config.slam.tracking.icp_max_distance, 0.0625f);
    EXPECT_EQ(*number_of<double>("1234.5"), 1234.5);
    EXPECT_EQ(fixed_text(1234.5, 2), "1234.50");
    EXPECT_EQ(shortest_text(0.1f), "0.1");
}

}  // namespace
}  // namespace posefusion
