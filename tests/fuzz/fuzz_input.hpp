#pragma once
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "engine/core/error.hpp"

/// What the fuzz targets share: the bytes of libFuzzer as a file, and the one exception that may come of it.
namespace posefusion::fuzz {

/// A file that lives in memory, under a name.
class MemoryFile {
public:
    MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(memfd_create("fuzz", 0)) {
        for (std::size_t done = 0; done < size;) {
            const ssize_t written = write(descriptor_, data + done, size - done);
            if (written <= 0) std::abort();
            done += static_cast<std::size_t>(written);
        }
    }
    ~MemoryFile() { close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;
    [[nodiscard]] std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

private:
    int descriptor_;
};

/// Error, in one line, is the only way to fail.
template <class Call>
void expect_no_more_than_an_error(Call call) {
    try {
        call();
    } catch (const Error& error) {
        if (std::string(error.what()).find('\n') != std::string::npos) std::abort();
    }
}

inline constexpr int kWidth = 16, kHeight = 12;  ///< of the images in the corpus

/// A camera file for them, made once per process.
inline std::filesystem::path camera_file() {
    static const std::string file = [] {
        std::string name = (std::filesystem::temp_directory_path() / "posefusion-fuzz-XXXXXX").string();
        const int descriptor = mkstemp(name.data());
        if (descriptor < 0) std::abort();
        close(descriptor);
        std::ofstream(name) << "fx: 15\nfy: 15\ncx: 7.5\ncy: 5.5\nwidth: " << kWidth << "\nheight: " << kHeight << "\n";
        return name;
    }();
    return file;
}

}  // namespace posefusion::fuzz
