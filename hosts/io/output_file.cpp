#include "hosts/io/output_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinished = ".tmp-";  // and the number of the process

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

[[noreturn]] void refuse_to_write(const fs::path& path, const char* what, int error_number) {
    const std::string reason = error_number != 0 ? std::strerror(error_number) : "the stream failed";
    throw Error(path.string() + ": " + what + ": " + reason);
}

/// Calls `write` on a stream into `path` and makes sure that all of it got there.
void write_stream(const fs::path& path, const fs::path& shown, const std::function<void(std::ostream&)>& write) {
    errno = 0;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    if (!out) refuse_to_write(shown, "cannot be written", errno);
    errno = 0;
    write(out);
    out.flush();
    if (!out) refuse_to_write(shown, "writing failed", errno);
    out.close();
    if (!out) refuse_to_write(shown, "writing failed", errno);
}

/// Waits until a file or folder is on the disk, so that a rename never precedes the content. File systems without
/// support are ignored.
void wait_for_disk(const fs::path& path, const fs::path& shown) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) refuse_to_write(shown, "writing failed", errno);
    const int result = ::fsync(file), error_number = errno;
    ::close(file);
    if (result != 0 && error_number != EINVAL && error_number != ENOTSUP)
        refuse_to_write(shown, "writing failed", error_number);
}

/// Removes the file at the end of its life unless it has been renamed away.
class TemporaryFile {
public:
    explicit TemporaryFile(fs::path path) : path_(std::move(path)) {}
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    ~TemporaryFile() {
        std::error_code ignored;
        if (!kept_) fs::remove(path_, ignored);
    }
    void rename_to(const fs::path& target) {
        std::error_code error;
        fs::rename(path_, target, error);
        if (error) refuse_to_write(target, "cannot be replaced", error.value());
        kept_ = true;
    }
    [[nodiscard]] const fs::path& path() const { return path_; }

private:
    fs::path path_;
    bool kept_ = false;
};

}  // namespace

void prepare_output_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (!fs::is_directory(folder)) {
        const std::string reason = fs::exists(folder) ? "a file of this name is in the way" : error.message();
        throw Error(folder.string() + ": output folder cannot be made: " + reason + "; choose another one");
    }
    // access() is not enough: a read-only file system or a full quota only shows when a file is created.
    TemporaryFile probe(folder / (".posefusion-" + std::to_string(::getpid())));
    errno = 0;
    if (!std::ofstream(probe.path())) {
        const std::string reason = errno != 0 ? std::strerror(errno) : "no file can be made in it";
        throw Error(folder.string() + ": output folder is not writable: " + reason + "; choose another one");
    }
}

FolderLock::FolderLock(const fs::path& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
    ::close(descriptor_);
    throw Error(folder.string() + ": another posefusion is writing into this folder; wait for it, or choose another");
}

FolderLock::~FolderLock() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

GrowingFile::GrowingFile(int descriptor, fs::path shown) : shown_(std::move(shown)), descriptor_(descriptor) {
    if (descriptor_ < 0) refuse_to_write(shown_, "cannot be written", errno);
}

GrowingFile::GrowingFile(const fs::path& path, std::string_view beginning, const fs::path& shown)
    : GrowingFile(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666), shown.empty() ? path : shown) {
    append(beginning);
}

GrowingFile::~GrowingFile() { ::close(descriptor_); }

void GrowingFile::append(std::string_view piece) {
    std::size_t done = 0;
    while (done < piece.size()) {
        const ssize_t written = ::write(descriptor_, piece.data() + done, piece.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            const int error_number = written < 0 ? errno : ENOSPC;
            shorten(bytes_);
            refuse_to_write(shown_, "writing failed", error_number);
        }
        done += static_cast<std::size_t>(written);
    }
    bytes_ += done;
}

void GrowingFile::overwrite(std::uintmax_t at, std::string_view bytes) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (written != static_cast<ssize_t>(bytes.size()))
        refuse_to_write(shown_, "writing failed", written < 0 ? errno : ENOSPC);
}

void GrowingFile::shorten(std::uintmax_t bytes) {
    const auto length = static_cast<off_t>(bytes);
    if (::ftruncate(descriptor_, length) != 0 || ::lseek(descriptor_, length, SEEK_SET) != length)
        refuse_to_write(shown_, "cannot be shortened", errno);
    bytes_ = bytes;
}

void write_file_atomically(const fs::path& path, const std::function<void(std::ostream&)>& write, Survives survives) {
    std::error_code error;
    if (fs::is_directory(path, error))
        throw Error(path.string() + ": cannot be written: a folder of this name is in the way");
    if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
        write_stream(path, path, write);
        return;
    }
    TemporaryFile temporary(path.string() + kUnfinished + std::to_string(::getpid()));
    write_stream(temporary.path(), path, write);
    if (survives == Survives::PowerFailure) wait_for_disk(temporary.path(), path);
    temporary.rename_to(path);
    if (survives == Survives::PowerFailure) wait_for_disk(folder_of(path), path);
}

void write_file_atomically(const fs::path& path, std::string_view content) {
    write_file_atomically(
        path, [&](std::ostream& out) { out.write(content.data(), static_cast<std::streamsize>(content.size())); });
}

void remove_unfinished(const fs::path& path) {
    const std::string prefix = path.filename().string() + kUnfinished;
    std::error_code ignored;
    std::vector<fs::path> found;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_of(path), ignored)) {
        if (entry.path().filename().string().starts_with(prefix)) found.push_back(entry.path());
    }
    for (const fs::path& file : found) fs::remove(file, ignored);
}

}  // namespace posefusion
