// `posefusion view` without a script, in the hands of somebody with a keyboard and a mouse.
#include <algorithm>
#include <set>

#include "hosts/io/image_file.hpp"
#include "tests/hosts/cli/cli_fixture.hpp"
#include "tests/hosts/support/virtual_display.hpp"
#include "tests/hosts/viewer/desktop_user.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

class ViewerUser : public Cli {
protected:
    ViewerUser() : display_(XVFB), user_(display_.name()) {}

    [[nodiscard]] Program viewer() const {
        Program program = this->program(
            {"view", recording().string(), "--no-people", "--engine-validation", "--out", out().string()});
        program.environment = {{"DISPLAY", display_.name()}, {"WAYLAND_DISPLAY", ""}};
        return program;
    }

    /// Presses P. @return the picture; an empty one after twenty seconds without
    ColorImage picture() {
        const std::set<fs::path> before = pictures();
        user_.press(XK_p);
        for (int i = 0; i < 2000; ++i) {
            for (const fs::path& file : pictures()) {
                if (!before.contains(file)) return read_photo(file);
            }
            usleep(10'000);
        }
        return {};
    }

    [[nodiscard]] std::set<fs::path> pictures() const {
        std::set<fs::path> files;
        if (!fs::exists(out())) return files;
        for (const auto& entry : fs::directory_iterator(out())) {
            if (entry.path().extension() == ".png") files.insert(entry.path());
        }
        return files;
    }

    VirtualDisplay display_;
    DesktopUser user_;
};

bool same(const ColorImage& a, const ColorImage& b) {
    return a.width() == b.width() && std::equal(a.begin(), a.end(), b.begin(), b.end());
}

TEST_F(ViewerUser, KeysMouseWheelResizingAndClosingWork) {
    Subprocess process(viewer(), temp_.path());
    ASSERT_TRUE(user_.find("PoseFusion")) << process.error_output();
    ASSERT_TRUE(process.wait_for("frame 12/12")) << process.error_output();
    user_.move(640, 360);
    user_.press(XK_Tab);  // the panels count what is drawn: without them the same view gives the same picture
    const ColorImage still = picture();
    ASSERT_FALSE(still.empty());
    EXPECT_TRUE(same(still, picture())) << "nothing has changed";

    user_.hold(1);
    user_.move(760, 400);
    user_.release(1);
    const ColorImage turned = picture();
    EXPECT_FALSE(same(still, turned)) << "the left button turns";
    user_.move(640, 360);
    EXPECT_TRUE(same(turned, picture())) << "no button, no turning";

    user_.hold(3);
    user_.move(700, 360);
    user_.release(3);
    const ColorImage shifted = picture();
    EXPECT_FALSE(same(turned, shifted)) << "the right button shifts";
    user_.hold(4);
    user_.release(4);
    const ColorImage nearer = picture();
    EXPECT_FALSE(same(shifted, nearer)) << "the wheel";
    user_.press(XK_c);
    const ColorImage normals = picture();
    EXPECT_FALSE(same(nearer, normals)) << "C changes the colours";
    user_.press(XK_f);
    EXPECT_FALSE(same(normals, picture())) << "F follows";

    user_.resize(500, 400);
    const ColorImage small = picture();
    EXPECT_EQ(small.width(), 500);
    EXPECT_EQ(small.height(), 400);
    user_.close();
    EXPECT_EQ(process.exit_code(), 0) << process.error_output();
    EXPECT_NE(process.output().find("12 frames in"), std::string::npos) << process.output();
    EXPECT_EQ(process.error_output().find("Vulkan validation"), std::string::npos) << process.error_output();
}

TEST_F(ViewerUser, AClickOnAPanelIsForThePanel) {
    Subprocess process(viewer(), temp_.path());
    ASSERT_TRUE(user_.find("PoseFusion")) << process.error_output();
    ASSERT_TRUE(process.wait_for("frame 12/12")) << process.error_output();
    user_.move(60, 67);  // "Save map"
    user_.hold(1);
    user_.release(1);
    const fs::path map = out() / "map-000012.ply";
    for (int i = 0; i < 2000 && !fs::exists(map); ++i) usleep(10'000);
    EXPECT_TRUE(fs::exists(map));
    user_.press(XK_Escape);
    EXPECT_EQ(process.exit_code(), 0) << process.error_output();
}

}  // namespace
}  // namespace posefusion::test
