#include "hosts/report/report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::read_all;
using test::TempFolder;

ReportData some_run(int frames) {
    ReportData data;
    data.recording = "walk <xyz> & \"more\"";
    data.camera = {500, 500, 319.5f, 239.5f, 640, 480};
    data.facts = {{"device", "llvmpipe </script><b>"}};
    data.warnings = {"a <b>warning</b>"};
    data.configuration = "scale: 1\n# @run@ @css@ stays as it is\n";
    for (int i = 0; i < frames; ++i) {
        StampedPose pose;
        pose.stamp = stamp_of(1000 + i / 30.0);
        pose.T_world_camera.translation() = Eigen::Vector3d(0.01 * i, 0.1 * std::sin(0.1 * i), 0);
        data.trajectory.push_back(pose);
        FrameResult frame;
        frame.valid_pixels = i == 0 ? 0u : 1000u;
        frame.icp_inliers = 800;
        frame.icp_rmse_m = i == 3 ? std::numeric_limits<float>::infinity() : 0.004f;
        frame.surfels = static_cast<std::uint32_t>(100 * i);
        data.frames.push_back(frame);
        data.people.push_back(i % 3);
    }
    data.groundtruth = data.trajectory;
    data.evaluation = evaluate(*data.groundtruth, data.trajectory);
    data.host_stages = {{"read", std::vector<double>(static_cast<std::size_t>(frames), 12.5)}};
    data.gpu_stages = {{"</script><script>alert(1)</script>", {1, std::nan(""), 3}}};
    for (int i = 0; i < 1600; ++i) {
        Surfel surfel;
        surfel.position = {0.02f * static_cast<float>(i % 40), 0.02f * static_cast<float>(i / 40), 2};
        surfel.normal = {0, 0, -1};
        surfel.radius = 0.01f;
        data.map.push_back(surfel);
    }
    SampleFrame sample;
    sample.color = ColorImage(64, 48, {9, 99, 199});
    sample.labels = LabelImage(64, 48, 1);
    data.samples = {sample};
    return data;
}

/// The JSON that page.js reads.
nlohmann::json run_of(const std::string& html) {
    const std::string open = "<script id=\"run\" type=\"application/json\">";
    const std::size_t begin = html.find(open) + open.size();
    return nlohmann::json::parse(html.substr(begin, html.find("</script>", begin) - begin));
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = 0; (at = text.find(part, at)) != std::string::npos; at += part.size()) ++n;
    return n;
}

TEST(Report, HasEverythingInOneFile) {
    const TempFolder folder;
    const auto library = folder.write("chart.js", "var Chart = 'the plot library';");
    write_report(folder.path(), some_run(60), library);
    const std::string html = read_all(folder / "report.html");
    EXPECT_NE(html.find("var Chart = 'the plot library';"), std::string::npos);
    EXPECT_EQ(count(html, "src=\"data:image/"), 4u) << "two views of the map, the trajectory, one sample";
    EXPECT_EQ(html.find("http://"), std::string::npos);
    EXPECT_EQ(html.find("https://"), std::string::npos);
    EXPECT_EQ(count(html, "<link"), 0u);
    for (const char* name : {"trajectory.png", "map.png", "map_view.png"})
        EXPECT_GT(read_photo(folder / name).width(), 1000) << name;
}

TEST(Report, TextOfTheRunCannotBreakThePage) {
    const TempFolder folder;
    write_report(folder.path(), some_run(10), folder / "none.js");
    const std::string html = read_all(folder / "report.html");
    EXPECT_NE(html.find("walk &lt;xyz&gt; &amp; &quot;more&quot;"), std::string::npos);
    EXPECT_NE(html.find("a &lt;b&gt;warning&lt;/b&gt;"), std::string::npos);
    EXPECT_NE(html.find("@run@ @css@ stays as it is"), std::string::npos);
    EXPECT_EQ(count(html, "</script>"), 3u) << "the page's own three";
    EXPECT_EQ(count(html, "alert(1)</script>"), 0u);
    EXPECT_EQ(run_of(html)["gpu_stages"][0]["name"], "</script><script>alert(1)</script>");
}

TEST(Report, PlotsTheNumbersOfTheRun) {
    const TempFolder folder;
    const ReportData data = some_run(60);
    write_report(folder.path(), data, folder / "none.js");
    const auto run = run_of(read_all(folder / "report.html"));
    EXPECT_EQ(run["estimate"].size(), 60u);
    EXPECT_EQ(run["groundtruth"].size(), 60u);
    EXPECT_NEAR(run["time_s"][30].get<double>(), 1.0, 1e-3);
    EXPECT_EQ(run["errors"]["ate_m"].size(), 60u);
    EXPECT_EQ(run["errors"]["rpe_m"].size(), data.evaluation->rpe->stamps.size());
    EXPECT_TRUE(run["frames"]["inliers"][0].is_null()) << "no valid pixel, no share";
    EXPECT_NEAR(run["frames"]["inliers"][1].get<double>(), 0.8, 1e-4);
    EXPECT_TRUE(run["frames"]["icp_rmse_m"][3].is_null()) << "infinite numbers are gaps";
    EXPECT_EQ(run["frames"]["surfels"][59], 5900);
    EXPECT_EQ(run["frames"]["people"][2], 2);
    EXPECT_TRUE(run["gpu_stages"][0]["ms"][1].is_null());
}

