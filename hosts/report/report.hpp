#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/slam/slam.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/report/people_drawing.hpp"
#include "pose/joints.hpp"

/// The report of a run as an HTML page. Plain data in, files out; independent of how a run is made.
namespace posefusion {

/// Milliseconds of one stage, one value per frame (NaN: the stage did not run on that frame).
struct StageSeries {
    std::string name;
    std::vector<double> milliseconds;
};

/// Consecutive frames without tracking, counted from the first frame of the run.
struct LostInterval {
    std::size_t first = 0, last = 0;
    bool found_again = false;  ///< false: lost until the end of the run
    [[nodiscard]] std::size_t frames() const { return last - first + 1; }
};

/// A frame as shown in the report.
struct SampleFrame {
    std::size_t index = 0;
    Stamp stamp{};
    ColorImage color;
    LabelImage labels;  ///< empty = no people
    People people;
};

/// A rigid thing that moved.
struct ObjectOfRun {
    std::uint8_t label = 0;          ///< in the masks
    Trajectory trajectory;           ///< object to world, of the frames in which it was tracked
    std::size_t stable_surfels = 0;  ///< of its model
};

struct ReportData {
    std::string recording;                                   ///< name of the recording
    std::vector<std::pair<std::string, std::string>> facts;  ///< lines of the summary: device, network, size ...
    std::vector<std::string> warnings;
    Trajectory trajectory;  ///< one pose per processed frame
    std::optional<Trajectory> groundtruth;
    std::optional<Evaluation> evaluation;  ///< nullopt: no ground truth, or no overlap with it
    std::vector<StageSeries> host_stages;  ///< time of the three stages of the pipeline
    std::vector<StageSeries> gpu_stages;   ///< GPU time stamps
    std::vector<FrameResult> frames;       ///< as the engine returned them, one per pose
    std::vector<int> people;               ///< cut out of each frame
    std::vector<LostInterval> lost;
    std::vector<Eigen::Isometry3d>
        earlier_poses;                     ///< cameras of the engine's frames before the first pose: of a loaded map
    std::vector<std::uint32_t> keyframes;  ///< places that can be recognised, as numbers of the engine's frames
    std::optional<LoopGraph> loop_graph;   ///< of the last loop that bent the map
    std::vector<Surfel> map;               ///< stable surfels, world frame
    std::vector<ObjectOfRun> objects;      ///< by label
    Intrinsics camera;
    std::vector<SampleFrame> samples;
    std::string configuration;  ///< text (YAML or JSON) to reproduce the run
};

/// Whether loops.png has something to show: a closed loop or a relocalisation.
[[nodiscard]] bool has_loop_picture(const ReportData& data);

/// Writes into `folder`: report.html (one file, opens without a network), trajectory.png, map.png (the map from above,
/// behind the first camera), map_view.png (from the first camera, a step back) and, if has_loop_picture(), loops.png
/// (the deformation graph, loops and keyframes over the map). Series may have any length; what is missing is left out.
/// Throws Error.
/// @return the names of the pictures
/// @param chart_library  chart.umd.js of Chart.js, put into the page; empty = where tools/setup puts it. Without it the
///                       page shows pictures instead of plots.
std::vector<std::string> write_report(const std::filesystem::path& folder, const ReportData& data,
                                      const std::filesystem::path& chart_library = {});

}  // namespace posefusion
