#include "hosts/pipeline/undistort_on_device.hpp"

#include <memory>

#include "engine/preprocess/undistortion.hpp"

namespace posefusion {

void undistort_on_device(ImageGeometry& geometry, const Slam& slam) {
    const LensMap& lens = geometry.lens();
    if (lens.empty() || lens.size() > Undistortion::most_pixels(*slam.context())) return;
    const auto undistortion = std::make_shared<const Undistortion>(slam.context(), lens);
    geometry.undistort_by(
        [undistortion](ColorImage& color, DepthImage& depth) { return undistortion->apply(color, depth); });
}

void add_undistortion_time(const Frame& frame, FrameResult& result) {
    const std::optional<double> time = frame.undistort.device_ms;
    if (time) result.gpu_times.insert(result.gpu_times.begin(), {"undistort", *time});
}

}  // namespace posefusion
