#pragma once

namespace posefusion {

/// How noisy depth is (Nguyen, Izadi & Lovell 2012, for Kinect; in the shaders: depth_sigma() in include/noise.glsl).
struct DepthNoise {
    float a = 0.0012f;     ///< metres
    float b = 0.0019f;     ///< 1/metres
    float c = 0.4f;        ///< metres
    float lateral = 0.8f;  ///< pixels (same source)
    float floor = 0.001f;  ///< metres, calibration error that no averaging removes

    /// Standard deviation of one measurement of depth z along the optical axis, metres.
    [[nodiscard]] float sigma(float z) const { return a + b * (z - c) * (z - c); }
};

}  // namespace posefusion
