#include "hosts/io/map_file.hpp"

#include <utility>

namespace posefusion {
namespace {

const SectionFormat kMapFormat{{'M', 'A', 'P', ' '}, kStateVersion, "map file"};

ByteArray state_bytes(const SlamState& state) {
    StateWriter out;
    const Intrinsics& camera = state.camera;
    for (const float value : {camera.fx, camera.fy, camera.cx, camera.cy}) out.put(value);
    for (const int value : {camera.width, camera.height}) out.put(value);
    for (const std::uint32_t value : {state.frames, state.map.capacity, state.map.slots, state.map.alive})
        out.put(value);
    const BackEndState& back_end = state.back_end;
    out.put(back_end.relocalisation.failures);
    out.put(back_end.pending_loop.overlap);
    out.put(back_end.pending_loop.last_seen);
    out.put(back_end.pending_loop.since);
    out.put(back_end.relocalisation.found.has_value());
    out.put(back_end.relocalisation.found.value_or(Eigen::Isometry3d::Identity()));
    out.put(back_end.relocalisation.proposal);
    return out.take();
}

void read_state(StateReader in, SlamState& state) {
    Intrinsics& camera = state.camera;
    for (float* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value = in.get<float>();
    for (int* value : {&camera.width, &camera.height}) *value = in.get<int>();
    for (std::uint32_t* value : {&state.frames, &state.map.capacity, &state.map.slots, &state.map.alive})
        *value = in.get<std::uint32_t>();
    BackEndState& back_end = state.back_end;
    back_end.relocalisation.failures = in.get<std::int32_t>();
    back_end.pending_loop.overlap = in.get<float>();
    back_end.pending_loop.last_seen = in.get<std::uint32_t>();
    back_end.pending_loop.since = in.get<std::uint32_t>();
    const bool found = in.get_bool();
    const Eigen::Isometry3d pose = in.get_pose();
    if (found) back_end.relocalisation.found = pose;
    back_end.relocalisation.proposal = in.get<std::uint32_t>();
    in.end();
}

ByteArray places_bytes(const BackEndState& back_end) {
    StateWriter out;
    out.put(back_end.ferns.ferns);
    out.put(back_end.ferns.shrink);
    out.put(back_end.ferns.seed);
    out.put(back_end.ferns.depth_max);
    out.list(back_end.keyframes, [&](const Keyframe& keyframe) {
        out.put(keyframe.frame);
        out.put(keyframe.blocked_until);
        out.put(keyframe.T_world_camera);
        out.put(keyframe.code.good);
        out.list(keyframe.code.ferns, [&](std::uint8_t fern) { out.put(fern); });
    });
    return out.take();
}

void read_places(StateReader in, BackEndState& back_end) {
    back_end.ferns.ferns = in.get<std::int32_t>();
    back_end.ferns.shrink = in.get<std::int32_t>();
    back_end.ferns.seed = in.get<std::uint32_t>();
    back_end.ferns.depth_max = in.get<float>();
    back_end.keyframes = in.list<Keyframe>(sizeof(Eigen::Matrix4d), [&] {
        Keyframe keyframe;
        keyframe.frame = in.get<std::uint32_t>();
        keyframe.blocked_until = in.get<std::uint32_t>();
        keyframe.T_world_camera = in.get_pose();
        keyframe.code.good = in.get<int>();
        keyframe.code.ferns = in.list<std::uint8_t>(1, [&] { return in.get<std::uint8_t>(); });
        return keyframe;
    });
    in.end();
}

ByteArray trajectory_bytes(const BackEndState& back_end) {
    StateWriter out;
    out.list(back_end.trajectory, [&](const Eigen::Isometry3d& pose) { out.put(pose); });
    out.list(back_end.information, [&](const Matrix6d& information) { out.put(information); });
    return out.take();
}

ByteArray loops_bytes(const BackEndState& back_end) {
    StateWriter out;
    out.list(back_end.relative_constraints, [&](const LoopConstraint& constraint) {
        out.put(constraint.source);
        out.put(constraint.source_time);
        out.put(constraint.target);
        out.put(constraint.target_time);
        out.put(constraint.relative);
        out.put(constraint.pin);
        out.put(constraint.by_camera);
    });
    return out.take();
}

std::vector<LoopConstraint> read_loops(StateReader in) {
    auto constraints = in.list<LoopConstraint>(2 * sizeof(Eigen::Vector3d), [&] {
        LoopConstraint constraint;
        constraint.source = in.get_matrix<Eigen::Vector3d>();
        constraint.source_time = in.get<std::uint32_t>();
        constraint.target = in.get_matrix<Eigen::Vector3d>();
        constraint.target_time = in.get<std::uint32_t>();
        constraint.relative = in.get_bool();
        constraint.pin = in.get_bool();
        constraint.by_camera = in.get_bool();
        return constraint;
    });
    in.end();
    return constraints;
}

/// The sections that are bytes of the device, written and read as they are.
template <class S>  // SlamState or const SlamState
auto raw_sections(S& state) {
    return std::array{
        std::pair{"counters", &state.map.counters},    std::pair{"position", &state.map.position_confidence},
        std::pair{"normal", &state.map.normal_radius}, std::pair{"look", &state.map.appearance},
        std::pair{"tracking", &state.tracking.record}, std::pair{"previous", &state.tracking.previous_live},
        std::pair{"model", &state.tracking.model}};
}

}  // namespace

std::vector<Section> sections_of(const SlamState& state) {
    std::vector<Section> sections{{"state", state_bytes(state)},
                                  {"places", places_bytes(state.back_end)},
                                  {"poses", trajectory_bytes(state.back_end)},
                                  {"loops", loops_bytes(state.back_end)}};
    for (const auto& [name, bytes] : raw_sections(state)) sections.push_back({name, {}, *bytes});
    return sections;
}

SlamState take_state(ReadSections& sections) {
    SlamState state;
    const auto reading = [&](const char* name, auto&& read) {
        const ByteArray bytes = sections.take(name);
        read(StateReader(bytes, sections.file() + ": section '" + name + "'"));
    };
    reading("state", [&](StateReader in) { read_state(std::move(in), state); });
    reading("places", [&](StateReader in) { read_places(std::move(in), state.back_end); });
    reading("poses", [&](StateReader in) {
        state.back_end.trajectory = in.list<Eigen::Isometry3d>(sizeof(Eigen::Matrix4d), [&] { return in.get_pose(); });
        state.back_end.information = in.list<Matrix6d>(sizeof(Matrix6d), [&] { return in.get_matrix<Matrix6d>(); });
        in.end();
    });
    reading("loops", [&](StateReader in) { state.back_end.relative_constraints = read_loops(std::move(in)); });
    for (const auto& [name, bytes] : raw_sections(state)) *bytes = sections.take(name);
    return state;
}

void write_map(const std::filesystem::path& file, const SlamState& state) {
    write_sections(file, kMapFormat, sections_of(state));
}

bool is_map_file(const std::filesystem::path& file) { return is_section_file(file, kMapFormat); }

SlamState read_map(const std::filesystem::path& file) {
    ReadSections sections = read_sections(file, kMapFormat);
    return take_state(sections);
}

}  // namespace posefusion
