// `posefusion view` in a real window on a display that nobody sees, driven by scripts; what it shows is looked at.
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <set>
#include <sstream>

#include "hosts/io/image_file.hpp"
#include "hosts/io/ply.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"
#include "tests/hosts/support/virtual_display.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

constexpr Rgb8 kBackground{23, 26, 31};  // FrameDrawer's

int difference(const Rgb8& a, const Rgb8& b) { return std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b); }

/// Pixels that show something, as a share of all.
double covered(const ColorImage& image) {
    const auto drawn =
        std::count_if(image.begin(), image.end(), [](const Rgb8& c) { return difference(c, kBackground) > 6; });
    return static_cast<double>(drawn) / static_cast<double>(image.size());
}

std::size_t colors(const ColorImage& image) {
    std::set<std::uint32_t> seen;
    for (const Rgb8& c : image) seen.insert(pack_rgb(c));
    return seen.size();
}

/// Pixels that differ visibly, as a share of all; 1 if the sizes do.
double changed(const ColorImage& a, const ColorImage& b) {
    if (a.width() != b.width() || a.height() != b.height()) return 1;
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += difference(a[i], b[i]) > 12 ? 1u : 0u;
    return static_cast<double>(count) / static_cast<double>(a.size());
}

/// Pixels of a saturated red, the tint of people.
std::size_t red_pixels(const ColorImage& image) {
    return static_cast<std::size_t>(std::count_if(
        image.begin(), image.end(), [](const Rgb8& c) { return c.r > 100 && c.r > c.g + 60 && c.r > c.b + 60; }));
}

class Viewer : public Cli {
protected:
    [[nodiscard]] Program on_display(const std::vector<std::string>& command) const {
        static const VirtualDisplay display(XVFB);
        EXPECT_FALSE(display.name().empty()) << "Xvfb does not start";
        Program program{command};
        program.environment = {{"DISPLAY", display.name()}, {"WAYLAND_DISPLAY", ""}};
        return program;
    }

    /// posefusion view RECORDING --script ...; with validation
    [[nodiscard]] Program view_of(const std::string& script, const std::vector<std::string>& more = {}) const {
        std::vector<std::string> command{POSEFUSION_PROGRAM,
                                         "view",
                                         recording().string(),
                                         "--engine-validation",
                                         "--out",
                                         out().string(),
                                         "--script",
                                         temp_.write("script.txt", script).string()};
        command.insert(command.end(), more.begin(), more.end());
        return on_display(command);
    }

    Result view(const std::string& script, const std::vector<std::string>& more = {}) {
        Result result = execute(view_of(script, more));
        EXPECT_EQ(result.err.find("Vulkan validation"), std::string::npos) << result.err;
        return result;
    }

    [[nodiscard]] std::string file(const std::string& name) const { return (temp_ / name).string(); }
    [[nodiscard]] ColorImage picture(const std::string& name) const { return read_photo(temp_ / name); }

    /// trajectory.txt and map.ply of the headless run.
    [[nodiscard]] std::pair<std::string, std::string> headless(const std::vector<std::string>& more) {
        const Result result = execute(run_of(recording(), more));
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return {read_all(out() / "trajectory.txt"), read_all(out() / "map.ply")};
    }

    static constexpr const char* kNobody = "--no-people";
};

