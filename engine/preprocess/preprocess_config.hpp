#pragma once
namespace posefusion {

struct PreprocessConfig {
    float depth_min = 0.3f;    ///< nearest depth used, metres
    float depth_max = 5.0f;    ///< farthest depth used, metres
    int bilateral_radius = 2;  ///< window radius, pixels
    /// Standard deviations of the bilateral filter: in the image, pixels, and in depth, in standard deviations of the
    /// depth noise at that depth. Noise of another sensor is described by DepthNoise.
    static constexpr float kBilateralSpace = 1.5f;
    static constexpr float kBilateralRange = 3.0f;
    int normal_radius = 3;  ///< window radius of the plane fit, pixels at half resolution
    int mask_dilation = 4;  ///< person masks grow by this before tracking and fusion, pixels at 640 wide
};

}  // namespace posefusion
