#include "engine/slam/atlas.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/core/angle.hpp"
#include "engine/core/error.hpp"
#include "engine/core/stopwatch.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

/// Frames are counted otherwise in a piece that waits: what its keyframes wait for does not carry over.
PieceState unblocked(PieceState piece) {
    for (Keyframe& keyframe : piece.slam.back_end.keyframes) keyframe.blocked_until = 0;
    return piece;
}

void check(const PieceState& piece, std::uint32_t frames) {
    const bool counted = piece.frames.size() == piece.slam.frames && piece.tracked <= piece.frames.size() &&
                         piece.slam.back_end.trajectory.size() == piece.frames.size();
    const bool ascending =
        std::adjacent_find(piece.frames.begin(), piece.frames.end(), std::greater_equal<>()) == piece.frames.end();
    const auto& keyframes = piece.slam.back_end.keyframes;
    const bool known = std::all_of(keyframes.begin(), keyframes.end(),
                                   [&](const Keyframe& keyframe) { return keyframe.frame < piece.frames.size(); });
    if (!counted || !ascending || !known || (!piece.frames.empty() && piece.frames.back() >= frames))
        throw Error("the map to be restored contradicts itself; use another file");
}

bool is_within(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double metres, double degrees) {
    const Eigen::Isometry3d step = a.inverse() * b;
    return step.translation().norm() <= metres && Eigen::AngleAxisd(step.linear()).angle() <= radians(degrees);
}

/// Does an alignment with another piece, which nothing else speaks for, show the same place?
bool fits(const Alignment& alignment) {
    return alignment.accepted && alignment.correlation >= PieceConfig::kMinCorrelation;
}

}  // namespace

Atlas::Atlas(const Intrinsics& camera, const SlamConfig& config, std::shared_ptr<Context> context)
    : slam_(camera, config, std::move(context)) {}

FrameResult Atlas::process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels,
                           const FrameTiming& timing, std::span<const StartPose> starts) {
    const Input input{color, depth, labels, timing, starts};
    FrameResult result = track(input);
    const bool restored = !frames_.empty() && frames_.front() < restored_frames_;
    if (!restored && slam_.has_bad_start()) {
        result = start_again(input);
    } else if (slam_.is_lost_for_good()) {
        result = begin_piece(input);
    }
    if (!others_.empty()) look_for_other_pieces(input, result);
    return result;
}

FrameResult Atlas::track(const Input& input) {
    // earlier frames that the piece lacks: the others count from its end
    std::vector<StartPose> starts;
    for (StartPose start : input.starts) {
        const auto earlier = start.age <= next_frame_
                                 ? std::lower_bound(frames_.begin(), frames_.end(), next_frame_ - start.age)
                                 : frames_.end();
        if (earlier == frames_.end() || *earlier != next_frame_ - start.age) continue;
        start.age = static_cast<std::uint32_t>(frames_.end() - earlier);
        starts.push_back(start);
    }
    FrameResult result = slam_.process(input.color, input.depth, input.labels, input.timing, starts);
    frames_.push_back(next_frame_++);
    if (has_pose(result.tracking)) ++tracked_;
    for (LoopEvent& event : result.loops) {
        event.frame = frames_[event.frame];
        event.model_frame = frames_[event.model_frame];
    }
    return result;
}

FrameResult Atlas::start_again(const Input& input) {
    const Eigen::Isometry3d T_world_held = slam_.back_end().last_pose();
    slam_.restart();
    frames_.clear();
    tracked_ = 0;
    pending_.reset();
    --next_frame_;
    FrameResult result = track(input);
    result.map_change = MapChange::StartedAgain;
    result.T_world_tracked = T_world_held;  // how the camera moved until then is not known
    return result;
}

FrameResult Atlas::begin_piece(const Input& input) {
    PieceState left = unblocked(without_last_frame(current_piece()));
    FrameResult result = start_again(input);
    others_.push_back(std::move(left));
    result.map_change = MapChange::NewPiece;
    return result;
}

