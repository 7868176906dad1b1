#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "hosts/web/scene.hpp"

namespace posefusion {

/// The scene of a map and, where `source` is the folder of a run, of the path and the keyframes of that run. Throws
/// Error as read_run_results() does.
/// @param source     the map's file or the folder of its run
/// @param map        its surfels, world frame, not empty
/// @param recording  of the run, where it is now; empty = where it was
/// @param remark     called with what the page will lack and why
/// @param cancelled  asked now and then; the scene is incomplete afterwards
[[nodiscard]] WebScene read_scene(const std::filesystem::path& source, std::vector<Surfel> map,
                                  const std::filesystem::path& recording,
                                  const std::function<void(const std::string&)>& remark,
                                  const std::function<bool()>& cancelled);

}  // namespace posefusion
