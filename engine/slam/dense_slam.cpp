#include "engine/slam/dense_slam.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/stopwatch.hpp"
#include "engine/map/map_reader.hpp"
#include "engine/slam/input_checks.hpp"
#include "engine/slam/params.hpp"
#include "engine/tracking/information.hpp"
#include "engine/vulkan/pose_conversion.hpp"
#include "engine/vulkan/transfer.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

BackEndConfig back_end_config(const SlamConfig& config) {
    return {config.loops,          config.alignment, config.deformation,
            config.relocalisation, config.tracking,  config.preprocess.depth_max,
            config.localise_only};
}

/// A share of inliers that no frame has.
constexpr float kNever = 2;

/// Share of the image that was tracked and turns out to move, from which on the frame is tracked again.
constexpr float kTrackAgain = 0.005f;

/// Share of the pixels not known to be people or movers that has to fit the map. Where less does, the camera has got
/// somewhere else, and nothing is known about what moves.
constexpr float kLeastFit = 0.5f;

/// Without a thing that moves all else fits the map better by this factor at least, and about as well as noise lets it,
/// at this share of its pixels: where it does not, other errors may be greater than the motion, or this is another
/// place.
constexpr float kBetterIcp = 0.85f, kBetterPhotometric = 0.93f, kMostNoise = 1.3f, kRestFit = 0.7f;

bool fits(const gpu::TrackingRecord& record, float share) {
    return static_cast<float>(std::max(record.icp_inliers, record.photometric_inliers)) >=
           share * static_cast<float>(record.valid_pixels);
}

TrackingFit fit_of(const gpu::TrackingRecord& record) { return {record.icp_scale, record.photometric_rmse}; }

LabelImage with_suspect(LabelImage labels, const LabelImage& suspect) {
    if (labels.empty()) labels = LabelImage(suspect.width(), suspect.height());
    for (std::size_t i = 0; i < labels.size(); ++i)
        if (labels[i] == 0 && suspect[i] != 0) labels[i] = kFirstMoverLabel;
    return labels;
}

float share_of(const LabelImage& labels) {
    if (labels.empty()) return 0;
    const auto marked = labels.size() - static_cast<std::size_t>(std::count(labels.begin(), labels.end(), 0));
    return static_cast<float>(marked) / static_cast<float>(labels.size());
}

float newly_marked(const LabelImage& now, const LabelImage& before) {
    if (now.empty() || before.empty()) return share_of(now);
    std::size_t count = 0;
    for (std::size_t i = 0; i < now.size(); ++i) count += now[i] != 0 && before[i] == 0;
    return static_cast<float>(count) / static_cast<float>(now.size());
}

}  // namespace

DenseSlam::DenseSlam(const Intrinsics& camera, const SlamConfig& config, std::shared_ptr<Context> context)
    : camera_(checked(camera)),
      config_(checked(config)),
      shared_context_(std::move(context)),
      context_(*shared_context_),
      host_params_(host_buffer<gpu::Params>(context_, 1, "host parameters")),
      params_(device_buffer<gpu::Params>(context_, 1, "parameters")),
      pyramids_(context_, camera, config.preprocess),
      images_(context_, camera, config.preprocess, config.shutter),
      tracker_(context_, camera, config.tracking, !config.shutter.is_global()),
      exposure_(context_, camera),
      map_(context_, camera, config.map),
      back_end_(context_, camera, back_end_config(config)),
      model_(context_, camera, "model"),
      model_color_(device_buffer<std::uint32_t>(context_, pixels_at(camera, 0), "model colour")),
      host_before_(host_buffer<gpu::TrackingRecord>(context_, 1, "host tracking record before")),
      start_(device_buffer<gpu::StartRecord>(context_, 1, "start")),
      host_start_(host_buffer<gpu::StartRecord>(context_, 1, "host start")),
      host_record_(host_buffer<gpu::TrackingRecord>(context_, 1, "host tracking record")),
      host_counters_(host_buffer<gpu::MapRecord>(context_, 1, "host map counters")) {
    if (config.estimate_timing) timing_probe_.emplace(context_, camera, !config.shutter.is_global());
    host_record_.host<gpu::TrackingRecord>()[0] = first_record();
    write(context_, std::as_bytes(host_record_.host<gpu::TrackingRecord>()), tracker_.record);
}

