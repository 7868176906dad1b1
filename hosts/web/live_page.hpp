#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "engine/slam/slam.hpp"
#include "hosts/web/live_json.hpp"
#include "hosts/web/live_map.hpp"
#include "hosts/web/live_run.hpp"
#include "hosts/web/web_server.hpp"

namespace posefusion {

struct LivePageConfig {
    WebServerConfig server;
    std::string title;
    std::size_t frames_to_do = 0;                     ///< 0 = not known
    float least_confidence = 0;                       ///< surfels below it are not shown
    std::filesystem::path library;                    ///< as for served_page()
    std::function<void(const std::string&)> warning;  ///< called by another thread, at most once
};

/// The page of a run while it is going, for browsers. A run is hardly slowed down: its map is copied on the device, and
/// only when somebody looks; reading the copy and packing it is the work of a thread that the system runs last, of
/// which it does a bounded amount at a time, and rests four times as long.
class LivePage {
public:
    /// Begins to serve. `slam` must outlive this. Throws Error as WebServer and served_page() do.
    LivePage(LivePageConfig config, Slam& slam);
    /// Those who look get the last state before it goes.
    ~LivePage();
    LivePage(const LivePage&) = delete;
    LivePage& operator=(const LivePage&) = delete;

    [[nodiscard]] const std::string& url() const { return server_.url(); }

    /// Called by the run's thread after each frame.
    void frame_done(const ScheduledFrame& frame);
    /// Called by the run's thread after the last one. @param status  how it ended, one word
    void run_ended(const std::string& status);

private:
    using Clock = std::chrono::steady_clock;

    [[nodiscard]] std::optional<WebAnswer> answer(const std::string& path);
    void publish_while_running();
    void publish_at_the_end();
    /// Takes over the newest map, if there is a new one. @return whether there was
    bool take_map();
    struct TakenMap {
        std::shared_ptr<const MapSnapshot> snapshot;  ///< nullptr: there was none that had not been taken before
        std::uint64_t order = 0;                      ///< greater for what was taken later
    };
    /// That of the next frame, as the run's thread gives it: nobody else makes the engine wait for a copy. Where no
    /// frame comes, the newest there is.
    [[nodiscard]] TakenMap newest_map();
    void take();  ///< into offered_; under taking_
    void use(const TakenMap& map);
    /// @return whether the whole map is in what is published now
    bool publish(std::size_t most_surfels);
    /// The scene without its surfels.
    [[nodiscard]] WebScene scene_of(const LiveRun::State& state) const;
    void put_path(const WebScene& scene, LiveState& state);
    void put_pictures(const LiveRun::State& run, LiveState& state, std::map<std::string, WebAnswer>& parts);
    [[nodiscard]] bool somebody_looks() const;   ///< now
    [[nodiscard]] bool somebody_looked() const;  ///< ever
    [[nodiscard]] bool they_have_seen_the_end() const;

    const LivePageConfig config_;
    Slam& slam_;
    LiveRun run_;

    // of the publishing thread
    std::vector<Surfel> world_map_;  // as the engine gave it
    std::uint64_t map_order_ = 0;    // TakenMap::order
    Eigen::Isometry3d T_page_world_ = Eigen::Isometry3d::Identity();
    LiveMap map_;
    std::map<std::size_t, std::shared_ptr<const std::string>> jpegs_;  // by frame
    std::vector<std::string> path_;
    std::vector<std::uint64_t> path_versions_;
    std::uint64_t versions_ = 0;
    std::string status_ = "running";

    mutable std::mutex mutex_;
    std::map<std::string, WebAnswer> parts_;                     // what is published
    Clock::time_point asked_ = Clock::time_point::min();         // for the state
    Clock::time_point last_request_ = Clock::time_point::min();  // for anything
    Clock::time_point end_published_ = Clock::time_point::max();

    std::mutex taking_;  // guards what follows
    std::condition_variable news_;
    std::uint64_t taken_ = 0;
    TakenMap offered_, last_map_;
    std::atomic<bool> wanted_ = false, ended_ = false;  // read without the lock, too

    std::atomic<bool> stopped_ = false;
    WebServer server_;
    std::thread serving_, publishing_;
};

}  // namespace posefusion
