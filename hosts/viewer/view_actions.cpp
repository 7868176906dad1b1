#include "hosts/viewer/view_actions.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace posefusion {
namespace {

constexpr std::array kBindings{
    KeyBinding{GLFW_KEY_SPACE, "Space", ViewAction::PlayPause, "play or pause"},
    KeyBinding{GLFW_KEY_N, "N", ViewAction::Step, "one frame, then pause"},
    KeyBinding{GLFW_KEY_R, "R", ViewAction::Reset, "back to the start, with an empty map"},
    KeyBinding{GLFW_KEY_C, "C", ViewAction::NextColors, "colour by photo, normal, confidence, age, time"},
    KeyBinding{GLFW_KEY_F, "F", ViewAction::Follow, "follow the camera, or orbit"},
    KeyBinding{GLFW_KEY_HOME, "Home", ViewAction::Home, "look from where it began"},
    KeyBinding{GLFW_KEY_M, "M", ViewAction::SaveMap, "save the map (PLY)"},
    KeyBinding{GLFW_KEY_T, "T", ViewAction::SaveTrajectory, "save the trajectory (TUM)"},
    KeyBinding{GLFW_KEY_P, "P", ViewAction::Screenshot, "save a picture of the window (PNG)"},
    KeyBinding{GLFW_KEY_TAB, "Tab", ViewAction::Panels, "show or hide the panels"},
    KeyBinding{GLFW_KEY_H, "H", ViewAction::Help, "show or hide this help"},
    KeyBinding{GLFW_KEY_ESCAPE, "Esc", ViewAction::Close, "close"},
};

bool same_letters(std::string_view a, std::string_view b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

template <class Predicate>
std::optional<ViewAction> find(Predicate predicate) {
    const auto found = std::find_if(kBindings.begin(), kBindings.end(), predicate);
    return found == kBindings.end() ? std::nullopt : std::optional(found->action);
}

}  // namespace

std::span<const KeyBinding> key_bindings() { return kBindings; }

std::optional<ViewAction> action_of_key(int key) {
    return find([&](const KeyBinding& binding) { return binding.key == key; });
}

std::optional<ViewAction> action_of_key_name(std::string_view name) {
    return find([&](const KeyBinding& binding) { return same_letters(binding.name, name); });
}

}  // namespace posefusion