FrameResult DenseSlam::process(const ColorImage& color, const DepthImage& depth, const LabelImage& labels,
                               const FrameTiming& timing, std::span<const StartPose> starts) {
    check_sizes(camera_, color, depth, labels);
    if (config_.localise_only && frames_ == 0) throw Error("localise_only needs a map; restore one first");

    // preprocess, track, fuse, predict
    since_pose_s_ += timing.interval_s;
    auto& params = host_params_.host<gpu::Params>()[0];
    params = params_of_frame();
    params.depth_first_row += static_cast<float>(timing.depth_delay_s);
    offer_start(starts);
    if (frames_ == 1 && first_) find_first_motion(color, depth, labels);
    first_.reset();
    if (!config_.localise_only && map_.make_room()) forget_recordings();
    times_.clear();
    LabelImage movers;
    if (judge_) {
        movers = run_with_judge(color, depth, labels);
    } else {
        images_.upload(color, depth, labels);
        run(frames_ == 0 ? first_frame_ : next_frame_, &DenseSlam::enqueue_frame);
    }
    const auto& counters = host_counters_.host<gpu::MapRecord>()[0];
    map_.update(counters.count, counters.alive);
    FrameResult result = result_of_frame();
    if (frames_ == 0 && !config_.shutter.is_global()) first_ = {color, depth, with_movers(labels, movers), timing};
    result.moving_share = share_of(movers);
    result.movers = std::move(movers);
    if (judge_) result.objects = judge_->objects();
    const bool tracked = host_record_.host<gpu::TrackingRecord>()[0].failed == 0;
    if (tracked) since_pose_s_ = 0;
    if (timing_probe_) estimate_timing(tracked, timing);

    // close loops, or find the camera again
    BackEnd::Outcome outcome = back_end_.after_frame(tracked_frame(result));
    if (outcome.moved) predict_from(outcome.T_world_camera);
    result.T_world_camera = outcome.T_world_camera;
    result.tracking = outcome.state;
    result.loops = std::move(outcome.events);
    result.keyframes = static_cast<std::uint32_t>(back_end_.keyframes().size());
    ++frames_;
    return result;
}

/// The map begins again with the first frame, whose rows are corrected by that motion.
void DenseSlam::begin_with(const FirstFrame& first, const gpu::Twist& motion) {
    auto& params = host_params_.host<gpu::Params>()[0];
    const gpu::Params params_now = params;
    frames_ = 0;
    map_.restore(map_.empty_state());
    forget_recordings();
    gpu::TrackingRecord record = first_record();
    record.expected_motion = motion;
    write(context_, std::as_bytes(std::span(&record, 1)), tracker_.record);
    params = params_of_frame();
    params.depth_first_row += static_cast<float>(first.timing.depth_delay_s);
    images_.upload(first.color, first.depth, first.labels);
    run(first_frame_, &DenseSlam::enqueue_frame);
    const auto& counters = host_counters_.host<gpu::MapRecord>()[0];
    map_.update(counters.count, counters.alive);
    frames_ = 1;
    params = params_now;
}

/// The first frame was fused as if the camera had stood still. Two frames that are distorted alike fit each other, so
/// that the second one only shows how the motion has changed from the first to it; the mean of both is the motion
/// between their poses. Each round comes half as near.
void DenseSlam::find_first_motion(const ColorImage& color, const DepthImage& depth, const LabelImage& labels) {
    constexpr int kRounds = 3;
    const auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    gpu::Twist motion{};
    for (int round = 0; round < kRounds; ++round) {
        images_.upload(color, depth, labels);
        run(tracking_, &DenseSlam::enqueue_tracking);
        if (record.failed != 0) {
            begin_with(*first_, {});
            return;
        }
        motion.translation = record.last_motion.translation;
        motion.rotation = 0.5f * (record.last_motion.rotation - record.turn_offset + motion.rotation);
        begin_with(*first_, motion);
    }
}

/// The device's part of a frame.
void DenseSlam::enqueue_frame(Sequence& sequence) const {
    enqueue_preprocessing(sequence);
    if (frames_ > 0) enqueue_pose(sequence);
    enqueue_mapping(sequence);
}

