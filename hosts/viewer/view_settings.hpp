#pragma once
#include <array>

#include "hosts/viewer/scene_renderer.hpp"
#include "hosts/viewer/view_camera.hpp"

namespace posefusion {

/// The user's choice of what is shown.
struct ViewSettings {
    ViewCamera camera;
    ColorMode color_mode = ColorMode::Photo;
    float min_confidence = 0;  ///< surfels below this are not drawn
    bool map = true, path = true, frustum = true, skeletons = true, objects = true, mask = true, images = true;
    bool panels = true, help = false;
};

/// Names of ColorMode in scripts and in the panel, by its value.
inline constexpr std::array<const char*, 5> kColorModes{"photo", "normal", "confidence", "age", "time"};

/// Switches of what is shown, by their names in scripts.
struct Visibility {
    const char* name;
    bool ViewSettings::*field;
    const char* label;
};
inline constexpr std::array kVisibilities{
    Visibility{"map", &ViewSettings::map, "map"},
    Visibility{"path", &ViewSettings::path, "trajectory"},
    Visibility{"frustum", &ViewSettings::frustum, "camera"},
    Visibility{"skeletons", &ViewSettings::skeletons, "skeletons"},
    Visibility{"mask", &ViewSettings::mask, "person mask"},
    Visibility{"objects", &ViewSettings::objects, "objects"},
    Visibility{"images", &ViewSettings::images, "images"},
    Visibility{"panels", &ViewSettings::panels, "panels"},
    Visibility{"help", &ViewSettings::help, "help"},
};

}  // namespace posefusion