TEST(Report, ARunWithoutAnythingStillHasOne) {
    const TempFolder folder;
    write_report(folder.path(), ReportData{}, folder / "none.js");
    const std::string html = read_all(folder / "report.html");
    EXPECT_NE(html.find("No ground truth"), std::string::npos);
    EXPECT_EQ(run_of(html)["estimate"].size(), 0u);
    EXPECT_FALSE(run_of(html).contains("errors"));
}

TEST(Report, SameRunSameBytes) {
    const TempFolder folder;
    for (const char* name : {"a", "b"}) {
        std::filesystem::create_directories(folder / name);
        write_report(folder / name, some_run(40), folder / "none.js");
    }
    for (const char* name : {"report.html", "trajectory.png", "map.png", "map_view.png"})
        EXPECT_EQ(read_all(folder.path() / "a" / name), read_all(folder.path() / "b" / name)) << name;
}

TEST(Report, AFolderThatIsNotThereIsNamed) {
    const TempFolder folder;
    EXPECT_NE(test::message_of<Error>([&] { write_report(folder / "none", ReportData{}); }).find("none/trajectory.png"),
              std::string::npos);
}

/// Loops of all kinds after a loaded map of 10 frames, lost from 20 to 24.
ReportData some_loops() {
    ReportData data = some_run(60);
    data.earlier_poses.assign(10, Eigen::Isometry3d::Identity());
    data.keyframes = {0, 10, 40};
    LoopEvent event;
    event.frame = 40, event.kind = LoopKind::Global, event.model_frame = 4, event.reason = "too <little> in view";
    data.frames[30].loops.push_back(event);
    event.kind = LoopKind::Local, event.model_frame = 12, event.reason = "", event.accepted = true;
    event.overlap = 0.25f, event.inlier_ratio = 0.8f, event.residual_before_m = 0.0234, event.residual_after_m = 0.0012,
    event.nodes = 3, event.milliseconds = 140, event.solve_milliseconds = 37;
    data.frames[30].loops.push_back(event);
    event.frame = event.model_frame = 35, event.kind = LoopKind::Relocalisation, event.nodes = 0;
    data.frames[25].loops.push_back(event);
    data.lost = {{20, 24, true}};
    data.loop_graph =
        LoopGraph{40,
                  {{{0.2, 0.2, 2}, {0, 0, 0}}, {{0.6, 0.2, 2}, {0.05, 0, 0}}, {{0.2, 0.6, 2}, {0, 0.1, 0}}},
                  3,
                  {{0, 1}, {1, 2}}};
    return data;
}

TEST(Report, TellsOfLoopsKeyframesAndLostIntervals) {
    const TempFolder folder;
    const auto pictures = write_report(folder.path(), some_loops(), folder / "none.js");
    EXPECT_EQ(pictures, (std::vector<std::string>{"trajectory.png", "map.png", "map_view.png", "loops.png"}));
    const std::string html = read_all(folder / "report.html");
    EXPECT_NE(
        html.find(
            "1 loop closed in 2 attempts, 3 keyframes. Without tracking: 5 frames in 1 interval; 1 relocalisation."),
        std::string::npos);
    EXPECT_NE(html.find("too &lt;little&gt; in view"), std::string::npos);
    EXPECT_NE(html.find(">23.4</td><td class=\"number\">1.2</td><td class=\"number\">3</td><td "
                        "class=\"number\">37</td><td class=\"number\">140</td>"),
              std::string::npos)
        << "residuals in mm, nodes";
    EXPECT_NE(html.find(">4 of the loaded map</td>"), std::string::npos);
    EXPECT_NE(
        html.find(
            ">20 (0.67 s)</td><td class=\"number\">24 (0.80 s)</td><td class=\"number\">5</td><td>found again</td>"),
        std::string::npos);
    EXPECT_EQ(count(html, "src=\"data:image/"), 5u) << "loops.png is in the page";
    for (const char* mark : {"not tracked", "loop closed<", "found again<", "keyframe (tick"})
        EXPECT_NE(html.find(mark), std::string::npos) << mark;

    const auto run = run_of(html);
    EXPECT_EQ(run["lost"], nlohmann::json::parse("[[20, 24]]"));
    EXPECT_EQ(run["keyframes"], nlohmann::json::parse("[0, 30]")) << "those of this run";
    EXPECT_EQ(run["keyframe_positions"].size(), 3u);
    ASSERT_EQ(run["loops"].size(), 3u);
    EXPECT_EQ(run["loops"][0], nlohmann::json::parse(R"({"frame": 25, "kind": "relocalisation", "accepted": true})"));
    EXPECT_EQ(run["loops"][1]["accepted"], false);
    ASSERT_EQ(run["loop_links"].size(), 1u);
    EXPECT_EQ(run["loop_links"][0][0], run["estimate"][30]);
    EXPECT_EQ(run["loop_links"][0][1], run["estimate"][2]) << "frame 12 of the engine is the third of the run";
}

