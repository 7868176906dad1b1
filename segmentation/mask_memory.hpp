#pragma once
#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "segmentation/node_grid.hpp"

/// Memory of earlier frames, projected into the current view: where people were, and which static surface lies there or
/// behind them.
namespace posefusion {

/// The memory at one node of the current grid.
struct Memory {
    int person = 0;          ///< id of the person expected here, 0 = none
    float person_depth = 0;  ///< expected depth of the person, metres
    float static_depth = 0;  ///< depth of the static surface, metres; 0 = never seen
    float nearest_static =
        0;  ///< smallest static depth among the node and its neighbours; 0 = one of them was never seen
    float color_change =
        0;  ///< colour difference of a node without depth from the most similar static colour remembered there
};

struct MemoryConfig {
    int behind_people = 90;       ///< frames for which a static surface is remembered while a person hides it
    int behind_static = 10;       ///< same while something else hides it, which is then accepted as static
    float step_in_front = 0.08f;  ///< nearer than a static surface by this hides it, metres, beyond noise
};

class MaskMemory {
public:
    explicit MaskMemory(const MemoryConfig& config) : config_(config) {}

    /// Projects the memory into the current grid: static surfaces by the camera's motion, people by their own as well.
    /// displacement(id): motion of a person since the last frame, metres, previous camera axes. The nearest points win.
    [[nodiscard]] std::vector<Memory> recall(const NodeGrid& grid, const Eigen::Isometry3f& T_current_previous,
                                             const std::function<Eigen::Vector3f(int)>& displacement);
    /// Stores the labelled points of a frame: person[i] is the id of the person at node i, 0 = static. Static surfaces
    /// behind people are kept as recall() found them.
    void remember(const NodeGrid& grid, const std::vector<int>& person);

    /// Everything that later calls depend on, between a remember() and the next recall().
    void save(StateWriter& out) const;
    void load(StateReader& in);

private:
    struct StaticPoint {
        Eigen::Vector3f point;
        Eigen::Vector3f color;
        float age;  ///< grows from 0 when last seen to 1 when forgotten
    };
    struct PersonPoint {
        Eigen::Vector3f point;
        int person;
    };
    void compare_around(const NodeGrid& grid, int x, int y, std::vector<Memory>& memory) const;

    MemoryConfig config_;
    std::vector<StaticPoint> static_points_;
    std::vector<PersonPoint> person_points_;
    std::vector<StaticPoint> recalled_;  ///< per node of the current grid; z = 0 where there is none
};

}  // namespace posefusion
