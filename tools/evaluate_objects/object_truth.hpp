#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "hosts/io/trajectory.hpp"

/// The true objects of a recording of `posefusion synth --scenario movers`.
namespace posefusion {

/// Labels of objects in masks; below are people.
inline constexpr int kFirstObjectLabel = 101;

struct TrueMesh {
    std::vector<Eigen::Vector3f> vertices;  ///< metres, frame of the object
    std::vector<std::array<std::uint32_t, 3>> faces;

    /// Middle of its bounding box: what its trajectory is measured at.
    [[nodiscard]] Eigen::Vector3d middle() const;
};

struct TrueObject {
    std::string kind;
    int label = 0;  ///< in the masks
    bool rigid = true;
    Trajectory poses;  ///< T_world_object
    TrueMesh mesh;
};

/// Those that have a label, from info.json; none if the recording has no objects. Throws Error.
[[nodiscard]] std::vector<TrueObject> read_true_objects(const std::filesystem::path& recording);

/// As posefusion writes meshes: binary PLY of triangles. Throws Error.
[[nodiscard]] TrueMesh read_true_mesh(const std::filesystem::path& file);

struct MotionConfig {
    double window = 0.35;  ///< seconds over which a way is measured
    double way = 0.01;     ///< metres in that time from which on an object moves
    int settled = 10;      ///< frames after the motion begins from which on it has to be known
};

/// What an object does in a frame.
enum class ObjectState : std::uint8_t {
    Stands,  ///< or moves hardly
    Begins,  ///< moves, but since less than MotionConfig::settled frames
    Moves,
};

/// One per pose of its trajectory. A point of its surface far from its origin counts, so that turning is motion, too.
[[nodiscard]] std::vector<ObjectState> states_of(const TrueObject& object, const MotionConfig& config = {});

}  // namespace posefusion
