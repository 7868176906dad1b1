#include "segmentation/person_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

using Eigen::Vector3f;

bool seen_now(const Skeleton& s, int j) {
    return s.source[j] == JointSource::Measured || s.source[j] == JointSource::Inferred;
}

/// Mean of b - a over joints measured in both; nullopt if there are too few.
std::optional<Vector3f> shift_between(const Skeleton& a, const Skeleton& b) {
    Vector3f sum = Vector3f::Zero();
    int count = 0;
    for (int j = 0; j < kJointCount; ++j)
        if (a.has(j) && b.source[j] == JointSource::Measured) sum += b.joint[j] - a.joint[j], ++count;
    if (count < 3) return std::nullopt;
    return sum / static_cast<float>(count);
}

void save_skeleton(const Skeleton& s, StateWriter& out) {
    for (int j = 0; j < kJointCount; ++j) {
        out.put(s.joint[j]);
        out.put(static_cast<std::uint8_t>(s.source[j]));
        out.put(s.age[j]);
    }
    for (const float edge : {s.box.u_min, s.box.v_min, s.box.u_max, s.box.v_max}) out.put(edge);
    out.list(s.occluders, [&](const Vector3f& point) { out.put(point); });
}

Skeleton load_skeleton(StateReader& in) {
    Skeleton s;
    for (int j = 0; j < kJointCount; ++j) {
        s.joint[j] = in.get_matrix<Vector3f>();
        s.source[j] = in.get_enum(JointSource::Carried);
        s.age[j] = in.get<int>();
    }
    for (float* edge : {&s.box.u_min, &s.box.v_min, &s.box.u_max, &s.box.v_max}) *edge = in.get<float>();
    s.occluders = in.list<Vector3f>(sizeof(Vector3f), [&] { return in.get_matrix<Vector3f>(); });
    return s;
}

/// Whether the depth image is consistent with a joint there: hidden, outside, without depth or at the expected depth,
/// but not if the camera sees through the place to something behind.
bool possible(const Vector3f& joint, int j, const DepthImage& depth, const Intrinsics& camera) {
    constexpr float kTolerance = 0.15f;
    if (joint.z() <= 0.1f) return true;
    const Eigen::Vector2f at = project(joint, camera);
    const int u = static_cast<int>(std::lround(at.x())), v = static_cast<int>(std::lround(at.y()));
    if (!depth.contains(u, v)) return true;
    const float z = depth(u, v);
    return !(z > joint.z() - joint_inset(j) + kTolerance);
}

}  // namespace

void PersonTracker::predict(const Eigen::Isometry3f& T_current_previous) {
    for (PersonTrack& track : tracks_) {
        for (int j = 0; j < kJointCount; ++j) {
            if (!track.skeleton.has(j)) continue;
            track.skeleton.joint[j] = T_current_previous * Vector3f(track.skeleton.joint[j] + track.velocity);
            track.skeleton.source[j] = JointSource::Carried;
            track.skeleton.confidence[j] = 0;
            ++track.skeleton.age[j];
        }
        track.skeleton.occluders.clear();
        track.velocity = T_current_previous.linear() * track.velocity;
        track.detected = false;
        ++track.age;
    }
}

void PersonTracker::accept(PersonTrack& track, const Skeleton& detection, const DepthImage& depth,
                           const Intrinsics& camera) {
    const Skeleton predicted = track.skeleton;
    const auto shift = shift_between(predicted, detection);
    if (shift) {
        track.velocity += config_.velocity_gain / static_cast<float>(track.age) * *shift;
        const float speed = track.velocity.norm();
        if (speed > config_.max_speed) track.velocity *= config_.max_speed / speed;
    }
    track.skeleton = detection;
    for (int j = 0; j < kJointCount; ++j) {
        if (seen_now(detection, j) || !predicted.has(j) || predicted.age[j] > config_.carry_frames) continue;
        const Vector3f joint = predicted.joint[j] + shift.value_or(Vector3f::Zero());
        if (!possible(joint, j, depth, camera)) continue;
        track.skeleton.joint[j] = joint;
        track.skeleton.source[j] = JointSource::Carried;
        track.skeleton.age[j] = predicted.age[j];
    }
    track.detected = true;
    track.missed = 0;
    track.age = 0;
    ++track.seen;
}

