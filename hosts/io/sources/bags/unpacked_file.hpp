#pragma once
#include <filesystem>

namespace posefusion {

/// The unpacked copy of a file that was packed by zstd as a whole, in the folder for temporary files ($TMPDIR); it is
/// removed at the end of its life.
class UnpackedFile {
public:
    /// Throws Error: missing, not zstd, damaged, no room for it.
    explicit UnpackedFile(const std::filesystem::path& packed);
    ~UnpackedFile();
    UnpackedFile(const UnpackedFile&) = delete;
    UnpackedFile& operator=(const UnpackedFile&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace posefusion
