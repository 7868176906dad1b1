#pragma once
#include <filesystem>
#include <optional>

#include "hosts/config/run_config.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/export/data_set.hpp"
#include "hosts/io/recorders/recorder.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/mesh/reconstruction.hpp"
#include "hosts/run/exit_code.hpp"
#include "hosts/synth/synth.hpp"
#include "hosts/texture/texturing.hpp"
#include "hosts/web/web_server.hpp"

/// The sub-commands, without the parsing of their arguments. Each returns the exit code and throws Error.
namespace posefusion {

/// Options of `posefusion export`.
struct ExportConfig {
    /// The folder of a run, map.ply of one, or a file of `run --save-map`; for `trajectory` alone a trajectory file;
    /// for `views` the folder.
    std::filesystem::path source;
    std::filesystem::path mesh;                         ///< .ply or .obj; empty = none
    std::filesystem::path cloud;                        ///< .ply, .pcd or .xyz; empty = none
    std::filesystem::path html;                         ///< page for a browser; empty = none
    bool ascii = false;                                 ///< a .pcd is written as text
    std::filesystem::path trajectory;                   ///< empty = none
    std::optional<TrajectoryFormat> trajectory_format;  ///< nullopt: EuRoC's for a name that ends in .csv, else TUM's
    std::optional<float> min_confidence;  ///< surfels below it are left out; nullopt: those that are not stable
    std::filesystem::path recording;      ///< of the run; empty = where it was
    MeshConfig reconstruction;
    bool texture = false;  ///< the mesh gets one
    TextureConfig texturing;
    DataSetConfig views;

    [[nodiscard]] bool wants_map() const { return !mesh.empty() || !cloud.empty() || !html.empty() || views.wanted(); }
};

/// Options of `posefusion web`.
struct WebConfig {
    std::filesystem::path source;         ///< folder of a run, map.ply, or a file of `run --save-map`
    std::filesystem::path recording;      ///< as in ExportConfig
    std::optional<float> min_confidence;  ///< as in ExportConfig
    WebServerConfig server;
};

/// Options of `posefusion evaluate`.
struct EvaluateConfig {
    std::filesystem::path groundtruth, estimate;
    std::optional<TimeUnit> time_unit;  ///< of stamps whose unit is ambiguous
    EvaluationConfig evaluation;
    bool delta_unit_given = false;  ///< otherwise frames are used instead of seconds where there is no time
    Stamp time_offset{};            ///< added to the stamps of the estimate
    bool find_time_offset = false;  ///< search for the offset instead
    std::filesystem::path plot;     ///< .png; empty = none
    bool json = false;
};

/// Runs the method and writes the results to config.out, also those of a run that was interrupted or failed.
/// @param web  where its page is served while it is going; nullopt: nowhere
int run_command(const std::filesystem::path& recording, RunConfig& config,
                const std::optional<WebServerConfig>& web = std::nullopt);
/// Runs the method, writes nothing but a table of the time per stage, or JSON with the time of every frame.
int bench_command(const std::filesystem::path& recording, RunConfig& config, bool json);
/// Looks at the beginning of a recording and prints what it says about the camera's calibration.
/// @param out  camera file to write if it was corrected; empty = none
int calibrate_command(const std::filesystem::path& recording, RunConfig& config, const std::filesystem::path& out);
/// Copies a recording, or what a camera sees until Ctrl-C, to a TUM folder or a .klg log.
int record_command(const std::filesystem::path& source, const std::filesystem::path& out, const SourceOptions& reading,
                   const RecordOptions& writing);
int evaluate_command(const EvaluateConfig& config);
/// Throws Error if the values are not possible, or nothing is to be written.
void check(const ExportConfig& config);
/// @param config  checked
int export_command(const ExportConfig& config);
/// Serves a map, and the run in whose folder it is, to browsers until Ctrl-C.
int web_command(const WebConfig& config);
int synth_command(const SynthConfig& config);
int devices_command();

}  // namespace posefusion
