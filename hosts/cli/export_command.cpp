#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/cli/child_process.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/cli/map_input.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/mesh/cloud_file.hpp"
#include "hosts/mesh/mesh_file.hpp"
#include "hosts/run/signals.hpp"
#include "hosts/web/read_scene.hpp"
#include "hosts/web/web_page.hpp"

namespace posefusion {
namespace {

/// Prints progress on the standard error stream.
void progress(const std::string& text) { fmt::print(stderr, "{}\n", text); }

std::filesystem::path map_file(const ExportConfig& config) {
    return std::filesystem::is_directory(config.map) ? config.map / "map.ply" : config.map;
}

}  // namespace

void check(const ExportConfig& config) {
    if (config.mesh.empty() && config.cloud.empty() && config.html.empty())
        throw Error("nothing to export; give --mesh FILE, --cloud FILE or --html FILE");
    if (!config.mesh.empty()) check_mesh_name(config.mesh);
    if (!config.cloud.empty()) check_cloud_name(config.cloud);
    for (const std::filesystem::path& file : {config.mesh, config.cloud, config.html}) {
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

void write_page_of(const ExportConfig& config, const std::vector<Surfel>& surfels) {
    const auto remark = [](const std::string& text) { progress("posefusion: warning: " + text); };
    const WebScene scene = read_scene(config.map, surfels, remark, interrupted);
    if (interrupted()) return;
    const std::string page = self_contained_page(scene);
    write_file_atomically(config.html, page);
    fmt::print("{}: {}, {:.1f} MB\n", config.html.string(), counted(surfels.size(), "surfel"),
               static_cast<double>(page.size()) / 1e6);
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
    const std::vector<Surfel> surfels = read_wanted_surfels(map_file(config), config.min_confidence);
    const bool cloud = !config.cloud.empty() && !interrupted();
    if (cloud) write_cloud_of(config, surfels);
    if (!config.html.empty() && !interrupted()) write_page_of(config, surfels);
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
