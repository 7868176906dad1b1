#include "hosts/evaluate/map_evaluation.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>

#include "engine/core/error.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/masks.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/io/recording.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// The true surface and the true camera poses it was seen from.
struct Truth {
    StaticSurface surface;
    Trajectory poses;
};

Truth build_truth(const Recording& recording, const Trajectory& groundtruth, const GhostConfig& config) {
    std::optional<MaskFolder> masks;
    if (fs::is_directory(fs::path(recording.location()) / "masks"))
        masks.emplace(fs::path(recording.location()) / "masks", recording);
    const std::vector<Stamp> stamps = stamps_of(groundtruth);
    Truth truth{StaticSurface(config), {}};
    for (std::size_t i = 0; i < recording.size(); ++i) {
        const auto pose = nearest_stamp(stamps, recording.frames()[i].stamp);
        if (!pose) continue;
        const auto labels = masks ? masks->load(recording.frames()[i].stamp) : LabelImage{};
        if (!labels) continue;  // the people in this image are not known
        truth.surface.add(recording.load(i).depth, *labels, recording.intrinsics(), groundtruth[*pose].T_world_camera);
        truth.poses.push_back(groundtruth[*pose]);
    }
    if (truth.poses.empty())
        throw Error(recording.location() + ": no frame has a ground-truth pose (and mask) within 20 ms");
    return truth;
}

/// World of the run = its first camera, up to the identity that the run starts from.
Eigen::Isometry3d first_pose_alignment(const Trajectory& groundtruth, const Trajectory& estimate) {
    const auto pairs = associate(stamps_of(groundtruth), stamps_of(estimate));
    if (pairs.empty()) throw Error("no estimated pose has a ground-truth pose within 20 ms");
    const auto [g, e] = pairs.front();
    return groundtruth[g].T_world_camera * estimate[e].T_world_camera.inverse();
}

void paint(const fs::path& file, std::vector<Surfel> map, const std::vector<std::uint8_t>& is_ghost,
           const std::vector<std::uint8_t>& is_duplicated) {
    for (std::size_t i = 0; i < map.size(); ++i) {
        if (is_duplicated[i] != 0) map[i].color = {255, 255, 0};
        if (is_ghost[i] != 0) map[i].color = {255, 0, 0};
    }
    write_ply(file, map, {"PoseFusion map, ghosts in red, duplicate surfaces in yellow"});
}

std::string row(const char* name, const GhostCount& c) {
    constexpr double kPercent = 100;
    return fmt::format("{:<26} {:9} {:9} {:9.3f} % {:19}\n", name, c.surfels, c.ghosts, kPercent * c.fraction(),
                       c.noise);
}

nlohmann::ordered_json to_json(const GhostCount& c) {
    return {{"surfels", c.surfels}, {"ghosts", c.ghosts}, {"fraction", c.fraction()}, {"within_depth_noise", c.noise}};
}

nlohmann::ordered_json to_json(const DuplicateSurface& d) {
    return {{"surfels", d.surfels},
            {"duplicated", d.duplicated},
            {"fraction", d.fraction()},
            {"revisited", d.revisited},
            {"revisited_fraction", d.revisited_fraction()}};
}

}  // namespace

MapEvaluation evaluate_map(const fs::path& recording_folder, const fs::path& run, const GhostConfig& config,
                           const fs::path& painted, const DuplicateSurfaceConfig& layers) {
    const std::vector<Surfel> map = read_ply(run / "map.ply");
    if (map.empty()) throw Error((run / "map.ply").string() + ": holds no surfels");
    const Trajectory estimate = read_trajectory(run / "trajectory.txt");
    const Recording recording(recording_folder);
    const auto groundtruth = recording.groundtruth();
    if (!groundtruth)
        throw Error(recording_folder.string() + ": has no groundtruth.txt, the true surface is not known");

    const Eigen::Isometry3d by_first_pose = first_pose_alignment(*groundtruth, estimate);
    const Eigen::Isometry3d by_trajectory = align_poses(*groundtruth, estimate);
    const Truth truth = build_truth(recording, *groundtruth, config);
    const auto count = [&](const Eigen::Isometry3d& T_truth_map, std::vector<std::uint8_t>* is_ghost) {
        return count_ghosts(truth.surface, map, T_truth_map, truth.poses, recording.intrinsics(), config, is_ghost);
    };
    std::vector<std::uint8_t> is_ghost, is_duplicated;
    const MapEvaluation evaluation{config.max_distance, count(by_first_pose, &is_ghost), count(by_trajectory, nullptr),
                                   find_duplicate_surface(map, layers, &is_duplicated)};
    if (!painted.empty()) paint(painted, map, is_ghost, is_duplicated);
    return evaluation;
}

std::string map_evaluation_table(const MapEvaluation& e) {
    constexpr double kCentimetres = 100;
    return fmt::format("Ghosts: surfels more than {:.1f} cm from the true static surface\n",
                       kCentimetres * e.max_distance) +
           fmt::format("{:<26} {:>9} {:>9} {:>11} {:>19}\n", "map placed by", "surfels", "ghosts", "share",
                       "within depth noise") +
           row("true pose of first frame", e.by_first_pose) + row("all true poses", e.by_trajectory) +
           fmt::format(
               "Duplicate surface: {} of {} surfels ({:.3f} %) have a second layer, {} ({:.3f} %) one of another "
               "visit\n",
               e.duplicate_surface.duplicated, e.duplicate_surface.surfels, 100 * e.duplicate_surface.fraction(),
               e.duplicate_surface.revisited, 100 * e.duplicate_surface.revisited_fraction());
}

std::string map_evaluation_json(const MapEvaluation& e) {
    const nlohmann::ordered_json json{{"max_distance_m", e.max_distance},
                                      {"by_first_pose", to_json(e.by_first_pose)},
                                      {"by_trajectory", to_json(e.by_trajectory)},
                                      {"duplicate_surface", to_json(e.duplicate_surface)}};
    return json.dump(2) + "\n";
}

}  // namespace posefusion
