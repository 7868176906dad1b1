#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/core/byte_elements.hpp"
#include "engine/slam/map_piece.hpp"
#include "engine/vulkan/pose_conversion.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {
namespace {

/// Where the frames of one of two pieces are in the piece that both become.
struct Renumbering {
    std::vector<std::uint32_t> to;  ///< of each frame of the old piece
    [[nodiscard]] std::uint32_t operator()(std::uint32_t frame) const {
        return to.empty() ? 0 : to[std::min<std::size_t>(frame, to.size() - 1)];
    }
};

Renumbering renumbering(const std::vector<std::uint32_t>& frames, const std::vector<std::uint32_t>& all) {
    Renumbering numbers;
    for (const std::uint32_t frame : frames) {
        const auto at = std::lower_bound(all.begin(), all.end(), frame);
        numbers.to.push_back(static_cast<std::uint32_t>(at - all.begin()));
    }
    return numbers;
}

struct SurfelLists {
    std::vector<gpu::vec4> positions, normals;
    std::vector<gpu::uvec4> appearances;
};

/// A surfel's colour times `gain`, up to white. The layout is that of shaders/include/surfel.glsl.
gpu::uvec4 brightened(gpu::uvec4 appearance, float gain) {
    constexpr std::uint32_t kWhite = 0xffff;
    const auto brighter = [&](std::uint32_t channel) {
        const float value = std::min(gain * static_cast<float>(channel), static_cast<float>(kWhite));
        return static_cast<std::uint32_t>(std::lround(value));
    };
    const std::uint32_t red = brighter(appearance.x & kWhite), green = brighter(appearance.x >> 16),
                        blue = brighter(appearance.y & kWhite);
    appearance.x = red | green << 16;
    appearance.y = blue | (appearance.y & ~kWhite);
    return appearance;
}

/// Appends the live surfels of `from`, moved by `T`, their colours times `gain`.
void append_surfels(SurfelLists& to, const MapState& from, const Eigen::Isometry3d& T, float gain,
                    const Renumbering& renumber) {
    const auto positions = elements_of<gpu::vec4>(from.position_confidence);
    const auto normals = elements_of<gpu::vec4>(from.normal_radius);
    const auto appearances = elements_of<gpu::uvec4>(from.appearance);
    const bool moves = !T.isApprox(Eigen::Isometry3d::Identity(), 0);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        gpu::vec4 p = positions[i], n = normals[i];
        if (p.w <= 0) continue;
        if (moves) {
            const Eigen::Vector3f position = (T * Eigen::Vector3d(p.x, p.y, p.z)).cast<float>();
            const Eigen::Vector3f normal = (T.linear() * Eigen::Vector3d(n.x, n.y, n.z)).cast<float>();
            p = {position.x(), position.y(), position.z(), p.w};
            n = {normal.x(), normal.y(), normal.z(), n.w};
        }
        gpu::uvec4 look = brightened(appearances[i], gain);
        look[gpu::CREATED] = renumber(look[gpu::CREATED]);
        look[gpu::LAST_SEEN] = renumber(look[gpu::LAST_SEEN]);
        to.positions.push_back(p);
        to.normals.push_back(n);
        to.appearances.push_back(look);
    }
}

std::uint32_t stable_surfels(const MapState& map) {
    return map.counters.size() < sizeof(gpu::MapRecord) ? 0 : elements_of<gpu::MapRecord>(map.counters)[0].stable;
}

MapState join(const MapState& base, const MapState& moved, const Eigen::Isometry3d& T, float gain,
              const Renumbering& of_base, const Renumbering& of_moved) {
    SurfelLists surfels;
    append_surfels(surfels, base, Eigen::Isometry3d::Identity(), 1, of_base);
    append_surfels(surfels, moved, T, gain, of_moved);
    MapState map;
    map.slots = map.alive = static_cast<std::uint32_t>(surfels.positions.size());
    map.position_confidence = bytes_of(surfels.positions);
    map.normal_radius = bytes_of(surfels.normals);
    map.appearance = bytes_of(surfels.appearances);
    map.capacity = std::max({base.capacity, moved.capacity, map.slots});
    gpu::MapRecord counters{};
    counters.count = counters.alive = map.slots;
    counters.stable = stable_surfels(base) + stable_surfels(moved);
    map.counters = bytes_of(std::vector{counters});
    return map;
}

