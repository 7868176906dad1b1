#include "hosts/io/output_file.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const char* what, int error_number) {
    const std::string reason = error_number != 0 ? std::strerror(error_number) : "the stream failed";
    throw Error(path.string() + ": " + what + ": " + reason);
}

/// Calls `write` on a stream into `path` and makes sure that all of it got there.
void write_stream(const fs::path& path, const fs::path& shown, const std::function<void(std::ostream&)>& write) {
    errno = 0;
    std::ofstream out(path, std::ios::binary | std::ios::trunc);
    if (!out) fail(shown, "cannot be written", errno);
    errno = 0;
    write(out);
    out.flush();
    if (!out) fail(shown, "writing failed", errno);
    out.close();
    if (!out) fail(shown, "writing failed", errno);
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
        if (error) fail(target, "cannot be replaced", error.value());
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
    // access() is not enough: a read-only file system or a full quota only shows when a file is made.
    TemporaryFile probe(folder / (".posefusion-" + std::to_string(::getpid())));
    errno = 0;
    if (!std::ofstream(probe.path())) {
        const std::string reason = errno != 0 ? std::strerror(errno) : "no file can be made in it";
        throw Error(folder.string() + ": output folder is not writable: " + reason + "; choose another one");
    }
}

void write_file_atomically(const fs::path& path, const std::function<void(std::ostream&)>& write) {
    std::error_code error;
    if (fs::is_directory(path, error))
        throw Error(path.string() + ": cannot be written: a folder of this name is in the way");
    if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
        write_stream(path, path, write);
        return;
    }
    TemporaryFile temporary(path.string() + ".tmp-" + std::to_string(::getpid()));
    write_stream(temporary.path(), path, write);
    temporary.rename_to(path);
}

void write_file_atomically(const fs::path& path, std::string_view content) {
    write_file_atomically(
        path, [&](std::ostream& out) { out.write(content.data(), static_cast<std::streamsize>(content.size())); });
}

}  // namespace posefusion
