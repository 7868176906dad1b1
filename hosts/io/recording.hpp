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
    std::size_t index = 0;   ///< among the frames of the recording
    Stamp stamp{};           ///< of the colour image
    std::string stamp_text;  ///< as the recording writes it; names files that belong to this frame
    Stamp depth_delay{};     ///< stamp of the depth image minus that of the colour image
    ColorImage color;
    DepthImage depth;           ///< metres, 0 = no measurement
    UndistortTime undistort{};  ///< zero where no device undistorted the frame
};

/// Throws Error for an unusable frame: the depth image holds no measurement in the range, or the colour image is black
/// (no people could be found in it). @param color_name, depth_name  for the message
void check_usable(const Frame& frame, const DepthRange& range, const std::string& color_name,
                  const std::string& depth_name);

/// Images are undistorted where the camera is distorted, then shrunk by `scale` and cropped at the right and bottom to
/// sizes that divide by 4 (intrinsics() accounts for all three). Colour shrinks by area; depth takes the mean of the
/// measurements near the median of the block, so that it never mixes foreground and background.
class Recording {
public:
    /// Throws Error as open_source() and check_depth_unit() do.
    explicit Recording(const std::filesystem::path& location, const SourceOptions& options = {});
    explicit Recording(std::unique_ptr<FrameSource> source, float scale = 1.0f);

    [[nodiscard]] std::size_t size() const { return source_->size(); }  ///< FrameSource::kEndless for a camera
    [[nodiscard]] bool live() const { return source_->facts().live; }   ///< a camera
    [[nodiscard]] const std::vector<FrameEntry>& frames() const { return source_->facts().frames; }
    /// The frame that is number `place` of the whole recording; nullptr: there is none, or it is not selected.
    [[nodiscard]] const FrameEntry* frame_at(std::size_t place) const;
    [[nodiscard]] const Intrinsics& intrinsics() const { return geometry_.intrinsics(); }  ///< of load()'s images
    [[nodiscard]] const Camera& camera() const { return source_->camera(); }               ///< as recorded
    [[nodiscard]] const FrameSource& source() const { return *source_; }                   ///< of frames as recorded
    /// For choosing the undistorter, before the first load().
    [[nodiscard]] ImageGeometry& geometry() { return geometry_; }
    [[nodiscard]] const ImageGeometry& geometry() const { return geometry_; }
    [[nodiscard]] const std::string& location() const { return source_->facts().location; }
    [[nodiscard]] const std::string& name() const { return source_->facts().name; }
    /// Problems that do not prevent the use, one line each: lines left out, images without a partner, order corrected
    /// ...
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

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
    DepthRange depth_range_;
    std::vector<std::string> warnings_;
};

/// Handles unusable frames: they are skipped, also at the beginning (until the light goes on); a recording without any
/// other ends the run.
class BadFrames {
public:
    explicit BadFrames(std::size_t total_frames) : total_(total_frames) {}
    void good();
    /// @return the warning to show; empty for most of many frames in a row. Throws Error when the whole recording is
    ///         unusable.
    std::string bad(const std::string& reason);
    [[nodiscard]] std::size_t skipped() const { return bad_; }

private:
    std::size_t total_, good_ = 0, bad_ = 0, in_a_row_ = 0;
};

}  // namespace posefusion
