#pragma once
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "engine/core/image.hpp"
#include "engine/map/surfel.hpp"
#include "engine/map/surfel_map.hpp"
#include "engine/objects/object_view.hpp"
#include "engine/preprocess/preprocessing.hpp"
#include "engine/slam/slam_config.hpp"
#include "engine/tracking/tracker.hpp"

namespace posefusion {

/// The surfels of one object, in the frame of the object, and the commands that use them.
struct ObjectModel {
    ObjectModel(vulkan::Context& context, const Intrinsics& camera, const MapConfig& config)
        : map(context, camera, config) {}
    SurfelMap map;
    std::uint32_t frames = 0;  ///< fused
    std::unique_ptr<vulkan::Sequence> track, fuse;
};

/// A frame as an object sees it: what belongs to other things is labelled.
struct ObjectFrame {
    ObjectView view;
    ColorImage color;
    DepthImage depth;
    LabelImage outside;  ///< non-zero: not of the object
};

/// How well the pose of an object is known before a frame is tracked.
struct PosePrior {
    float share = 0;  ///< its weight, as a share of what the image says about the translation
    float sigma = 1;  ///< ... and its standard deviation, metres
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();  ///< of the object where it is expected, camera coordinates
    float radius = 0;                                  ///< of the object, metres
};

/// Tracks and fuses models of objects, one after the other, with the kernels that track the camera and fuse the map:
/// to them the object is the world, and its pixels are all that the camera sees. What the pixels do not fix follows
/// the motion that was expected.
class ModelTracker {
public:
    /// @param image  camera of the whole images
    ModelTracker(vulkan::Context& context, const Intrinsics& image, const SlamConfig& config);

    /// An empty one. Models that have been given back are used again.
    [[nodiscard]] std::unique_ptr<ObjectModel> model();
    void give_back(std::unique_ptr<ObjectModel> model);

    struct Result {
        Eigen::Isometry3d T_object_camera = Eigen::Isometry3d::Identity();
        bool solved = false;
        std::uint32_t inliers = 0;  ///< pixels
        float icp_rmse = 0;         ///< metres
        DepthImage model_depth;     ///< of the view: what the model looks like from there, metres; 0 where it is not
    };
    [[nodiscard]] Result track(ObjectModel& model, const ObjectFrame& frame, const Eigen::Isometry3d& T_object_camera,
                               const PosePrior& prior);
    void fuse(ObjectModel& model, const ObjectFrame& frame, const Eigen::Isometry3d& T_object_camera);

    [[nodiscard]] std::vector<Surfel> surfels(const ObjectModel& model, bool stable_only) const;
    void save(StateWriter& out, const ObjectModel& model) const;
    [[nodiscard]] std::unique_ptr<ObjectModel> load(StateReader& in);

private:
    void prepare(const ObjectModel& model, const ObjectFrame& frame, const Eigen::Isometry3d& T_object_camera);
    /// What prepare() has left, and its preprocessing.
    void enqueue_frame(vulkan::Sequence& sequence) const;
    void enqueue_prediction(vulkan::Sequence& sequence, const ObjectModel& model) const;

    vulkan::Context& context_;
    Intrinsics image_, window_;
    SlamConfig config_;
    vulkan::Buffer host_params_, params_;
    PyramidBuilder pyramids_;
    Preprocessing images_;
    Tracker tracker_;
    ImagePyramid predicted_;
    vulkan::Buffer predicted_color_;
    vulkan::Buffer host_record_, host_depth_, host_counters_;
    std::vector<std::unique_ptr<ObjectModel>> unused_;
};

}  // namespace posefusion
