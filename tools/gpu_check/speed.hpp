#pragma once
#include <string>
#include <vector>

#include "tools/gpu_check/replay.hpp"

namespace posefusion {

/// Times of the second half of the recording in a map that has been enlarged to so many surfels.
struct MapTimes {
    std::uint32_t surfels = 0;  ///< in the map at the end
    FrameTimes times;
};

/// The first half of the recording makes a map; copies of its stable surfels, too far away to be seen, are added to it
/// until it holds `surfels`, as if the camera had walked through that many rooms.
[[nodiscard]] std::vector<MapTimes> time_in_maps(const PackedRecording& recording, const std::string& device,
                                                 const std::vector<std::uint32_t>& surfels);

/// One column per entry of `times` below its title, one line per stage.
[[nodiscard]] std::string table_of(const std::vector<std::string>& titles, const std::vector<FrameTimes>& times);

}  // namespace posefusion
