#pragma once
#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "hosts/io/stamp.hpp"
#include "pose/joints.hpp"

/// The people.json of a run, see docs/files.md.
namespace posefusion {

/// Where the joints of a person were in a frame.
struct Sighting {
    Stamp stamp{};
    std::array<std::optional<Eigen::Vector3d>, kJointCount> joints;  ///< world frame, metres; nullopt: not seen
};

/// A person who was followed.
struct FollowedPerson {
    int id = 0;
    std::vector<Sighting> sightings;  ///< in the order of time
};

/// Throws Error: cannot be read, or is no such file, or of another version.
[[nodiscard]] std::vector<FollowedPerson> read_people(const std::filesystem::path& file);

}  // namespace posefusion