TEST_F(Viewer, ShowsTheMapInAllColoursFromAllSides) {
    std::ostringstream script;
    script << "step 6\nshow panels off\nshow images off\nshow path off\nshow frustum off\nshow skeletons off\n";
    for (const char* mode : {"photo", "normal", "confidence", "age", "time"}) {
        script << "colour " << mode << "\nscreenshot " << file(std::string(mode) + ".png") << "\n";
    }
    script << "colour photo\nscreenshot " << file("again.png") << "\norbit 30 10\nscreenshot " << file("orbit.png")
           << "\nzoom 2\nscreenshot " << file("far.png") << "\nfollow on\nscreenshot " << file("follow.png")
           << "\nfollow off\nkey Home\nzoom 0.5\nscreenshot " << file("home.png") << "\nconfidence 1000\nscreenshot "
           << file("sure.png") << "\nconfidence 0\nshow map off\nscreenshot " << file("nothing.png") << "\nclose\n";
    const Result result = view(script.str(), {kNobody});
    ASSERT_EQ(result.exit_code, 0) << result.err;

    const ColorImage photo = picture("photo.png");
    EXPECT_EQ(photo.width(), 1280);
    EXPECT_EQ(photo.height(), 720);
    EXPECT_GT(covered(photo), 0.10) << "the room is seen";
    EXPECT_GT(colors(photo), 500u);
    EXPECT_EQ(changed(photo, picture("again.png")), 0) << "the same view gives the same picture";
    for (const char* mode : {"normal", "confidence", "age", "time"}) {
        const ColorImage shown = picture(std::string(mode) + ".png");
        EXPECT_GT(changed(photo, shown), 0.05) << mode;
        EXPECT_NEAR(covered(shown), covered(photo), 0.02) << mode << " colours the same surfels";
    }
    EXPECT_GT(changed(picture("confidence.png"), picture("age.png")), 0.05);
    EXPECT_GT(changed(photo, picture("orbit.png")), 0.05);
    EXPECT_LT(covered(picture("far.png")), 0.5 * covered(picture("orbit.png")));
    EXPECT_GT(covered(picture("follow.png")), 0.10);
    EXPECT_GT(changed(picture("follow.png"), picture("orbit.png")), 0.05);
    EXPECT_EQ(covered(picture("sure.png")), 0) << "no surfel is as sure as that";
    EXPECT_EQ(covered(picture("nothing.png")), 0);
}

TEST_F(Viewer, DrawsCameraTrajectoryAndSkeletonsAndTintsPeople) {
    std::ostringstream script;
    script << "step 8\nshow panels off\nshow images off\nshow map off\nshow path off\nshow frustum off\nshow skeletons "
              "off\n";
    for (const char* what : {"path", "frustum", "skeletons"}) {
        script << "show " << what << " on\nscreenshot " << file(std::string(what) + ".png") << "\nshow " << what
               << " off\n";
    }
    script << "show images on\nshow mask off\nscreenshot " << file("untinted.png") << "\nshow mask on\nscreenshot "
           << file("tinted.png") << "\n";
    ASSERT_EQ(view(script.str()).exit_code, 0);
    EXPECT_GT(covered(picture("path.png")), 0);
    EXPECT_LT(covered(picture("path.png")), 0.02);
    EXPECT_GT(covered(picture("frustum.png")), 0.0005);
    EXPECT_LT(covered(picture("frustum.png")), 0.05);
    EXPECT_GT(covered(picture("skeletons.png")), 0.0005) << "a person with joints and limbs";
    EXPECT_LT(covered(picture("skeletons.png")), 0.05);
    EXPECT_GT(changed(picture("skeletons.png"), picture("frustum.png")), 0.0005);

    const ColorImage untinted = picture("untinted.png"), tinted = picture("tinted.png");
    EXPECT_GT(covered(tinted), 0.1) << "four images";
    EXPECT_GT(changed(untinted, tinted), 0.0005);
    EXPECT_GT(red_pixels(tinted), red_pixels(untinted) + 100);
}

