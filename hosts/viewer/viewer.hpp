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
#include "hosts/viewer/shown_objects.hpp"
#include "hosts/viewer/view_script.hpp"
#include "hosts/viewer/view_settings.hpp"
#include "hosts/viewer/window.hpp"

namespace posefusion {

/// The window of a run. The run has its own thread and publishes its frames; the window draws the newest and never
/// delays the run: a slow window shows fewer frames.
class Viewer {
public:
    /// All three must outlive this. @param config  that of the session; the sliders change its engine parameters
    /// @param script  steps to perform; nullopt = interactive
    Viewer(Window& window, RunSession& session, RunConfig& config, std::optional<std::vector<ScriptStep>> script);
    ~Viewer();

    /// Runs until the window is closed, the script has ended or the program is interrupted. Throws Error of the script.
    void run();

    [[nodiscard]] const BackgroundRun& background() const { return run_; }
    [[nodiscard]] std::uint64_t frames_drawn() const { return drawer_.frames(); }
    /// Median device time of the drawn frames, milliseconds; 0 = none.
    [[nodiscard]] double median_draw_ms() const;

private:
    void connect_window();
    void act(ViewAction action);
    void reset(bool playing);
    void parameters_changed();
    void set_live(const std::string& key, const std::string& value);
    /// Performs all steps of the script that are possible now. @return false: it has ended
    [[nodiscard]] bool follow_script();
    /// @return false: not complete yet, call again
    [[nodiscard]] bool do_step(const ScriptStep& step);
    void show(const ScriptStep& step);

    void collect_news();
    /// @return false: nothing could be drawn
    bool draw(bool with_screenshot = false);
    [[nodiscard]] PanelFacts panel_facts() const;
    [[nodiscard]] SceneView scene_view(WindowSize size) const;
    void update_lines();
    void update_objects();
    [[nodiscard]] std::vector<SceneLabel> object_labels(const SceneView& view) const;

    [[nodiscard]] bool up_to_date() const;  ///< the window shows the newest state completely
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
    std::optional<std::uint64_t> draw_until_;  // target of the step "draw"
    double resize_until_ = 0;                  // now() at which a resize is given up
    bool step_begun_ = false;                  // the current step is waiting
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
    bool coarse_ = false;              // not all surfels were drawn

    FrameFeed feed_;
    Playback playback_;
    BackgroundRun run_;
    std::optional<FrameNews> newest_;
    std::vector<Eigen::Vector3f> path_;
    ShownObjects objects_;
    std::optional<std::size_t> models_of_;  // number of the frame that the models of objects are of, where it is known
    bool objects_changed_ = false;          // since they were handed to the renderer
    std::string message_;
    std::future<std::string> saving_;  // saving of the map
    std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

}  // namespace posefusion
