#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "hosts/evaluate/map_evaluation.hpp"

/// evaluate_map RECORDING RUN: ghosts in RUN/map.ply, measured against the true static surface of RECORDING, and
/// surfaces that are there twice.
int main(int argc, char** argv) {
    CLI::App app{
        "Counts the surfels of a map that are not part of the true static scene (remains of people) and those with a "
        "second "
        "layer before or behind them (double walls)"};
    std::string recording, run, painted;
    bool json = false;
    posefusion::GhostConfig config;
    posefusion::DuplicateSurfaceConfig layers;
    app.add_option("RECORDING", recording, "recording in TUM layout with groundtruth.txt and masks/")->required();
    app.add_option("RUN", run, "output folder of `posefusion run`: map.ply and trajectory.txt")->required();
    app.add_option("--distance", config.max_distance,
                   "a surfel farther than this from the true surface is a ghost, metres")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_option("--layer-min", layers.min_offset, "distance of a second layer along the normal, at least, metres")
        ->capture_default_str();
    app.add_option("--layer-max", layers.max_offset, "distance of a second layer along the normal, at most, metres")
        ->capture_default_str();
    app.add_option("--visit-gap", layers.visit_gap, "layers begun this many frames apart are of different visits")
        ->capture_default_str();
    app.add_option("--painted", painted,
                   "write the map with its ghosts in red and its double surfaces in yellow to this PLY file");
    app.add_flag("--json", json, "print JSON");
    CLI11_PARSE(app, argc, argv);
    try {
        const auto evaluation = posefusion::evaluate_map(recording, run, config, painted, layers);
        std::fputs((json ? map_evaluation_json(evaluation) : map_evaluation_table(evaluation)).c_str(), stdout);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "error: %s\n", e.what());
        return 1;
    }
}
