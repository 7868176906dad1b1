#include "hosts/run/people_tracks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "engine/core/motion_judge.hpp"

namespace posefusion {
namespace {

using Config = PeopleTracksConfig;

bool seen_now(const Skeleton& skeleton, int joint) {
    return skeleton.source[joint] == JointSource::Measured || skeleton.source[joint] == JointSource::Inferred;
}

bool detected(const Skeleton& skeleton) {
    for (int j = 0; j < kJointCount; ++j)
        if (seen_now(skeleton, j)) return true;
    return false;
}

Skeleton moved(Skeleton skeleton, const Eigen::Isometry3d& T) {
    for (int j = 0; j < kJointCount; ++j)
        if (skeleton.has(j)) skeleton.joint[j] = (T * skeleton.joint[j].cast<double>()).cast<float>();
    skeleton.occluders.clear();
    return skeleton;
}

/// Mean way of the joints that both have; nullopt: they share none.
std::optional<Eigen::Vector3d> way_between(const Skeleton& from, const Skeleton& to) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (int j = 0; j < kJointCount; ++j)
        if (from.has(j) && to.has(j)) sum += (to.joint[j] - from.joint[j]).cast<double>(), ++count;
    return count == 0 ? std::nullopt : std::optional<Eigen::Vector3d>(sum / count);
}

Skeleton expected(const Skeleton& last, const Eigen::Vector3d& velocity, double seconds) {
    const double faded = Config::kFading_s * (1 - std::exp(-seconds / Config::kFading_s));
    return moved(last, Eigen::Isometry3d(Eigen::Translation3d(faded * velocity)));
}

Skeleton skeleton_of(const PersonInView& person) {
    Skeleton skeleton;
    for (int j = 0; j < kJointCount; ++j) {
        if (person.joints[j].confidence <= 0) continue;
        skeleton.joint[j] = person.joints[j].point;
        skeleton.source[j] = JointSource::Measured;
    }
    return skeleton;
}

}  // namespace

std::vector<PersonInView> people_in_view(std::span<const Skeleton> skeletons, std::span<const int> ids) {
    std::vector<PersonInView> people;
    for (std::size_t i = 0; i < skeletons.size(); ++i) {
        const Skeleton& skeleton = skeletons[i];
        if (!detected(skeleton)) continue;
        PersonInView& person = people.emplace_back();
        person.id = ids[i];
        for (int j = 0; j < kJointCount; ++j) {
            if (!seen_now(skeleton, j)) continue;
            const bool inferred = skeleton.source[j] == JointSource::Inferred;
            person.joints[j] = {skeleton.joint[j], skeleton.confidence[j] * (inferred ? kInferredConfidence : 1)};
        }
    }
    return people;
}

std::vector<int> PeopleTracks::update(std::span<const Skeleton> skeletons, const Eigen::Isometry3d& T_world_camera,
                                      const Eigen::Isometry3d& T_world_tracked, Stamp stamp) {
    move_world(T_world_camera * T_world_tracked.inverse());
    std::erase_if(tracks_, [&](const Track& track) { return to_seconds(stamp - track.seen) > Config::kGap_s; });
    std::vector<Skeleton> in_world;
    for (const Skeleton& skeleton : skeletons) in_world.push_back(moved(skeleton, T_world_camera));
    return assign(in_world, stamp);
}

void PeopleTracks::replay(std::span<const PersonInView> people, const Eigen::Isometry3d& T_world_camera,
                          const Eigen::Isometry3d& T_world_tracked, Stamp stamp) {
    std::vector<Skeleton> skeletons;
    for (const PersonInView& person : people) skeletons.push_back(skeleton_of(person));
    update(skeletons, T_world_camera, T_world_tracked, stamp);
}

void PeopleTracks::move_world(const Eigen::Isometry3d& T_new_old) {
    for (Track& track : tracks_) {
        track.skeleton = moved(std::move(track.skeleton), T_new_old);
        track.velocity = T_new_old.linear() * track.velocity;
    }
}

/// The detected ones first: a carried one has the track that they leave.
std::vector<int> PeopleTracks::assign(const std::vector<Skeleton>& skeletons, Stamp stamp) {
    std::vector<int> ids(skeletons.size(), 0);
    std::vector<bool> taken(tracks_.size(), false);
    std::vector<Skeleton> places;
    for (const Track& track : tracks_)
        places.push_back(expected(track.skeleton, track.velocity, to_seconds(stamp - track.seen)));
    for (const bool now : {true, false}) {
        for (;;) {  // nearest pairs first
            double least = std::numeric_limits<double>::max();
            std::size_t best_track = 0, best = skeletons.size();
            for (std::size_t t = 0; t < taken.size(); ++t) {
                const double unseen = to_seconds(stamp - tracks_[t].seen);
                const double gate = std::min(Config::kGate_m + Config::kGateGrowth_m_s * unseen, Config::kWidestGate_m);
                for (std::size_t s = 0; s < skeletons.size() && !taken[t]; ++s) {
                    if (ids[s] != 0 || detected(skeletons[s]) != now) continue;
                    const double distance = distance_between(places[t], skeletons[s]);
                    if (distance < std::min(least, gate)) least = distance, best_track = t, best = s;
                }
            }
            if (best == skeletons.size()) break;
            taken[best_track] = true;
            ids[best] = tracks_[best_track].id;
            if (now) accept(tracks_[best_track], skeletons[best], stamp);
        }
    }
    for (std::size_t s = 0; s < skeletons.size(); ++s) {
        if (ids[s] != 0 || !detected(skeletons[s])) continue;
        ids[s] = next_id_++;
        tracks_.push_back({ids[s], skeletons[s], Eigen::Vector3d::Zero(), stamp});
    }
    return ids;
}

void PeopleTracks::accept(Track& track, const Skeleton& skeleton, Stamp stamp) {
    const double seconds = to_seconds(stamp - track.seen);
    const auto way = way_between(track.skeleton, skeleton);
    if (way && seconds > 0) {
        track.velocity += Config::kVelocityGain * (*way / seconds - track.velocity);
        const double speed = track.velocity.norm();
        if (speed > Config::kTopSpeed_m_s) track.velocity *= Config::kTopSpeed_m_s / speed;
    }
    track.skeleton = skeleton;
    track.seen = stamp;
}

LabelImage labels_by_id(LabelImage labels, std::span<const int> ids) {
    std::array<std::uint8_t, std::numeric_limits<std::uint8_t>::max() + 1> changed{};
    for (std::size_t label = 0; label < changed.size(); ++label) {
        const int id = label == 0 || label > ids.size() ? 0 : ids[label - 1];
        changed[label] =
            static_cast<std::uint8_t>(id == 0 ? label : 1 + static_cast<std::size_t>(id - 1) % kLastPersonLabel);
    }
    for (std::uint8_t& label : labels) label = changed[label];
    return labels;
}

}  // namespace posefusion
