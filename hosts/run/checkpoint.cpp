#include "hosts/run/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string_view>

#include "engine/core/error.hpp"
#include "hosts/config/option_table.hpp"
#include "hosts/io/input_file.hpp"
#include "hosts/io/map_file.hpp"

namespace posefusion {
namespace {

constexpr std::uint32_t kRunVersion = 16;  ///< of the sections besides the state
const SectionFormat kFormat{{'C', 'H', 'K', 'P'}, kRunVersion << 16 | kStateVersion, "checkpoint"};

/// Options that do not affect trajectory or map, only where results go, how many there are and how fast they come.
constexpr std::array<std::string_view, 11> kFreeOptions{
    "out",    "max_frames", "save_masks", "save_background",  "all_surfels", "sequential",
    "report", "save_map",   "resume",     "checkpoint_every", "final_adjust"};

void put(StateWriter& out, const std::optional<double>& value) {
    out.put(value.has_value());
    out.put(value.value_or(0));
}

std::optional<double> get_optional(StateReader& in) {
    const bool there = in.get_bool();
    const auto value = in.get<double>();
    return there ? std::optional(value) : std::nullopt;
}

void put(StateWriter& out, Stamp stamp) { out.put(std::int64_t{stamp.count()}); }

Stamp get_stamp(StateReader& in) {
    const Stamp stamp{in.get<std::int64_t>()};
    if (stamp > kFarthestStamp || stamp < -kFarthestStamp) in.fail();
    return stamp;
}

void put(StateWriter& out, const LoopEvent& event) {
    out.put(event.frame);
    out.put(static_cast<std::uint8_t>(event.kind));
    out.put(event.model_frame);
    out.put(event.accepted);
    out.put(event.reason);
    for (const float value :
         {event.overlap, event.inlier_ratio, event.icp_rmse_m, event.photometric_rmse, event.correlation})
        out.put(value);
    for (const double value :
         {event.residual_before_m, event.residual_after_m, event.milliseconds, event.solve_milliseconds})
        out.put(value);
    out.put(event.nodes);
}

LoopEvent get_loop(StateReader& in) {
    LoopEvent event;
    event.frame = in.get<std::uint32_t>();
    event.kind = in.get_enum(LoopKind::Join);
    event.model_frame = in.get<std::uint32_t>();
    event.accepted = in.get_bool();
    event.reason = in.get_text();
    for (float* value :
         {&event.overlap, &event.inlier_ratio, &event.icp_rmse_m, &event.photometric_rmse, &event.correlation})
        *value = in.get<float>();
    for (double* value :
         {&event.residual_before_m, &event.residual_after_m, &event.milliseconds, &event.solve_milliseconds})
        *value = in.get<double>();
    event.nodes = in.get<std::uint32_t>();
    return event;
}

void put(StateWriter& out, const std::optional<LoopGraph>& graph) {
    out.put(graph.has_value());
    if (!graph) return;
    out.put(graph->frame);
    out.put(graph->map_nodes);
    out.list(graph->nodes, [&](const LoopGraph::Node& node) {
        out.put(node.position);
        out.put(node.moved);
    });
    out.list(graph->edges, [&](const auto& edge) {
        for (const std::uint32_t node : edge) out.put(node);
    });
}

std::optional<LoopGraph> get_loop_graph(StateReader& in) {
    if (!in.get_bool()) return std::nullopt;
    LoopGraph graph;
    graph.frame = in.get<std::uint32_t>();
    graph.map_nodes = in.get<std::uint32_t>();
    graph.nodes = in.list<LoopGraph::Node>(sizeof(LoopGraph::Node), [&] {
        LoopGraph::Node node;
        node.position = in.get_matrix<Eigen::Vector3d>();
        node.moved = in.get_matrix<Eigen::Vector3d>();
        return node;
    });
    using Edge = std::array<std::uint32_t, 2>;
    graph.edges = in.list<Edge>(sizeof(Edge), [&] {
        Edge edge{};
        for (std::uint32_t& node : edge) {
            node = in.get<std::uint32_t>();
            if (node >= graph.nodes.size()) in.fail();
        }
        return edge;
    });
    if (graph.map_nodes > graph.nodes.size()) in.fail();
    return graph;
}

void put(StateWriter& out, const FrameResult& result) {
    out.put(result.T_world_camera);
    out.put(result.T_world_tracked);
    out.put(static_cast<std::uint8_t>(result.tracking));
    out.put(result.covariance);
    for (const std::uint32_t value : {result.icp_inliers, result.photometric_inliers, result.valid_pixels,
                                      result.surfels, result.stable_surfels, result.keyframes})
        out.put(value);
    for (const float value : {result.icp_rmse_m, result.photometric_rmse, result.moving_share}) out.put(value);
    for (const float factor : result.exposure) out.put(factor);
    out.put(result.iterations);
    out.put(result.start_inliers);
    out.put(result.start_used);
    out.put(result.device_bytes);
    out.list(result.objects, [&](const MovingObject& object) {
        out.put(object.label);
        out.put(object.T_camera_object);
        out.put(object.pixels);
    });
    out.list(result.loops, [&](const LoopEvent& event) { put(out, event); });
    out.list(result.gpu_times, [&](const StageTime& time) {
        out.put(time.name);
        out.put(time.milliseconds);
    });
}

FrameResult get_result(StateReader& in) {
    FrameResult result;
    result.T_world_camera = in.get_pose();
    result.T_world_tracked = in.get_pose();
    result.tracking = in.get_enum(TrackingState::Relocalised);
    result.covariance = in.get_matrix<Eigen::Matrix<double, 6, 6>>();
    for (std::uint32_t* value : {&result.icp_inliers, &result.photometric_inliers, &result.valid_pixels,
                                 &result.surfels, &result.stable_surfels, &result.keyframes})
        *value = in.get<std::uint32_t>();
    for (float* value : {&result.icp_rmse_m, &result.photometric_rmse, &result.moving_share}) *value = in.get<float>();
    for (float& factor : result.exposure) factor = in.get<float>();
    result.iterations = in.get<int>();
    result.start_inliers = in.get<std::uint32_t>();
    result.start_used = in.get_bool();
    result.device_bytes = in.get<std::uint64_t>();
    result.objects = in.list<MovingObject>(sizeof(Eigen::Matrix4d), [&] {
        MovingObject object;
        object.label = in.get<std::uint8_t>();
        object.T_camera_object = in.get_pose();
        object.pixels = in.get<std::uint32_t>();
        return object;
    });
    result.loops = in.list<LoopEvent>(1, [&] { return get_loop(in); });
    result.gpu_times = in.list<StageTime>(1, [&] {
        StageTime time;
        time.name = in.get_text();
        time.milliseconds = in.get<double>();
        return time;
    });
    return result;
}

void put(StateWriter& out, const PersonInView& person) {
    out.put(person.id);
    for (const PersonInView::Joint& joint : person.joints) {
        out.put(joint.point);
        out.put(joint.confidence);
    }
}

PersonInView get_person_in_view(StateReader& in) {
    PersonInView person;
    person.id = in.get<int>();
    for (PersonInView::Joint& joint : person.joints) {
        joint.point = in.get_matrix<Eigen::Vector3f>();
        joint.confidence = in.get<float>();
    }
    return person;
}

template <class Pixel>
void put(StateWriter& out, const Image<Pixel>& image) {
    out.put(image.width());
    out.put(image.height());
    out.raw(image.data(), image.size() * sizeof(Pixel));
}

template <class Pixel>
Image<Pixel> get_image(StateReader& in) {
    constexpr int kMostPixelsPerSide = 1 << 15;
    const int width = in.get<int>(), height = in.get<int>();
    if (width < 0 || height < 0 || width > kMostPixelsPerSide || height > kMostPixelsPerSide) in.fail();
    in.expect(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * sizeof(Pixel));
    Image<Pixel> image(width, height);
    in.raw(image.data(), image.size() * sizeof(Pixel));
    return image;
}

void put(StateWriter& out, const FrameRecord& frame) {
    out.put(std::uint64_t{frame.index});
    put(out, frame.stamp);
    put(out, frame.result);
    out.put(frame.people);
    out.put(frame.carried);
    out.list(frame.in_view, [&](const PersonInView& person) { put(out, person); });
    put(out, frame.not_static);
    put(out, frame.joints_ms);
    put(out, frame.segmentation_ms);
    put(out, frame.features_ms);
    for (const double value : {frame.read_ms, frame.slam_ms, frame.latency_ms, frame.interval_ms}) out.put(value);
}

FrameRecord get_frame(StateReader& in) {
    FrameRecord frame;
    frame.index = in.get<std::uint64_t>();
    frame.stamp = get_stamp(in);
    frame.result = get_result(in);
    frame.people = in.get<int>();
    frame.carried = in.get<int>();
    frame.in_view = in.list<PersonInView>(sizeof(PersonInView), [&] { return get_person_in_view(in); });
    frame.not_static = get_image<std::uint8_t>(in);
    frame.joints_ms = get_optional(in);
    frame.segmentation_ms = get_optional(in);
    frame.features_ms = get_optional(in);
    for (double* value : {&frame.read_ms, &frame.slam_ms, &frame.latency_ms, &frame.interval_ms})
        *value = in.get<double>();
    return frame;
}

void put(StateWriter& out, const Person& person) {
    for (const JointObservation& joint : person.joints) {
        for (const float value : {joint.u, joint.v, joint.p}) out.put(value);
    }
    const PixelBox& box = person.box;
    for (const float value : {person.score, box.u_min, box.v_min, box.u_max, box.v_max}) out.put(value);
}

Person get_person(StateReader& in) {
    Person person;
    for (JointObservation& joint : person.joints) {
        for (float* value : {&joint.u, &joint.v, &joint.p}) *value = in.get<float>();
    }
    PixelBox& box = person.box;
    for (float* value : {&person.score, &box.u_min, &box.v_min, &box.u_max, &box.v_max}) *value = in.get<float>();
    return person;
}

ByteArray run_bytes(const RunRecord& record, double wall_seconds) {
    StateWriter out;
    out.put(wall_seconds);
    out.list(record.frames, [&](const FrameRecord& frame) { put(out, frame); });
    out.list(record.samples, [&](const SampleFrame& sample) {
        out.put(std::uint64_t{sample.index});
        put(out, sample.stamp);
        put(out, sample.color);
        put(out, sample.labels);
        out.list(sample.people, [&](const Person& person) { put(out, person); });
    });
    put(out, record.loop_graph);
    return out.take();
}

void read_run(StateReader in, Checkpoint& checkpoint) {
    checkpoint.wall_seconds = in.get<double>();
    checkpoint.frames = in.list<FrameRecord>(2 * sizeof(Eigen::Matrix4d), [&] { return get_frame(in); });
    checkpoint.samples = in.list<SampleFrame>(1, [&] {
        SampleFrame sample;
        sample.index = in.get<std::uint64_t>();
        sample.stamp = get_stamp(in);
        sample.color = get_image<Rgb8>(in);
        sample.labels = get_image<std::uint8_t>(in);
        sample.people = in.list<Person>(1, [&] { return get_person(in); });
        return sample;
    });
    checkpoint.loop_graph = get_loop_graph(in);
    in.end();
}

void put_bytes(StateWriter& out, std::span<const std::byte> bytes) {
    out.put(std::uint64_t{bytes.size()});
    out.raw(bytes.data(), bytes.size());
}

ByteArray get_bytes(StateReader& in) {
    const auto size = in.get<std::uint64_t>();
    in.expect(size);
    ByteArray bytes(size);
    in.raw(bytes.data(), bytes.size());
    return bytes;
}

/// All of a piece but its state.
void put_frames(StateWriter& out, const PieceState& piece) {
    out.list(piece.frames, [&](std::uint32_t frame) { out.put(frame); });
    out.put(piece.tracked);
}

void get_frames(StateReader& in, PieceState& piece) {
    piece.frames = in.list<std::uint32_t>(sizeof(std::uint32_t), [&] { return in.get<std::uint32_t>(); });
    piece.tracked = in.get<std::uint32_t>();
}

/// What there is besides the state of the current piece. Each other piece is the sections that it would have in a file.
ByteArray pieces_bytes(const AtlasState& atlas) {
    StateWriter out;
    out.put(atlas.frames);
    out.put(atlas.restored_frames);
    put_frames(out, atlas.current);
    out.list(atlas.others, [&](const PieceState& piece) {
        put_frames(out, piece);
        out.list(sections_of(piece.slam), [&](const Section& section) {
            out.put(section.name);
            put_bytes(out, section.bytes());
        });
    });
    put_bytes(out, atlas.motion);
    out.put(atlas.pending.has_value());
    if (!atlas.pending) return out.take();
    out.put(atlas.pending->piece);
    out.put(atlas.pending->frame);
    out.put(atlas.pending->model_frame);
    out.put(atlas.pending->T_other_current);
    out.put(atlas.pending->view.good);
    put_bytes(out, std::as_bytes(std::span(atlas.pending->view.ferns)));
    return out.take();
}

void read_pieces(StateReader in, const std::string& file, AtlasState& atlas) {
    atlas.frames = in.get<std::uint32_t>();
    atlas.restored_frames = in.get<std::uint32_t>();
    get_frames(in, atlas.current);
    atlas.others = in.list<PieceState>(1, [&] {
        PieceState piece;
        get_frames(in, piece);
        std::map<std::string, ByteArray> sections;
        (void)in.list<int>(1, [&] {
            const std::string name = in.get_text();
            sections[name] = get_bytes(in);
            return 0;
        });
        ReadSections state(file, std::move(sections));
        piece.slam = take_state(state);
        return piece;
    });
    atlas.motion = get_bytes(in);
    if (in.get_bool()) {
        PendingJoin& pending = atlas.pending.emplace();
        pending.piece = in.get<std::uint32_t>();
        if (pending.piece >= atlas.others.size()) in.fail();
        pending.frame = in.get<std::uint32_t>();
        pending.model_frame = in.get<std::uint32_t>();
        pending.T_other_current = in.get_pose();
        pending.view.good = in.get<int>();
        for (const std::byte fern : get_bytes(in)) pending.view.ferns.push_back(static_cast<std::uint8_t>(fern));
    }
    in.end();
}

ByteArray identity_bytes(const RunIdentity& identity) {
    StateWriter out;
    out.put(identity.recording);
    out.list(identity.stamps, [&](Stamp stamp) { put(out, stamp); });
    out.list(identity.options, [&](const auto& option) {
        out.put(option.first);
        out.put(option.second);
    });
    return out.take();
}

RunIdentity read_identity(StateReader in) {
    RunIdentity identity;
    identity.recording = in.get_text();
    identity.stamps = in.list<Stamp>(sizeof(Stamp), [&] { return get_stamp(in); });
    identity.options = in.list<std::pair<std::string, std::string>>(1, [&] {
        std::string key = in.get_text();
        return std::pair(std::move(key), in.get_text());
    });
    in.end();
    return identity;
}

void check_same(const std::filesystem::path& file, const RunIdentity& was, const RunIdentity& is) {
    const auto refuse = [&](const std::string& reason) {
        throw Error(file.string() + ": " + printable(reason) +
                    "; resume with what it was made with, or run without --resume");
    };
    if (was.recording != is.recording) refuse("is of another recording, " + was.recording);
    if (was.stamps != is.stamps) refuse("the frames of the recording have changed since");
    for (const auto& [key, value] : is.options) {
        const auto same_key = [&k = key](const auto& option) { return option.first == k; };
        const auto before = std::find_if(was.options.begin(), was.options.end(), same_key);
        const std::string old = before == was.options.end() ? "unknown" : before->second;
        if (before == was.options.end() || old != value)
            refuse("was made with " + key + " = '" + old + "', not '" + value + "'");
    }
    if (was.options.size() != is.options.size()) refuse("was made with options that are no more");
}

}  // namespace

RunIdentity identity_of(const RunConfig& config, const Recording& recording) {
    RunIdentity identity;
    identity.recording = std::filesystem::weakly_canonical(recording.location()).string();
    for (const FrameEntry& frame : recording.frames()) identity.stamps.push_back(frame.stamp);
    RunConfig copy = config;
    for (const Option& option : option_table(copy)) {
        if (std::find(kFreeOptions.begin(), kFreeOptions.end(), option.key) == kFreeOptions.end())
            identity.options.emplace_back(option.key, option.get());
    }
    return identity;
}

std::filesystem::path checkpoint_file(const RunConfig& config) { return config.out / "checkpoint.bin"; }

void write_checkpoint(const std::filesystem::path& file, const RunIdentity& identity, const AtlasState& engine,
                      const ByteArray& people, const RunRecord& record, double wall_seconds) {
    std::vector<Section> sections = sections_of(engine.current.slam);
    sections.push_back({"pieces", pieces_bytes(engine)});
    sections.push_back({"identity", identity_bytes(identity)});
    sections.push_back({"run", run_bytes(record, wall_seconds)});
    sections.push_back({"people", {}, people});
    write_sections(file, kFormat, sections);
}

Checkpoint read_checkpoint(const std::filesystem::path& file, const RunIdentity& identity) {
    ReadSections sections = read_sections(file, kFormat);
    const auto what = [&](const char* name) { return file.string() + ": section '" + name + "'"; };
    const ByteArray identity_was = sections.take("identity"), run = sections.take("run");
    check_same(file, read_identity(StateReader(identity_was, what("identity"))), identity);
    Checkpoint checkpoint;
    read_run(StateReader(run, what("run")), checkpoint);
    checkpoint.people = sections.take("people");
    const ByteArray pieces = sections.take("pieces");
    read_pieces(StateReader(pieces, what("pieces")), file.string(), checkpoint.engine);
    checkpoint.engine.current.slam = take_state(sections);
    const std::vector<FrameRecord>& frames = checkpoint.frames;
    const std::uint64_t counted = std::uint64_t{checkpoint.engine.restored_frames} + frames.size();
    if (counted != checkpoint.engine.frames || frames.empty() || frames.back().index >= identity.stamps.size()) {
        throw Error(file.string() + ": contradicts itself; use another copy");
    }
    return checkpoint;
}

}  // namespace posefusion
