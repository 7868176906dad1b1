#pragma once
#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "hosts/config/option_table.hpp"
#include "hosts/viewer/frame_feed.hpp"
#include "hosts/viewer/shown_objects.hpp"
#include "hosts/viewer/view_actions.hpp"
#include "hosts/viewer/view_settings.hpp"

namespace posefusion {

/// A word in the scene.
struct SceneLabel {
    std::string text;
    Rgb8 color;
    glm::vec2 pixel{0};  ///< of the window
};
/// Writes them beneath the panels. Called between Gui::begin() and Gui::end().
void draw_labels(const std::vector<SceneLabel>& labels);

/// Input of the panels.
struct PanelFacts {
    const FrameNews* newest = nullptr;                  ///< null: no frame is finished yet
    const std::vector<ShownObject>* objects = nullptr;  ///< null: none
    Intrinsics camera;
    std::size_t frames_total = 0;
    bool playing = false, ended = false, real_time = false;
    std::string message;  ///< of the last save, or the error that ended the run
    std::uint64_t frames_drawn = 0;
    double draw_ms = 0;                         ///< of the device, for the last drawn frame
    float window_width = 0, window_height = 0;  ///< filled in by the panels, units of the desktop
};

/// Output of the panels.
struct PanelResult {
    std::vector<ViewAction> actions;
    bool parameters_changed = false;
    std::vector<Tile> tiles;  ///< to be drawn beneath the panels
    glm::vec2 centre{0};      ///< of the area between the panels, pixels from the middle of the window
};

/// The panels of the window: playback and counters, view, parameters, images, times, help.
class Panels {
public:
    /// @param config  whose engine parameters the sliders change; must outlive this
    explicit Panels(RunConfig& config);

    /// Adds the times of a frame to the plot.
    void add(const FrameNews& news);
    void clear();
    /// Called between Gui::begin() and Gui::end().
    [[nodiscard]] PanelResult show(ViewSettings& settings, PanelFacts facts);

private:
    void show_run(const ViewSettings& settings, const PanelFacts& facts, PanelResult& result);
    void show_view(ViewSettings& settings);
    void show_parameters(PanelResult& result);
    void show_images(const ViewSettings& settings, const PanelFacts& facts, PanelResult& result);
    void show_times(const PanelFacts& facts);
    void show_help(ViewSettings& settings);

    RunConfig& config_;
    std::vector<Option> options_;
    std::vector<std::pair<std::string, std::deque<float>>> stages_;  ///< milliseconds of the last frames
};

}  // namespace posefusion
