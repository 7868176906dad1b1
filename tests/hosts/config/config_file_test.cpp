#include "hosts/config/config_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

class ConfigFile : public testing::Test {
protected:
    /// Loads a file of that content. @return the error, or "" if it was accepted
    std::string load(const std::string& content) {
        std::ofstream(file_) << content;
        return load_file(file_);
    }
    std::string load_file(const std::filesystem::path& file) {
        try {
            load_config(file, options_);
            return "";
        } catch (const Error& error) {
            const std::string what = error.what();
            EXPECT_EQ(what.find('\n'), std::string::npos) << "more than one line";
            return what;
        }
    }
    static std::filesystem::path name() {
        return std::string("config-") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml";
    }
    void TearDown() override { std::filesystem::remove(file_); }

    std::filesystem::path file_ = std::filesystem::path(testing::TempDir()) / name();
    RunConfig config_;
    std::vector<Option> options_ = option_table(config_);
};

TEST_F(ConfigFile, NestedAndDottedKeysMeanTheSame) {
    ASSERT_EQ(load("tracking:\n  icp: false\n  iterations: [3, 2, 1]\nloops.patience: 7\nscale: 0.5\n"), "");
    EXPECT_FALSE(config_.slam.tracking.icp);
    EXPECT_EQ(config_.slam.tracking.iterations[1], 2);
    EXPECT_EQ(config_.slam.loops.patience, 7);
    EXPECT_FLOAT_EQ(config_.scale, 0.5f);
}

TEST_F(ConfigFile, AnEmptyFileSetsNothing) {
    const std::string before = config_yaml(options_);
    EXPECT_EQ(load(""), "");
    EXPECT_EQ(load("# only a comment\n"), "");
    EXPECT_EQ(config_yaml(options_), before);
}

TEST_F(ConfigFile, WhatIsWrittenReadsBackToTheSameValues) {
    find_option(options_, "out").set("a \"quoted\": # strange\\name");
    find_option(options_, "noise.a").set("0.00123456");
    find_option(options_, "pose.network").set("openpose");
    find_option(options_, "tracking.iterations").set("9,8,7");
    const std::string written = config_yaml(options_);
    config_ = RunConfig();
    ASSERT_EQ(load(written), "");
    EXPECT_EQ(config_yaml(options_), written);
    EXPECT_EQ(config_.out, "a \"quoted\": # strange\\name");
}

TEST_F(ConfigFile, AnUnknownKeyIsNamedWithFileAndLine) {
    const std::string error = load("scale: 0.5\ntracking:\n  icq: true\n");
    EXPECT_NE(error.find(file_.string() + ":3: tracking.icq: unknown option"), std::string::npos) << error;
    EXPECT_NE(error.find("'tracking.icp'"), std::string::npos) << error;
}

TEST_F(ConfigFile, ABadValueIsNamedWithFileLineAndKey) {
    EXPECT_EQ(load("\nscale: big\n"),
              file_.string() + ":2: scale: 'big' is not allowed here; give a number, 0.05 .. 1");
    EXPECT_NE(load("tracking.iterations: [1, [2], 3]\n"), "");
    EXPECT_NE(load("tracking: true\n"), "") << "a group is not an option";
    EXPECT_NE(load("scale:\n"), "") << "a key without a value";
    EXPECT_NE(load("scale: 0.5\nscale: 0.6\n"), "") << "the same key twice";
    EXPECT_NE(load("? [1, 2]\n: 3\n"), "") << "a key that is not text";
}

TEST_F(ConfigFile, AGroupWithinAGroupIsRefusedEvenItself) {
    EXPECT_EQ(load("scale: 1\ntracking: &t\n  icp: true\n  tracking: *t\n"),
              file_.string() + ":4: tracking.tracking: is no group of options");
    EXPECT_NE(load("tracking:\n  iterations: &l [1, *l, 3]\n"), "");
}

TEST_F(ConfigFile, WhatIsNoYamlIsSaidInOneLine) {
    EXPECT_NE(load("scale: [0.5\n"), "");
    EXPECT_NE(load("just words\n"), "");
    EXPECT_NE(load("- 1\n- 2\n"), "");
}

TEST_F(ConfigFile, AMissingFileOrAFolderIsAnError) {
    EXPECT_NE(load_file("/nonexistent/posefusion.yaml"), "");
    EXPECT_NE(load_file(testing::TempDir()), "");
}

}  // namespace
}  // namespace posefusion
