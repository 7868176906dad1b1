#pragma once
namespace posefusion {

/// When the pixels of a frame were taken. Rows of a rolling shutter are read one after another, and colour and depth
/// come from two sensors: while the camera moves, each row sees the scene from its own pose.
struct ShutterConfig {
    float color_readout_ms = 0;  ///< from the first row to the last; 0: all at once (global shutter)
    float depth_readout_ms = 0;
    float stamp_row = 0.5f;    ///< the row that the time stamp refers to: 0 first, 0.5 middle, 1 last
    float depth_delay_ms = 0;  ///< how much later than its stamp depth was taken, relative to colour

    /// Whether every pixel is taken at the stamp.
    [[nodiscard]] bool is_global() const {
        return color_readout_ms == 0 && depth_readout_ms == 0 && depth_delay_ms == 0;
    }
};

/// The timing of a frame, as known to the host.
struct FrameTiming {
    double interval_s = 1.0 / 30;  ///< since the previous frame
    double depth_delay_s = 0;      ///< how much later than colour depth was taken, by the stamps of this frame
};

}  // namespace posefusion
