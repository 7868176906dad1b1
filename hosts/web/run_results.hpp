#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/intrinsics.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/web/people_file.hpp"

/// What a run left in its folder, apart from the map.
namespace posefusion {

struct RunResults {
    Trajectory trajectory;
    std::vector<std::size_t> frames;                         ///< of each pose: which frame of the run it is, from 0
    std::vector<std::size_t> keyframes;                      ///< positions in `trajectory`, ascending
    std::size_t frames_of_run = 0;                           ///< with and without a pose
    std::optional<Intrinsics> camera;                        ///< of the images as the run used them
    std::vector<std::pair<std::string, std::string>> facts;  ///< of the run, to be read
    std::vector<FollowedPerson> people;                      ///< empty: nobody, or not known
};

/// Reads trajectory.txt and, where they are there, stats.json and people.json. Throws Error: no trajectory, or files
/// that no run wrote.
[[nodiscard]] RunResults read_run_results(const std::filesystem::path& folder);

}  // namespace posefusion
