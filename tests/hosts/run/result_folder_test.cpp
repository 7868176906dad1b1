#include "hosts/run/result_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "engine/core/error.hpp"
#include "hosts/io/output_file.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

class ResultFolderTest : public ::testing::Test {
protected:
    ResultFolderTest() {
        config_.out = temp_ / "out";
        config_.save_masks = true;
    }
    TempFolder temp_;
    RunConfig config_;
};

TEST_F(ResultFolderTest, MadeForNothingItGoesAgain) {
    {
        ResultFolder folder(config_, temp_ / "recording");
        folder.open();
        EXPECT_TRUE(fs::exists(folder.masks()));
    }
    EXPECT_FALSE(fs::exists(config_.out)) << "interrupted before the first frame";
}

TEST_F(ResultFolderTest, WithAResultItStays) {
    {
        ResultFolder folder(config_, temp_ / "recording");
        folder.open();
        folder.begin("scale: 1\n");
    }
    EXPECT_TRUE(fs::exists(config_.out / "config.yaml"));
}

TEST_F(ResultFolderTest, AFailureIsLeftUnlessThereAreResultsOrNoRecording) {
    const fs::path recording = temp_ / "recording", stats = config_.out / "stats.json";
    const auto fail = [&](const std::string& text) {
        ResultFolder(config_, recording).leave_failure("scale: 1\n", text);
    };
    fail("no such recording");
    EXPECT_FALSE(fs::exists(config_.out));
    fs::create_directories(recording);
    fail("damaged");
    EXPECT_EQ(read_all(stats), "damaged");
    fail("damaged again");
    EXPECT_EQ(read_all(stats), "damaged again") << "of the last run";
    write_file_atomically(config_.out / "trajectory.txt", "0 0 0 0 0 0 0 1\n");
    fail("a wrong file");
    EXPECT_EQ(read_all(stats), "damaged again") << "results of an earlier run are kept as they are";
}

TEST_F(ResultFolderTest, ABackgroundGoesIfARunWroteIt) {
    config_.save_masks = false;
    config_.save_background = true;
    const fs::path list = config_.out / "background" / "rgb.txt", image = config_.out / "background/holes/1.png";
    fs::create_directories(image.parent_path());
    for (const fs::path& file : {list, image}) write_file_atomically(file, "");
    EXPECT_NE(message_of<Error>([&] { ResultFolder(config_, temp_ / "recording"); }).find("no earlier run saved"),
              std::string::npos);
    write_file_atomically(config_.out / "config.yaml", "save_background: true\n");
    ResultFolder folder(config_, temp_ / "recording");
    folder.open();
    EXPECT_TRUE(fs::exists(image)) << "until there is a new result";
    folder.begin("save_background: true\n");
    EXPECT_FALSE(fs::exists(config_.out / "background"));
}

TEST_F(ResultFolderTest, AFolderOfOthersStays) {
    fs::create_directories(config_.out);
    {
        ResultFolder folder(config_, temp_ / "recording");
        folder.open();
    }
    EXPECT_TRUE(fs::exists(config_.out));
}

}  // namespace
}  // namespace posefusion::test
