#include "hosts/web/live_page.hpp"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "engine/slam/snapshot_surfels.hpp"
#include "hosts/run/people_json.hpp"
#include "hosts/web/keyframe_images.hpp"
#include "hosts/web/web_page.hpp"

namespace posefusion {
namespace {

using namespace std::chrono_literals;

constexpr auto kTick = 50ms;
constexpr auto kLeastInterval = 400ms;  // between two publications
constexpr auto kPatience = 1s;          // for a frame, after which its map is taken
constexpr int kRest = 4;                // times what a publication took, before the next one
constexpr auto kAttention = 3s;         // who has not asked for so long has gone
constexpr auto kQuiet = 1s;             // at the end: who asks for nothing any more has everything
constexpr auto kLongestFarewell = 10s;
constexpr std::size_t kMostSurfels = 100'000;  // encoded for a publication
constexpr std::size_t kPosesPerPart = 128;
constexpr double kTilt = 2, kShift = 0.1;  // degrees, metres: by so much the axes may be off before all is turned
constexpr int kNiceness = 10;

constexpr const char* kStateUrl = "live/state";
constexpr const char* kLiveFolder = "live/";
constexpr const char* kJson = "application/json";

std::string cell_url(std::size_t id) { return "live/map/" + std::to_string(id); }
std::string path_url(std::size_t part) { return "live/path/" + std::to_string(part); }
std::string picture_url(std::size_t frame) { return "live/keyframes/" + std::to_string(frame) + ".jpg"; }

/// On Linux the priority of a process is that of its thread.
void run_this_thread_last() {
    (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), kNiceness);  // if not, not
}

/// Whether page frames differ so much that everything is worth being sent again.
bool differ(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, const Trajectory& trajectory) {
    const double angle = Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() * 180 / std::numbers::pi;
    if (trajectory.empty()) return angle > kTilt;
    const Eigen::Vector3d first = trajectory.front().T_world_camera.translation();
    return angle > kTilt || (a * first - b * first).norm() > kShift;
}

WebAnswer answer_of(const char* type, std::string body) {
    return {type, std::make_shared<const std::string>(std::move(body))};
}

/// People who were seen often enough to be more than a mistake, at the poses of the scene.
std::vector<ScenePerson> people_in(const std::vector<LiveRun::Frame>& frames, const std::vector<std::size_t>& poses,
                                   const Eigen::Isometry3d& T_page_world) {
    std::map<int, ScenePerson> people;
    for (std::size_t pose = 0; pose < poses.size(); ++pose) {
        const LiveRun::Frame& frame = frames[poses[pose]];
        for (const PersonInView& seen : frame.people) {
            ScenePerson& person = people[seen.id];
            person.id = seen.id;
            SceneSkeleton& skeleton = person.skeletons.emplace_back();
            skeleton.pose = pose;
            for (std::size_t i = 0; i < seen.joints.size(); ++i)
                if (seen.joints[i].confidence > 0)
                    skeleton.joints[i] = T_page_world * (frame.T_world_camera * seen.joints[i].point.cast<double>());
        }
    }
    std::vector<ScenePerson> list;
    for (auto& [id, person] : people)
        if (person.skeletons.size() >= kFewestSightings) list.push_back(std::move(person));
    return list;
}

/// Of the scene: the frame of each pose.
std::vector<std::size_t> frames_with_pose(const std::vector<LiveRun::Frame>& frames) {
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < frames.size(); ++i)
        if (frames[i].tracked && frames[i].in_map) numbers.push_back(i);
    return numbers;
}

}  // namespace

