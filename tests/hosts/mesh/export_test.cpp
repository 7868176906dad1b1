#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "hosts/io/ply.hpp"
#include "hosts/io/trajectory.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"
#include "tests/hosts/mesh/shapes.hpp"

/// posefusion export on maps that the test makes.
namespace posefusion::test {
namespace {

class Export : public Cli {
protected:
    [[nodiscard]] std::filesystem::path map() const { return temp_ / "map.ply"; }
    [[nodiscard]] Result exported(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), {"export", map().string()});
        return execute(program(arguments));
    }
    [[nodiscard]] std::string path(const std::string& name) const { return (temp_ / name).string(); }
    void write_map() const {
        auto surfels = sphere({0, 0, 1}, 0.3f, 5000);
        for (std::size_t i = 0; i < surfels.size(); i += 2) surfels[i].confidence = 3;
        write_ply(map(), surfels);
    }
};

TEST_F(Export, WritesMeshAndCloudAndSaysSo) {
    write_map();
    const Result result = exported({"--mesh", path("mesh.ply"), "--cloud", path("cloud.pcd")});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("cloud.pcd: 5000 points"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("triangles"), std::string::npos);
    EXPECT_NE(result.err.find("reconstructing"), std::string::npos) << "no progress";
    EXPECT_GT(read_ply(temp_ / "mesh.ply").size(), 1000u);  // its vertices
}

