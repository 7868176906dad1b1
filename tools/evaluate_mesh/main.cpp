#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/recording.hpp"
#include "tools/evaluate_mesh/mesh_input.hpp"
#include "tools/evaluate_mesh/mesh_scores.hpp"
#include "tools/evaluate_mesh/seen_surface.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

TrueMesh moved(TrueMesh mesh, const Eigen::Isometry3d& T) {
    for (Eigen::Vector3f& p : mesh.vertices) p = T.cast<float>() * p;
    return mesh;
}

int evaluate_meshes(const fs::path& folder, const fs::path& run, const std::vector<std::string>& meshes, bool json,
                    const MeshScoreConfig& config) {
    const Recording recording(folder);
    const auto groundtruth = recording.groundtruth();
    if (!groundtruth) throw Error(folder.string() + ": has no groundtruth.txt, the true surface cannot be placed");
    const TrueMesh truth = read_true_mesh(folder / "surface.ply");
    const Eigen::Isometry3d T_truth_run = align_poses(*groundtruth, read_trajectory(run / "trajectory.txt"));
    const auto seen = seen_points(recording, truth, spread_points(truth, config.spacing));
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    constexpr double kPercent = 100, kMillimetres = 1000;
    if (!json)
        fmt::print("{:>10} {:>8} {:>9} {:>9} {:>9} {:>13}  mesh\n", "triangles", "area", "mean", "accuracy", "invented",
                   "completeness");
    for (const std::string& file : meshes) {
        const MeshScores s = score_mesh(truth, seen, moved(read_exported_mesh(file), T_truth_run), config);
        list.push_back({{"mesh", file},
                        {"triangles", s.triangles},
                        {"area_m2", s.area},
                        {"mean_distance_m", s.mean_distance},
                        {"accuracy", s.accuracy},
                        {"invented", s.invented},
                        {"completeness", s.completeness}});
        if (!json)
            fmt::print("{:10} {:5.1f} m2 {:6.1f} mm {:7.1f} % {:7.2f} % {:11.1f} %  {}\n", s.triangles, s.area,
                       kMillimetres * s.mean_distance, kPercent * s.accuracy, kPercent * s.invented,
                       kPercent * s.completeness, file);
    }
    if (json) fmt::print("{}\n", list.dump(2));
    return 0;
}

}  // namespace
}  // namespace posefusion

/// evaluate_mesh RECORDING RUN MESH...: meshes exported from RUN, measured against the true surface of RECORDING.
int main(int argc, char** argv) {
    CLI::App app{
        "Accuracy (share of the mesh near the true surface), completeness (share of the surface that the camera saw "
        "near "
        "the mesh) and what is invented (far from any true surface) of exported meshes"};
    std::string recording, run;
    std::vector<std::string> meshes;
    bool json = false;
    posefusion::MeshScoreConfig config;
    app.add_option("RECORDING", recording, "recording of `posefusion synth`")->required();
    app.add_option("RUN", run, "output folder of `posefusion run`: trajectory.txt places its world")->required();
    app.add_option("MESH", meshes, ".ply or .glb of `posefusion export RUN --mesh`")->required();
    app.add_option("--within", config.within, "what is nearer counts as right, metres")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--invented", config.invented, "what is farther counts as invented, metres")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_flag("--json", json, "print JSON");
    CLI11_PARSE(app, argc, argv);
    try {
        if (config.within > config.invented) throw posefusion::Error("--within must not be beyond --invented");
        return posefusion::evaluate_meshes(recording, run, meshes, json, config);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "error: %s\n", e.what());
        return 1;
    }
}
