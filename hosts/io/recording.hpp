#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/frame_source.hpp"
#include "hosts/io/image_geometry.hpp"
#include "hosts/io/trajectory.hpp"

/// The frames of any source, prepared for the pipeline.
namespace posefusion {

/// One colour image and the depth image that belongs to it, same size, same camera.
struct Frame {
    std::size_t index = 0;   ///< position in the recording
    Stamp stamp{};           ///< of the colour image
    std::string stamp_text;  ///< as the recording writes it; names files that belong to this frame
    ColorImage color;
    DepthImage depth;           ///< metres, 0 = no measurement
    UndistortTime undistort{};  ///< zero where no device undistorted the frame
};

/// Throws Error for an unusable frame: the depth image holds no measurement at all, or the colour image is black (no
/// people could be found in it). @param color_name, depth_name  for the message
void check_usable(const Frame& frame, const std::string& color_name, const std::string& depth_name);

/// Images are undistorted where the camera is distorted, then shrunk by `scale` and cropped at the right and bottom to
/// sizes that divide by 4 (intrinsics() accounts for all three). Colour shrinks by area; depth takes the mean of the
/// measurements near the median of the block, so that it never mixes foreground and background.
class Recording {
public:
    /// Throws Error as open_source() does.
    explicit Recording(const std::filesystem::path& location, const SourceOptions& options = {});
    explicit Recording(std::unique_ptr<FrameSource> source, float scale = 1.0f);

    [[nodiscard]] std::size_t size() const { return source_->size(); }  ///< FrameSource::kEndless for a camera
    [[nodiscard]] bool live() const { return source_->facts().live; }   ///< a camera
    [[nodiscard]] const std::vector<FrameEntry>& frames() const { return source_->facts().frames; }
    [[nodiscard]] const Intrinsics& intrinsics() const { return geometry_.intrinsics(); }  ///< of load()'s images
    [[nodiscard]] const Camera& camera() const { return source_->camera(); }               ///< as recorded
    /// For choosing the undistorter, before the first load().
    [[nodiscard]] ImageGeometry& geometry() { return geometry_; }
    [[nodiscard]] const std::string& location() const { return source_->facts().location; }
    [[nodiscard]] const std::string& name() const { return source_->facts().name; }
    /// Problems that do not prevent the use, one line each: lines left out, images without a partner, order corrected
    /// ...
    [[nodiscard]] const std::vector<std::string>& warnings() const { return source_->facts().warnings; }

    /// Reads, undistorts and shrinks frame i (of a camera: the next one). May be called from several threads. Throws
    /// Error naming the image when one is missing, damaged, of wrong size or type, and as check_usable() does; see
    /// BadFrames for what to do then. Throws SourceLost when no further frame can be had.
    [[nodiscard]] Frame load(std::size_t i) const;

    /// Transforms labels from the recording's own image geometry to that of load()'s images, and back (nearest
    /// neighbour).
    [[nodiscard]] LabelImage labels_from_source(const LabelImage& labels) const;
    [[nodiscard]] LabelImage labels_to_source(const LabelImage& labels) const;

    /// The ground truth of the source; nullopt if there is none. Throws Error when it cannot be used.
    [[nodiscard]] std::optional<Trajectory> groundtruth() const { return source_->groundtruth(); }

private:
    std::unique_ptr<FrameSource> source_;
    ImageGeometry geometry_;
};

/// Handles unreadable frames: single ones are skipped, a recording with no others ends the run.
class BadFrames {
public:
    /// @param patience  this many bad frames from the start without a good one end the run
    explicit BadFrames(std::size_t total_frames, std::size_t patience = 30)
        : total_(total_frames), patience_(patience) {}
    void good() { ++good_; }
    /// @return the warning to show. Throws Error when there was no good frame and patience or the recording is
    /// exhausted.
    std::string bad(const std::string& reason);
    [[nodiscard]] std::size_t skipped() const { return bad_; }

private:
    std::size_t total_, patience_, good_ = 0, bad_ = 0;
};

}  // namespace posefusion
