#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace posefusion {

/// Actions of keys and buttons.
enum class ViewAction {
    PlayPause,
    Step,
    Reset,
    NextColors,
    Follow,
    Home,
    SaveMap,
    SaveTrajectory,
    Screenshot,
    Panels,
    Help,
    Close,
};

struct KeyBinding {
    int key;           ///< GLFW's number
    const char* name;  ///< on the keyboard
    ViewAction action;
    const char* meaning;
};

/// All keys; the help window shows this table.
[[nodiscard]] std::span<const KeyBinding> key_bindings();
[[nodiscard]] std::optional<ViewAction> action_of_key(int key);
/// By KeyBinding::name, any case.
[[nodiscard]] std::optional<ViewAction> action_of_key_name(std::string_view name);

}  // namespace posefusion
