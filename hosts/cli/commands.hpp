#pragma once
#include <filesystem>

#include "hosts/config/run_config.hpp"
#include "hosts/io/recorders/recorder.hpp"
#include "hosts/mesh/reconstruction.hpp"
#include "hosts/run/exit_code.hpp"
#include "hosts/synth/synth.hpp"

/// What the sub-commands do, without their parsing. Each returns the exit code and throws Error.
namespace posefusion {

/// What `posefusion export` makes of a map.
struct ExportConfig {
    std::filesystem::path map;    ///< map.ply of a run, or the folder it is in
    std::filesystem::path mesh;   ///< .ply or .obj; empty = none
    std::filesystem::path cloud;  ///< .ply or .pcd; empty = none
    float min_confidence = 0;     ///< surfels below this take no part
    MeshConfig reconstruction;
};

/// Runs the method and writes the results to config.out, also those of a run that was interrupted or failed.
int run_command(const std::filesystem::path& recording, RunConfig& config);
/// Runs the method, writes nothing but a table of the time per stage, or JSON with the time of every frame.
int bench_command(const std::filesystem::path& recording, RunConfig& config, bool json);
/// Copies a recording, or what a camera sees until Ctrl-C, to a TUM folder or a .klg log.
int record_command(const std::filesystem::path& source, const std::filesystem::path& out, const SourceOptions& reading,
                   const RecordOptions& writing);
int evaluate_command(const std::filesystem::path& groundtruth, const std::filesystem::path& estimate, bool json);
int export_command(const ExportConfig& config);
int synth_command(const SynthConfig& config);
int devices_command();

}  // namespace posefusion
