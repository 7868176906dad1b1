#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "hosts/web/run_results.hpp"
#include "hosts/web/scene.hpp"

namespace posefusion {

/// Fills in the images of the keyframes, from the recording of the run and prepared as the run prepared them
/// (config.yaml in its folder): at most 320 pixels wide, of at most 60 keyframes spread over the run.
/// @param cancelled  asked before each image
/// @return why there are none; empty: there are
std::string add_keyframe_images(WebScene& scene, const std::filesystem::path& folder, const RunResults& results,
                                const std::function<bool()>& cancelled);

}  // namespace posefusion
