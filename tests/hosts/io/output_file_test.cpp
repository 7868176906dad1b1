#include "hosts/io/output_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <ostream>
#include <stdexcept>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;
using test::read_all;
using test::TempFolder;

std::size_t files_in(const TempFolder& folder) {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder.path()), {}));
}

/// Files of this process cannot grow beyond `bytes` for the life of the object: what a full disk looks like.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }

private:
    void (*handler_)(int);
    rlimit before_{};
};

TEST(OutputFile, ReplacesTheOldContentAndLeavesNothingElse) {
    const TempFolder folder;
    folder.write("a.txt", "old and longer");
    write_file_atomically(folder / "a.txt", "new");
    EXPECT_EQ(read_all(folder / "a.txt"), "new");
    EXPECT_EQ(files_in(folder), 1u);
}

TEST(OutputFile, WhatAKilledRunLeftUnfinishedCanBeRemoved) {
    const TempFolder folder;
    for (const char* name : {"a.bin", "a.bin.tmp-12", "a.bin.tmp-345", "b.bin.tmp-12"}) folder.write(name, "x");
    remove_unfinished(folder / "a.bin");
    EXPECT_EQ(files_in(folder), 2u);
    EXPECT_TRUE(std::filesystem::exists(folder / "a.bin"));
    EXPECT_TRUE(std::filesystem::exists(folder / "b.bin.tmp-12"));
    remove_unfinished(folder / "none/a.bin");  // nothing there
}

TEST(OutputFile, AFullDiskIsAnErrorAndKeepsTheOldFile) {
    const TempFolder folder;
    folder.write("a.txt", "old");
    const std::string large(1 << 20, 'x');
    std::string message;
    {
        const FileSizeLimit limit(1 << 16);
        message = message_of<Error>([&] { write_file_atomically(folder / "a.txt", large); });
    }
    EXPECT_NE(message.find("a.txt: writing failed: File too large"), std::string::npos) << message;
    EXPECT_EQ(read_all(folder / "a.txt"), "old");
    EXPECT_EQ(files_in(folder), 1u);
}

TEST(OutputFile, AFullDeviceIsNamed) {
    const std::string message = message_of<Error>([] { write_file_atomically("/dev/full", "some text"); });
    EXPECT_EQ(message, "/dev/full: writing failed: No space left on device");
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST(OutputFile, AnExceptionOfTheWriterKeepsTheOldFile) {
    const TempFolder folder;
    folder.write("a.txt", "old");
    const auto broken = [](std::ostream& out) {
        out << "half";
        throw std::runtime_error("stop");
    };
    EXPECT_EQ(message_of<std::runtime_error>([&] { write_file_atomically(folder / "a.txt", broken); }), "stop");
    EXPECT_EQ(read_all(folder / "a.txt"), "old");
    EXPECT_EQ(files_in(folder), 1u);
}

TEST(OutputFile, AFolderInTheWayIsNamed) {
    const TempFolder folder;
    std::filesystem::create_directories(folder / "a.txt");
    EXPECT_NE(message_of<Error>([&] { write_file_atomically(folder / "a.txt", "x"); }).find("folder of this name"),
              std::string::npos);
    EXPECT_NE(message_of<Error>([&] { write_file_atomically(folder / "none/a.txt", "x"); }).find("No such file"),
              std::string::npos);
}

TEST(OutputFolder, IsMadeWithItsParents) {
    const TempFolder folder;
    prepare_output_folder(folder / "a/b/c");
    EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b/c"));
    EXPECT_NO_THROW(prepare_output_folder(folder / "a/b/c"));
    EXPECT_TRUE(std::filesystem::is_empty(folder / "a/b/c"));
}

TEST(OutputFolder, ThatCannotBeUsedIsNamed) {
    const TempFolder folder;
    folder.write("file", "x");
    EXPECT_NE(message_of<Error>([&] { prepare_output_folder(folder / "file"); }).find("a file of this name"),
              std::string::npos);
    EXPECT_NE(message_of<Error>([&] { prepare_output_folder(folder / "file/below"); }).find("cannot be made"),
              std::string::npos);
    // /proc takes no files, not even from root.
    EXPECT_NE(message_of<Error>([] { prepare_output_folder("/proc"); }).find("not writable"), std::string::npos);
}

}  // namespace
}  // namespace posefusion
