#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "engine/slam/slam.hpp"
#include "hosts/config/run_config.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_geometry.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/pipeline/motion_prediction.hpp"
#include "hosts/pipeline/people_finder.hpp"

namespace posefusion {

/// The whole method for those who have the images themselves: one call per frame, on the calling thread. Frames in the
/// order of a recording give the same poses as `posefusion run` on that recording.
class FrameByFrame {
public:
    struct Result {
        FoundPeople people;  ///< in the geometry of intrinsics()
        FrameResult slam;
    };

    /// @param camera  of the images given to process()
    /// @param config  scale, no_people, pose_every, device, pose, segmentation and slam count; what concerns files does
    /// not. Throws Error: numbers that make no sense together, masks that are files, model or device that cannot be
    /// used.
    FrameByFrame(const Camera& camera, const RunConfig& config);

    /// @param stamp   seconds, ascending
    /// @param color, depth  of the camera's size, depth registered to colour, metres, 0 = no measurement; undistorted
    ///                and shrunk here
    /// @param labels  people (0 static, 1..n person), of the camera's size; nullopt: they are looked for
    /// Throws Error: stamps out of order, images of another size or a frame that `posefusion run` would skip
    /// (check_usable()), in which case the frame takes no part and the next may come; or what the parts throw.
    Result process(double stamp, ColorImage color, DepthImage depth, std::optional<LabelImage> labels = std::nullopt);

    [[nodiscard]] const Intrinsics& intrinsics() const { return geometry_.intrinsics(); }  ///< of the images worked on
    /// Of all frames so far, corrected by the loops closed since.
    [[nodiscard]] Trajectory trajectory() const;
    [[nodiscard]] const Slam& slam() const { return slam_; }

private:
    RunConfig config_;
    ImageGeometry geometry_;
    std::unique_ptr<PeopleFinder> people_;
    Slam slam_;
    MotionPrediction motion_;
    std::vector<double> stamps_;  // of the frames processed
};

}  // namespace posefusion