void Atlas::look_for_other_pieces(const Input& input, FrameResult& result) {
    const auto accepted = [](const LoopEvent& event) { return event.accepted; };
    if (!is_due() || std::any_of(result.loops.begin(), result.loops.end(), accepted)) return;  // one thing at a time
    const std::optional<Proposal> proposed = proposal(input, result);
    if (!proposed) return;
    const std::optional<Place> found = find_in(*proposed, result);
    const std::optional<PendingJoin> before = std::exchange(pending_, std::nullopt);
    if (!found) {
        if (proposed->keyframe) proposed->keyframe->blocked_until = next_frame_ + PieceConfig::kRetryAfter;
        return;
    }
    const bool lost = !has_pose(result.tracking);
    const Eigen::Isometry3d& T_other_camera = found->alignment.T_world_camera;
    const Eigen::Isometry3d T_other_current = T_other_camera * result.T_world_camera.inverse();
    const FernCode view = slam_.back_end().code_of_frame();
    const bool agrees = before && are_near(proposed->T_other_camera, T_other_camera, lost);
    if (agrees && lost) {
        const std::vector<LoopEvent> events = std::move(result.loops);
        result = move_to(proposed->piece, T_other_camera, input);
        result.loops.insert(result.loops.begin(), events.begin(), events.end());
        return;
    }
    const auto is_another_view = [&] {
        const float similarity = FernDatabase::similarity(before->view, view);
        return similarity < 1 - slam_.config().loops.ferns.keyframe_dissimilarity;
    };
    if (agrees && (is_another_view() || is_recognised(proposed->piece, T_other_camera, input.starts))) {
        join_with(proposed->piece, T_other_current, found->alignment.gain, result);
        return;
    }
    pending_ = PendingJoin{proposed->piece, next_frame_ - 1, found->model_frame, T_other_current,
                           agrees ? before->view : view};
    result.loops.back().accepted = false;
    result.loops.back().reason = lost ? "to be confirmed by the next frame" : "to be confirmed by another view";
}

/// Do two poses of this frame's camera in another piece say the same? If the camera is lost, the first is that of the
/// frame before.
bool Atlas::are_near(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, bool lost) const {
    const TrackingConfig& tracking = slam_.config().tracking;
    const double metres = lost ? static_cast<double>(tracking.max_translation) : PieceConfig::kMaxDistance;
    const double degrees = lost ? static_cast<double>(tracking.max_rotation_deg) : PieceConfig::kMaxAngleDeg;
    return is_within(a, b, metres, degrees);
}

/// Frames between two attempts: as for loops, and one while the camera is lost.
bool Atlas::is_due() const {
    if (slam_.back_end().failures() > 0) return slam_.back_end().lost() && slam_.sees_enough();
    if (pending_) return next_frame_ - 1 >= pending_->frame + PieceConfig::kConfirmAfter;
    return next_frame_ % static_cast<std::uint32_t>(slam_.config().loops.interval) == 0;
}

/// Where the newest frame is in another piece, if the earlier frame belongs to it and has a pose.
std::optional<Eigen::Isometry3d> Atlas::pose_in(std::uint32_t piece, const StartPose& start) const {
    const auto& [slam, frames, tracked] = others_[piece];
    const std::uint32_t newest = next_frame_ - 1;
    if (start.age > newest) return std::nullopt;
    const auto earlier = std::lower_bound(frames.begin(), frames.end(), newest - start.age);
    if (earlier == frames.end() || *earlier != newest - start.age) return std::nullopt;
    const auto i = static_cast<std::size_t>(earlier - frames.begin());
    if (i > 0 && slam.back_end.information[i].isZero()) return std::nullopt;
    return slam.back_end.trajectory[i] * start.T_earlier_current;
}

/// Do features say the same, that the colours and surfaces of the whole view say?
bool Atlas::is_recognised(std::uint32_t piece, const Eigen::Isometry3d& T_other_camera,
                          std::span<const StartPose> starts) const {
    return std::any_of(starts.begin(), starts.end(), [&](const StartPose& start) {
        const auto pose = pose_in(piece, start);
        return pose && is_within(*pose, T_other_camera, PieceConfig::kMaxDistance, PieceConfig::kMaxAngleDeg);
    });
}