void DenseSlam::enqueue_preprocessing(Sequence& sequence) const {
    sequence.stage("preprocess");
    sequence.copy(host_params_, params_, sizeof(gpu::Params));
    images_.enqueue(sequence, params_, tracker_.record, pyramids_);
}

/// The pose of the preprocessed frame.
void DenseSlam::enqueue_pose(Sequence& sequence) const {
    sequence.copy(host_start_, start_, sizeof(gpu::StartRecord));
    tracker_.enqueue_frame(sequence, params_, images_.live, model_, &start_);
    sequence.copy(start_, host_start_, sizeof(gpu::StartRecord));
}

/// All but the preprocessing and the tracking. The rows of a rolling shutter are brought to the stamp once more, now
/// that the motion of the camera is known: what the map and the next frames get is better than what was tracked.
void DenseSlam::enqueue_mapping(Sequence& sequence) const {
    if (frames_ > 0 && !config_.shutter.is_global()) {
        sequence.stage("shutter");
        images_.enqueue(sequence, params_, tracker_.record, pyramids_, GlobalShutter::Motion::Found);
    }
    if (frames_ > 0) exposure_.enqueue(sequence, params_, tracker_.record, images_, model_.geometry[0], model_color_);
    if (!config_.localise_only) map_.enqueue_fusion(sequence, params_, tracker_.record, images_);
    enqueue_prediction(sequence);
    tracker_.enqueue_keep_live(sequence, images_.live);
    back_end_.enqueue_thumbnail(sequence, params_, tracker_.record, model_color_, model_.depth[0], images_);
    sequence.copy(tracker_.record, host_record_, sizeof(gpu::TrackingRecord));
    sequence.copy(map_.counters(), host_counters_, sizeof(gpu::MapRecord));
}

void DenseSlam::enqueue_tracking(Sequence& sequence) const {
    enqueue_preprocessing(sequence);
    enqueue_pose(sequence);
    sequence.copy(tracker_.record, host_record_, sizeof(gpu::TrackingRecord));
}

/// As if the frame had not been tracked yet: the pose that other pixels led to is no better start.
void DenseSlam::enqueue_second_tracking(Sequence& sequence) const {
    sequence.copy(host_before_, tracker_.record, sizeof(gpu::TrackingRecord));
    enqueue_tracking(sequence);
}

/// Records the commands if that has not been done, and runs them.
void DenseSlam::run(std::unique_ptr<Sequence>& sequence, void (DenseSlam::*enqueue)(Sequence&) const) {
    if (!sequence) {
        sequence = std::make_unique<Sequence>(context_);
        (this->*enqueue)(*sequence);
        sequence->finish();
    }
    sequence->run();
    for (const auto& time : sequence->times()) times_.push_back({time.stage, time.milliseconds});
}

/// Tracks the frame once more, without a suspect: does all else fit much better? If not, all is as before.
bool DenseSlam::rest_moves_otherwise(const ColorImage& color, const DepthImage& depth, const LabelImage& labels,
                                     const LabelImage& suspect) {
    auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    const gpu::TrackingRecord with = record;
    images_.upload(color, depth, with_suspect(labels, suspect));
    run(second_tracking_, &DenseSlam::enqueue_second_tracking);
    const TrackingFit all = fit_of(with), rest = fit_of(record);
    if (record.failed == 0 && fits(record, kRestFit) &&
        rest.icp_scale < std::min(kMostNoise, kBetterIcp * all.icp_scale) &&
        rest.photometric_rmse < kBetterPhotometric * all.photometric_rmse)
        return true;
    record = with;
    write(context_, std::as_bytes(std::span(&with, 1)), tracker_.record);
    change_mask(color, depth, labels);
    return false;
}

/// Of a frame that has been tracked.
void DenseSlam::change_mask(const ColorImage& color, const DepthImage& depth, const LabelImage& labels) {
    images_.upload(color, depth, labels);
    // with a rolling shutter the mapping preprocesses the frame again anyway
    if (config_.shutter.is_global()) run(masking_, &DenseSlam::enqueue_preprocessing);
}

