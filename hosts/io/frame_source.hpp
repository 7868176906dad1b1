#pragma once
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/image.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/stamp.hpp"
#include "hosts/io/trajectory.hpp"

/// Where RGB-D frames come from: a recording in any of the formats of open_source(), or a camera.
namespace posefusion {

/// What is known of a recorded frame without opening its images.
struct FrameEntry {
    Stamp stamp{};           ///< of the colour image
    std::string stamp_text;  ///< as the recording writes it; names files that belong to this frame
};

/// A frame of that time, its stamp written in seconds.
[[nodiscard]] inline FrameEntry entry_at(Stamp stamp) { return {stamp, seconds_text(stamp)}; }

/// A frame as it was recorded: not undistorted, not shrunk. Colour and depth have the size of FrameSource::camera().
struct RawFrame {
    Stamp stamp{};
    std::string stamp_text;
    ColorImage color;
    RawDepth depth;          ///< registered to colour; FrameSource::camera().depth_scale units are one metre
    std::string color_name;  ///< where the images come from, for messages
    std::string depth_name;
};

/// A camera that was disconnected, or a recording that cannot be read any further: later frames fail as well.
class SourceLost : public Error {
public:
    using Error::Error;
};

class FrameSource {
public:
    static constexpr std::size_t kEndless = std::numeric_limits<std::size_t>::max();

    /// What is known once a source is open.
    struct Facts {
        std::string location;               ///< what was opened: folder, file or address of a camera
        std::string name;                   ///< a word for it
        Camera camera;                      ///< of the recorded images
        std::vector<FrameEntry> frames;     ///< ascending stamps; empty for a camera
        std::vector<std::string> warnings;  ///< one line each about what was odd but could be used
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
    /// SourceLost when it makes no sense to ask for another frame.
    [[nodiscard]] virtual RawFrame read(std::size_t i) const = 0;

    /// nullopt where there is none. Throws Error when it cannot be used.
    [[nodiscard]] virtual std::optional<Trajectory> groundtruth() const { return std::nullopt; }

    /// Of a recording: adds a warning where its frames are so far apart that the time stamps may be of another unit, or
    /// where nothing was recorded for long.
    void warn_of_pauses();

protected:
    FrameSource() = default;
    Facts facts_;  ///< filled in by the constructors of the formats
};

/// How a source is to be understood where it does not say itself.
struct SourceOptions {
    std::filesystem::path camera_file;          ///< overrides what the source says of its camera; empty = that
    float scale = 1.0f;                         ///< used by Recording: images are shrunk to this, (0, 1]
    std::filesystem::path associations_file{};  ///< folders: pairs of images, instead of associations.txt; empty = that
    std::string color_topic{}, depth_topic{};   ///< bags: which images; empty = the most likely ones
    bool flip_colors = false;                   ///< .klg: red and blue are exchanged in the recording
    std::optional<TimeUnit> time_unit{};        ///< folders: of time stamps that do not tell it themselves
};

/// Opens a recording or a camera:
///   - folder with rgb.txt and depth.txt or associations.txt: TUM layout, ICL-NUIM included
///   - other folder with colour and depth images: paired by their names; layouts of ScanNet, Replica, SUN3D ...
///   - .klg (ElasticFusion), .bag (ROS 1), .oni (OpenNI2) files
///   - `openni2:` the first OpenNI2 camera, `openni2:URI` a certain one
/// Throws Error: nothing there, not one of these, not usable, camera not known.
[[nodiscard]] std::unique_ptr<FrameSource> open_source(const std::filesystem::path& location,
                                                       const SourceOptions& options = {});

}  // namespace posefusion
