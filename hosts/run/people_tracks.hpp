#pragma once
#include <Eigen/Geometry>
#include <array>
#include <span>
#include <vector>

#include "engine/core/image.hpp"
#include "hosts/io/stamp.hpp"
#include "segmentation/skeleton.hpp"

/// Who is who over a whole run: people under ids that stay, as long as their joints in the world can tell. The tracks
/// of the segmentation (segmentation/person_tracker.hpp) live in the camera, by a motion that is only predicted, and
/// end with a mask; these come after tracking, when the pose of the camera is known.
namespace posefusion {

/// A person as seen in a frame.
struct PersonInView {
    struct Joint {
        Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< camera coordinates, metres
        float confidence = 0;                             ///< [0, 1]; 0 = not seen
    };
    int id = 0;
    std::array<Joint, kJointCount> joints{};
};

/// Joints whose depth was not measured, but inferred from the bones, have so much of the confidence of the network.
inline constexpr float kInferredConfidence = 0.5f;

/// Those of the skeletons that were detected in the frame itself. @param ids  of each
[[nodiscard]] std::vector<PersonInView> people_in_view(std::span<const Skeleton> skeletons, std::span<const int> ids);

struct PeopleTracksConfig {
    static constexpr double kGap_s = 3;  ///< who is not seen for longer comes back as somebody else
    /// Farther than this from where a track is expected is another person: metres, and metres per second since it was
    /// last seen, as people turn around; but never more than the last.
    static constexpr double kGate_m = 0.4, kGateGrowth_m_s = 0.8, kWidestGate_m = 1.5;
    static constexpr double kVelocityGain = 0.5;  ///< weight of a new velocity against the old one
    static constexpr double kTopSpeed_m_s = 3;    ///< of a person; faster is a wrong match
    /// Who is not seen goes on at the velocity last seen, which fades with this time.
    static constexpr double kFading_s = 0.7;
};

/// Joints are assigned to the tracks of a constant velocity model in the world, the nearest pairs first. Deterministic:
/// same calls, same ids.
class PeopleTracks {
public:
    /// The next frame.
    /// @param skeletons     camera coordinates. A detected one updates its track or begins one; one that is only
    /// carried
    ///                      (JointSource::Carried) changes nothing
    /// @param T_world_camera, T_world_tracked  as in FrameResult: by the difference, the world itself has moved
    /// @return for each skeleton the id of its track, from 1, in the order of first sight; 0: of none
    std::vector<int> update(std::span<const Skeleton> skeletons, const Eigen::Isometry3d& T_world_camera,
                            const Eigen::Isometry3d& T_world_tracked, Stamp stamp);
    /// The same for what was seen in a frame of an earlier run, which the next update() continues.
    void replay(std::span<const PersonInView> people, const Eigen::Isometry3d& T_world_camera,
                const Eigen::Isometry3d& T_world_tracked, Stamp stamp);

private:
    struct Track {
        int id = 0;
        Skeleton skeleton;                                   ///< where it was last seen, world coordinates
        Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< metres per second, world axes
        Stamp seen{};
    };
    void move_world(const Eigen::Isometry3d& T_new_old);
    std::vector<int> assign(const std::vector<Skeleton>& skeletons, Stamp stamp);
    void accept(Track& track, const Skeleton& skeleton, Stamp stamp);

    std::vector<Track> tracks_;  // in the order of their ids
    int next_id_ = 1;
};

/// The labels of people with the id of each in place of its number; without an id it keeps that. Ids that an image of
/// labels has no room for begin again at 1.
/// @param ids  of person 1..n; empty: nothing changes
[[nodiscard]] LabelImage labels_by_id(LabelImage labels, std::span<const int> ids);

}  // namespace posefusion
