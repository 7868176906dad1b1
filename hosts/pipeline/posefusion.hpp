#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "engine/objects/object_map.hpp"
#include "engine/slam/slam.hpp"
#include "hosts/config/run_config.hpp"
#include "hosts/features/sparse_start.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_geometry.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/pipeline/motion_prediction.hpp"
#include "hosts/pipeline/people_finder.hpp"

namespace posefusion {

class ObjectTracker;  // engine/objects/object_tracker.hpp

/// A frame and the results of the method for it.
struct ProcessedFrame {
    std::size_t number = 0;             ///< among the frames processed; the first is 0
    Stamp previous_stamp{};             ///< of the previous frame
    Frame input;                        ///< undistorted and scaled
    FoundPeople people;                 ///< of find_people(), in the pixels of `input`
    std::vector<StartPose> starts;      ///< of find_start(): where the camera may be
    std::optional<double> features_ms;  ///< time that finding them took; nullopt: they were not sought
    FrameResult result;                 ///< of track_and_map()
};

/// A gap in a recording, across which the camera cannot be tracked.
struct GapConfig {
    static constexpr double kLeast_s = 1;
    static constexpr double kIntervals = 10;    ///< and at least this many times the median of the last intervals ...
    static constexpr std::size_t kRecent = 31;  ///< ... between this many frames
};

/// The method of the paper, dense RGB-D SLAM in a room with people:
///   1. joints of people in the colour image, eq. (1)
///   2. min-cut of people from the depth image around their joints, eq. (2) and (3)
///   3. dense SLAM on what is left
///
///     posefusion::PoseFusion slam(camera);
///     slam.process(color, depth, stamp);
///
/// Frames in the order of a recording give the trajectory and map of `posefusion run` on that recording.
class PoseFusion {
public:
    /// For images from any origin. @param camera  of the images given to process()
    /// @param config  scale, no_people, no_motion, objects, pose_every, device, pose, segmentation and slam are used;
    /// options about files are ignored. Throws Error: inconsistent values, masks that are files, an unusable model or
    /// device.
    explicit PoseFusion(const Camera& camera, const RunConfig& config = {});
    /// For the frames of `recording`, which applies its own scale. Throws Error as above, and for unusable masks.
    /// @param sharing  requirements of a renderer that shares the device
    explicit PoseFusion(Recording& recording, const RunConfig& config = {}, const DeviceSharing& sharing = {});

    /// One frame. @param color, depth  of the camera's size; depth registered to colour, metres, 0 = no measurement
    /// @param stamp   ascending; of seconds: stamp_of()
    /// @param labels  people (0 static, 1..n person), of the camera's size; nullopt: they are detected
    /// Throws Error: stamps out of order, images of another size or a frame that `posefusion run` would skip
    /// (check_usable()), after which the next frame may be processed; or an Error of one of the steps.
    ProcessedFrame process(ColorImage color, DepthImage depth, Stamp stamp,
                           std::optional<LabelImage> labels = std::nullopt);
    /// The same for a frame that is already undistorted and scaled, as returned by Recording::load().
    ProcessedFrame process(Frame input, std::optional<LabelImage> labels = std::nullopt);

    /// The two halves of process(), for use in two threads: each in the order of the frames, find_people() before
    /// track_and_map(). find_people() may run ahead: for frame k it waits until track_and_map() has finished frame k-2.
    void find_people(ProcessedFrame& frame);  ///< steps 1 and 2: from frame.input to frame.people
    /// Step 3: from both to frame.result. After a gap in time (GapConfig) the camera may be anywhere in the map, and
    /// has to be recognised: a place that looks alike must not make the jump a motion.
    void track_and_map(ProcessedFrame& frame);
    /// No more frames will be tracked: a waiting find_people() continues.
    void end_tracking() { motion_.close(); }

    /// Of the frames processed, corrected by the loops closed since. Without those whose pose is not known: tracking
    /// failed, they are of a beginning that was given up, or of another piece of map (engine/slam/map_piece.hpp).
    [[nodiscard]] Trajectory trajectory() const;
    [[nodiscard]] const Intrinsics& intrinsics() const { return slam_.camera(); }  ///< of the processed images
    [[nodiscard]] const Slam& engine() const { return slam_; }                     ///< map, views, device
    [[nodiscard]] Slam& engine() { return slam_; }
    /// Models of the rigid things that move, by label; empty without RunConfig::objects. Their poses are in
    /// FrameResult::objects. Not while a frame is processed. @param stable_only  as for Slam::surfels()
    [[nodiscard]] std::vector<ObjectMap> object_maps(bool stable_only = true) const;
    [[nodiscard]] const PeopleFinder& people() const { return *people_; }
    /// The memory of find_people() between calls.
    [[nodiscard]] ByteArray people_state() const;

    /// Continues after the frames of an earlier run. @param poses  of these frames, as tracked at the time
    /// @param map, people  Slam::atlas_state() and people_state() after the last of them. Throws Error as their
    /// restore() does.
    void restore(const AtlasState& map, const ByteArray& people, const std::vector<MotionPrediction::Pose>& poses);
    /// Starts in the map of an earlier run, wherever in it the camera may be. Throws Error as Slam::restore() does.
    void continue_in(const SlamState& map);
    /// Starts again with an empty map on the same device. @param people  replaces the finder of people
    void reset(std::unique_ptr<PeopleFinder> people);

private:
    void find_motion(const RunConfig& config);
    [[nodiscard]] bool follows_a_gap(Stamp stamp) const;
    void find_start(ProcessedFrame& frame);

    ImageGeometry geometry_;  // of the images given to process()
    DepthRange depth_range_;
    std::unique_ptr<PeopleFinder> people_;
    std::optional<SparseStart> sparse_start_;  // nullopt: tracking starts by itself
    Slam slam_;
    std::shared_ptr<ObjectTracker> objects_;  // nullptr: not asked for
    MotionPrediction motion_;
    struct TrackedFrame {
        Stamp stamp{};
        bool found = false;  // its pose
    };
    std::vector<TrackedFrame> frames_;
};

}  // namespace posefusion
