#pragma once
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string_view>

/// Output files that are either complete or not there: a full disk or a killed run never leaves half a file under the
/// final name, and never destroys the file that was there before.
namespace posefusion {

/// Creates `folder` (and its parents) and makes sure that files can be written into it. Throws Error.
void prepare_output_folder(const std::filesystem::path& folder);

/// Calls `write` with a binary stream on a temporary file beside `path`, then renames it to `path`. Throws Error that
/// names the file and the reason (disk full, no permission, ...). The temporary file is removed on every failure, also
/// when `write` throws. A `path` that exists and is no regular file (/dev/stdout, a pipe) is written directly.
void write_file_atomically(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write);
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

}  // namespace posefusion