LivePage::LivePage(LivePageConfig config, Slam& slam)
    : config_(std::move(config)),
      slam_(slam),
      server_(config_.server,
              page_in_parts(config_.title, live_scene_json(config_.title, slam.camera(), map_.coding(), kStateUrl),
                            config_.library),
              [this](const std::string& path) { return answer(path); }) {
    publish(0);
    serving_ = std::thread([this] { server_.serve([this] { return stopped_.load(); }); });
    publishing_ = std::thread([this] {
        run_this_thread_last();
        try {
            publish_while_running();
            publish_at_the_end();
        } catch (const std::exception& error) {  // the run goes on without it
            if (config_.warning)
                config_.warning("the web page shows nothing new from now on: " + std::string(error.what()));
        }
    });
}

LivePage::~LivePage() {
    {
        const std::lock_guard lock(taking_);
        ended_ = true;
    }
    news_.notify_all();
    publishing_.join();
    const auto begin = Clock::now();
    while (!they_have_seen_the_end() && Clock::now() < begin + kLongestFarewell) std::this_thread::sleep_for(kTick);
    stopped_ = true;
    serving_.join();
}

void LivePage::frame_done(const ScheduledFrame& frame) {
    run_.add(frame, slam_);
    if (!wanted_) return;
    const std::lock_guard lock(taking_);
    if (!wanted_.exchange(false)) return;
    take();
    news_.notify_all();
}

void LivePage::run_ended(const std::string& status) {
    run_.correct(slam_);  // to the main piece of map
    const bool looked = somebody_looked();
    {
        const std::scoped_lock lock(taking_, mutex_);
        if (looked) {  // now, as writing the results keeps the engine busy
            take();
            last_map_ = std::exchange(offered_, {});
        }
        status_ = status;
        ended_ = true;
    }
    news_.notify_all();
}

std::optional<WebAnswer> LivePage::answer(const std::string& path) {
    if (!path.starts_with(kLiveFolder)) return std::nullopt;
    const std::lock_guard lock(mutex_);
    last_request_ = Clock::now();
    if (path == kStateUrl) asked_ = last_request_;
    const auto part = parts_.find(path);
    if (part != parts_.end()) return part->second;
    return answer_of("text/plain", "");  // it has gone since the state was told
}

bool LivePage::somebody_looks() const {
    const std::lock_guard lock(mutex_);
    return asked_ != Clock::time_point::min() && Clock::now() - asked_ < kAttention;
}

bool LivePage::somebody_looked() const {
    const std::lock_guard lock(mutex_);
    return asked_ != Clock::time_point::min();
}

bool LivePage::they_have_seen_the_end() const {
    const std::lock_guard lock(mutex_);
    const auto now = Clock::now();
    if (asked_ == Clock::time_point::min() || now - last_request_ > kAttention) return true;
    return end_published_ != Clock::time_point::max() && asked_ > end_published_ && now - last_request_ > kQuiet;
}

void LivePage::publish_while_running() {
    auto next = Clock::now();
    for (bool complete = true; !ended_; std::this_thread::sleep_for(kTick)) {
        const auto begin = Clock::now();
        if (begin < next || !somebody_looks()) continue;
        if (!take_map() && complete) continue;  // nothing new
        complete = publish(kMostSurfels);
        next = Clock::now() + std::max<Clock::duration>(kLeastInterval, kRest * (Clock::now() - begin));
    }
}

void LivePage::publish_at_the_end() {
    if (!somebody_looked()) return;
    if (last_map_.order > map_order_) use(last_map_);
    last_map_ = {};
    publish(world_map_.size());
    const std::lock_guard lock(mutex_);
    end_published_ = Clock::now();
}

bool LivePage::take_map() {
    const TakenMap map = newest_map();
    use(map);
    return map.snapshot != nullptr;
}

void LivePage::use(const TakenMap& map) {
    if (!map.snapshot) return;
    world_map_ = read_surfels(*map.snapshot, config_.least_confidence);
    map_order_ = map.order;
}

