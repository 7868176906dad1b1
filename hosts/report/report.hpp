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

/// The page a person looks at after a run. Plain data in, files out; knows nothing of how a run is made.
namespace posefusion {

/// Milliseconds of one stage, one value per frame (NaN: the stage did not run on that frame).
struct StageSeries {
    std::string name;
    std::vector<double> milliseconds;
};

/// A frame as shown in the report.
struct SampleFrame {
    std::size_t index = 0;
    double stamp = 0;
    ColorImage color;
    LabelImage labels;  ///< empty = nobody
    People people;
};

struct ReportData {
    std::string sequence;                                    ///< name of the recording
    std::vector<std::pair<std::string, std::string>> facts;  ///< lines of the summary: device, network, size ...
    std::vector<std::string> warnings;
    Trajectory trajectory;  ///< one pose per processed frame
    std::optional<Trajectory> groundtruth;
    std::optional<Evaluation> evaluation;  ///< nullopt: no ground truth, or no overlap with it
    std::vector<StageSeries> host_stages;  ///< time of the three stages of the pipeline
    std::vector<StageSeries> gpu_stages;   ///< GPU time stamps
    std::vector<FrameResult> frames;       ///< as the engine returned them, one per pose
    std::vector<int> people;               ///< cut out of each frame
    std::vector<Surfel> map;               ///< stable surfels, world frame
    Intrinsics camera;
    std::vector<SampleFrame> samples;
    std::string configuration;  ///< text (YAML or JSON) to reproduce the run
};

/// Writes into `folder`: report.html (one file, opens without a network), trajectory.png, map.png (the map from above,
/// behind the first camera) and map_view.png (from the first camera, a step back). Series may have any length; what
/// is missing is left out. Throws Error.
/// @param chart_library  chart.umd.js of Chart.js, put into the page; empty = where tools/setup puts it. Without it the
///                       page shows pictures instead of plots.
void write_report(const std::filesystem::path& folder, const ReportData& data,
                  const std::filesystem::path& chart_library = {});

}  // namespace posefusion
