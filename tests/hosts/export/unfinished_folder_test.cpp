#include "hosts/export/unfinished_folder.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

void write_in(const UnfinishedFolder& folder) { std::ofstream(folder.path() / "file") << "content"; }

TEST(UnfinishedFolder, IsThereWhenFinished) {
    const TempFolder temp;
    fs::create_directories(temp / "empty");
    for (const std::string name : {"set", "empty", "slash/", "new/parents/set"}) {
        UnfinishedFolder folder(temp / name);
        write_in(folder);
        EXPECT_FALSE(fs::exists(temp / name / "file"));
        folder.finish();
        EXPECT_EQ(read_all(temp / name / "file"), "content") << name;
    }
}

TEST(UnfinishedFolder, LeavesNothingOtherwise) {
    const TempFolder temp;
    {
        const UnfinishedFolder folder(temp / "set");
        write_in(folder);
    }
    EXPECT_TRUE(fs::is_empty(temp.path()));
}

TEST(UnfinishedFolder, ReplacesNothing) {
    const TempFolder temp;
    temp.write("full/file", "precious");
    temp.write("file", "precious");
    for (const auto& [name, reason] : {std::pair("full", "not empty"), {"file", "in the way"}})
        EXPECT_NE(message_of<Error>([&] { UnfinishedFolder(temp / name); }).find(reason), std::string::npos) << name;
    EXPECT_EQ(read_all(temp / "full/file"), "precious");
}

}  // namespace
}  // namespace posefusion::test