/// The frame in parts. Returns what moves and is no person.
LabelImage DenseSlam::run_with_judge(const ColorImage& color, const DepthImage& depth, const LabelImage& people) {
    const Stopwatch begin_watch;
    if (frames_ == 0) judge_->restart();
    LabelImage movers = judge_->begin(color, depth, people);
    double judge_ms = begin_watch.milliseconds();
    const auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    host_before_.host<gpu::TrackingRecord>()[0] = record;
    const auto T_previous_current = [&] { return from_device(record.model_live).cast<float>(); };
    images_.upload(color, depth, with_movers(people, movers));
    if (frames_ == 0) {
        run(first_frame_, &DenseSlam::enqueue_frame);
        judge_->end(Eigen::Isometry3f::Identity());
        return movers;
    }
    run(tracking_, &DenseSlam::enqueue_tracking);
    const auto is_credible = [&] { return record.failed == 0 && fits(record, kLeastFit); };
    const auto judge = [&] {
        const Stopwatch watch;
        LabelImage found = judge_->find(T_previous_current());
        judge_ms += watch.milliseconds();
        return found;
    };
    if (record.failed == 0) {
        const Stopwatch watch;
        const LabelImage suspect = is_credible() ? judge_->suspect(fit_of(record)) : LabelImage();
        judge_ms += watch.milliseconds();
        if (!suspect.empty() && rest_moves_otherwise(color, depth, with_movers(people, movers), suspect)) {
            judge_->accuse(suspect);
            movers = with_suspect(std::move(movers), suspect);
        }
        LabelImage found = judge();
        if (newly_marked(found, movers) > kTrackAgain) {
            images_.upload(color, depth, with_movers(people, found));
            run(second_tracking_, &DenseSlam::enqueue_second_tracking);
            movers = std::move(found);
            found = record.failed == 0 ? judge() : movers;
        }
        if (!std::equal(found.begin(), found.end(), movers.begin(), movers.end())) {
            change_mask(color, depth, with_movers(people, found));
            movers = std::move(found);
        }
    }
    const Stopwatch end_watch;
    if (is_credible()) {
        judge_->end(T_previous_current());
    } else {
        judge_->restart();
        if (!movers.empty()) {  // as if nobody had judged
            movers = LabelImage();
            images_.upload(color, depth, with_movers(people, movers));
            run(second_tracking_, &DenseSlam::enqueue_second_tracking);
        }
    }
    times_.push_back({"movers (host)", judge_ms + end_watch.milliseconds()});
    run(mapping_, &DenseSlam::enqueue_mapping);
    return movers;
}

void DenseSlam::set_motion_judge(std::shared_ptr<MotionJudge> judge) {
    judge_ = std::move(judge);
    if (judge_) judge_->restart();
}

/// Predicts the active model from the current pose: the next frame is tracked against it.
void DenseSlam::enqueue_prediction(Sequence& sequence) const {
    sequence.stage("predict");
    map_.enqueue_prediction(sequence, params_, tracker_.record, images_, true, model_, model_color_);
    sequence.stage("model pyramid");
    pyramids_.enqueue_model(sequence, params_, model_);
}

/// Of the poses offered, the first one whose earlier frame has a pose.
void DenseSlam::offer_start(std::span<const StartPose> starts) {
    auto& offered = host_start_.host<gpu::StartRecord>()[0];
    offered = {};
    offered.model_live = to_device(Eigen::Isometry3d::Identity());
    start_inliers_ = 0;
    proposal_.reset();
    for (const StartPose& start : starts) {
        const std::optional<Eigen::Isometry3d> T_world_earlier = back_end_.pose_before(start.age);
        if (!T_world_earlier) continue;
        offered.model_live = to_device(back_end_.last_pose().inverse() * *T_world_earlier * start.T_earlier_current);
        offered.known = 1;
        start_inliers_ = start.inliers;
        proposal_ = {*T_world_earlier * start.T_earlier_current, frames_ - start.age};
        return;
    }
}

