#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace posefusion {

/// How much this process may still take, and which limit says so.
struct AvailableMemory {
    std::uint64_t bytes = 0;
    std::string limit;  ///< for messages: "the limit on address space (ulimit -v)"
};

/// Address space: what RLIMIT_AS and RLIMIT_DATA leave.
[[nodiscard]] AvailableMemory available_address_space();

/// Memory proper: the least of what the machine has (MemAvailable and swap) and the control groups of this process
/// leave; page cache that can be dropped counts as free. @param root  where proc and sys are found, for tests
[[nodiscard]] AvailableMemory available_memory(const std::filesystem::path& root = "/");

/// A software driver compiles shaders on the CPU and crashes where memory ends while it does so. Throws Error that
/// names the limit and what is needed, if it is not there. @param when  "to load a Vulkan driver" ...
void require_memory(std::uint64_t address_space, std::uint64_t memory, const std::string& when);

}  // namespace posefusion