/// What was found before and is to be confirmed; else, in turn, where features recognise another piece, and the
/// keyframe of another piece that looks most like this frame.
std::optional<Atlas::Proposal> Atlas::proposal(const Input& input, const FrameResult& result) {
    if (pending_) {
        return Proposal{pending_->piece, pending_->T_other_current * result.T_world_camera, pending_->model_frame,
                        nullptr};
    }
    const bool by_features = next_frame_ / static_cast<std::uint32_t>(slam_.config().loops.interval) % 2 == 0;
    for (const StartPose& start : input.starts) {
        for (std::uint32_t i = 0; by_features && i < others_.size(); ++i) {
            if (const auto pose = pose_in(i, start)) return Proposal{i, *pose, next_frame_ - 1 - start.age, nullptr};
        }
    }
    std::optional<Proposal> best;
    float similarity = 0;
    const FernCode code = slam_.back_end().code_of_frame();
    for (std::uint32_t i = 0; i < others_.size(); ++i) {
        std::vector<Keyframe>& keyframes = others_[i].slam.back_end.keyframes;
        const auto matches =
            slam_.back_end().places_like(code, keyframes, 1, next_frame_, std::numeric_limits<std::uint32_t>::max());
        if (matches.empty() || matches[0].similarity <= similarity) continue;
        similarity = matches[0].similarity;
        Keyframe& keyframe = keyframes[matches[0].keyframe];
        best = Proposal{i, keyframe.T_world_camera, others_[i].frames[keyframe.frame], &keyframe};
    }
    return best;
}

std::optional<Atlas::Place> Atlas::find_in(const Proposal& proposed, FrameResult& result) {
    const Stopwatch watch;
    const FernCode view = slam_.back_end().code_of_frame();
    const SlamState here = slam_.state();
    slam_.restore(others_[proposed.piece].slam);
    const std::vector<Place> places = places_in(proposed, view);
    slam_.restore(here);
    std::vector<Alignment> alignments;
    for (const Place& place : places) alignments.push_back(place.alignment);
    const std::optional<std::size_t> best = most_alike(alignments);
    const Place& place = places[best.value_or(0)];
    LoopEvent event = event_of(has_pose(result.tracking) ? LoopKind::Join : LoopKind::Relocalisation, next_frame_ - 1,
                               place.alignment);
    event.model_frame = place.model_frame;
    event.milliseconds = watch.milliseconds();
    if (!best) {
        event.accepted = false;
        event.reason = "two places look like this";
    } else if (event.accepted && !fits(place.alignment)) {
        event.accepted = false;
        event.reason = "it looks different";
    }
    result.loops.push_back(event);
    return event.accepted ? std::optional(place) : std::nullopt;
}

/// Where the newest frame fits into a piece, which is on the device. First as proposed; where that fits, it may fit
/// elsewhere as well, or better: in places that look most like it, and where a pattern repeats itself.
std::vector<Atlas::Place> Atlas::places_in(const Proposal& proposed, const FernCode& view) {
    const auto align = [&](const Eigen::Isometry3d& T, std::uint32_t model_frame) {
        return Place{slam_.align_newest(T, LoopConfig::kMinOverlapElsewhere), model_frame};
    };
    std::vector<Place> places{align(proposed.T_other_camera, proposed.model_frame)};
    if (!fits(places[0].alignment)) return places;
    const auto is_known = [&](const Eigen::Isometry3d& T, double metres, double degrees) {
        return std::any_of(places.begin(), places.end(), [&](const Place& place) {
            return is_within(place.alignment.T_world_camera, T, metres, degrees);
        });
    };
    const auto look_from = [&](const Eigen::Isometry3d& T, std::uint32_t model_frame) {
        Place place = align(T, model_frame);
        const Eigen::Isometry3d& T_other_camera = place.alignment.T_world_camera;
        if (fits(place.alignment) && !is_known(T_other_camera, PieceConfig::kMaxDistance, PieceConfig::kMaxAngleDeg))
            places.push_back(std::move(place));
    };

    constexpr std::uint32_t kAll = std::numeric_limits<std::uint32_t>::max();
    constexpr int kMostKeyframes = 3;
    // nearer keyframes lead to the same place
    constexpr double kElsewhere = static_cast<double>(AlignmentConfig::kWideDistance), kElsewhereDeg = 15;
    const PieceState& piece = others_[proposed.piece];
    const std::vector<Keyframe>& keyframes = piece.slam.back_end.keyframes;
    int tried = 0;
    for (const FernMatch& match : slam_.back_end().places_like(view, keyframes, keyframes.size(), kAll, kAll)) {
        const Keyframe& keyframe = keyframes[match.keyframe];
        if (is_known(keyframe.T_world_camera, kElsewhere, kElsewhereDeg)) continue;
        look_from(keyframe.T_world_camera, piece.frames[keyframe.frame]);
        if (++tried == kMostKeyframes) break;
    }

    // along a wall or a shelf surfaces do not say where, only the pattern on it does
    constexpr double kStep = 0.2, kFarthest = 1.2;  // metres: what alignment finds by itself, and a long period
    const Alignment first = places[0].alignment;
    for (double distance = kStep; distance < kFarthest + kStep / 2; distance += kStep) {
        for (const double side : {-1.0, 1.0}) {
            const Eigen::Translation3d shift(side * distance * first.least_certain);
            look_from(first.T_world_camera * shift, proposed.model_frame);
        }
    }
    return places;
}

