#include "hosts/viewer/panels.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hosts/io/frame_source.hpp"
#include "hosts/report/person_colors.hpp"
#include "hosts/run/console.hpp"

namespace posefusion {
namespace {

// Positions of the panels, pixels
constexpr float kGap = 8, kTimesHeight = 170, kMaxTileWidth = 300, kMinTileWidth = 120, kSliderWidth = 90;
constexpr float kContentWidth = 310, kScrollbar = 14, kLeftWidth = kContentWidth + kScrollbar;
constexpr float kTileShare = 0.22f;  // of the window's width
constexpr float kLabelOffset = 6, kLabelMargin = 2;
constexpr float kImageJointRadius = 2.5f, kImageLimbWidth = 1.5f;
constexpr std::size_t kHistory = 240;  // frames in the plot
/// A panel that appears must not take the focus: it would end a click that has begun on another.
constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing;
constexpr double kMebi = 1024.0 * 1024.0;

constexpr std::array<std::pair<const char*, TileContent>, 4> kTiles{{{"colour and people", TileContent::Color},
                                                                     {"static depth", TileContent::Depth},
                                                                     {"predicted colour", TileContent::PredictedColor},
                                                                     {"predicted depth", TileContent::PredictedDepth}}};

/// A parameter that can be changed during the run; its key is that of the option.
struct Slider {
    const char* key;
    float* value;
    float min, max;
};

std::vector<Slider> sliders(SlamConfig& c) {
    return {{"map.stable_confidence", &c.map.stable_confidence, 0, 50},
            {"map.predict_confidence", &c.map.predict_confidence, 0, 10},
            {"map.max_weight", &c.map.max_weight, 1, 500},
            {"map.association_depth", &c.map.association_depth, 0.005f, 0.2f},
            {"map.free_space_margin", &c.map.free_space_margin, 0, 0.3f},
            {"map.free_space_decay", &c.map.free_space_decay, 0, 1},
            {"preprocess.depth_min", &c.preprocess.depth_min, 0, 2},
            {"preprocess.depth_max", &c.preprocess.depth_max, 0.5f, 10},
            {"tracking.photometric_weight", &c.tracking.photometric_weight, 0, 50},
            {"tracking.icp_max_distance", &c.tracking.icp_max_distance, 0.01f, 0.5f},
            {"tracking.icp_robust", &c.tracking.icp_robust, 0.5f, 10},
            {"tracking.min_inlier_ratio", &c.tracking.min_inlier_ratio, 0, 1}};
}

struct Tick {
    const char* key;
    bool* value;
};

std::vector<Tick> ticks(SlamConfig& c) {
    return {{"tracking.icp", &c.tracking.icp}, {"tracking.photometric", &c.tracking.photometric}};
}

void tooltip(const Option& option) {
    if (!ImGui::IsItemHovered()) return;
    ImGui::SetTooltip("%s%s%s", option.help.c_str(), option.unit.empty() ? "" : ", ", option.unit.c_str());
}

void text(const std::string& line) { ImGui::TextUnformatted(line.c_str()); }

void place(float x, float y, float width, float height) {
    ImGui::SetNextWindowPos({x, y});
    ImGui::SetNextWindowSize({width, height});
}

bool full_width_button(const char* label, int columns) {
    const float spacing = ImGui::GetStyle().ItemSpacing.x;
    const float whole = kContentWidth - 2 * ImGui::GetStyle().WindowPadding.x;
    return ImGui::Button(label, {(whole - spacing * static_cast<float>(columns - 1)) / static_cast<float>(columns), 0});
}

/// A share of the window's width, or less if the tiles would not fit below each other.
float tile_width(const PanelFacts& facts) {
    const float room = (facts.window_height - 4 * kGap) / static_cast<float>(kTiles.size());
    const float height = room - ImGui::GetTextLineHeightWithSpacing() - ImGui::GetStyle().ItemSpacing.y;
    const float fitting = height * static_cast<float>(facts.camera.width) / static_cast<float>(facts.camera.height);
    return std::clamp(std::min(kTileShare * facts.window_width, fitting), kMinTileWidth, kMaxTileWidth);
}

/// Panels are laid out in units of the desktop, which are several pixels each on high-resolution displays.
void scale_to_pixels(PanelResult& result) {
    const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
    for (Tile& tile : result.tiles) {
        tile.left *= pixels.x, tile.width *= pixels.x;
        tile.top *= pixels.y, tile.height *= pixels.y;
    }
    result.centre *= glm::vec2(pixels.x, pixels.y);
}

/// A line each.
void show_objects(const std::vector<ShownObject>& objects) {
    for (const ShownObject& object : objects) {
        const Rgb8 color = label_color(object.label);
        const std::string now = object.T_world_object ? fmt::format("{} pixels", object.pixels) : "not tracked now";
        ImGui::TextColored(ImVec4(ImColor(color.r, color.g, color.b)), "object %d: %zu frames, %s", int{object.label},
                           object.frames, now.c_str());
    }
}

/// Joints and limbs over a tile of the colour image.
void draw_joints(const People& people, const Tile& tile, const Intrinsics& camera) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    const ImU32 bone = IM_COL32(255, 255, 255, 220), dot = IM_COL32(230, 30, 60, 255);
    const auto at = [&](const JointObservation& joint) {
        return ImVec2(tile.left + joint.u / static_cast<float>(camera.width) * tile.width,
                      tile.top + joint.v / static_cast<float>(camera.height) * tile.height);
    };
    list.PushClipRect({tile.left, tile.top}, {tile.left + tile.width, tile.top + tile.height}, true);
    for (const Person& person : people) {
        const auto joint = [&](int i) -> const JointObservation& { return person.joints[static_cast<std::size_t>(i)]; };
        for (const auto& [a, b] : kLimbs) {
            if (joint(a).p > 0 && joint(b).p > 0) list.AddLine(at(joint(a)), at(joint(b)), bone, kImageLimbWidth);
        }
        for (const JointObservation& j : person.joints) {
            if (j.p > 0) list.AddCircleFilled(at(j), kImageJointRadius, dot);
        }
    }
    list.PopClipRect();
}

}  // namespace

