#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/slam/slam_config.hpp"
#include "hosts/features/feature_config.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/frame_selection.hpp"
#include "pose/detector.hpp"
#include "segmentation/segmenter.hpp"

namespace posefusion {

/// When the rows of images are taken (ShutterConfig).
enum class SensorTimingMode {
    Auto,   ///< looked for in the first frames of a recording, unless given
    Given,  ///< as given
};

/// Whether the calibration of the camera is taken as it is given.
enum class SensorCalibrationMode {
    Auto,   ///< corrected where the first frames of a recording are certain about it
    Given,  ///< as given
};

/// Everything that determines the result of `posefusion run`, apart from the recording.
struct RunConfig {
    std::filesystem::path out = "posefusion-out";  ///< folder the results are written to
    FrameSelection selection;                      ///< which frames of the recording are used
    int max_frames = 0;                            ///< of these; 0 = all
    bool no_people = false;                        ///< no pose network: who moves is left out like any mover
    bool no_motion = false;                        ///< nothing but people moves
    bool objects = false;                          ///< give rigid things that move a model of their own
    std::filesystem::path masks;         ///< folder of label images to use instead of the network; empty = network
    std::filesystem::path mask_network;  ///< instance segmentation network to use instead of joints; empty = joints
    float mask_threshold = 0.5f;         ///< detections with a lower score are ignored, [0, 1]
    std::vector<int> classes;            ///< label values of `masks`, or classes of `mask_network`, that are people
    bool save_masks = false;
    bool save_background = false;          ///< write what the camera would have seen without people
    bool no_loops = false;                 ///< never close a loop: the trajectory is what tracking alone gives
    std::string device;                    ///< name or index of the Vulkan device; empty = the best one
    std::filesystem::path associations;    ///< list of image pairs to use instead of the folder's; empty = that one
    std::string color_topic, depth_topic;  ///< topics of a bag; empty = the most likely ones
    std::optional<TimeUnit> time_unit;     ///< unit of ambiguous time stamps; nullopt = by their intervals
    bool flip_colors = false;              ///< red and blue are swapped in a .klg log
    std::filesystem::path camera;          ///< camera.yaml to use instead of the recording's own; empty = that one
    float scale = 1.0f;                    ///< images are shrunk by this first, (0, 1]
    bool all_surfels = false;              ///< unstable surfels go into map.ply, too
    bool sequential = false;               ///< one stage after the other, for comparison; same results
    bool real_time = false;                ///< play at the recorded rate and drop frames when the pipeline is busy
    bool final_adjust = true;              ///< bundle adjustment of poses at the end of a recording
    bool report = true;                    ///< write report.html
    std::filesystem::path save_map;        ///< file to save the map to, for load_map; empty = none
    std::filesystem::path load_map;        ///< map of an earlier run to continue; empty = start a new one
    bool localise_only = false;            ///< track the camera in the loaded map without changing it
    int checkpoint_every = 0;              ///< frames between checkpoints in `out`; 0 = none
    bool resume = false;                   ///< continue from the last checkpoint in `out`
    int pose_every = 1;                    ///< the joint detector runs on every n-th frame; masks are carried between

    SensorTimingMode sensor_timing = SensorTimingMode::Auto;
    SensorCalibrationMode sensor_calibration = SensorCalibrationMode::Auto;
    std::optional<Camera> calibrated;  ///< no option: what was found of the recording's camera

    PoseConfig pose;
    SegmentationConfig segmentation;
    FeatureConfig features;
    SlamConfig slam;
};

/// The configuration of the engine, with the switches of the run applied.
[[nodiscard]] SlamConfig slam_config(const RunConfig& config);

/// Throws Error for values that are valid one by one but not together.
void check_config(const RunConfig& config);

}  // namespace posefusion
