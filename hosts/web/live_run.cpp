#include "hosts/web/live_run.hpp"

#include <algorithm>

#include "hosts/web/keyframe_images.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kMostPictures = 60;  // 14 MB

bool moves_earlier_poses(const FrameResult& result) {
    return result.map_change != MapChange::None ||
           std::any_of(result.loops.begin(), result.loops.end(), [](const LoopEvent& event) { return event.accepted; });
}

}  // namespace

void LiveRun::add(const ScheduledFrame& frame, const Slam& slam) {
    Frame news;
    news.stamp = frame.input.stamp;
    news.tracked = has_pose(frame.result.tracking);
    news.in_map = true;
    news.T_world_camera = frame.result.T_world_camera;
    news.is_keyframe = frame.result.keyframes > keyframes_;
    if (!frame.people.ids.empty()) news.people = people_in_view(frame.people.segmentation.skeletons, frame.people.ids);
    std::erase_if(news.people, [](const PersonInView& person) { return person.id == 0; });
    if (news.is_keyframe) keep_picture(frame.input.color);
    keyframes_ = frame.result.keyframes;
    const bool first = [&] {
        const std::lock_guard lock(mutex_);
        news.number = next_number_++;
        state_.frames.push_back(std::move(news));
        return state_.frames.size() == 1;
    }();
    // at first, to know how many frames came before: of a loaded map
    if (first || moves_earlier_poses(frame.result)) correct(slam);
}

void LiveRun::correct(const Slam& slam) {
    const std::vector<Eigen::Isometry3d> poses = slam.trajectory();
    const std::vector<std::uint32_t> numbers = slam.frames();  // counted over all frames
    const std::vector<std::uint32_t> keyframes = slam.keyframes();
    const std::lock_guard lock(mutex_);
    std::vector<Frame>& frames = state_.frames;
    const std::size_t earlier = slam.frames_processed() - frames.size();
    for (Frame& frame : frames) frame.in_map = frame.is_keyframe = false;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] < earlier) continue;
        Frame& frame = frames.at(numbers[i] - earlier);
        frame.T_world_camera = poses[i];
        frame.number = static_cast<std::uint32_t>(i);
        frame.in_map = true;
        frame.is_keyframe = std::binary_search(keyframes.begin(), keyframes.end(), i);
    }
    next_number_ = static_cast<std::uint32_t>(numbers.size());
}

LiveRun::State LiveRun::state() const {
    const std::lock_guard lock(mutex_);
    return state_;
}

/// Of more and more keyframes one is kept, so that the pictures are spread over the run.
void LiveRun::keep_picture(const ColorImage& image) {
    if (pictures_seen_++ % one_of_ != 0) return;
    auto picture = std::make_shared<const ColorImage>(small_picture(image));
    const std::lock_guard lock(mutex_);
    std::vector<Picture>& pictures = state_.pictures;
    pictures.push_back({state_.frames.size(), std::move(picture)});
    if (pictures.size() <= kMostPictures) return;
    for (std::size_t i = 1; i < pictures.size(); ++i)
        if (i % 2 == 0) pictures[i / 2] = pictures[i];
    pictures.resize((pictures.size() + 1) / 2);
    one_of_ *= 2;
}

}  // namespace posefusion
