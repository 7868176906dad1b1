#include "hosts/pipeline/posefusion.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/median.hpp"
#include "engine/core/stopwatch.hpp"
#include "engine/objects/object_tracker.hpp"
#include "engine/slam/map_piece.hpp"
#include "hosts/pipeline/undistort_on_device.hpp"
#include "segmentation/motion_segmenter.hpp"

namespace posefusion {
namespace {

const RunConfig& checked(const RunConfig& config) {
    check_config(config);
    return config;
}

DepthRange depth_range(const RunConfig& config) {
    return {config.slam.preprocess.depth_min, config.slam.preprocess.depth_max};
}

std::optional<SparseStart> make_sparse_start(const RunConfig& config, const Intrinsics& camera) {
    if (!config.features.sparse_start) return std::nullopt;
    return SparseStart(camera, config.slam.noise, config.features);
}

}  // namespace

void PoseFusion::find_people(ProcessedFrame& frame) {
    FoundPeople& people = frame.people;

    // Step 1, eq. (1): the joints of people in the colour image.
    const Stopwatch joints_watch;
    people.joints = people_->find_joints(frame.input);
    if (people.joints) people.joints_ms = joints_watch.milliseconds();

    // Where the network missed somebody, the mask of the previous frame is carried over by the motion of the camera.
    const Eigen::Isometry3f T_previous_current = motion_.predict(frame.number, frame.input.stamp, frame.previous_stamp);

    // Step 2, eq. (2), (3): the min-cut of people from the depth image, around their joints.
    const Stopwatch segmentation_watch;
    people.segmentation = people_->segment(frame.input, people.joints, T_previous_current);
    if (!people.segmentation.labels.empty()) people.segmentation_ms = segmentation_watch.milliseconds();

    find_start(frame);
}

/// How the camera moved, by features of the static scene.
void PoseFusion::find_start(ProcessedFrame& frame) {
    if (!sparse_start_) return;
    const Stopwatch watch;
    frame.starts = sparse_start_->find(frame.input.color, frame.input.depth, frame.people.segmentation.labels);
    frame.features_ms = watch.milliseconds();
}

void PoseFusion::track_and_map(ProcessedFrame& frame) {
    // Step 3: dense SLAM on what is left. The engine leaves out what is labelled.
    FrameTiming timing;
    if (frame.number > 0) timing.interval_s = to_seconds(frame.input.stamp - frame.previous_stamp);
    timing.depth_delay_s = to_seconds(frame.input.depth_delay);
    if (follows_a_gap(frame.input.stamp)) slam_.lose_camera();
    frame.result =
        slam_.process(frame.input.color, frame.input.depth, frame.people.segmentation.labels, timing, frame.starts);

    add_undistortion_time(frame.input, frame.result);
    const bool found = has_pose(frame.result.tracking);
    motion_.publish({frame.input.stamp, frame.result.T_world_tracked, frame.result.T_world_camera, found});
    frames_.push_back({frame.input.stamp, found});
}

bool PoseFusion::follows_a_gap(Stamp stamp) const {
    std::vector<double> intervals;
    for (std::size_t i = frames_.size() - std::min(frames_.size(), GapConfig::kRecent); i + 1 < frames_.size(); ++i)
        intervals.push_back(to_seconds(frames_[i + 1].stamp - frames_[i].stamp));
    if (intervals.empty()) return false;
    const double gap = to_seconds(stamp - frames_.back().stamp);
    return gap >= GapConfig::kLeast_s && gap >= GapConfig::kIntervals * upper_median(intervals);
}

ProcessedFrame PoseFusion::process(Frame input, std::optional<LabelImage> labels) {
    ProcessedFrame frame;
    frame.number = frames_.size();
    frame.previous_stamp = frames_.empty() ? Stamp{} : frames_.back().stamp;
    if (!frames_.empty() && input.stamp <= frame.previous_stamp) {
        throw Error("time stamp " + seconds_text(input.stamp) +
                    " s does not come after that of the frame before; give frames in order");
    }
    frame.input = std::move(input);
    if (labels) {
        frame.people.segmentation = segmentation_of(std::move(*labels));
        find_start(frame);
    } else {
        find_people(frame);
    }
    track_and_map(frame);
    return frame;
}

ProcessedFrame PoseFusion::process(ColorImage color, DepthImage depth, Stamp stamp, std::optional<LabelImage> labels) {
    ImageGeometry::FrameImages images = geometry_.from_source(std::move(color), std::move(depth));
    Frame frame;
    frame.index = frames_.size();
    frame.stamp = stamp;
    frame.color = std::move(images.color);
    frame.depth = std::move(images.depth);
    frame.undistort = images.undistort;
    const std::string name = "frame at " + seconds_text(stamp) + " s";
    check_usable(frame, depth_range_, name, name);
    if (labels) labels = geometry_.from_source(std::move(*labels));
    return process(std::move(frame), std::move(labels));
}

PoseFusion::PoseFusion(const Camera& camera, const RunConfig& config)
    : geometry_(camera, checked(config).scale),
      depth_range_(depth_range(config)),
      people_(make_people_finder(config, geometry_.intrinsics())),
      sparse_start_(make_sparse_start(config, geometry_.intrinsics())),
      slam_(geometry_.intrinsics(), slam_config(config), config.device) {
    find_motion(config);
    undistort_on_device(geometry_, slam_);
}

PoseFusion::PoseFusion(Recording& recording, const RunConfig& config, const DeviceSharing& sharing)
    : geometry_({.intrinsics = recording.intrinsics()}, 1),
      depth_range_(depth_range(config)),
      people_(make_people_finder(checked(config), recording)),
      sparse_start_(make_sparse_start(config, recording.intrinsics())),
      slam_(recording.intrinsics(), slam_config(config), config.device, sharing) {
    find_motion(config);
    undistort_on_device(recording.geometry(), slam_);
}

/// Who decides what moves and is no person.
void PoseFusion::find_motion(const RunConfig& config) {
    if (config.no_motion) return;
    std::shared_ptr<MotionJudge> judge = make_motion_segmenter(slam_.camera(), config.slam.noise);
    if (config.objects) {
        objects_ =
            std::make_shared<ObjectTracker>(std::move(judge), slam_.context(), slam_.camera(), slam_config(config));
        judge = objects_;
    }
    slam_.set_motion_judge(std::move(judge));
}

std::vector<ObjectMap> PoseFusion::object_maps(bool stable_only) const {
    return objects_ ? objects_->maps(stable_only) : std::vector<ObjectMap>{};
}

Trajectory PoseFusion::trajectory() const {
    const std::vector<Eigen::Isometry3d> poses = slam_.trajectory();
    const std::vector<std::uint32_t> numbers = slam_.frames();
    const std::size_t earlier = slam_.frames_processed() - frames_.size();  // of a map that was restored
    Trajectory trajectory;
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (numbers[i] < earlier) continue;
        const TrackedFrame& frame = frames_[numbers[i] - earlier];
        if (frame.found) trajectory.push_back({frame.stamp, poses[i]});
    }
    return trajectory;
}

