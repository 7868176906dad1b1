#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string_view>

/// Output files that are either complete or not there: a full disk or a killed run never leaves half a file under the
/// final name, and never destroys the file that was there before.
namespace posefusion {

/// Creates `folder` (and its parents) and makes sure that files can be written into it. Throws Error.
void prepare_output_folder(const std::filesystem::path& folder);

/// Locks an output folder against other processes of this program during its lifetime. The lock ends with the process
/// in any case and leaves no file. No effect on file systems without locks.
class FolderLock {
public:
    /// @param folder  exists. Throws Error when another process holds it.
    explicit FolderLock(const std::filesystem::path& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

private:
    int descriptor_;
};

/// Which failures a written file survives. Surviving a power failure requires waiting for the disk: too slow for the
/// thousands of images of a run.
enum class Survives { Kill, PowerFailure };

/// Calls `write` with a binary stream on a temporary file beside `path`, then renames it to `path`. Throws Error that
/// names the file and the reason (disk full, no permission, ...). The temporary file is removed on every failure, also
/// when `write` throws. A `path` that exists and is no regular file (/dev/stdout, a pipe) is written directly.
void write_file_atomically(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write,
                           Survives survives = Survives::Kill);
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Removes unfinished files that killed runs have left beside `path`. No other run may be writing it.
void remove_unfinished(const std::filesystem::path& path);

/// A text file that grows piece by piece and is readable at any time, even when the program is killed or the disk is
/// full: each piece is there completely or not at all.
class GrowingFile {
public:
    /// Begins a new file. Throws Error, as all of these do. @param shown  its name in errors; empty = its path
    explicit GrowingFile(const std::filesystem::path& path, std::string_view beginning = {},
                         const std::filesystem::path& shown = {});
    ~GrowingFile();
    GrowingFile(const GrowingFile&) = delete;
    GrowingFile& operator=(const GrowingFile&) = delete;

    /// After an error the file is as it was before.
    void append(std::string_view piece);
    /// Number of bytes written so far.
    void overwrite(std::uintmax_t at, std::string_view bytes);
    /// Removes the last pieces: truncates the file to `bytes`.
    void shorten(std::uintmax_t bytes);
    [[nodiscard]] std::uintmax_t bytes() const { return bytes_; }

private:
    GrowingFile(int descriptor, std::filesystem::path shown);

    std::filesystem::path shown_;
    int descriptor_;
    std::uintmax_t bytes_ = 0;
};

}  // namespace posefusion