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

/// The deformation graph of the map: deformed when a loop is closed. After Sumner, Schmid & Pauly, "Embedded
/// deformation for shape manipulation" (2007) and Whelan et al., "ElasticFusion" (2015); different from the latter:
///  * nodes cover space and time evenly; their number follows from that;
///  * neighbours are found by one distance in space AND time, so that influence fades smoothly in both
///    and a surface and its drifted duplicate do not move each other;
///  * rotations are rotations: six unknowns per node, the rotation term ties those of neighbours.
/// World frame, metres; times are frame numbers.
namespace posefusion {

/// A surfel that may become a node.
struct GraphSample {
    Eigen::Vector3f position;
    std::uint32_t created = 0;
    std::uint32_t last_seen = 0;  ///< values before `created` count as `created`
};

/// A frame of the trajectory.
struct GraphCamera {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    std::uint32_t frame = 0;
    /// Information matrix of the step from the previous camera, (translation, rotation) in that camera's frame, 1/m^2
    /// and 1/rad^2: the normal equations of tracking. Zero where tracking failed.
    Matrix6d information = Matrix6d::Zero();
};

struct GraphNode {
    Eigen::Vector3d position;
    std::uint32_t time = 0;       ///< created
    std::uint32_t last_seen = 0;  ///< of the surface it represents, >= time: a surface that stays in view does not age
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Vector3d t = Eigen::Vector3d::Zero();

    /// A point transformed by this node alone: R (p - g) + g + t.
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
    Matrix6d root;  ///< square root of the weight of b's error (translation, rotation) relative to a, world axes
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

/// The four nearest nodes move a point; weight (1 - d / d_fifth)^2 before normalisation. The margin added to that 1
/// keeps the sum from vanishing where all five are equally far; the fifth would weigh one millionth.
inline constexpr int kInfluences = 4;
inline constexpr double kInfluenceMargin = 1e-3;

class DeformationGraph {
public:
    DeformationGraph() = default;
    /// Nodes such that every sample has one within about node_spacing in space and time, and no two nodes are nearer to
    /// each other. Deterministic: depends only on the samples and their order. Samples that are not finite are left
    /// out. Throws Error if the configuration is invalid.
    /// @param cameras  by frame; every camera_interval-th becomes a node that is tied to the next one, to earlier
    /// cameras that saw the same surfaces, and to the map nodes it saw first. The ties describe how the map was built,
    /// and so where drift can have accumulated
    static DeformationGraph sample(std::span<const GraphSample> samples, const DeformationConfig& config,
                                   std::span<const GraphCamera> cameras = {});

    struct SolveResult {
        bool accepted = false;
        double constraint_error_before_m = 0,
               constraint_error_after_m = 0;  ///< mean distance of the absolute ones
        double energy_before = 0, energy_after = 0;
        double edge_error_m =
            0;  ///< largest distance between a node and the position a neighbour predicts for it, afterwards
        int iterations = 0;
        std::string reason;  ///< why it was not accepted, one line; empty if it was
    };
    /// Finds the node transforms that satisfy the constraints with the least deformation: sparse Gauss-Newton with
    /// analytic Jacobians. A rejected solution leaves the transforms unchanged.
    /// @param fixed_before  nodes created before this frame are fixed; 0: all are free
    SolveResult solve(std::span<const LoopConstraint> constraints, std::uint32_t fixed_before = 0);

    /// The surfaces follow cameras whose poses are known better: each node moves as the cameras that saw it do in the
    /// mean, each camera as its own pose.
    /// @param cameras  of sample(), by frame  @param poses  T_world_camera of each, as they should be
    void follow(std::span<const GraphCamera> cameras, std::span<const Eigen::Isometry3d> poses);

    /// The deformed position of the surface at `point` that was created at `time`. Unchanged without nodes.
    [[nodiscard]] Eigen::Vector3d deform(const Eigen::Vector3d& point, std::uint32_t time) const;
    /// The deformed pose of the camera of frame `time`: interpolated between the nodes of the cameras before and after
    /// it. In a graph without camera nodes the position is deformed like a point, the rotation is blended in the same
    /// way and projected onto SO(3); as a camera is metres away from what it sees, more nodes take part, above all
    /// those seen at `time`.
    [[nodiscard]] Eigen::Isometry3d deform(const Eigen::Isometry3d& T_world_camera, std::uint32_t time) const;

    /// The nodes that influence a point, by index.
    [[nodiscard]] std::vector<Influence> influences(const Eigen::Vector3d& point, std::uint32_t time) const;
    /// The nodes that influence the camera of frame `time` at `position`: those of the cameras before and after it,
    /// where there are any.
    [[nodiscard]] std::vector<Influence> pose_influences(const Eigen::Vector3d& position, std::uint32_t time) const;

    /// Nodes of the map, in order of time.
    [[nodiscard]] std::span<const GraphNode> nodes() const { return std::span(nodes_).first(map_nodes_); }
    /// Nodes of cameras, in order of frames. Their indices in edges() and camera_ties() follow those of nodes().
    [[nodiscard]] std::span<const GraphNode> cameras() const { return std::span(nodes_).subspan(map_nodes_); }
    /// Every map node is tied to the nearest ones before it: the graph is connected.
    [[nodiscard]] const std::vector<GraphEdge>& edges() const { return edges_; }
    [[nodiscard]] const std::vector<CameraTie>& camera_ties() const { return camera_ties_; }
    [[nodiscard]] const std::vector<GraphPlace>& places() const { return places_; }
    [[nodiscard]] double place_size() const;
    [[nodiscard]] const DeformationConfig& config() const { return config_; }
    /// The distance that one frame of absence beyond the temporal window counts as, metres.
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