gpu::Params DenseSlam::params_of_frame() const {
    gpu::Params p = make_params(camera_, config_);
    p.frame = frames_;
    p.interval = static_cast<float>(since_pose_s_);
    expect_steady_motion(p);
    p.first_mover_label = judge_ ? kFirstMoverLabel : gpu::NO_MOVERS;
    // after a few frames no surfel has its final confidence yet
    p.predict_confidence = std::min(config_.map.predict_confidence, 0.3f * static_cast<float>(frames_));
    // while lost, the camera may come back anywhere
    const auto window = static_cast<std::uint32_t>(config_.loops.time_window);
    const bool windowed = config_.loops.enabled && !config_.localise_only;
    p.active_since = windowed && frames_ > window && !back_end_.lost() ? frames_ - window : 0;
    // After a failure a similar place must not be mistaken for the lost one. Once the camera is lost and may be
    // anywhere, the number of inliers says too little: only a relocalisation finds it, which compares colours, too, and
    // is confirmed by a second frame.
    if (back_end_.failures() > 0) p.min_inlier_ratio = RelocalisationConfig::kRecoverInlierRatio;
    if (back_end_.lost() && config_.relocalisation.enabled) p.min_inlier_ratio = kNever;
    return p;
}

FrameResult DenseSlam::result_of_frame() {
    const auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    const auto& counters = host_counters_.host<gpu::MapRecord>()[0];
    FrameResult result;
    result.T_world_tracked = from_device(record.world_live);
    if (frames_ > 0) {
        result.covariance = covariance_of(record);
        result.icp_inliers = record.icp_inliers;
        result.photometric_inliers = record.photometric_inliers;
        result.icp_rmse_m = record.icp_rmse;
        result.photometric_rmse = record.photometric_rmse;
        result.valid_pixels = record.valid_pixels;
        result.iterations = static_cast<int>(record.iterations);
        result.start_inliers = start_inliers_;
        result.start_used = host_start_.host<gpu::StartRecord>()[0].used != 0;
    }
    result.exposure = {record.exposure.x, record.exposure.y, record.exposure.z};
    result.surfels = counters.alive;
    result.stable_surfels = counters.stable;
    result.device_bytes = context_.allocated_bytes();
    result.gpu_times = std::move(times_);
    return result;
}

TrackedFrame DenseSlam::tracked_frame(const FrameResult& result) {
    const auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    const bool failed = record.failed != 0;
    const Matrix6d information = frames_ > 0 && !failed ? information_of(record) : Matrix6d::Zero().eval();
    return {host_params_.host<gpu::Params>()[0],
            result.T_world_tracked,
            information,
            failed,
            host_counters_.host<gpu::MapRecord>()[0].inactive_in_view,
            images_,
            pyramids_,
            map_,
            proposal_};
}

void DenseSlam::estimate_timing(bool tracked, const FrameTiming& timing) {
    const auto sums = timing_probe_->after_frame(tracked, params_, tracker_.record, images_.live);
    // images of a global shutter are not corrected at all, not even by what their stamps say
    constexpr double kSeconds = 1e-3;
    const ShutterConfig& shutter = config_.shutter;
    const SensorTimes used = shutter.is_global()
                                 ? SensorTimes(-previous_depth_delay_s_, 0, 0)
                                 : SensorTimes(kSeconds * SensorTimes(static_cast<double>(shutter.depth_delay_ms),
                                                                      static_cast<double>(shutter.depth_readout_ms),
                                                                      static_cast<double>(shutter.color_readout_ms)));
    if (!sums.empty()) sensor_timing_.add(sums, used);
    previous_depth_delay_s_ = timing.depth_delay_s;
}

/// The back end has moved the camera or deformed the map.
void DenseSlam::predict_from(const Eigen::Isometry3d& T_world_camera) {
    auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    record.world_live = to_device(T_world_camera);
    record.failed = 0;  // the live frame may fill holes again
    if (!prediction_) {
        prediction_ = std::make_unique<Sequence>(context_);
        prediction_->copy(host_record_, tracker_.record, sizeof(gpu::TrackingRecord));
        enqueue_prediction(*prediction_);
        prediction_->finish();
    }
    prediction_->run();
}

void DenseSlam::forget_recordings() {
    first_frame_.reset(), next_frame_.reset(), prediction_.reset();
    tracking_.reset(), masking_.reset(), second_tracking_.reset(), mapping_.reset();
    back_end_.forget_recordings();
}