TEST_F(Viewer, DrawsObjectsWhereTheyAreAndTheRunIsTheSame) {
    constexpr Rgb8 kLabel{0, 158, 115};  // of label 101
    const std::string moving = (temp_ / "moving").string();
    ASSERT_EQ(execute(program({"synth", "--out", moving, "--scenario", "movers", "--seed", "3", "--people", "0",
                               "--no-noise", "--frames", "32", "--width", "160", "--height", "120"}))
                  .exit_code,
              0);
    ASSERT_EQ(execute(run_of(moving, {kNobody, "--objects"})).exit_code, 0);
    const std::string expected = read_all(out() / "trajectory.txt");
    ASSERT_GT(read_ply(out() / "objects" / "101" / "map.ply").size(), 100u);

    const std::string script =
        "show panels off\nshow images off\nshow path off\nshow frustum off\nshow map off\nstep 30\nscreenshot " +
        file("door.png") + "\nshow objects off\nscreenshot " + file("none.png") + "\nshow images on\nscreenshot " +
        file("tinted.png") + "\nshow mask off\nscreenshot " + file("untinted.png") +
        "\nshow images off\nshow objects on\nplay\nwait-end\n" + "screenshot " + file("end.png") +
        "\ncolour age\nscreenshot " + file("age.png") + "\nsave-trajectory " + file("t.txt") + "\nreset\nscreenshot " +
        file("reset.png") + "\n";
    Program viewer = view_of(script, {kNobody, "--objects"});
    viewer.arguments[2] = moving;
    const Result result = execute(viewer);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("Vulkan validation"), std::string::npos) << result.err;
    EXPECT_EQ(read_all(temp_ / "t.txt"), expected);

    const ColorImage shown = picture("door.png"), end = picture("end.png");
    EXPECT_GT(covered(shown), 0.003) << "surfels of a door";
    EXPECT_LT(covered(shown), 0.2) << "and nothing else";
    EXPECT_GT(colors(shown), 50u);
    EXPECT_GT(std::count(shown.begin(), shown.end(), kLabel), 10) << "its path and its label";
    EXPECT_EQ(covered(picture("none.png")), 0);
    const auto green = [&](const char* name) {
        const ColorImage image = picture(name);
        return std::count_if(image.begin(), image.end(),
                             [](const Rgb8& c) { return c.g > c.r + 40 && c.b > c.r + 20; });
    };
    EXPECT_GT(green("tinted.png"), green("untinted.png") + 200) << "the door's pixels in the colour of its label";
    EXPECT_GT(changed(shown, end), 0.001) << "it has moved";
    EXPECT_GT(changed(end, picture("age.png")), 0.001);
    EXPECT_EQ(covered(picture("reset.png")), 0);
}

TEST_F(Viewer, PanelsHelpResizingAndMinimising) {
    const std::string script = "step 3\nscreenshot " + file("panels.png") + "\nkey Tab\nscreenshot " +
                               file("bare.png") + "\nkey H\nscreenshot " + file("help.png") +
                               "\nkey H\nresize 640 480\nscreenshot " + file("small.png") +
                               "\nresize 211 163\nscreenshot " + file("tiny.png") +
                               "\nminimise\nrestore\nresize 1000 700\nstep 1\nscreenshot " + file("large.png") + "\n";
    const Result result = view(script, {kNobody});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_GT(changed(picture("panels.png"), picture("bare.png")), 0.2);
    EXPECT_GT(changed(picture("help.png"), picture("bare.png")), 0.05);
    EXPECT_EQ(picture("small.png").width(), 640);
    EXPECT_EQ(picture("small.png").height(), 480);
    EXPECT_EQ(picture("tiny.png").width(), 211);
    EXPECT_EQ(picture("large.png").width(), 1000);
    EXPECT_EQ(picture("large.png").height(), 700);
    EXPECT_GT(covered(picture("large.png")), 0.1);
}

TEST_F(Viewer, TrajectoryAndMapAreThoseOfTheHeadlessRunWhateverIsDone) {
    const auto expected = headless({"--pose-every", "2"});
    ASSERT_FALSE(expected.first.empty());
    const std::string save = "save-trajectory " + file("t.txt") + "\nsave-map " + file("m.ply") + "\n";
    for (const std::string& script :
         {std::string("play\nwait-end\n"),
          std::string("step 3\ndraw 2\norbit 20 5\npause\ncolour normal\nplay\nwait 7\npause\n"
                      "draw 3\nresize 700 500\nstep 1\nplay\nwait-end\ndraw 1\n"),
          std::string("step 4\nreset\nplay\nwait 5\nreset\nplay\nwait-end\n")}) {
        const Result result = view(script + save, {"--pose-every", "2"});
        ASSERT_EQ(result.exit_code, 0) << result.err;
        EXPECT_EQ(read_all(temp_ / "t.txt"), expected.first) << script;
        EXPECT_EQ(read_all(temp_ / "m.ply"), expected.second) << script;
    }
}

