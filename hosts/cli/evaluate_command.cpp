#include <fmt/format.h>

#include "hosts/cli/commands.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/trajectory.hpp"

namespace posefusion {

int evaluate_command(const std::filesystem::path& groundtruth, const std::filesystem::path& estimate, bool json) {
    const Evaluation evaluation = evaluate(read_trajectory(groundtruth), read_trajectory(estimate));
    fmt::print("{}", json ? evaluation_json(evaluation) : evaluation_table(evaluation));
    return kExitOk;
}

}  // namespace posefusion