void draw_labels(const std::vector<SceneLabel>& labels) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
    for (const SceneLabel& label : labels) {
        const char* words = label.text.c_str();
        const ImVec2 at(label.pixel.x / pixels.x + kLabelOffset, label.pixel.y / pixels.y - kLabelOffset);
        const ImVec2 size = ImGui::CalcTextSize(words);
        list.AddRectFilled({at.x - kLabelMargin, at.y}, {at.x + size.x + kLabelMargin, at.y + size.y},
                           IM_COL32(0, 0, 0, 170));
        list.AddText(at, IM_COL32(label.color.r, label.color.g, label.color.b, 255), words);
    }
}

Panels::Panels(RunConfig& config) : config_(config), options_(option_table(config)) {}

void Panels::add(const FrameNews& news) {
    const float none = std::numeric_limits<float>::quiet_NaN();
    std::vector<std::pair<std::string, double>> now = news.stages_ms;
    now.emplace_back("latency", news.latency_ms);
    const auto is = [](const std::string& name) { return [&](const auto& stage) { return stage.first == name; }; };
    auto position = stages_.begin();  // position for a stage that has not been seen before
    for (const auto& [name, ms] : now) {
        auto stage = std::find_if(stages_.begin(), stages_.end(), is(name));
        if (stage == stages_.end()) stage = stages_.insert(position, {name, {}});
        position = stage + 1;
    }
    for (auto& [name, history] : stages_) {
        const auto found = std::find_if(now.begin(), now.end(), is(name));
        history.push_back(found == now.end() ? none : static_cast<float>(found->second));
        if (history.size() > kHistory) history.pop_front();
    }
}

void Panels::clear() { stages_.clear(); }

