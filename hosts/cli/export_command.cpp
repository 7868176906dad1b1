#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/cli/commands.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/mesh/cloud_file.hpp"
#include "hosts/mesh/mesh_file.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {
namespace {

struct Stopped {};

/// Says what is being done, on the standard error stream. Throws Stopped after Ctrl-C.
void progress(const std::string& text) {
    if (interrupted()) throw Stopped();
    fmt::print(stderr, "{}\n", text);
}

std::vector<Surfel> read_map(const ExportConfig& config) {
    const std::filesystem::path file = std::filesystem::is_directory(config.map) ? config.map / "map.ply" : config.map;
    std::vector<Surfel> surfels = read_ply(file);
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
}

}  // namespace

int export_command(const ExportConfig& config) {
    check(config);
    try {
        const std::vector<Surfel> surfels = read_map(config);
        if (!config.cloud.empty()) {
            write_cloud(config.cloud, surfels);
            fmt::print("{}: {} points\n", config.cloud.string(), surfels.size());
        }
        if (!config.mesh.empty()) {
            const Mesh mesh = reconstruct_mesh(surfels, config.reconstruction, progress);
            write_mesh(config.mesh, mesh);
            fmt::print("{}: {} vertices, {} triangles\n", config.mesh.string(), mesh.vertices.size(),
                       mesh.faces.size());
        }
    } catch (const Stopped&) {
        return kExitInterrupted;
    }
    return kExitOk;
}

}  // namespace posefusion
