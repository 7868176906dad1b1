#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/image.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/frame_selection.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/stamp.hpp"
#include "hosts/io/trajectory.hpp"

/// Where RGB-D frames come from: a recording in any of the formats of open_source(), or a camera.
namespace posefusion {

/// The description of a recorded frame, known without opening its images.
struct FrameEntry {
    Stamp stamp{};           ///< of the colour image
    std::string stamp_text;  ///< as the recording writes it; names files that belong to this frame
    Stamp depth_delay{};     ///< stamp of the depth image minus that of the colour image
};

/// An entry for a stamp, written in seconds.
/// @param depth_stamp  of the depth image
[[nodiscard]] inline FrameEntry entry_at(Stamp stamp, Stamp depth_stamp) {
    return {stamp, seconds_text(stamp), depth_stamp - stamp};
}
[[nodiscard]] inline FrameEntry entry_at(Stamp stamp) { return entry_at(stamp, stamp); }

/// A frame as recorded: neither undistorted nor scaled. Colour and depth have the size of FrameSource::camera().
struct RawFrame {
    Stamp stamp{};
    std::string stamp_text;
    Stamp depth_delay{};  ///< stamp of the depth image minus that of the colour image
    ColorImage color;
    RawDepth depth;          ///< registered to colour; FrameSource::camera().depth_scale units are one metre
    std::string color_name;  ///< names of the images, for messages
    std::string depth_name;
};

/// A camera that was disconnected, or a recording that cannot be read any further: later frames fail as well.
class SourceLost : public Error {
public:
    using Error::Error;
};

/// The end of a live source that has one, as of a stream: no fault.
class SourceEnded : public SourceLost {
public:
    using SourceLost::SourceLost;
};

/// Waiting for a live source was given up because SourceOptions::cancelled said so.
class SourceCancelled : public SourceEnded {
public:
    using SourceEnded::SourceEnded;
};

class FrameSource {
public:
    static constexpr std::size_t kEndless = std::numeric_limits<std::size_t>::max();

    /// Properties of an open source.
    struct Facts {
        std::string location;               ///< folder, file or address of a camera
        std::string name;                   ///< short name
        Camera camera;                      ///< of the recorded images
        std::vector<FrameEntry> frames;     ///< ascending stamps; empty for a camera
        std::vector<std::size_t> places;    ///< of the frames among all of the recording, ascending; empty = all frames
        std::vector<std::string> warnings;  ///< problems that do not prevent its use, one line each
        bool live = false;                  ///< a camera: frames arrive in real time and cannot be read again
    };

    virtual ~FrameSource() = default;
    FrameSource(const FrameSource&) = delete;
    FrameSource& operator=(const FrameSource&) = delete;

    [[nodiscard]] const Facts& facts() const { return facts_; }
    [[nodiscard]] const Camera& camera() const { return facts_.camera; }
    [[nodiscard]] bool seekable() const { return !facts_.live; }
    [[nodiscard]] std::size_t size() const { return facts_.live ? kEndless : facts_.frames.size(); }  ///< frames

    /// Frame i of a recording, in any order; of a camera the next frame, whatever i is (waits for it). May be called
    /// from several threads. Throws Error naming the image that is missing, damaged or of wrong size or type, and
    /// SourceLost when it makes no sense to ask for another frame (SourceEnded: because there was none left;
    /// SourceCancelled: because nobody wants to wait for it any more).
    [[nodiscard]] virtual RawFrame read(std::size_t i) const = 0;

    /// The ground truth; nullopt if there is none. Throws Error when it cannot be used.
    [[nodiscard]] virtual std::optional<Trajectory> groundtruth() const { return std::nullopt; }

    /// For recordings: adds a warning if the frames are so far apart that the time unit may be wrong, or if there are
    /// long gaps.
    void warn_of_pauses();

protected:
    FrameSource() = default;
    Facts facts_;  ///< filled in by the constructors of the formats
};

/// Depth that is of use, metres.
struct DepthRange {
    float min = 0, max = std::numeric_limits<float>::infinity();
};

/// How to interpret a source where it does not say itself, and what of it is used.
struct SourceOptions {
    std::filesystem::path camera_file;   ///< camera file that overrides the source's own; empty = the source's own
    std::optional<Camera> calibrated{};  ///< used by Recording: what is known better of the camera; nullopt = nothing
    float scale = 1.0f;                  ///< used by Recording: scale of the images, (0, 1]
    std::filesystem::path
        associations_file{};  ///< folders: list of image pairs instead of associations.txt; empty = that file
    std::string color_topic{}, depth_topic{};  ///< bags: topics of the images; empty = the most likely ones
    bool flip_colors = false;                  ///< .klg: red and blue are swapped in the recording
    std::optional<TimeUnit> time_unit{};       ///< folders: unit of time stamps where it is ambiguous
    FrameSelection selection{};                ///< the others do not count as frames of the source
    DepthRange depth{};                        ///< used by Recording: frames without depth in it are not usable
    /// Live sources: whether nobody waits for frames any more. Asked while waiting, by the thread that opens or reads.
    std::function<bool()> cancelled = [] { return false; };
};

/// Whether open_source() would open a camera or a stream there, rather than a recording: its frames come once.
[[nodiscard]] bool is_camera(const std::filesystem::path& location);

/// Opens a recording or a camera:
///   - folder with rgb.txt and depth.txt or associations.txt: TUM layout, ICL-NUIM included
///   - other folder with colour and depth images: paired by their names; layouts of ScanNet, Replica, SUN3D ...
///   - folder of rosbag2 (ROS 2): .db3 or .mcap files, metadata.yaml; of Stray Scanner: rgb.mp4, odometry.csv, depth
///   - .klg (ElasticFusion), .bag (ROS 1), .mcap and .db3 (ROS 2), .oni (OpenNI2), .mkv (Azure Kinect) files
///   - `openni2:` the first OpenNI2 camera, `openni2:URI` a certain one
///   - `raw:-` what another program writes into standard input
/// Throws Error: not found, none of these, not usable, camera unknown, no frame selected, SourceCancelled.
[[nodiscard]] std::unique_ptr<FrameSource> open_source(const std::filesystem::path& location,
                                                       const SourceOptions& options = {});

}  // namespace posefusion
