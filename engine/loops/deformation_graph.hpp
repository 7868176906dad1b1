#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "engine/core/matrix6d.hpp"
#include "engine/loops/loop_config.hpp"
#include "engine/loops/loop_constraint.hpp"

/// The deformation graph of the map: what a closed loop bends. After Sumner, Schmid & Pauly, "Embedded deformation for
/// shape manipulation" (2007) and Whelan et al., "ElasticFusion" (2015); different from the latter:
///  * nodes cover space and time evenly, as many as that takes;
///  * who is whose neighbour is decided by one distance in space AND time, so that influence fades smoothly in both
///    and a surface and its drifted duplicate do not move each other;
///  * rotations are rotations: six unknowns per node, the rotation term ties those of neighbours.
/// World frame, metres; times are frame numbers.
namespace posefusion {

/// A surfel offered as a node.
struct GraphSample {
    Eigen::Vector3f position;
    std::uint32_t created = 0;
    std::uint32_t last_seen = 0;  ///< before `created`: taken as `created`
};

/// A frame of the trajectory.
struct GraphCamera {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    std::uint32_t frame = 0;
    /// Of the step from the camera before, (translation, rotation) in that camera's frame, 1/m^2 and 1/rad^2: the
    /// system that tracking solved. Zero where it found no pose.
    Matrix6d information = Matrix6d::Zero();
};

struct GraphNode {
    Eigen::Vector3d position;
    std::uint32_t time = 0;       ///< created
    std::uint32_t last_seen = 0;  ///< of what it stands for, >= time: a place that stays in view does not age
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Vector3d t = Eigen::Vector3d::Zero();

    /// Where this node alone takes a point: R (p - g) + g + t.
    [[nodiscard]] Eigen::Vector3d apply(const Eigen::Vector3d& p) const { return R * (p - position) + position + t; }
};

/// A tie between two nodes and the roots of its weights.
struct GraphEdge {
    std::uint32_t a = 0, b = 0;
    double rotation = 0, regularisation = 0;
};

/// A tie between two cameras.
struct CameraTie {
    std::uint32_t a = 0, b = 0;  ///< nodes
    Matrix6d root;               ///< of the weight of b's error (translation, rotation) as seen from a, world axes
};

/// Where and when there were samples: within place_size of `position`, from `created` to `last_seen`, frames.
struct GraphPlace {
    Eigen::Vector3d position;
    std::uint32_t created = 0, last_seen = 0;
};

/// Share of a node in the motion of a point; the shares of a point add up to 1.
struct Influence {
    std::uint32_t node;
    double weight;
};

/// The four nearest nodes move a point; weight (1 - d / d_fifth)^2 before normalisation. What is added to that 1 keeps
/// the sum from vanishing where all are equally far; it gives the fifth one millionth.
inline constexpr int kInfluences = 4;
inline constexpr double kInfluenceMargin = 1e-3;

class DeformationGraph {
public:
    DeformationGraph() = default;
    /// Nodes such that every sample has one within about node_spacing in space and time, and no two nodes are nearer to
    /// each other. Depends on nothing but the samples and their order. Samples that are not finite are left out. Throws
    /// Error if the configuration makes no sense.
    /// @param cameras  by frame; every camera_interval-th becomes a node that is tied to the next one, to the cameras
    ///                 that saw the same before, and to what it saw first: how the map came about, and so where drift
    ///                 can have crept in
    static DeformationGraph sample(std::span<const GraphSample> samples, const DeformationConfig& config,
                                   std::span<const GraphCamera> cameras = {});

    struct SolveResult {
        bool accepted = false;
        double constraint_error_before_m = 0,
               constraint_error_after_m = 0;  ///< mean distance of those that are not relative
        double energy_before = 0, energy_after = 0;
        double edge_error_m = 0;  ///< largest distance between where a node is and where a neighbour expects it, after
        int iterations = 0;
        std::string reason;  ///< why it was not accepted, one line; empty if it was
    };
    /// Finds the transforms of the nodes that meet the constraints with the least bending: sparse Gauss-Newton with
    /// analytic Jacobians. If not accepted the transforms stay as they were.
    /// @param fixed_before  nodes created before this frame stay as they are; 0: all are free
    SolveResult solve(std::span<const LoopConstraint> constraints, std::uint32_t fixed_before = 0);

    /// Where the map of `time` at `point` goes. Without nodes it stays.
    [[nodiscard]] Eigen::Vector3d deform(const Eigen::Vector3d& point, std::uint32_t time) const;
    /// ... and the camera of frame `time`: between the nodes of the cameras before and after it. In a graph without
    /// cameras: position like a point, rotation blended in the same way and projected onto SO(3); a camera is metres
    /// away from what it sees, so more nodes take part, of those seen at `time` above all.
    [[nodiscard]] Eigen::Isometry3d deform(const Eigen::Isometry3d& T_world_camera, std::uint32_t time) const;

    /// The nodes that move a point, by index.
    [[nodiscard]] std::vector<Influence> influences(const Eigen::Vector3d& point, std::uint32_t time) const;
    /// ... and a camera of frame `time` at `position`: the nodes of the cameras before and after it, where there are
    /// any.
    [[nodiscard]] std::vector<Influence> pose_influences(const Eigen::Vector3d& position, std::uint32_t time) const;

    /// Those of the map, by time.
    [[nodiscard]] std::span<const GraphNode> nodes() const { return std::span(nodes_).first(map_nodes_); }
    /// Those of cameras, by frame. Their indices in edges() and camera_ties() follow those of nodes().
    [[nodiscard]] std::span<const GraphNode> cameras() const { return std::span(nodes_).subspan(map_nodes_); }
    /// Every map node is tied to the nearest ones before it: the graph is connected.
    [[nodiscard]] const std::vector<GraphEdge>& edges() const { return edges_; }
    [[nodiscard]] const std::vector<CameraTie>& camera_ties() const { return camera_ties_; }
    [[nodiscard]] const std::vector<GraphPlace>& places() const { return places_; }
    [[nodiscard]] double place_size() const;
    [[nodiscard]] const DeformationConfig& config() const { return config_; }
    /// What one frame of absence beyond the temporal window adds to the distance in space and time, metres.
    [[nodiscard]] double metres_per_frame() const {
        return static_cast<double>(config_.node_spacing) / config_.temporal_window;
    }

private:
    void connect();
    void add_cameras(std::span<const GraphCamera> cameras);
    [[nodiscard]] double distance2(const Eigen::Vector3d& point, std::uint32_t time, const GraphNode& node,
                                   double time_factor = 1) const;
    [[nodiscard]] std::vector<Influence> influences(const Eigen::Vector3d& point, std::uint32_t time, int count,
                                                    double time_factor) const;

    DeformationConfig config_;
    std::vector<GraphNode> nodes_;
    std::size_t map_nodes_ = 0;
    std::vector<GraphEdge> edges_;
    std::vector<CameraTie> camera_ties_;
    std::vector<GraphPlace> places_;
};

}  // namespace posefusion