PanelResult Panels::show(ViewSettings& settings, PanelFacts facts) {
    facts.window_width = ImGui::GetIO().DisplaySize.x;
    facts.window_height = ImGui::GetIO().DisplaySize.y;
    PanelResult result;
    if (settings.panels) {
        place(kGap, kGap, kLeftWidth, facts.window_height - 2 * kGap);
        ImGui::Begin("PoseFusion", nullptr, kFixed);
        show_run(settings, facts, result);
        if (ImGui::CollapsingHeader("View", ImGuiTreeNodeFlags_DefaultOpen)) show_view(settings);
        if (ImGui::CollapsingHeader("Parameters", ImGuiTreeNodeFlags_DefaultOpen)) show_parameters(result);
        ImGui::End();
        show_times(facts);
    }
    if (settings.images && facts.newest != nullptr) show_images(settings, facts, result);
    if (settings.help) show_help(settings);
    const float left = settings.panels ? kLeftWidth + 2 * kGap : 0;
    const float right = result.tiles.empty() ? 0 : facts.window_width - result.tiles.front().left + kGap;
    const float below = settings.panels && !stages_.empty() ? kTimesHeight + kGap : 0;
    result.centre = {(left - right) / 2, -below / 2};
    scale_to_pixels(result);
    return result;
}

void Panels::show_run(const ViewSettings& settings, const PanelFacts& facts, PanelResult& result) {
    const auto button = [&](const char* label, int columns, ViewAction action) {
        if (full_width_button(label, columns)) result.actions.push_back(action);
    };
    button(facts.playing ? "Pause" : "Play", 3, ViewAction::PlayPause);
    ImGui::SameLine();
    button("Step", 3, ViewAction::Step);
    ImGui::SameLine();
    button("Reset", 3, ViewAction::Reset);
    button("Save map", 3, ViewAction::SaveMap);
    ImGui::SameLine();
    button("Save path", 3, ViewAction::SaveTrajectory);
    ImGui::SameLine();
    button("Picture", 3, ViewAction::Screenshot);

    const char* state = facts.ended ? "ended" : facts.playing ? "playing" : "paused";
    const std::size_t done = facts.newest == nullptr ? 0 : facts.newest->number + 1;
    const bool endless = facts.frames_total == FrameSource::kEndless;
    const bool counted = facts.real_time && facts.newest != nullptr;
    text(fmt::format("frame {}{}, {}{}", done, endless ? "" : fmt::format(" of {}", facts.frames_total), state,
                     counted ? fmt::format(", {} dropped", facts.newest->dropped) : ""));
    if (facts.newest != nullptr) {
        const FrameResult& r = facts.newest->result;
        text(map_text(r.surfels, facts.newest->people) + fmt::format("\n{} stable surfels", r.stable_surfels));
        text(fmt::format("tracking {}, {} inliers, {:.1f} mm", name_of(r.tracking), r.icp_inliers,
                         1000 * static_cast<double>(r.icp_rmse_m)));
        text(fmt::format("{} loops closed, {} keyframes", facts.newest->loops, r.keyframes));
        if (facts.objects != nullptr) show_objects(*facts.objects);
        text(fmt::format("latency {:.0f} ms, device memory {:.0f} MiB", facts.newest->latency_ms,
                         static_cast<double>(r.device_bytes) / kMebi));
    }
    text(fmt::format("{} frames drawn, {:.1f} ms", facts.frames_drawn, facts.draw_ms));
    if (!facts.message.empty()) ImGui::TextWrapped("%s", facts.message.c_str());
    if (!settings.help) ImGui::TextDisabled("H: keys");
}