void DenseSlam::set_config(const SlamConfig& config) {
    const bool localise_only = config_.localise_only;  // part of the recorded commands, as is the shutter
    const ShutterConfig shutter = config_.shutter;
    config_ = config;
    config_.localise_only = localise_only;
    config_.shutter = shutter;
}

bool DenseSlam::has_bad_start() const {
    const int failures = back_end_.failures();
    if (config_.localise_only || !sees_enough()) return false;
    const auto& counters = host_counters_.host<gpu::MapRecord>()[0];
    const auto pixels = static_cast<float>(pixels_at(camera_, 0));
    const bool is_young = static_cast<float>(counters.stable) < StartConfig::kMinStable * pixels;
    if (is_young && frames_ <= StartConfig::kMaxSeenThroughFrames && is_seen_through()) return true;
    if (failures < StartConfig::kPatience) return false;
    const auto lost = static_cast<std::uint32_t>(failures);
    const std::uint32_t tracked = frames_ > lost ? frames_ - lost : 0;
    return is_young || (tracked < StartConfig::kMaxFrames && tracked < lost);
}

bool DenseSlam::is_seen_through() const {
    const auto& counters = host_counters_.host<gpu::MapRecord>()[0];
    const auto in_view = static_cast<float>(counters.in_view);
    return in_view >= StartConfig::kMinView * static_cast<float>(pixels_at(camera_, 0)) &&
           static_cast<float>(counters.seen_through) >= StartConfig::kSeenThrough * in_view;
}

bool DenseSlam::is_lost_for_good() const {
    const int patience = config_.pieces.begin_after;
    return patience > 0 && back_end_.failures() >= patience && config_.relocalisation.enabled &&
           !config_.localise_only && sees_enough();
}

bool DenseSlam::sees_enough() const {
    const std::uint32_t in_view = host_record_.host<gpu::TrackingRecord>()[0].valid_pixels;
    return static_cast<float>(in_view) >= StartConfig::kMinView * static_cast<float>(pixels_at(camera_, 0));
}

Alignment DenseSlam::align_newest(const Eigen::Isometry3d& T_world_camera, float min_overlap) {
    const TrackedFrame frame{
        host_params_.host<gpu::Params>()[0], T_world_camera, Matrix6d::Zero(), false, 0, images_, pyramids_, map_};
    return back_end_.align(frame, T_world_camera, min_overlap);
}

void DenseSlam::place_camera(const Eigen::Isometry3d& T_world_camera) {
    back_end_.found_camera();
    host_params_.host<gpu::Params>()[0] = params_of_frame();
    write(context_, std::as_bytes(host_params_.host<gpu::Params>()), params_);
    predict_from(T_world_camera);
}

void DenseSlam::follow(std::span<const Eigen::Isometry3d> poses) {
    if (poses.size() != back_end_.trajectory().size())
        throw Error("the trajectory has " + std::to_string(back_end_.trajectory().size()) + " frames, and " +
                    std::to_string(poses.size()) + " poses are given for them");
    if (poses.empty()) return;
    back_end_.follow(map_, poses);
    if (back_end_.failures() == 0) predict_from(back_end_.last_pose());
}

void DenseSlam::restart() {
    SlamState empty;
    empty.camera = camera_;
    empty.map = map_.empty_state();
    empty.tracking = tracker_.first_state(model_, model_color_);
    empty.back_end.ferns = back_end_.fern_identity();
    restore(empty);
}

std::vector<Surfel> DenseSlam::surfels(float min_confidence) const {
    return read_surfels(context_, map_, min_confidence);
}

ModelView DenseSlam::render(const Eigen::Isometry3d& T_world_camera) const {
    return render_view(context_, map_, camera_, make_params(camera_, config_), T_world_camera, images_);
}

std::shared_ptr<MapSnapshot> DenseSlam::snapshot(SnapshotExchange& exchange) const {
    auto snapshot = exchange.blank(shared_context_, camera_, map_.slots());
    snapshot->copy_from(map_, images_, model_.depth[0], model_color_, frames_ - 1);
    return snapshot;
}

}  // namespace posefusion
