#pragma once
namespace posefusion {

/// When the pixels of a frame were taken. Rows of a rolling shutter are read one after another, and colour and depth
/// come from two sensors: while the camera moves, each row sees the scene from a pose of its own.
struct ShutterConfig {
    float color_readout_ms = 0;  ///< from the first row to the last; 0: all at once (global shutter)
    float depth_readout_ms = 0;
    float stamp_row = 0.5f;    ///< what the time stamp is the time of: 0 the first row, 0.5 the middle, 1 the last
    float depth_delay_ms = 0;  ///< depth was taken so much later than its stamp says, as against colour

    /// Is every pixel taken at the stamp?
    [[nodiscard]] bool is_global() const {
        return color_readout_ms == 0 && depth_readout_ms == 0 && depth_delay_ms == 0;
    }
};

/// When a frame was taken, as far as the host knows.
struct FrameTiming {
    double interval_s = 1.0 / 30;  ///< since the frame before
};

}  // namespace posefusion