void Panels::show_view(ViewSettings& settings) {
    int mode = static_cast<int>(settings.color_mode);
    if (ImGui::Combo("colour", &mode, kColorModes.data(), static_cast<int>(kColorModes.size()))) {
        settings.color_mode = static_cast<ColorMode>(mode);
    }
    ImGui::SliderFloat("confidence >", &settings.min_confidence, 0, 50, "%.1f");
    bool follow = settings.camera.follows();
    if (ImGui::Checkbox("follow", &follow)) settings.camera.follow(follow);
    int column = 1;  // of three; "follow" was the first
    for (const Visibility& visibility : kVisibilities) {
        if (column++ % 3 != 0) ImGui::SameLine(kContentWidth / 3 * static_cast<float>((column - 1) % 3));
        ImGui::Checkbox(visibility.label, &(settings.*visibility.field));
    }
}

void Panels::show_parameters(PanelResult& result) {
    ImGui::PushItemWidth(kSliderWidth);
    for (const Tick& tick : ticks(config_.slam)) {
        result.parameters_changed |= ImGui::Checkbox(tick.key, tick.value);
        tooltip(find_option(options_, tick.key));
    }
    for (const Slider& slider : sliders(config_.slam)) {
        result.parameters_changed |= ImGui::SliderFloat(slider.key, slider.value, slider.min, slider.max, "%.3g");
        tooltip(find_option(options_, slider.key));
    }
    ImGui::PopItemWidth();
}

void Panels::show_images(const ViewSettings& settings, const PanelFacts& facts, PanelResult& result) {
    const float width = tile_width(facts);
    const float height = width * static_cast<float>(facts.camera.height) / static_cast<float>(facts.camera.width);
    const ImVec2 padding = ImGui::GetStyle().WindowPadding;
    place(facts.window_width - width - 2 * padding.x - kGap, kGap, width + 2 * padding.x,
          facts.window_height - 2 * kGap);
    ImGui::Begin("Images", nullptr,
                 kFixed | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoScrollbar |
                     ImGuiWindowFlags_NoInputs);
    for (const auto& [label, content] : kTiles) {
        text(label);
        const ImVec2 corner = ImGui::GetCursorScreenPos();
        if (corner.y + height > facts.window_height) break;  // no room
        ImGui::Dummy({width, height});
        const Tile tile{corner.x, corner.y, width, height, content, settings.mask, config_.slam.preprocess.depth_max};
        result.tiles.push_back(tile);
        if (content == TileContent::Color && settings.skeletons) {
            draw_joints(facts.newest->joints, tile, facts.camera);
        }
    }
    ImGui::End();
}

void Panels::show_times(const PanelFacts& facts) {
    if (stages_.empty()) return;
    const float x = kLeftWidth + 2 * kGap;
    const float tiles = tile_width(facts) + 4 * kGap;
    const float width = facts.window_width - x - tiles;
    if (width < kMinTileWidth) return;
    place(x, facts.window_height - kTimesHeight - kGap, width, kTimesHeight);
    ImGui::Begin("Milliseconds per frame", nullptr, kFixed);
    const float row = (kTimesHeight - 3 * ImGui::GetTextLineHeightWithSpacing()) / static_cast<float>(stages_.size()) -
                      ImGui::GetStyle().ItemSpacing.y;
    for (const auto& [name, history] : stages_) {
        const std::vector<float> values(history.begin(), history.end());
        float most = 0;
        for (const float value : values) most = std::isnan(value) ? most : std::max(most, value);
        const std::string label = std::isnan(values.back()) ? name : fmt::format("{} {:.1f}", name, values.back());
        ImGui::PlotLines(label.c_str(), values.data(), static_cast<int>(values.size()), 0, nullptr, 0, most,
                         {std::max(40.0f, width - 140), std::max(8.0f, row)});
    }
    ImGui::End();
}

void Panels::show_help(ViewSettings& settings) {
    ImGui::SetNextWindowPos({kLeftWidth + 3 * kGap, 3 * kGap}, ImGuiCond_FirstUseEver);
    ImGui::Begin("Help", &settings.help, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings);
    for (const KeyBinding& binding : key_bindings()) text(fmt::format("{:<7}{}", binding.name, binding.meaning));
    text("");
    text("left button   turn around the scene");
    text("right button  shift it");
    text("wheel         nearer or farther");
    ImGui::End();
}

}  // namespace posefusion
