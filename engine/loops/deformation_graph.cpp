#include "engine/loops/deformation_graph.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "engine/core/error.hpp"
#include "engine/core/median.hpp"
#include "engine/loops/camera_ties.hpp"

namespace posefusion {
namespace {

using Eigen::Vector3d;
using std::size_t;
using std::uint32_t;

constexpr int kThinning = 4;            // samples are thinned to one per cube of node_spacing / kThinning first
constexpr int kPoseInfluences = 12;     // nodes that move a camera ...
constexpr double kPoseTimeFactor = 10;  // ... for which a difference in time counts this many times as much

// The view cone of a camera node, and the share of common map nodes from which two views overlap.
constexpr double kViewDepth = 5, kViewSlope = 0.6;  // metres, tangent of the half angle
constexpr double kLeastShare = 0.1, kLeastVisible = 5;

/// Frames between `time` and the interval [created, last_seen]; 0 inside.
double absence(uint32_t time, uint32_t created, uint32_t last_seen) {
    if (time < created) return created - time;
    return time > last_seen ? time - last_seen : 0;
}

using Cell = std::array<std::int64_t, 3>;

Cell cell_of(const Vector3d& p, double size) {
    Cell cell;
    for (int i = 0; i < 3; ++i) cell[static_cast<size_t>(i)] = static_cast<std::int64_t>(std::floor(p[i] / size));
    return cell;
}

struct CellHash {
    size_t operator()(const Cell& c) const {
        std::uint64_t h = 0;
        for (const auto x : c) h = (h ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u, h ^= h >> 32;
        return static_cast<size_t>(h);
    }
};

/// Finite samples in the order of their creation, at most one per small cube and visit.
std::vector<GraphPlace> thinned(std::span<const GraphSample> samples, double cube, double window) {
    std::vector<uint32_t> order(samples.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto earlier = [&](uint32_t a, uint32_t b) { return samples[a].created < samples[b].created; };
    if (!std::is_sorted(order.begin(), order.end(), earlier)) std::stable_sort(order.begin(), order.end(), earlier);
    std::vector<GraphPlace> kept;
    std::unordered_map<Cell, uint32_t, CellHash> latest;  // index into kept
    constexpr float kReach = 1e6f;                        // metres; farther samples are treated as not finite
    for (const auto i : order) {
        const auto& s = samples[i];
        if (!s.position.allFinite() || s.position.cwiseAbs().maxCoeff() > kReach) continue;
        const Vector3d p = s.position.cast<double>();
        const auto [at, is_new] = latest.try_emplace(cell_of(p, cube), static_cast<uint32_t>(kept.size()));
        const uint32_t last_seen = std::max(s.last_seen, s.created);
        if (is_new || absence(s.created, kept[at->second].created, kept[at->second].last_seen) > window) {
            at->second = static_cast<uint32_t>(kept.size());
            kept.push_back({p, s.created, last_seen});
        } else {
            kept[at->second].last_seen = std::max(kept[at->second].last_seen, last_seen);
        }
    }
    return kept;
}

double median_variance(std::span<const Matrix6d> covariances) {
    std::vector<double> variances;
    for (const auto& covariance : covariances) variances.push_back(translation_variance(covariance));
    if (variances.empty()) return 1;
    return upper_median(variances);
}

void check_config(const DeformationConfig& c) {
    if (!(c.node_spacing > 0) || c.temporal_window < 1 || c.neighbours < 1 || c.iterations < 1 ||
        !(c.constraint_weight > 0) || !(c.correlated_pixels > 0)) {
        throw Error(
            "the deformation graph needs a node spacing, a temporal window, neighbours, iterations, correlated pixels "
            "and a constraint weight above 0");
    }
}

}  // namespace

DeformationGraph DeformationGraph::sample(std::span<const GraphSample> samples, const DeformationConfig& config,
                                          std::span<const GraphCamera> cameras) {
    check_config(config);
    DeformationGraph graph;
    graph.config_ = config;
    const double spacing = static_cast<double>(config.node_spacing);
    graph.places_ = thinned(samples, graph.place_size(), static_cast<double>(config.temporal_window) / kThinning);
    std::unordered_map<Cell, std::vector<uint32_t>, CellHash> cells;  // nodes in each cube of node_spacing
    for (const auto& s : graph.places_) {
        const Cell home = cell_of(s.position, spacing);
        double nearest = spacing * spacing;
        GraphNode* covering = nullptr;
        for (int k = 0; k < 27; ++k) {
            const auto found = cells.find({home[0] + k % 3 - 1, home[1] + k / 3 % 3 - 1, home[2] + k / 9 - 1});
            if (found == cells.end()) continue;
            for (const auto index : found->second) {
                auto& node = graph.nodes_[index];
                const double distance = graph.distance2(s.position, s.created, node);
                if (distance < nearest) nearest = distance, covering = &node;
            }
        }
        if (covering) {
            covering->last_seen = std::max(covering->last_seen, s.last_seen);
        } else {
            cells[home].push_back(static_cast<uint32_t>(graph.nodes_.size()));
            GraphNode node;
            node.position = s.position, node.time = s.created, node.last_seen = s.last_seen;
            graph.nodes_.push_back(node);
        }
    }
    graph.map_nodes_ = graph.nodes_.size();
    graph.connect();
    if (!graph.nodes_.empty()) graph.add_cameras(cameras);
    return graph;
}

double DeformationGraph::place_size() const { return static_cast<double>(config_.node_spacing) / kThinning; }

/// Squared distance of a point from a node in space and time.
double DeformationGraph::distance2(const Vector3d& point, uint32_t time, const GraphNode& node,
                                   double time_factor) const {
    const double frames = std::max(0.0, absence(time, node.time, node.last_seen) - config_.temporal_window);
    const double gap = time_factor * metres_per_frame() * frames;
    return (node.position - point).squaredNorm() + gap * gap;
}

void DeformationGraph::connect() {
    const auto count = static_cast<size_t>(config_.neighbours);
    std::vector<std::pair<double, uint32_t>> nearest;
    for (uint32_t j = 1; j < nodes_.size(); ++j) {
        nearest.clear();
        for (uint32_t i = 0; i < j; ++i) {
            const std::pair candidate{distance2(nodes_[j].position, nodes_[j].time, nodes_[i]), i};
            if (nearest.size() == count && !(candidate < nearest.back())) continue;
            if (nearest.size() == count) nearest.pop_back();
            nearest.insert(std::upper_bound(nearest.begin(), nearest.end(), candidate), candidate);
        }
        const double rotation = std::sqrt(static_cast<double>(DeformationConfig::kRotationWeight));
        const double regularisation = std::sqrt(static_cast<double>(DeformationConfig::kRegularisationWeight));
        for (const auto& [distance, i] : nearest) edges_.push_back({i, j, rotation, regularisation});
    }
}

void DeformationGraph::add_cameras(std::span<const GraphCamera> cameras) {
    const auto interval = static_cast<size_t>(std::max(1, DeformationConfig::kCameraInterval));
    std::vector<size_t> views;  // index into `cameras` of each camera node
    for (size_t i = 0; i < cameras.size(); ++i) {
        if (i % interval != 0 && i + 1 != cameras.size()) continue;
        GraphNode node;
        node.position = cameras[i].T_world_camera.translation();
        node.time = node.last_seen = cameras[i].frame;
        nodes_.push_back(node);
        views.push_back(i);
    }
    if (views.empty()) return;

    // covariance of each step between camera nodes; the one that corresponds to weight 1
    std::vector<Matrix6d> ways(views.size()), steps(views.size());
    for (size_t k = 1; k < views.size(); ++k) {
        ways[k] = way_covariance(cameras, views[k - 1], views[k], config_);
        steps[k] = step_covariance(cameras, views[k], config_);
    }
    const double usual_way = median_variance(std::span(ways).subspan(1)),
                 usual_step = median_variance(std::span(steps).subspan(1));
    const double stiff = std::sqrt(static_cast<double>(DeformationConfig::kOdometryWeight));
    const auto index_of = [&](size_t camera) { return static_cast<uint32_t>(map_nodes_ + camera); };
    // the camera node that first saw each map node
    std::vector<size_t> first_seen_by(map_nodes_);
    for (uint32_t i = 0; i < map_nodes_; ++i) {
        const auto later =
            std::lower_bound(nodes_.begin() + static_cast<std::ptrdiff_t>(map_nodes_), nodes_.end(), nodes_[i].time,
                             [](const GraphNode& camera, uint32_t time) { return camera.time < time; });
        const auto camera = std::min(static_cast<size_t>(later - nodes_.begin()) - map_nodes_, views.size() - 1);
        first_seen_by[i] = camera;
        edges_.push_back({i, index_of(camera), stiff, stiff});
    }
    std::vector<double> share(views.size());
    for (size_t k = 1; k < views.size(); ++k) {
        camera_ties_.push_back(
            {index_of(k - 1), index_of(k),
             whitening(ways[k] / (usual_way * static_cast<double>(DeformationConfig::kOdometryWeight)))});
        // the share of this view that each earlier camera saw first
        std::fill(share.begin(), share.end(), 0.0);
        double visible = 0;
        const Eigen::Isometry3d T_camera_world = cameras[views[k]].T_world_camera.inverse();
        for (uint32_t i = 0; i < map_nodes_; ++i) {
            const GraphNode& node = nodes_[i];
            if (absence(nodes_[index_of(k)].time, node.time, node.last_seen) > static_cast<double>(interval)) continue;
            const Vector3d p = T_camera_world * node.position;
            if (p.z() <= 0 || p.z() > kViewDepth || p.head<2>().norm() > kViewSlope * p.z()) continue;
            share[first_seen_by[i]] += 1;
            visible += 1;
        }
        for (size_t j = 0; j + 1 < k; ++j) {
            if (share[j] < kLeastShare * visible || visible < kLeastVisible) continue;
            // as stiff as a chain of ties of this weight: a tie across many cameras must not be stiffer than the chain
            const double links = static_cast<double>(k - j);
            const double weight =
                static_cast<double>(DeformationConfig::kCovisibilityWeight) * share[j] / visible / links;
            if (!(weight > 0)) continue;
            camera_ties_.push_back({index_of(j), index_of(k), whitening(steps[k] / (usual_step * weight))});
        }
    }
}

void DeformationGraph::follow(std::span<const GraphCamera> cameras, std::span<const Eigen::Isometry3d> poses) {
    constexpr size_t kSamples = 16;  // cameras whose mean a node follows
    if (cameras.size() != poses.size()) throw Error("each camera of the deformation graph needs one pose to follow");
    if (cameras.empty()) return;
    const auto first_from = [&](uint32_t frame) {
        const auto at = std::lower_bound(cameras.begin(), cameras.end(), frame,
                                         [](const GraphCamera& camera, uint32_t f) { return camera.frame < f; });
        return std::min(static_cast<size_t>(at - cameras.begin()), cameras.size() - 1);
    };
    for (GraphNode& node : nodes_) {
        const size_t first = first_from(node.time), last = std::max(first, first_from(node.last_seen));
        const size_t step = (last - first) / kSamples + 1;
        Eigen::Vector4d rotations = Eigen::Vector4d::Zero();
        Vector3d position = Vector3d::Zero();
        double count = 0;
        for (size_t k = first; k <= last; k += step, ++count) {
            const Eigen::Isometry3d motion = poses[k] * cameras[k].T_world_camera.inverse();
            Eigen::Vector4d rotation = Eigen::Quaterniond(motion.linear()).coeffs();
            if (rotation.dot(rotations) < 0) rotation = -rotation;
            rotations += rotation;
            position += motion * node.position;
        }
        node.R = Eigen::Quaterniond(rotations).normalized().toRotationMatrix();
        node.t = position / count - node.position;
    }
}

std::vector<Influence> DeformationGraph::influences(const Vector3d& point, uint32_t time, int count,
                                                    double time_factor) const {
    // the (count + 1)-th smallest distance, where weights reach zero; with too few nodes all weights are equal
    std::vector<double> least(static_cast<size_t>(count) + 1, std::numeric_limits<double>::infinity());
    for (const auto& node : nodes()) {
        const double distance = distance2(point, time, node, time_factor);
        if (distance >= least.back()) continue;
        least.pop_back();
        least.insert(std::upper_bound(least.begin(), least.end(), distance), distance);
    }
    const double reach = std::max(std::sqrt(least.back()), std::numeric_limits<double>::min());
    std::vector<Influence> result;
    double sum = 0;
    for (uint32_t i = 0; i < map_nodes_; ++i) {
        const double w = 1 + kInfluenceMargin - std::sqrt(distance2(point, time, nodes_[i], time_factor)) / reach;
        if (!(w > 0)) continue;
        result.push_back({i, w * w});
        sum += w * w;
    }
    for (auto& influence : result) influence.weight /= sum;
    return result;
}

std::vector<Influence> DeformationGraph::influences(const Vector3d& point, uint32_t time) const {
    return influences(point, time, kInfluences, 1);
}

Vector3d DeformationGraph::deform(const Vector3d& point, uint32_t time) const {
    const auto shares = influences(point, time);
    if (shares.empty()) return point;
    Vector3d result = Vector3d::Zero();
    for (const auto& share : shares) result += share.weight * nodes_[share.node].apply(point);
    return result;
}

std::vector<Influence> DeformationGraph::pose_influences(const Vector3d& position, uint32_t time) const {
    const auto all = cameras();
    if (all.empty()) return influences(position, time, kPoseInfluences, kPoseTimeFactor);
    const auto after = std::lower_bound(all.begin(), all.end(), time,
                                        [](const GraphNode& camera, uint32_t t) { return camera.time < t; });
    const auto index = static_cast<uint32_t>(map_nodes_ + static_cast<size_t>(after - all.begin()));
    if (after == all.end()) return {{index - 1, 1.0}};
    if (after == all.begin() || after->time == time) return {{index, 1.0}};
    const auto before = after - 1;
    const double share = static_cast<double>(time - before->time) / static_cast<double>(after->time - before->time);
    return {{index - 1, 1 - share}, {index, share}};
}

Eigen::Isometry3d DeformationGraph::deform(const Eigen::Isometry3d& T_world_camera, uint32_t time) const {
    const auto shares = pose_influences(T_world_camera.translation(), time);
    if (shares.empty()) return T_world_camera;
    Vector3d position = Vector3d::Zero();
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
    for (const auto& share : shares) {
        position += share.weight * nodes_[share.node].apply(T_world_camera.translation());
        rotation += share.weight * nodes_[share.node].R;
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation * T_world_camera.linear(),
                                                Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double handedness = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
    result.linear() = svd.matrixU() * Vector3d(1, 1, handedness).asDiagonal() * svd.matrixV().transpose();
    result.translation() = position;
    return result;
}

}  // namespace posefusion
