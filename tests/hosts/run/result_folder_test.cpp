#include "hosts/run/result_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>

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
