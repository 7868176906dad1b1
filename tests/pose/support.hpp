#pragma once
#include <filesystem>
#include <string>

#include "engine/core/image.hpp"
#include "pose/joints.hpp"

/// What the tests of pose share.
namespace posefusion::testing {

/// Data that lies beside the project on some machines; POSEFUSION_SHARED_DATA names another place.
[[nodiscard]] std::filesystem::path shared_data();

/// Skips the test, saying so, where a file or folder of the shared data is absent.
#define POSEFUSION_REQUIRE_DATA(path) \
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no shared data at " << (path)

[[nodiscard]] ColorImage load_color(const std::filesystem::path& file);

/// Removed with all it holds at the end of the test.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

void write_file(const std::filesystem::path& file, const std::string& bytes);
[[nodiscard]] std::string read_file(const std::filesystem::path& file);

/// All numbers as text, bit for bit: two results are the same if and only if these are.
[[nodiscard]] std::string exact_text(const People& people);

/// The largest distance in pixels between joints that both have; infinite if the people do not correspond.
[[nodiscard]] float largest_difference(const People& a, const People& b);

}  // namespace posefusion::testing
