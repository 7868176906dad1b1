#pragma once
#include <chrono>
#include <deque>
#include <filesystem>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "hosts/run/run_session.hpp"
#include "hosts/viewer/background_run.hpp"
#include "hosts/viewer/draw_pace.hpp"
#include "hosts/viewer/frame_drawer.hpp"
#include "hosts/viewer/frame_feed.hpp"
#include "hosts/viewer/gui.hpp"
#include "hosts/viewer/panels.hpp"
#include "hosts/viewer/playback.hpp"
#include "hosts/viewer/scene_renderer.hpp"
#include "hosts/viewer/view_script.hpp"
#include "hosts/viewer/view_settings.hpp"
#include "hosts/viewer/window.hpp"

namespace posefusion {

/// A window around a run. The run has its own thread and hands over what is to be drawn; drawing takes the newest and
/// never makes it wait: a slow window shows fewer frames.
class Viewer {
public:
    /// All three must outlive this. @param config  that of the session; the sliders change its engine parameters
    /// @param script  what to do; nullopt = what the user does
    Viewer(Window& window, RunSession& session, RunConfig& config, std::optional<std::vector<ScriptStep>> script);
    ~Viewer();

    /// Until the window is closed, the script is at its end or the program is interrupted. Throws Error of the script.
    void run();

    [[nodiscard]] const BackgroundRun& background() const { return run_; }
    [[nodiscard]] std::uint64_t frames_drawn() const { return drawer_.frames(); }
    /// Device time of the drawn frames in the middle of all, milliseconds; 0 = none.
    [[nodiscard]] double median_draw_ms() const;

private:
    void connect_window();
    void act(ViewAction action);
    void reset(bool playing);
    void parameters_changed();
    void set_live(const std::string& key, const std::string& value);
    /// Runs the script as far as it goes now. @return false: it is at its end
    [[nodiscard]] bool follow_script();
    /// @return false: not complete yet, to be called again
    [[nodiscard]] bool do_step(const ScriptStep& step);
    void show(const ScriptStep& step);

    void collect_news();
    /// @return false: nothing could be drawn now
    bool draw(bool with_screenshot = false);
    [[nodiscard]] PanelFacts panel_facts() const;
    [[nodiscard]] SceneView scene_view(WindowSize size) const;
    void update_lines();

    [[nodiscard]] bool up_to_date() const;  ///< what is drawn is all there is
    [[nodiscard]] std::filesystem::path file_for(const std::string& what, const std::string& ending) const;
    void save_map(const std::filesystem::path& file, bool wait);
    void save_trajectory(const std::filesystem::path& file);
    [[nodiscard]] bool save_screenshot(const std::filesystem::path& file);
    [[nodiscard]] double now() const;

    Window& window_;
    RunSession& session_;
    RunConfig& config_;
    std::optional<std::vector<ScriptStep>> script_;
    std::size_t script_at_ = 0;
    std::optional<std::uint64_t> draw_until_;  // of the step "draw"
    bool step_begun_ = false;                  // of a step that waits
    bool close_ = false;

    std::shared_ptr<vulkan::Context> context_;
    FrameDrawer drawer_;
    SceneRenderer scene_;
    Gui gui_;
    ViewSettings settings_;
    Panels panels_;
    DrawPace pace_;
    std::vector<float> draw_times_;    // milliseconds
    std::uint32_t surfels_drawn_ = 0;  // in the last frame
    bool coarse_ = false;              // not all of them

    FrameFeed feed_;
    Playback playback_;
    BackgroundRun run_;
    std::optional<FrameNews> newest_;
    std::vector<Eigen::Vector3f> path_;
    std::string message_;
    std::future<std::string> saving_;  // of the map
    std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace posefusion