TEST_F(Export, TheFolderOfARunWillDo) {
    write_map();
    const Result result = execute(program({"export", temp_.path().string(), "--mesh", path("mesh.obj")}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(read_all(temp_ / "mesh.obj").starts_with("# made by PoseFusion"));
}

TEST_F(Export, SimplifiesTheMesh) {
    write_map();
    const Result result = exported({"--mesh", path("mesh.glb"), "--max-triangles", "500"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("simplifying"), std::string::npos) << result.err;
    EXPECT_NE(result.out.find(" 500 triangles"), std::string::npos) << result.out;
    EXPECT_TRUE(read_all(temp_ / "mesh.glb").starts_with("glTF"));
}

TEST_F(Export, NothingButResultsIsOnTheStandardOutput) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> coordinate(-1, 1);
    std::vector<Surfel> surfels;  // in such disorder PCL has remarks to make
    for (int i = 0; i < 20'000; ++i) {
        const Eigen::Vector3f direction(coordinate(random), coordinate(random), coordinate(random));
        const Eigen::Vector3f position(coordinate(random), coordinate(random), coordinate(random));
        surfels.push_back(surfel_at(position, direction.normalized(), {}));
    }
    write_ply(map(), surfels);
    const Result result = exported({"--mesh", path("mesh.ply"), "--resolution", "0.05"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(result.out.starts_with(path("mesh.ply"))) << result.out.substr(0, 200);
    EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 1);
}

TEST_F(Export, MinConfidenceLeavesOutTheRest) {
    write_map();
    const Result result = exported({"--cloud", path("cloud.ply"), "--min-confidence", "10"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto kept = read_ply(temp_ / "cloud.ply");
    EXPECT_EQ(kept.size(), 2500u);
    for (const Surfel& s : kept) ASSERT_GE(s.confidence, 10.0f);
}

TEST_F(Export, WritesTheTrajectoryOfARunInEveryFormatThatEvaluateReads) {
    Trajectory trajectory;
    for (int i = 0; i < 40; ++i) {
        StampedPose pose{Stamp(1403636579763555584 + 33333333LL * i)};
        pose.T_world_camera.translation() = Eigen::Vector3d(0.1 * i, -1, 0.01 * i * i);
        trajectory.push_back(pose);
    }
    write_trajectory(temp_ / "trajectory.txt", trajectory);
    const std::string run = temp_.path().string(), original = path("trajectory.txt");
    struct Case {
        std::vector<std::string> options;
        TrajectoryFormat format;
    };
    for (const auto& [options, format] :
         {Case{{path("a.txt")}, TrajectoryFormat::Tum}, Case{{path("a.csv")}, TrajectoryFormat::Asl},
          Case{{path("b.txt"), "--format", "euroc"}, TrajectoryFormat::Asl},
          Case{{path("c.txt"), "--format", "kitti"}, TrajectoryFormat::Kitti}}) {
        for (const std::string& source : {run, original}) {
            std::vector<std::string> arguments{"export", source, "--trajectory"};
            arguments.insert(arguments.end(), options.begin(), options.end());
            const Result result = execute(program(arguments));
            ASSERT_EQ(result.exit_code, 0) << result.err;
            EXPECT_NE(result.out.find(options[0] + ": 40 poses"), std::string::npos) << result.out;
        }
        const TrajectoryFile read = read_trajectory_file(options[0]);
        EXPECT_EQ(read.format, format);
        ASSERT_EQ(read.poses.size(), trajectory.size());
        EXPECT_TRUE(read.poses.back().T_world_camera.isApprox(trajectory.back().T_world_camera, 1e-9));
        const Result evaluated = execute(program({"evaluate", original, options[0], "--align", "none", "--json"}));
        EXPECT_EQ(evaluated.exit_code, 0) << evaluated.err;
    }
}

/// The camera was lost in between: the rows do not say so, the stamps do.
TEST_F(Export, KittisPosesHaveTheirStampsBesideThem) {
    write_trajectory(temp_ / "trajectory.txt", {StampedPose{Stamp(1'500'000'000)}, StampedPose{Stamp(9'250'000'000)}});
    const Result result =
        execute(program({"export", temp_.path().string(), "--trajectory", path("poses.txt"), "--format", "kitti"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find(path("poses_times.txt") + ": 2 time stamps"), std::string::npos) << result.out;
    std::ifstream times(temp_ / "poses_times.txt");
    double first = 0, second = 0;
    std::string none;
    ASSERT_TRUE(times >> first >> second);
    EXPECT_FALSE(times >> none);
    EXPECT_EQ(first, 1.5);
    EXPECT_EQ(second, 9.25);
}

TEST_F(Export, ATrajectoryThatCannotBeWrittenIsAnErrorInOneLine) {
    constexpr int kUsage = 2;
    expect_error(execute(program({"export", temp_.path().string(), "--trajectory", path("t.csv")})),
                 {"trajectory.txt"});
    write_trajectory(temp_ / "kitti.txt", {StampedPose{}}, TrajectoryFormat::Kitti);
    const std::string kitti = path("kitti.txt");
    expect_error(execute(program({"export", kitti, "--trajectory", path("t.csv")})), {"kitti.txt", "no time stamps"});
    EXPECT_EQ(execute(program({"export", kitti, "--trajectory", path("t"), "--format", "kitti"})).exit_code, 0);
    expect_error(execute(program({"export", kitti, "--trajectory", kitti})), {"is what is exported"}, kUsage);
    expect_error(execute(program({"export", kitti, "--cloud", path("c.ply"), "--format", "tum"})), {"--trajectory"},
                 kUsage);
    expect_error(execute(program({"export", kitti, "--trajectory", path("t"), "--format", "bvh"})), {"bvh"}, kUsage);
}

TEST_F(Export, EndsAtOnceWhenInterruptedAndSaysWhatThereIs) {
    write_ply(map(), sphere({0, 0, 1}, 0.5f, 400'000));
    Subprocess process(program({"export", map().string(), "--cloud", path("cloud.pcd"), "--mesh", path("mesh.ply"),
                                "--resolution", "0.001"}),  // a minute of work
                       temp_.path());
    ASSERT_TRUE(process.wait_for("reconstructing")) << process.error_output();
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const auto asked = std::chrono::steady_clock::now();
    process.send(SIGINT);
    EXPECT_EQ(process.exit_code(), 130) << process.error_output();
    EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(5)) << "at once, on a busy computer, too";
    EXPECT_NE(process.error_output().find("mesh.ply was not written, " + path("cloud.pcd") + " was"), std::string::npos)
        << process.error_output();
    EXPECT_EQ(process.output(), path("cloud.pcd") + ": 400000 points\n");
    for (const auto& entry : std::filesystem::directory_iterator(temp_.path()))
        EXPECT_FALSE(entry.path().filename().string().starts_with("mesh.ply")) << entry.path();
}

TEST_F(Export, FaultsEndInOneLine) {
    expect_error(exported({"--mesh", path("mesh.ply")}), {"map.ply", "cannot be read"});
    write_map();
    constexpr int kUsage = 2;
    expect_error(exported({}), {"nothing to export", "--mesh"}, kUsage);
    expect_error(exported({"--mesh", path("mesh.stl")}), {"mesh.stl", ".ply, .obj or .glb"}, kUsage);
    expect_error(exported({"--cloud", path("cloud.las")}), {"cloud.las", ".pcd, .ply or .xyz"}, kUsage);
    expect_error(exported({"--cloud", path("cloud.ply"), "--ascii"}), {"--ascii", ".pcd"}, kUsage);
    expect_error(exported({"--mesh", path("mesh.ply"), "--resolution", "0"}), {"the resolution"}, kUsage);
    expect_error(exported({"--mesh", path("mesh.ply"), "--trim", "0"}), {"--trim"}, kUsage);
    expect_error(exported({"--mesh", path("mesh.ply"), "--max-triangles", "-5"}), {"--max-triangles"}, kUsage);
    expect_error(exported({"--mesh", path("mesh.ply"), "--min-confidence", "-1"}), {"confidence"}, kUsage);
    expect_error(exported({"--mesh", path("mesh.ply"), "--min-confidence", "1000"}), {"--min-confidence"});
    expect_error(exported({"--mesh", path("mesh.ply"), "--resolution", "0.00001"}), {"the finest is"});
    expect_error(exported({"--mesh", path("none/mesh.ply")}), {"none"});
    expect_error(exported({"--cloud", map().string()}), {"map.ply", "is what is exported"}, kUsage);
    write_ply(map(), {});
    expect_error(exported({"--cloud", path("cloud.ply")}), {"map.ply", "the map is empty"});
    temp_.write("map.ply", "no map\n");
    expect_error(exported({"--mesh", path("mesh.ply")}), {"map.ply", "not a PLY file"});
}

}  // namespace
}  // namespace posefusion::test
