#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

/// Text files as other programs leave them.
namespace posefusion {

/// As UTF-8 without a byte order mark: UTF-16 (either byte order, recognised by its mark, as Windows writes it) is
/// converted, anything else is kept.
[[nodiscard]] std::string to_utf8(std::string bytes);

/// A whole file, to_utf8(). Throws Error: missing, a folder, not readable, larger than `max_bytes`.
[[nodiscard]] std::string read_text_file(const std::filesystem::path& file, std::uintmax_t max_bytes);

}  // namespace posefusion
