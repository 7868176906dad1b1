// A disk that is full: loaded before the C library (LD_PRELOAD), it lets every regular file below the folder
// FULL_DISK_FOLDER grow to FULL_DISK_BYTES, or all of them together to FULL_DISK_TOTAL_BYTES, and fails what goes
// beyond with ENOSPC, as a file system does.
#include <dlfcn.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace {

template <class Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// Bytes in all files below the folder.
long long used(const char* folder) {
    long long bytes = 0;
    std::error_code error;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, error)) {
        if (const auto size = entry.file_size(error); !error) bytes += static_cast<long long>(size);
    }
    return bytes;
}

/// How many of `bytes` more fit into the file; all of them where it is not on the full disk.
size_t room(int file, size_t bytes) {
    const char *folder = std::getenv("FULL_DISK_FOLDER"), *limit = std::getenv("FULL_DISK_BYTES");
    const char* total = std::getenv("FULL_DISK_TOTAL_BYTES");
    struct stat status {};
    if (folder == nullptr || (limit == nullptr && total == nullptr) || fstat(file, &status) != 0 ||
        !S_ISREG(status.st_mode))
        return bytes;
    char link[64], path[PATH_MAX] = {};
    std::snprintf(link, sizeof(link), "/proc/self/fd/%d", file);
    if (readlink(link, path, sizeof(path) - 1) < 0 || std::strncmp(path, folder, std::strlen(folder)) != 0)
        return bytes;
    if (total != nullptr) return std::min(bytes, static_cast<size_t>(std::max(0LL, std::atoll(total) - used(folder))));
    const off_t at = std::max<off_t>(0, lseek(file, 0, SEEK_CUR));
    return std::min(bytes, static_cast<size_t>(std::max(0LL, std::atoll(limit) - static_cast<long long>(at))));
}

ssize_t full() {
    errno = ENOSPC;
    return -1;
}

}  // namespace

extern "C" ssize_t write(int file, const void* data, size_t bytes) {
    const size_t fits = room(file, bytes);
    if (fits == 0 && bytes > 0) return full();
    return next<ssize_t (*)(int, const void*, size_t)>("write")(file, data, fits);
}

extern "C" ssize_t writev(int file, const iovec* parts, int count) {
    size_t bytes = 0;
    for (int i = 0; i < count; ++i) bytes += parts[i].iov_len;
    if (room(file, bytes) < bytes) return full();
    return next<ssize_t (*)(int, const iovec*, int)>("writev")(file, parts, count);
}