/// A cart that rolls by a metre in frames 10 to 29, with errors of some millimetres, is lost for five of them, and then
/// stands; and a box that was tracked in one frame.
ReportData some_objects() {
    ReportData data = some_run(60);
    ObjectOfRun cart{101, {}, 4321}, box{104, {}, 12};
    for (int i = 10; i < 50; ++i) {
        if (i >= 20 && i < 25) continue;
        StampedPose pose = data.trajectory[static_cast<std::size_t>(i)];
        pose.T_world_camera.setIdentity();
        pose.T_world_camera.translation() = Eigen::Vector3d(i < 30 ? 0.05 * (i - 10) : 1, 0.003 * (i % 2), 2);
        cart.trajectory.push_back(pose);
        if (i == 40) box.trajectory.push_back(pose);
    }
    data.objects = {cart, box};
    return data;
}

TEST(Report, ShowsObjectsAndTheirPaths) {
    const TempFolder folder;
    const ReportData data = some_objects();
    write_report(folder.path(), data, folder / "none.js");
    const std::string html = read_all(folder / "report.html");
    EXPECT_NE(html.find("<b>2</b><span>objects that moved</span>"), std::string::npos);
    EXPECT_NE(html.find("</i>101</td><td class=\"number\">35</td><td class=\"number\">10 (0.33 s)</td><td "
                        "class=\"number\">49 (1.63 s)</td><td class=\"number\">1.00</td><td "
                        "class=\"number\">4321</td>"),
              std::string::npos)
        << "errors of the poses do not lengthen the path";
    EXPECT_NE(html.find("</i>104</td><td class=\"number\">1</td>"), std::string::npos);
    const auto objects = run_of(html)["objects"];
    ASSERT_EQ(objects.size(), 2u);
    EXPECT_EQ(objects[0]["label"], 101);
    ASSERT_EQ(objects[0]["path"].size(), 36u) << "and a gap";
    EXPECT_TRUE(objects[0]["path"][10][0].is_null());
    EXPECT_NEAR(objects[0]["path"][35][0].get<double>(), 1, 1e-3) << "right";
    EXPECT_NEAR(objects[0]["path"][35][1].get<double>(), 2, 1e-3) << "forward";
    EXPECT_EQ(objects[1]["path"].size(), 1u);
    EXPECT_NE(html.find("background: " + objects[1]["color"].get<std::string>() + "\""), std::string::npos);

    const std::string with = read_all(folder / "trajectory.png");
    write_report(folder.path(), some_run(60), folder / "none.js");
    EXPECT_NE(read_all(folder / "trajectory.png"), with) << "the picture shows them, too";
    const std::string without = read_all(folder / "report.html");
    EXPECT_EQ(count(without, "Objects"), 0u);
    EXPECT_EQ(count(without, "objects that moved"), 0u);
}

TEST(Report, LongTablesAreFolded) {
    const TempFolder folder;
    ReportData data = some_loops();
    write_report(folder.path(), data, folder / "none.js");
    EXPECT_EQ(count(read_all(folder / "report.html"), "<details open><summary>Not accepted: 1<"), 1u);
    for (int i = 0; i < 20; ++i) data.frames[40].loops.push_back(data.frames[30].loops[0]);
    write_report(folder.path(), data, folder / "none.js");
    EXPECT_EQ(count(read_all(folder / "report.html"), "<details><summary>Not accepted: 21<"), 1u);
}

TEST(Report, WithoutLoopsALineSaysSoAndNoPictureIsLeft) {
    const TempFolder folder;
    write_report(folder.path(), some_loops(), folder / "none.js");
    ASSERT_TRUE(std::filesystem::exists(folder / "loops.png"));
    const auto pictures = write_report(folder.path(), some_run(60), folder / "none.js");
    EXPECT_EQ(pictures.size(), 3u);
    const std::string html = read_all(folder / "report.html");
    EXPECT_NE(html.find("No loop closed in 0 attempts, 0 keyframes. Tracking was never lost."), std::string::npos);
    EXPECT_EQ(count(html, "src=\"data:image/"), 4u);
    EXPECT_EQ(count(html, "In plots over time"), 0u);
    EXPECT_FALSE(std::filesystem::exists(folder / "loops.png")) << "of the run before";
}

}  // namespace
}  // namespace posefusion
