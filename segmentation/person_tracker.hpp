#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "segmentation/skeleton.hpp"

/// People over time: who was seen where, and where they must be when the network misses them or parts of them.
namespace posefusion {

struct PersonTrack {
    int id = 0;         ///< unique over the life of the tracker, from 1
    Skeleton skeleton;  ///< current camera coordinates
    Eigen::Vector3f velocity =
        Eigen::Vector3f::Zero();  ///< metres per frame, current camera axes, camera motion excluded
    int seen = 0;                 ///< number of frames with a detection
    int age = 0;                  ///< frames since the last detection
    int missed = 0;               ///< consecutive frames on which the network ran and did not find the person
    bool detected = false;        ///< in this frame
    int nodes = 0;                ///< size of the mask in the last frame, nodes of the grid
};

struct TrackerConfig {
    int carry_frames = 15;       ///< a track ends after this many misses; joints not seen for as long are forgotten
    float gate = 0.3f;           ///< a detection farther than this from a track is another person, metres
    float gate_growth = 0.05f;   ///< added for each frame since the last detection, metres
    float duplicate = 0.25f;     ///< a missed track this near a detected one is the same person, metres
    float velocity_gain = 0.5f;  ///< weight of a new velocity against the old one, per detection
    float max_speed = 0.15f;     ///< metres per frame; faster is a wrong match
    int max_tracks = 64;         ///< the longest missed are dropped first
    float min_remaining =
        0.25f;  ///< a carried mask that shrinks to less than this share in one frame has lost its person
};

class PersonTracker {
public:
    explicit PersonTracker(const TrackerConfig& config) : config_(config) {}

    /// Moves every track to the current frame.
    void predict(const Eigen::Isometry3f& T_current_previous);
    /// Updates the tracks with the skeletons found; nullopt = the network did not run, no person counts as missed.
    void update(const std::optional<std::vector<Skeleton>>& detections, const DepthImage& depth,
                const Intrinsics& camera);
    /// Updates the tracks with the sizes of their masks in nodes (same order as tracks()): carried tracks with too few
    /// nodes end. Returns for each track whether it continues.
    std::vector<bool> confirm(const std::vector<int>& nodes);

    [[nodiscard]] const std::vector<PersonTrack>& tracks() const { return tracks_; }

    /// Everything that later calls depend on.
    void save(StateWriter& out) const;
    void load(StateReader& in);

private:
    void limit();
    void accept(PersonTrack& track, const Skeleton& detection, const DepthImage& depth, const Intrinsics& camera);

    TrackerConfig config_;
    std::vector<PersonTrack> tracks_;
    int next_id_ = 1;
};

}  // namespace posefusion