void PersonTracker::update(const std::optional<std::vector<Skeleton>>& detections, const DepthImage& depth,
                           const Intrinsics& camera) {
    if (!detections) return;
    std::vector<bool> taken(detections->size(), false);
    for (;;) {  // nearest pairs first
        float least = std::numeric_limits<float>::max();
        PersonTrack* best_track = nullptr;
        std::size_t best = 0;
        for (PersonTrack& track : tracks_) {
            if (track.detected) continue;
            for (std::size_t d = 0; d < detections->size(); ++d) {
                if (taken[d]) continue;
                const float distance = distance_between(track.skeleton, (*detections)[d]);
                const float gate = config_.gate + config_.gate_growth * static_cast<float>(track.age);
                if (distance < std::min(least, gate)) least = distance, best_track = &track, best = d;
            }
        }
        if (!best_track) break;
        accept(*best_track, (*detections)[best], depth, camera);
        taken[best] = true;
    }
    for (std::size_t d = 0; d < detections->size(); ++d) {
        if (taken[d]) continue;
        PersonTrack track;
        track.id = next_id_++;
        track.skeleton = (*detections)[d];
        track.detected = true;
        track.seen = 1;
        tracks_.push_back(track);
    }
    for (PersonTrack& track : tracks_)
        if (!track.detected) ++track.missed;
    std::vector<PersonTrack> kept;
    for (const PersonTrack& track : tracks_) {
        const bool duplicate = std::any_of(tracks_.begin(), tracks_.end(), [&](const PersonTrack& other) {
            return other.detected && distance_between(track.skeleton, other.skeleton) < config_.duplicate;
        });
        const bool lost = track.missed > std::min(config_.carry_frames, track.seen);
        if (track.detected || (!lost && !duplicate)) kept.push_back(track);
    }
    tracks_ = std::move(kept);
    limit();
}

void PersonTracker::limit() {
    while (static_cast<int>(tracks_.size()) > config_.max_tracks)
        tracks_.erase(std::max_element(tracks_.begin(), tracks_.end(),
                                       [](const PersonTrack& a, const PersonTrack& b) { return a.missed < b.missed; }));
}

void PersonTracker::save(StateWriter& out) const {
    out.put(next_id_);
    out.list(tracks_, [&](const PersonTrack& track) {
        for (const int value : {track.id, track.seen, track.age, track.missed, track.nodes}) out.put(value);
        out.put(track.detected);
        out.put(track.velocity);
        save_skeleton(track.skeleton, out);
    });
}

void PersonTracker::load(StateReader& in) {
    next_id_ = in.get<int>();
    tracks_ = in.list<PersonTrack>(1, [&] {
        PersonTrack track;
        for (int* value : {&track.id, &track.seen, &track.age, &track.missed, &track.nodes}) *value = in.get<int>();
        track.detected = in.get_bool();
        track.velocity = in.get_matrix<Vector3f>();
        track.skeleton = load_skeleton(in);
        return track;
    });
}

std::vector<bool> PersonTracker::confirm(const std::vector<int>& nodes) {
    std::vector<bool> alive(tracks_.size(), true);
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        PersonTrack& track = tracks_[t];
        const float remaining = static_cast<float>(nodes[t]) / static_cast<float>(std::max(track.nodes, 1));
        if (!track.detected && (nodes[t] == 0 || remaining < config_.min_remaining)) alive[t] = false;
        track.nodes = nodes[t];
    }
    std::vector<PersonTrack> kept;
    for (std::size_t t = 0; t < tracks_.size(); ++t)
        if (alive[t]) kept.push_back(tracks_[t]);
    tracks_ = std::move(kept);
    return alive;
}

}  // namespace posefusion
