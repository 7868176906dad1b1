#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/frame_source.hpp"

/// Depth images that are read in the wrong unit.
namespace posefusion {

/// Throws Error, with a depth_scale that would fit, when no room is like that: a median of the measured values below
/// 5 cm or above 50 m.
/// @param values  measurements, in the units of the images  @param location  of the recording, for messages
/// @return a warning where the unit may be wrong: the depth is so near that the images may be in millimetres, although
///         they are read in the units of TUM's recordings
[[nodiscard]] std::optional<std::string> judge_depth_unit(const std::vector<std::uint16_t>& values, float depth_scale,
                                                          const std::string& location);

/// The same for the first depth images of a recording; a camera's driver knows its unit.
[[nodiscard]] std::optional<std::string> check_depth_unit(const FrameSource& source);

}  // namespace posefusion
