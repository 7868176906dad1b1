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

/// What a file written survives. A power failure costs a wait for the disk: not for the thousands of images of a run.
enum class Survives { Kill, PowerFailure };

/// Calls `write` with a binary stream on a temporary file beside `path`, then renames it to `path`. Throws Error that
/// names the file and the reason (disk full, no permission, ...). The temporary file is removed on every failure, also
/// when `write` throws. A `path` that exists and is no regular file (/dev/stdout, a pipe) is written directly.
void write_file_atomically(const std::filesystem::path& path, const std::function<void(std::ostream&)>& write,
                           Survives survives = Survives::Kill);
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// Removes the unfinished files that killed runs have left beside `path`. No other run may be writing it.
void remove_unfinished(const std::filesystem::path& path);

}  // namespace posefusion
