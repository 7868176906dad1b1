#include "engine/vulkan/available_memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

/// The first word of a file as a number; nullopt where it is none ("max") or there is no such file.
std::optional<std::uint64_t> number_in(const fs::path& file) {
    std::uint64_t value = 0;
    return std::ifstream(file) >> value ? std::optional(value) : std::nullopt;
}

/// The number behind a word of a file of such lines; 0 where there is none.
std::uint64_t number_after(const std::string& word, const fs::path& file) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        std::istringstream words(line);
        std::string first;
        std::uint64_t value = 0;
        if (words >> first >> value && first == word) return value;
    }
    return 0;
}

std::uint64_t left(std::uint64_t limit, std::uint64_t used) { return limit > used ? limit - used : 0; }

/// Pages of statm: 0 = whole address space, 5 = data and stack.
std::uint64_t process_bytes(int column) {
    std::ifstream stream("/proc/self/statm");
    std::uint64_t pages = 0;
    for (int i = 0; i <= column; ++i) stream >> pages;
    return stream ? pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

void tighten(AvailableMemory& available, std::uint64_t bytes, const char* limit) {
    if (bytes < available.bytes) available = {bytes, limit};
}

/// A control group and those it is in. @param limit, usage, cache  names of files, and of the line in memory.stat
void tighten_by_groups(AvailableMemory& available, const fs::path& mount, const fs::path& group, const char* limit,
                       const char* usage, const char* cache) {
    for (fs::path at = group.relative_path();; at = at.parent_path()) {
        const fs::path folder = mount / at;
        const auto most = number_in(folder / limit), used = number_in(folder / usage);
        if (most && used) {
            const std::uint64_t droppable = number_after(cache, folder / "memory.stat");
            tighten(available, left(*most, left(*used, droppable)), "the memory of its control group");
        }
        if (at.empty()) return;
    }
}

}  // namespace

AvailableMemory available_address_space() {
    AvailableMemory available{kUnlimited, ""};
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        tighten(available, left(limit.rlim_cur, process_bytes(0)), "the limit on address space (ulimit -v)");
    if (getrlimit(RLIMIT_DATA, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        tighten(available, left(limit.rlim_cur, process_bytes(5)), "the limit on data (ulimit -d)");
    return available;
}

AvailableMemory available_memory(const fs::path& root) {
    AvailableMemory available{kUnlimited, ""};
    const fs::path machine = root / "proc/meminfo";
    constexpr std::uint64_t kKibibyte = 1024;
    if (const std::uint64_t kib = number_after("MemAvailable:", machine); kib > 0)
        tighten(available, kKibibyte * (kib + number_after("SwapFree:", machine)), "the memory of this machine");
    std::ifstream groups(root / "proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {  // number:controllers:path
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1), path = line.substr(second + 1);
        if (controllers.empty()) {
            tighten_by_groups(available, root / "sys/fs/cgroup", path, "memory.max", "memory.current", "inactive_file");
        } else if (controllers == "memory") {
            tighten_by_groups(available, root / "sys/fs/cgroup/memory", path, "memory.limit_in_bytes",
                              "memory.usage_in_bytes", "total_inactive_file");
        }
    }
    return available;
}

void require_memory(std::uint64_t address_space, std::uint64_t memory, const std::string& when) {
    const auto require = [&](std::uint64_t needed, const AvailableMemory& available) {
        if (available.bytes >= needed) return;
        throw Error("too little memory " + when + ": " + std::to_string(needed >> 20) + " MiB are needed, and " +
                    available.limit + " leaves " + std::to_string(available.bytes >> 20) +
                    " MiB; raise it, or close other programs");
    };
    require(address_space, available_address_space());
    require(memory, available_memory());
}

}  // namespace posefusion
