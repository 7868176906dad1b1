#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>

#include "tools/evaluate_objects/report.hpp"

/// evaluate_objects RECORDING RUN: what RUN left out as moving and its models of objects, measured against the true
/// masks and objects of RECORDING.
int main(int argc, char** argv) {
    CLI::App app{
        "Compares what a run found to move with what moves: recall and precision of its masks, and for each true "
        "object "
        "the trajectory, the mask and the model that the run has of it"};
    std::string recording, run;
    bool json = false;
    posefusion::MotionConfig motion;
    app.add_option("RECORDING", recording,
                   "recording of `posefusion synth --scenario movers`, or with masks/ or movers/")
        ->required();
    app.add_option("RUN", run, "output folder of `posefusion run --save-masks`")->required();
    app.add_option("--settled", motion.settled,
                   "frames after the motion of an object begins from which on it has to be known")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    app.add_flag("--json", json, "print JSON");
    CLI11_PARSE(app, argc, argv);
    try {
        const auto evaluation = posefusion::evaluate_objects(recording, run, motion);
        std::fputs((json ? object_evaluation_json(evaluation) : object_evaluation_table(evaluation)).c_str(), stdout);
        return 0;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "error: %s\n", e.what());
        return 1;
    }
}
