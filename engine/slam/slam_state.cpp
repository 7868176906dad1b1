#include "engine/slam/slam_state.hpp"

#include <algorithm>

#include "engine/core/error.hpp"
#include "engine/slam/dense_slam.hpp"
#include "engine/slam/input_checks.hpp"

namespace posefusion {

SlamState DenseSlam::state() const {
    SlamState state;
    state.camera = camera_;
    state.frames = frames_;
    state.map = map_.state();
    state.tracking = tracker_.state(model_, model_color_);
    state.back_end = back_end_.state();
    return state;
}

void DenseSlam::restore(const SlamState& state) {
    check_same_camera(camera_, state.camera);
    if (!tracker_.fits(state.tracking, model_, model_color_) || state.back_end.trajectory.size() != state.frames ||
        state.back_end.information.size() != state.frames) {
        throw Error("the map to be restored contradicts itself; use another file");
    }
    map_.check(state.map);
    back_end_.restore(state.back_end);
    forget_recordings();
    map_.restore(state.map);
    tracker_.restore(state.tracking, model_, model_color_);
    frames_ = state.frames;
    first_.reset();
    // as if the last frame had just come back from the device
    std::copy(state.tracking.record.begin(), state.tracking.record.end(), host_record_.host<std::byte>().begin());
    std::copy(state.map.counters.begin(), state.map.counters.end(), host_counters_.host<std::byte>().begin());
}

}  // namespace posefusion