/// Adds what the back end knows of a piece. Frames of both are in `to` already, as many as there are.
void add(BackEndState& to, const BackEndState& from, const Eigen::Isometry3d& T, const Renumbering& renumber) {
    for (Keyframe keyframe : from.keyframes) {
        keyframe.frame = renumber(keyframe.frame);
        keyframe.T_world_camera = T * keyframe.T_world_camera;
        keyframe.blocked_until = 0;
        to.keyframes.push_back(std::move(keyframe));
    }
    for (std::uint32_t frame = 0; frame < from.trajectory.size(); ++frame) {
        to.trajectory[renumber(frame)] = T * from.trajectory[frame];
        const bool follows =
            frame > 0 && renumber(frame) == renumber(frame - 1) + 1;  // on the frame it was tracked from
        if (follows) to.information[renumber(frame)] = from.information[frame];
    }
    for (LoopConstraint constraint : from.relative_constraints) {
        constraint.source = T * constraint.source;
        constraint.target = T * constraint.target;
        constraint.source_time = renumber(constraint.source_time);
        constraint.target_time = renumber(constraint.target_time);
        to.relative_constraints.push_back(constraint);
    }
}

BackEndState join(const BackEndState& base, const BackEndState& moved, const Eigen::Isometry3d& T,
                  const Renumbering& of_base, const Renumbering& of_moved) {
    BackEndState state;
    state.ferns = base.ferns;
    const std::size_t frames = base.trajectory.size() + moved.trajectory.size();
    state.trajectory.resize(frames, Eigen::Isometry3d::Identity());
    state.information.resize(frames, Matrix6d::Zero());
    add(state, base, Eigen::Isometry3d::Identity(), of_base);
    add(state, moved, T, of_moved);
    std::stable_sort(state.keyframes.begin(), state.keyframes.end(),
                     [](const Keyframe& a, const Keyframe& b) { return a.frame < b.frame; });
    return state;
}

/// The record of a camera in the world and exposure of `moved`, in those of `base`.
void move_camera(TrackerState& tracking, const Eigen::Isometry3d& T, float gain) {
    auto record = elements_of<gpu::TrackingRecord>(tracking.record)[0];
    for (gpu::Pose* pose : {&record.world_model, &record.world_live}) *pose = to_device(T * from_device(*pose));
    record.exposure *= gain;
    tracking.record = bytes_of(std::vector{record});
}

}  // namespace

PieceState join(const PieceState& base, const PieceState& moved, const Eigen::Isometry3d& T_base_moved, float gain,
                bool camera_in_moved) {
    PieceState piece;
    std::merge(base.frames.begin(), base.frames.end(), moved.frames.begin(), moved.frames.end(),
               std::back_inserter(piece.frames));
    piece.tracked = base.tracked + moved.tracked;
    const Renumbering of_base = renumbering(base.frames, piece.frames),
                      of_moved = renumbering(moved.frames, piece.frames);
    SlamState& slam = piece.slam;
    slam.camera = base.slam.camera;
    slam.frames = base.slam.frames + moved.slam.frames;
    slam.map = join(base.slam.map, moved.slam.map, T_base_moved, gain, of_base, of_moved);
    slam.back_end = join(base.slam.back_end, moved.slam.back_end, T_base_moved, of_base, of_moved);
    slam.tracking = camera_in_moved ? moved.slam.tracking : base.slam.tracking;
    if (camera_in_moved) move_camera(slam.tracking, T_base_moved, gain);
    return piece;
}

PieceState without_last_frame(PieceState piece) {
    if (piece.frames.empty()) return piece;
    piece.frames.pop_back();
    --piece.slam.frames;
    piece.slam.back_end.trajectory.pop_back();
    piece.slam.back_end.information.pop_back();
    return piece;
}

}  // namespace posefusion
