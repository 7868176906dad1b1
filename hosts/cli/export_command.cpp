#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "engine/map/map_config.hpp"
#include "hosts/cli/child_process.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/io/map_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/mesh/cloud_file.hpp"
#include "hosts/mesh/mesh_file.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {
namespace {

/// Prints progress on the standard error stream.
void progress(const std::string& text) { fmt::print(stderr, "{}\n", text); }

std::filesystem::path map_file(const ExportConfig& config) {
    return std::filesystem::is_directory(config.map) ? config.map / "map.ply" : config.map;
}

/// Reads map.ply, which holds stable surfels (or all, if the run was told so), or a map file, which holds all.
std::vector<Surfel> read_surfels(const std::filesystem::path& file) {
    return is_map_file(file) ? surfels_of(read_map(file).map, 0) : read_ply(file);
}

std::vector<Surfel> wanted_surfels(const ExportConfig& config) {
    const std::filesystem::path file = map_file(config);
    std::vector<Surfel> surfels = read_surfels(file);
    if (surfels.empty()) throw Error(file.string() + ": the map is empty; `posefusion run` said why");
    const std::size_t all = surfels.size();
    const float least = config.min_confidence.value_or(is_map_file(file) ? MapConfig{}.stable_confidence : 0);
    std::erase_if(surfels, [&](const Surfel& s) { return s.confidence < least; });
    progress(fmt::format("{}: {}, {} with a confidence of at least {}", file.string(), counted(all, "surfel"),
                         surfels.size(), least));
    if (surfels.empty())
        throw Error(
            fmt::format("{}: no surfel has a confidence of at least {}; lower --min-confidence", file.string(), least));
    return surfels;
}

}  // namespace

void check(const ExportConfig& config) {
    if (config.mesh.empty() && config.cloud.empty())
        throw Error("nothing to export; give --mesh FILE, --cloud FILE or both");
    if (!config.mesh.empty()) check_mesh_name(config.mesh);
    if (!config.cloud.empty()) check_cloud_name(config.cloud);
    for (const std::filesystem::path& file : {config.mesh, config.cloud}) {
        std::error_code error;
        if (std::filesystem::equivalent(file, map_file(config), error) && !error)
            throw Error(file.string() + ": is the map itself; choose another name");
    }
    const float resolution = config.reconstruction.resolution, confidence = config.min_confidence.value_or(0);
    if (!(resolution > 0) || !std::isfinite(resolution)) throw Error("the resolution must be a length above 0 m");
    if (!(confidence >= 0)) throw Error("the least confidence must not be negative");
}

namespace {

void write_cloud_of(const ExportConfig& config, const std::vector<Surfel>& surfels) {
    write_cloud(config.cloud, surfels);
    fmt::print("{}: {}\n", config.cloud.string(), counted(surfels.size(), "point"));
    std::fflush(stdout);
}

int write_mesh_of(const ExportConfig& config, const std::vector<Surfel>& surfels) {
    const Mesh mesh = reconstruct_mesh(surfels, config.reconstruction, progress);
    write_mesh(config.mesh, mesh);
    fmt::print("{}: {} vertices, {} triangles\n", config.mesh.string(), mesh.vertices.size(), mesh.faces.size());
    return kExitOk;
}

}  // namespace

int export_command(const ExportConfig& config) {
    const std::vector<Surfel> surfels = wanted_surfels(config);
    const bool cloud = !config.cloud.empty() && !interrupted();
    if (cloud) write_cloud_of(config, surfels);
    int exit_code = interrupted() ? kExitInterrupted : kExitOk;
    // PCL's reconstruction cannot be interrupted, but its process can be killed
    if (!config.mesh.empty() && !interrupted())
        exit_code = run_in_child([&] { return write_mesh_of(config, surfels); }, interrupted);
    if (exit_code == kExitInterrupted && !config.mesh.empty()) {
        remove_unfinished(config.mesh);
        progress(fmt::format("posefusion: interrupted; {} was not written{}", config.mesh.string(),
                             cloud ? ", " + config.cloud.string() + " was" : ""));
    }
    return exit_code;
}

}  // namespace posefusion