TEST_F(Viewer, ParametersTakeEffectWhileItRuns) {
    const auto map_of = [&](const std::string& script) {
        const Result result = view(script + "save-map " + file("m.ply") + "\n", {kNobody});
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return read_ply(temp_ / "m.ply");
    };
    EXPECT_LT(map_of("step 4\n").size(), 100u) << "nothing is stable yet";
    EXPECT_GT(map_of("step 3\nset map.stable_confidence 0.1\nstep 1\n").size(), 5000u);
    const auto near = map_of("set map.stable_confidence 0.1\nset preprocess.depth_max 2\nstep 2\n");
    EXPECT_GT(near.size(), 100u);
    for (const Surfel& surfel : near) ASSERT_LT(surfel.position.z(), 2.2f) << "farther than the slider allows";
}

TEST_F(Viewer, StepsPauseAndEndAreCounted) {
    const Result stepped = view("step 3\nstep 2\n", {kNobody});
    EXPECT_EQ(stepped.exit_code, 0);
    EXPECT_NE(stepped.out.find("5 frames in"), std::string::npos) << stepped.out;
    const Result whole =
        view("play\nwait-end\nsave-trajectory " + file("t.txt") + "\n", {kNobody, "--max-frames", "7"});
    EXPECT_NE(whole.out.find("7 frames in"), std::string::npos) << whole.out;
    const Result closed = view("play\nwait 2\nclose\nwait-end\n", {kNobody});
    EXPECT_EQ(closed.exit_code, 0) << "closing while it runs: " << closed.err;
    EXPECT_EQ(view("close\n", {kNobody}).exit_code, 0) << "closing before the first frame";
}

TEST_F(Viewer, KeysSaveIntoTheOutputFolder) {
    const Result result = view("step 2\nkey P\nkey P\nkey T\nkey M\nkey Space\nkey Esc\nwait-end\n", {kNobody});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    for (const char* name : {"view-000002.png", "view-000002-1.png", "trajectory-000002.txt", "map-000002.ply"}) {
        EXPECT_TRUE(fs::exists(out() / name)) << name;
    }
}

TEST_F(Viewer, WithoutADisplayOneLineNamesTheCommandThatNeedsNone) {
    Program program{{POSEFUSION_PROGRAM, "view", recording().string()}};
    program.environment = {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}};
    expect_error(execute(program), {"no display", "posefusion run"});
    program.environment = {{"DISPLAY", ":4711"}, {"WAYLAND_DISPLAY", ""}};
    expect_error(execute(program), {"no display", "posefusion run"});
}

TEST_F(Viewer, FaultsOfScriptsAreOneLineWithTheirPlace) {
    expect_error(view("step 1\njump\n", {kNobody}), {"script.txt:2", "jump"});
    expect_error(view("step 1\nset map.max_wait 3\n", {kNobody}), {"script.txt:2", "map.max_weight"});
    expect_error(view("set max_frames 3\n", {kNobody}), {"script.txt:1", "at the start"});
    expect_error(view("set preprocess.depth_min 90\n", {kNobody}), {"script.txt:1", "depth_m"});
    expect_error(view("colour mauve\n", {kNobody}), {"script.txt:1", "mauve"});
    expect_error(view("show everything on\n", {kNobody}), {"script.txt:1", "everything"});
    expect_error(view("key Hyper\n", {kNobody}), {"script.txt:1", "Hyper"});
    expect_error(view("play\nwait 1000\n", {kNobody}), {"script.txt:2", "ended after 12 frames"});
    expect_error(view("step 3\nwait 4\n", {kNobody}), {"script.txt:2", "paused after 3 frames", "play"});
    expect_error(view("step 12\nwait 13\n", {kNobody}), {"script.txt:2", "after 12 frames"});
    expect_error(view("step 1\nwait-end\n", {kNobody}), {"script.txt:2", "paused after 1 frame"});
    expect_error(view("step 1\nscreenshot /proc/no/such.png\n", {kNobody}), {"script.txt:2", "/proc/no"});
    expect_error(view("step 1\nsave-map /proc/no/such.ply\n", {kNobody}), {"script.txt:2", "/proc/no"});
    expect_error(view("step 1\nsave-trajectory /proc/no/such.txt\n", {kNobody}), {"script.txt:2", "/proc/no"});
}

