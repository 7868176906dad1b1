#pragma once
#include <filesystem>
#include <functional>

#include "engine/slam/slam.hpp"
#include "hosts/io/trajectory.hpp"

namespace posefusion {

/// What the camera would have seen without people and what else moves: the stable map, rendered from each pose. A
/// recording in TUM layout, with the poses as its ground truth, and with holes/STAMP.png beside rgb and depth: 255
/// where the map shows nothing, which colour and depth have 0 for, else 0. One frame at a time is in memory.
/// @param folder  without another recording  @param progress  frames done
/// Throws Error: the folder cannot be written to, or holds a recording.
void write_background(const std::filesystem::path& folder, const Slam& slam, const Trajectory& trajectory,
                      const std::function<void(std::size_t)>& progress);

/// Removes what write_background() wrote there, and the folder if nothing else is in it.
void remove_background(const std::filesystem::path& folder);

}  // namespace posefusion
