#include "segmentation/image_segmenter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "segmentation/evidence.hpp"
#include "segmentation/grid_cut.hpp"
#include "segmentation/mask_memory.hpp"
#include "segmentation/node_grid.hpp"
#include "segmentation/person_tracker.hpp"
#include "segmentation/refinement.hpp"
#include "segmentation/skeleton.hpp"
#include "segmentation/support_planes.hpp"

namespace posefusion {
namespace {

/// The lengths of eq. (3) at a radius. At the default the factor is exactly 1.
EvidenceConfig evidence_at(float radius) {
    const float relative = radius / SegmentationConfig{}.radius;
    EvidenceConfig config;
    config.border *= relative;
    config.scale *= relative;
    config.margin *= relative;
    return config;
}

/// The lengths of eq. (2) at a sigma.
SmoothnessConfig smoothness_at(float sigma) {
    SmoothnessConfig config;
    config.depth_sigma *= sigma / SegmentationConfig{}.sigma;
    return config;
}
RefinementConfig refinement_at(float sigma) {
    RefinementConfig config;
    config.depth_sigma *= sigma / SegmentationConfig{}.sigma;
    return config;
}

class ImageSegmenter final : public Segmenter {
public:
    ImageSegmenter(const SegmentationConfig& config, const Intrinsics& camera, const DepthNoise& noise)
        : camera_(camera),
          noise_(noise),
          step_(node_step(camera)),
          evidence_(evidence_at(config.radius)),
          smoothness_(smoothness_at(config.sigma)),
          refinement_(refinement_at(config.sigma)),
          tracker_({.carry_frames = config.carry_frames}),
          memory_({}) {
        evidence_.motion_reach = config.reach;
        evidence_.motion_near = std::min(evidence_.motion_near, config.reach);
    }

    Segmentation segment(const ColorImage& color, const DepthImage& depth, const std::optional<People>& people,
                         const Eigen::Isometry3f& T_previous_current) override;

    ByteArray state() const override {
        StateWriter out;
        tracker_.save(out);
        memory_.save(out);
        return out.take();
    }
    void restore(std::span<const std::byte> state) override {
        StateReader in(state, "the state of the segmentation");
        tracker_.load(in);
        memory_.load(in);
        in.end();
    }

private:
    [[nodiscard]] std::vector<Memory> recall(const NodeGrid& grid, const Eigen::Isometry3f& T_current_previous);
    [[nodiscard]] std::optional<std::vector<Skeleton>> lift(const std::optional<People>& people,
                                                            const DepthImage& depth) const;
    [[nodiscard]] std::vector<std::uint8_t> cut(const NodeGrid& grid, const std::vector<Memory>& memory) const;
    void confirm_tracks(std::vector<std::uint8_t>& labels);
    void remember(const NodeGrid& grid, const std::vector<std::uint8_t>& labels);

    Intrinsics camera_;
    DepthNoise noise_;
    int step_;  ///< pixels per node
    LiftingConfig lifting_;
    EvidenceConfig evidence_;
    SupportConfig support_;
    SmoothnessConfig smoothness_;
    RefinementConfig refinement_;
    PersonTracker tracker_;
    MaskMemory memory_;
};

Segmentation ImageSegmenter::segment(const ColorImage& color, const DepthImage& depth,
                                     const std::optional<People>& people, const Eigen::Isometry3f& T_previous_current) {
    const Eigen::Isometry3f T_current_previous =
        T_previous_current.matrix().allFinite() ? T_previous_current.inverse() : Eigen::Isometry3f::Identity();
    const NodeGrid grid = make_node_grid(color, depth, camera_, noise_, step_);
    const std::vector<Memory> memory = recall(grid, T_current_previous);
    tracker_.predict(T_current_previous);
    tracker_.update(lift(people, depth), depth, camera_);
    std::vector<std::uint8_t> labels = cut(grid, memory);
    confirm_tracks(labels);
    remember(grid, labels);

    const std::vector<PersonTrack>& tracks = tracker_.tracks();
    Segmentation result;
    result.labels = refine_labels(grid, labels, color, depth, refinement_);
    for (const PersonTrack& track : tracks) result.skeletons.push_back(track.skeleton);
    result.people = static_cast<int>(tracks.size());
    result.carried = static_cast<int>(
        std::count_if(tracks.begin(), tracks.end(), [](const PersonTrack& track) { return !track.detected; }));
    return result;
}

std::vector<Memory> ImageSegmenter::recall(const NodeGrid& grid, const Eigen::Isometry3f& T_current_previous) {
    return memory_.recall(grid, T_current_previous, [this](int id) -> Eigen::Vector3f {
        for (const PersonTrack& track : tracker_.tracks())
            if (track.id == id) return track.velocity;
        return Eigen::Vector3f::Zero();
    });
}

std::optional<std::vector<Skeleton>> ImageSegmenter::lift(const std::optional<People>& people,
                                                          const DepthImage& depth) const {
    if (!people) return std::nullopt;
    std::vector<Skeleton> skeletons;
    for (std::size_t p = 0; p < people->size() && p < kMaxPeople; ++p)
        if (const auto skeleton = lift_skeleton((*people)[p], depth, camera_, lifting_)) skeletons.push_back(*skeleton);
    return skeletons;
}

/// One cut for all people; a node goes to the person with the strongest evidence.
std::vector<std::uint8_t> ImageSegmenter::cut(const NodeGrid& grid, const std::vector<Memory>& memory) const {
    if (tracker_.tracks().empty()) return std::vector<std::uint8_t>(grid.nodes.size(), 0);
    const Evidence evidence = gather_evidence(grid, tracker_.tracks(), memory, evidence_, support_);
    std::vector<std::uint8_t> labels = cut_grid(grid, evidence.preference, smoothness_);
    for (std::size_t i = 0; i < labels.size(); ++i)
        if (labels[i]) labels[i] = evidence.person[i];
    return labels;
}

/// Ends tracks without a mask and closes the gaps in the numbering.
void ImageSegmenter::confirm_tracks(std::vector<std::uint8_t>& labels) {
    std::vector<int> nodes(tracker_.tracks().size(), 0);
    for (const std::uint8_t label : labels)
        if (label) ++nodes[label - 1u];
    std::vector<std::uint8_t> renumbered{0};
    std::uint8_t next = 1;
    for (const bool lives : tracker_.confirm(nodes)) renumbered.push_back(lives ? next++ : std::uint8_t{0});
    for (std::uint8_t& label : labels) label = renumbered[label];
}

void ImageSegmenter::remember(const NodeGrid& grid, const std::vector<std::uint8_t>& labels) {
    std::vector<int> ids(labels.size(), 0);
    for (std::size_t i = 0; i < labels.size(); ++i)
        if (labels[i]) ids[i] = tracker_.tracks()[labels[i] - 1u].id;
    memory_.remember(grid, ids);
}

}  // namespace

std::unique_ptr<Segmenter> make_image_segmenter(const SegmentationConfig& config, const Intrinsics& camera,
                                                const DepthNoise& noise) {
    return std::make_unique<ImageSegmenter>(config, camera, noise);
}

}  // namespace posefusion
