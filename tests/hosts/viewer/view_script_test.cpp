#include "hosts/viewer/view_script.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion::test {
namespace {

std::string error_of(const std::string& text) {
    try {
        (void)parse_view_script(text, "s.txt");
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(ViewScript, OneStepALineWithCommentsAndEmptyLines) {
    const auto steps =
        parse_view_script("# first\n\nstep 5   # five\n  orbit -30.5 10\nset map.max_weight 50\nclose", "s.txt");
    ASSERT_EQ(steps.size(), 4u);
    EXPECT_EQ(steps[0].verb, "step");
    EXPECT_EQ(steps[0].words, std::vector<std::string>{"5"});
    EXPECT_EQ(steps[0].line, 3u);
    EXPECT_EQ(script_number(steps[1].words[0]), -30.5);
    EXPECT_EQ(steps[2].words.size(), 2u);
    EXPECT_EQ(steps[3].where, "s.txt:6");
    EXPECT_TRUE(parse_view_script("", "s.txt").empty());
}

TEST(ViewScript, FaultsNameFileLineAndWhatIsWrong) {
    EXPECT_NE(error_of("play\ndance 3").find("s.txt:2: 'dance'"), std::string::npos) << error_of("play\ndance 3");
    EXPECT_NE(error_of("orbit 1").find("takes 2 words"), std::string::npos);
    EXPECT_NE(error_of("close now").find("takes 0 words"), std::string::npos);
    for (const char* bad : {"step x", "step -1", "step 1.5", "step 1e300", "step nan", "step 0x10", "step 5k"}) {
        EXPECT_NE(error_of(bad).find("no whole number"), std::string::npos) << bad << ": " << error_of(bad);
    }
    for (const char* bad : {"resize -5 0", "resize 640 x", "resize 1.5 9"}) {
        EXPECT_NE(error_of(bad).find("no whole number"), std::string::npos) << bad << ": " << error_of(bad);
    }
    for (const char* bad : {"resize 0 480", "resize 640 0", "resize 16385 480"}) {
        EXPECT_NE(error_of(bad).find("give 1 .. 16384"), std::string::npos) << bad << ": " << error_of(bad);
    }
    for (const char* bad : {"zoom x", "zoom inf", "zoom nan", "orbit 1 2,5"}) {
        EXPECT_NE(error_of(bad).find("no number"), std::string::npos) << bad << ": " << error_of(bad);
    }
}

TEST(ViewScript, EveryVerbIsInTheHelp) {
    const std::string help = view_script_help();
    for (const char* verb : {"play", "step N", "screenshot FILE", "resize N N", "set KEY VALUE"}) {
        EXPECT_NE(help.find(verb), std::string::npos) << verb;
    }
}

TEST(ViewScript, FilesThatAreNoScriptsAreRefused) {
    const TempFolder temp;
    EXPECT_THROW((void)load_view_script(temp / "missing.txt"), Error);
    EXPECT_THROW((void)load_view_script(temp.path()), Error) << "a folder";
    const auto large = temp.write("large.txt", std::string(2 << 20, '#'));
    EXPECT_THROW((void)load_view_script(large), Error);
    const auto binary = temp.write("binary.txt", std::string("\0\1\2\377 \n", 6));
    EXPECT_THROW((void)load_view_script(binary), Error);
    EXPECT_EQ(load_view_script(temp.write("good.txt", "play\r\nclose\r\n")).size(), 2u) << "line ends of Windows";
}

}  // namespace
}  // namespace posefusion::test
