#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_geometry.hpp"
#include "hosts/io/trajectory.hpp"

/// Recorded RGB-D sequences in TUM layout.
namespace posefusion {

struct SequenceOptions {
    std::filesystem::path camera_file;  ///< overrides camera.yaml of the sequence; empty = that one or the TUM cameras
    float scale = 1.0f;                 ///< images are shrunk to this, (0, 1]
};

/// One colour image and the depth image that belongs to it, same size, same camera.
struct Frame {
    std::size_t index = 0;   ///< position in the sequence
    double stamp = 0;        ///< of the colour image, seconds
    std::string stamp_text;  ///< as written in rgb.txt; names files that belong to this frame
    ColorImage color;
    DepthImage depth;  ///< metres, 0 = no measurement
};

/// What is known of a frame without opening its images.
struct FrameEntry {
    double stamp = 0;        ///< of the colour image, seconds
    std::string stamp_text;  ///< as written in rgb.txt
    std::filesystem::path color, depth;
};

/// A folder with rgb.txt and depth.txt, paired within 20 ms by associate.py's rule, or associations.txt (which counts
/// where it is there), and the images they name. The camera comes from options.camera_file, else camera.yaml in the
/// folder, else the published TUM calibration for a folder name with fr1/fr2/fr3.
///
/// Images are undistorted where the camera is distorted, then shrunk by `scale` and cropped at the right and bottom to
/// sizes that divide by 4 (intrinsics() accounts for all three). Colour shrinks by area; depth takes the mean of the
/// measurements near the median of the block, so that it never mixes foreground and background.
class Sequence {
public:
    /// Throws Error: missing folder, no usable line in a list, no pair, no camera, camera.yaml not usable.
    explicit Sequence(const std::filesystem::path& folder, const SequenceOptions& options = {});

    [[nodiscard]] std::size_t size() const { return frames_.size(); }
    [[nodiscard]] const std::vector<FrameEntry>& frames() const { return frames_; }
    [[nodiscard]] const Intrinsics& intrinsics() const { return geometry_.intrinsics(); }  ///< of load()'s images
    [[nodiscard]] const Camera& camera() const { return camera_; }                         ///< of the files
    [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
    [[nodiscard]] std::string name() const;  ///< last part of the folder name
    /// One line each about what was odd but could be used: lines left out, images without partner, order mended ...
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

    /// Reads, undistorts and shrinks frame i. May be called from several threads. Throws Error naming the file when an
    /// image is missing, damaged, of wrong size or type, when the depth image holds no measurement at all, and when the
    /// colour image is black (nobody can be found in it). See BadFrames for what to do then.
    [[nodiscard]] Frame load(std::size_t i) const;

    /// Labels of the recording's own image geometry brought to that of load()'s images, and back (nearest neighbour).
    [[nodiscard]] LabelImage labels_from_source(const LabelImage& labels) const;
    [[nodiscard]] LabelImage labels_to_source(const LabelImage& labels) const;

    /// groundtruth.txt of the folder; nullopt where there is none. Throws Error when it cannot be used.
    [[nodiscard]] std::optional<Trajectory> groundtruth() const;

private:
    std::filesystem::path folder_;
    std::vector<FrameEntry> frames_;
    Camera camera_;
    ImageGeometry geometry_;
    std::vector<std::string> warnings_;
};

/// What to do about frames that cannot be read: one is skipped, a sequence of nothing else ends the run.
class BadFrames {
public:
    /// @param patience  so many bad frames from the start without a good one end the run
    explicit BadFrames(std::size_t total_frames, std::size_t patience = 30)
        : total_(total_frames), patience_(patience) {}
    void good() { ++good_; }
    /// @return the warning to show. Throws Error when no frame has been good and patience or the sequence is at its
    /// end.
    std::string bad(const std::string& reason);
    [[nodiscard]] std::size_t skipped() const { return bad_; }

private:
    std::size_t total_, patience_, good_ = 0, bad_ = 0;
};

}  // namespace posefusion