ByteArray PoseFusion::people_state() const {
    const ByteArray people = people_->state(), features = sparse_start_ ? sparse_start_->state() : ByteArray{};
    StateWriter out;
    out.put(std::uint64_t{people.size()});
    out.raw(people.data(), people.size());
    out.raw(features.data(), features.size());
    return out.take();
}

void PoseFusion::restore(const AtlasState& map, const ByteArray& people,
                         const std::vector<MotionPrediction::Pose>& poses) {
    slam_.restore(map);
    StateReader in(people, "the state of the people and features");
    const auto people_bytes = in.get<std::uint64_t>();
    in.expect(people_bytes);
    const std::span<const std::byte> both = std::span(people).subspan(sizeof(people_bytes));
    if (sparse_start_) sparse_start_->restore(both.subspan(people_bytes));
    people_->restore(both.first(people_bytes));
    motion_.restart(poses);
    frames_.clear();
    for (const MotionPrediction::Pose& pose : poses) frames_.push_back({pose.stamp, pose.found});
}

void PoseFusion::continue_in(const SlamState& map) {
    slam_.restore(map);
    if (objects_) objects_->clear();
    slam_.lose_camera();
    motion_.restart({});
    if (sparse_start_) sparse_start_->restart();
    frames_.clear();
}

void PoseFusion::reset(std::unique_ptr<PeopleFinder> people) {
    people_ = std::move(people);
    slam_.reset();
    if (objects_) objects_->clear();
    motion_.restart({});
    if (sparse_start_) sparse_start_->restart();
    frames_.clear();
}

}  // namespace posefusion