LivePage::TakenMap LivePage::newest_map() {
    std::unique_lock lock(taking_);
    offered_ = {};
    wanted_ = true;
    news_.wait_for(lock, kPatience, [&] { return offered_.snapshot != nullptr || ended_; });
    wanted_ = false;
    if (offered_.snapshot == nullptr && !ended_) take();  // no frame comes: the newest is an earlier one
    return std::exchange(offered_, {});
}

void LivePage::take() { offered_ = {slam_.snapshot(), ++taken_}; }

bool LivePage::publish(std::size_t most_surfels) {
    const LiveRun::State run = run_.state();
    Trajectory trajectory;
    for (const std::size_t frame : frames_with_pose(run.frames))
        trajectory.push_back({run.frames[frame].stamp, run.frames[frame].T_world_camera});
    const Eigen::Isometry3d T_now = page_from_world(world_map_, trajectory);
    if (differ(T_now, T_page_world_, trajectory)) T_page_world_ = T_now;
    std::vector<Surfel> surfels = world_map_;
    transform(surfels, T_page_world_);
    const bool complete = map_.update(surfels, most_surfels);

    LiveState state;
    state.frames = run.frames.size();
    state.frames_to_do = config_.frames_to_do;
    state.cells = map_.cells();
    const WebScene scene = scene_of(run);
    std::map<std::string, WebAnswer> parts;
    for (const LiveMap::Cell& cell : state.cells) parts[cell_url(cell.id)] = {"application/octet-stream", cell.bytes};
    put_path(scene, state);
    for (std::size_t i = 0; i < path_.size(); ++i) parts[path_url(i)] = answer_of(kJson, path_[i]);
    put_pictures(run, state, parts);

    const std::lock_guard lock(mutex_);
    state.status = status_;
    parts[kStateUrl] = answer_of(kJson, live_state_json(state, scene, surfels));
    parts_ = std::move(parts);
    return complete;
}

WebScene LivePage::scene_of(const LiveRun::State& run) const {
    WebScene scene;
    const std::vector<std::size_t> numbers = frames_with_pose(run.frames);
    for (const std::size_t number : numbers) {
        const LiveRun::Frame& frame = run.frames[number];
        if (frame.is_keyframe) scene.keyframes.push_back({scene.poses.size(), {}});
        scene.poses.push_back({frame.number, to_seconds(frame.stamp - run.frames[numbers.front()].stamp),
                               T_page_world_ * frame.T_world_camera});
    }
    scene.people = people_in(run.frames, numbers, T_page_world_);
    return scene;
}

void LivePage::put_path(const WebScene& scene, LiveState& state) {
    const std::size_t parts = (scene.poses.size() + kPosesPerPart - 1) / kPosesPerPart;
    path_.resize(parts);
    path_versions_.resize(parts, 0);
    for (std::size_t i = 0; i < parts; ++i) {
        const std::size_t first = i * kPosesPerPart;
        std::string text = live_path_json(scene, first, std::min(kPosesPerPart, scene.poses.size() - first));
        if (text == path_[i]) continue;
        path_[i] = std::move(text);
        path_versions_[i] = ++versions_;
    }
    state.path = path_versions_;
}

void LivePage::put_pictures(const LiveRun::State& run, LiveState& state, std::map<std::string, WebAnswer>& parts) {
    std::map<std::size_t, std::shared_ptr<const std::string>> jpegs;
    for (const LiveRun::Picture& picture : run.pictures) {
        auto& jpeg = jpegs[picture.frame];
        const auto known = jpegs_.find(picture.frame);
        jpeg = known != jpegs_.end() ? known->second : std::make_shared<const std::string>(jpeg_of(*picture.image));
        parts[picture_url(picture.frame)] = {"image/jpeg", jpeg};
    }
    jpegs_ = std::move(jpegs);
    for (const std::size_t frame : frames_with_pose(run.frames))
        if (run.frames[frame].is_keyframe)
            state.pictures.push_back(jpegs_.contains(frame) ? std::optional(frame) : std::nullopt);
}

}  // namespace posefusion
