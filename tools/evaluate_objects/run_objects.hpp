#pragma once
#include <filesystem>
#include <vector>

#include "tools/evaluate_objects/object_scores.hpp"

namespace posefusion {

/// The objects of a run: its folders objects/N with trajectory.txt and map.ply, N being the label or, below
/// kFirstObjectLabel, the number of the object from 1. None if there is no such folder. Throws Error.
[[nodiscard]] std::vector<EstimatedObject> read_run_objects(const std::filesystem::path& run);

}  // namespace posefusion
