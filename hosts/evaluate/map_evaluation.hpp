#pragma once
#include <filesystem>
#include <string>

#include "hosts/evaluate/duplicate_surface.hpp"
#include "hosts/evaluate/ghosts.hpp"

/// Ghosts and duplicate surfaces in the map of a run on a recording with ground truth.
namespace posefusion {

struct MapEvaluation {
    float max_distance = 0;    ///< beyond which a surfel counted as a ghost, metres
    GhostCount by_first_pose;  ///< map placed by the true pose of the first frame (world = first camera)
    GhostCount by_trajectory;  ///< map placed by the poses of the whole run: the rigid motion that best fits them to
                               ///< the true ones
    DuplicateSurface duplicate_surface;
};

/// @param recording  recording with groundtruth.txt and, where there are people, a folder `masks` with the true masks
/// @param run       output folder of `posefusion run`: map.ply and trajectory.txt
/// @param painted   if not empty: the map with its ghosts in red and its duplicate surfaces in yellow is written to
///                  this PLY file
/// Throws Error.
[[nodiscard]] MapEvaluation evaluate_map(const std::filesystem::path& recording, const std::filesystem::path& run,
                                         const GhostConfig& config = {}, const std::filesystem::path& painted = {},
                                         const DuplicateSurfaceConfig& layers = {});

[[nodiscard]] std::string map_evaluation_table(const MapEvaluation& evaluation);
[[nodiscard]] std::string map_evaluation_json(const MapEvaluation& evaluation);

}  // namespace posefusion