void Atlas::join_with(std::uint32_t piece, const Eigen::Isometry3d& T_other_current, float gain, FrameResult& result) {
    const PieceState here = current_piece();
    const PieceState& other = others_[piece];
    const bool other_is_older = other.frames.front() < here.frames.front();
    PieceState joined = other_is_older ? join(other, here, T_other_current, gain, true)
                                       : join(here, other, T_other_current.inverse(), 1 / gain, false);
    if (joined.slam.map.slots > slam_.largest_map()) {
        result.loops.back().accepted = false;
        result.loops.back().reason = "the joined map would be too large; raise map.max_capacity";
        return;
    }
    others_.erase(others_.begin() + piece);
    make_current(joined);
    if (other_is_older) result.T_world_camera = T_other_current * result.T_world_camera;
    slam_.place_camera(result.T_world_camera);
    result.map_change = MapChange::Joined;
    result.surfels = joined.slam.map.slots;
    result.keyframes = static_cast<std::uint32_t>(joined.slam.back_end.keyframes.size());
}

FrameResult Atlas::move_to(std::uint32_t piece, const Eigen::Isometry3d& T_other_camera, const Input& input) {
    const Eigen::Isometry3d T_world_held = slam_.back_end().last_pose();
    PieceState left = unblocked(without_last_frame(current_piece()));
    const PieceState other = unblocked(std::exchange(others_[piece], std::move(left)));
    make_current(other);
    slam_.place_camera(T_other_camera);
    --next_frame_;
    FrameResult result = track(input);
    if (has_pose(result.tracking)) result.tracking = TrackingState::Relocalised;
    result.map_change = MapChange::OtherPiece;
    result.T_world_tracked = T_world_held;  // how the camera moved until then is not known
    return result;
}

PieceState Atlas::current_piece() const { return {slam_.state(), frames_, tracked_}; }

void Atlas::make_current(const PieceState& piece) {
    slam_.restore(piece.slam);
    frames_ = piece.frames;
    tracked_ = piece.tracked;
    pending_.reset();
}

std::optional<LoopGraph> Atlas::loop_graph() const {
    std::optional<LoopGraph> graph = slam_.back_end().loop_graph();
    if (graph) graph->frame = frames_[graph->frame];
    return graph;
}

std::vector<MapPiece> Atlas::other_pieces(float min_confidence) const {
    std::vector<MapPiece> pieces;
    for (const PieceState& piece : others_) {
        pieces.push_back({piece.frames, piece.slam.back_end.trajectory, surfels_of(piece.slam.map, min_confidence)});
    }
    std::stable_sort(pieces.begin(), pieces.end(),
                     [](const MapPiece& a, const MapPiece& b) { return a.frames < b.frames; });
    return pieces;
}

void Atlas::choose_main_piece() {
    if (others_.empty()) return;
    others_.push_back(current_piece());
    const auto is_better = [&](const PieceState& a, const PieceState& b) {
        const bool a_restored = a.frames.front() < restored_frames_, b_restored = b.frames.front() < restored_frames_;
        if (a_restored != b_restored) return a_restored;
        return a.tracked != b.tracked ? a.tracked > b.tracked : a.frames.front() < b.frames.front();
    };
    const auto main = std::min_element(others_.begin(), others_.end(), is_better);
    if (main + 1 != others_.end()) make_current(*main);
    others_.erase(main);
}

AtlasState Atlas::state() const { return {current_piece(), others_, next_frame_, restored_frames_, pending_}; }

void Atlas::restore(const AtlasState& state) {
    check(state.current, state.frames);
    for (const PieceState& piece : state.others) check(piece, state.frames);
    make_current(state.current);
    others_ = state.others;
    next_frame_ = state.frames;
    restored_frames_ = state.restored_frames;
    pending_ = state.pending;
}

void Atlas::restore(const SlamState& state) {
    AtlasState whole;
    whole.current.slam = state;
    whole.current.frames.resize(state.frames);
    std::iota(whole.current.frames.begin(), whole.current.frames.end(), 0u);
    whole.current.tracked = whole.frames = whole.restored_frames = state.frames;
    restore(whole);
}

}  // namespace posefusion
