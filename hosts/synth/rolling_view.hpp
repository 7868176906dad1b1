#pragma once
#include <vector>

#include "hosts/synth/skeleton.hpp"

namespace posefusion::synth {

/// From where a row of an image is seen, and when: see Moment.
struct RowView {
    Isometry3f T_world_camera;
    float moment = 0;
};

/// One per row of the image. A global shutter has the same for all.
using RollingView = std::vector<RowView>;

}  // namespace posefusion::synth
