#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/cli/child_process.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/mesh/cloud_file.hpp"
#include "hosts/mesh/mesh_file.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {
namespace {

/// Says what is being done, on the standard error stream.
void progress(const std::string& text) { fmt::print(stderr, "{}\n", text); }

std::filesystem::path map_file(const ExportConfig& config) {
    return std::filesystem::is_directory(config.map) ? config.map / "map.ply" : config.map;
}

std::vector<Surfel> read_map(const ExportConfig& config) {
    const std::filesystem::path file = map_file(config);
    std::vector<Surfel> surfels = read_ply(file);
    if (surfels.empty()) throw Error(file.string() + ": the map is empty; `posefusion run` said why");
    const std::size_t all = surfels.size();
    std::erase_if(surfels, [&](const Surfel& s) { return s.confidence < config.min_confidence; });
    progress(fmt::format("{}: {} surfels, {} with a confidence of at least {}", file.string(), all, surfels.size(),
                         config.min_confidence));
    if (surfels.empty())
        throw Error(file.string() + ": no surfel has a confidence of at least " +
                    fmt::format("{}", config.min_confidence) + "; lower --min-confidence");
    return surfels;
}

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
}

void write_cloud_of(const ExportConfig& config, const std::vector<Surfel>& surfels) {
    write_cloud(config.cloud, surfels);
    fmt::print("{}: {} points\n", config.cloud.string(), surfels.size());
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
    check(config);
    const std::vector<Surfel> surfels = read_map(config);
    const bool cloud = !config.cloud.empty() && !interrupted();
    if (cloud) write_cloud_of(config, surfels);
    int exit_code = interrupted() ? kExitInterrupted : kExitOk;
    // PCL's reconstruction cannot be stopped, its process can
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
