#pragma once
#include <filesystem>
#include <functional>
#include <memory>

#include "hosts/io/frame_source.hpp"

/// Copies any source to a recording of another format.
namespace posefusion {

/// Throws Error if a recording, or a part of one, of whatever layout, is in this folder or the folders in it: none is
/// overwritten, or mixed with another.
void expect_no_recording(const std::filesystem::path& folder);

struct RecordOptions {
    std::size_t max_frames = 0;  ///< 0 = all
    bool compress = true;        ///< .klg: depth as zlib, else raw
    int jpeg_quality = 0;        ///< .klg: colour as JPEG of this quality, 1..100; 0 = raw, lossless
};

/// Writes frames one after the other.
class Recorder {
public:
    virtual ~Recorder() = default;
    /// Appends a frame; stamps must ascend. Throws Error (disk full, ...); the recording is then unchanged and can
    /// still be finished.
    virtual void add(const RawFrame& frame) = 0;
    /// After the last frame: without it the recording is not complete.
    virtual void finish(const std::optional<Trajectory>& groundtruth) = 0;
};

/// A .klg log (see open_klg(), lossless unless options ask for JPEG) for that extension, otherwise a folder in TUM
/// layout (lossless). Both with the camera beside them. Throws Error.
[[nodiscard]] std::unique_ptr<Recorder> make_recorder(const std::filesystem::path& out, const Camera& camera,
                                                      const RecordOptions& options = {});
[[nodiscard]] std::unique_ptr<Recorder> make_klg_recorder(const std::filesystem::path& file, const Camera& camera,
                                                          const RecordOptions& options);
[[nodiscard]] std::unique_ptr<Recorder> make_tum_recorder(const std::filesystem::path& folder, const Camera& camera);

struct Recorded {
    std::size_t frames = 0, skipped = 0;
};

struct RecordObserver {
    std::function<void(std::size_t frames)> progress;
    std::function<void(const std::string&)> warning;
    std::function<bool()> cancelled = [] { return false; };
};

/// Copies the frames of the source. Unreadable frames are skipped with a warning; a lost source ends the recording,
/// which stays valid. Throws Error: no frame could be read, or the recording cannot be written; frames written before
/// are kept and readable.
Recorded record(const FrameSource& source, const std::filesystem::path& out, const RecordOptions& options,
                const RecordObserver& observer);

}  // namespace posefusion