TEST_F(Viewer, FaultsOfTheRunAreOneLineToo) {
    Program program =
        view_of("play\nwait-end\n", {kNobody, "--map-initial-capacity", "1024", "--map-max-capacity", "1024"});
    expect_error(execute(program), {"map is full"});
    program = view_of("close\n", {"--pose-model", file("missing.onnx")});
    expect_error(execute(program), {"missing.onnx"});
}

TEST_F(Viewer, CtrlCClosesIt) {
    Program program = view_of("play\nwait-end\n", {kNobody});
    temp_.write("script.txt", "step 2\nsave-trajectory " + file("t.txt") + "\ndraw 1000000\n");
    Subprocess process(program, temp_.path());
    while (!fs::exists(temp_ / "t.txt")) usleep(1000);
    process.send(SIGINT);
    EXPECT_EQ(process.exit_code(), 130) << process.error_output();
    EXPECT_NE(process.output().find("2 frames in"), std::string::npos) << process.output();
}

TEST_F(Viewer, ADisplayThatGoesAwayIsToldInOneLine) {
    for (const char* meanwhile : {"", "reset\nplay\n"}) {
        auto display = std::make_unique<VirtualDisplay>(XVFB);
        fs::remove(temp_ / "t.txt");
        Program program =
            view_of("step 2\nsave-trajectory " + file("t.txt") + "\n" + meanwhile + "draw 1000000\n", {kNobody});
        program.environment = {{"DISPLAY", display->name()}, {"WAYLAND_DISPLAY", ""}};
        Subprocess process(program, temp_.path());
        while (!fs::exists(temp_ / "t.txt")) usleep(1000);
        display.reset();
        EXPECT_EQ(process.exit_code(), 1) << process.error_output();
        EXPECT_NE(process.error_output().find("posefusion: the display has gone"), std::string::npos)
            << process.error_output();
    }
}

TEST_F(Viewer, InRealTimeEveryFrameIsShownOrCounted) {
    const Result result = view("play\nwait-end\nsave-trajectory " + file("t.txt") + "\n", {kNobody, "--real-time"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    int done = 0, dropped = -1;
    ASSERT_EQ(std::sscanf(result.out.c_str(), "%d frames (%d dropped)", &done, &dropped), 2) << result.out;
    EXPECT_EQ(done + dropped, kFrames);
    EXPECT_GT(done, 0);
}

TEST_F(Viewer, ACameraIsInRealTimeWithoutBeingAsked) {
    const std::string camera =
        temp_.write("c.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n").string();
    const std::string script = temp_.write("script.txt", "step 3\nscreenshot " + file("view.png") + "\n").string();
    const Result result = execute(
        on_display({POSEFUSION_PROGRAM, "view", "openni2:Dummy", "--camera", camera, kNobody, "--script", script}));
    if (result.err.find("built without OpenNI2") != std::string::npos) GTEST_SKIP() << result.err;
    ASSERT_EQ(result.exit_code, 0) << result.err;
    int done = 0, dropped = -1;
    EXPECT_EQ(std::sscanf(result.out.c_str(), "%d frames (%d dropped)", &done, &dropped), 2) << result.out;
    EXPECT_GE(done, 3);
    EXPECT_GE(dropped, 0);
}

TEST_F(Viewer, AMillionSurfels) {
    const Result result = execute(on_display({DRAW_BENCHMARK, "1000000", "1280", "720", "3"}));
    ASSERT_EQ(result.exit_code, 0) << result.err;
    std::fputs(result.out.c_str(), stdout);
    unsigned long surfels = 0;
    ASSERT_EQ(std::sscanf(result.out.c_str(), "%lu surfels at 1280 x 720", &surfels), 1) << result.out;
    EXPECT_GT(surfels, 990'000u);
}

}  // namespace
}  // namespace posefusion::test
