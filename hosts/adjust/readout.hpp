#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>

#include "engine/core/intrinsics.hpp"

/// The rows of a rolling shutter are read one after another: each is a camera of its own, on the way of the frame's
/// camera.
namespace posefusion {

/// How a camera goes from frame to frame.
enum class Way {
    Smooth,   ///< a hand: a polynomial through the neighbours. It shakes so quickly that two are not enough: with 4 Hz
              ///< at 30 frames per second, a parabola through them takes a tenth off the speed
    Straight  ///< at the same speed from one to the next: motors that change theirs in jumps, and rendered motion
};

/// How a camera moves while a frame is read out, relative to where it is at the frame's stamp: position and rotation
/// vector as polynomials in time, one before the stamp and one after it.
class ReadoutMotion {
public:
    /// It stands still.
    ReadoutMotion() = default;
    /// A pose in the frame of the camera at the stamp.
    struct Neighbour {
        double seconds;  ///< since the stamp; not 0
        Eigen::Isometry3d T_stamp_camera;
    };
    static constexpr std::size_t kMostNeighbours = 4;
    /// Through the pose at the stamp and its neighbours, at most kMostNeighbours, each at another time.
    explicit ReadoutMotion(std::span<const Neighbour> neighbours, Way way = Way::Smooth);

    using Vector6d = Eigen::Matrix<double, 6, 1>;  ///< position, rotation vector
    enum class Side { Before, After };             ///< of the stamp
    /// The same, but on one side faster by this, per second.
    [[nodiscard]] ReadoutMotion faster(Side side, const Vector6d& speed) const;

    /// T_stamp_camera of the camera at a time, seconds since the stamp.
    [[nodiscard]] Eigen::Isometry3d at(double seconds) const;

    /// A point, and how it changes by the same point at the stamp, and with time.
    struct Seen {
        Eigen::Vector3d point;
        Eigen::Matrix3d by_point;
        Eigen::Vector3d by_time;
    };
    /// The point as the camera at a time sees it. @param point  in the camera at the stamp
    [[nodiscard]] Seen seen(const Eigen::Vector3d& point, double seconds) const;

private:
    using Coefficients = Eigen::Matrix<double, 6, kMostNeighbours>;  ///< of the powers of time, from the first on
    [[nodiscard]] const Coefficients& at_side(double seconds) const { return seconds < 0 ? before_ : after_; }
    Coefficients before_ = Coefficients::Zero(), after_ = Coefficients::Zero();
};

/// The motion during a frame, and how much later than colour its depth was taken, by their stamps, seconds.
struct FrameReadout {
    ReadoutMotion motion;
    double depth_delay = 0;
    std::optional<ReadoutMotion::Side> unknown = std::nullopt;  ///< no frame tells the motion there: it is as on the
                                                                ///< other side, roughly
};

/// When the rows of images are read; seconds, the meaning as in ShutterConfig.
struct RowTimes {
    double depth_delay = 0, depth_readout = 0, color_readout = 0;
    double stamp_row = 0.5;

    /// How far below the row of the stamp a row lies, in parts of the image. @param v  pixels
    [[nodiscard]] double below_stamp(double v, int height) const { return (v + 0.5) / height - stamp_row; }
    [[nodiscard]] double of_color(double v, int height) const { return below_stamp(v, height) * color_readout; }
    [[nodiscard]] double of_depth(double v, int height, const FrameReadout& frame) const {
        return below_stamp(v, height) * depth_readout + depth_delay + frame.depth_delay;
    }
};

/// A camera whose rows are read at their times.
struct RowCamera {
    Intrinsics camera;
    RowTimes times;

    /// The point at depth z (metres, in the camera of its row) that colour shows at a pixel, as the camera at the stamp
    /// sees it.
    [[nodiscard]] Eigen::Vector3d point_at(const Eigen::Vector2d& pixel, double z, const FrameReadout& frame) const;

    /// Where colour shows a point. @param point  in the camera at the stamp  @return nullopt: behind the camera
    [[nodiscard]] std::optional<Eigen::Vector2d> pixel_of(const Eigen::Vector3d& point,
                                                          const FrameReadout& frame) const;

    /// The depth of a surface at the time of colour. @param inverse_depth  as depth shows it at that pixel, 1/m
    /// @param slope  of the inverse depth over the image
    [[nodiscard]] double depth_with_color(const Eigen::Vector2d& pixel, double inverse_depth,
                                          const Eigen::Vector2d& slope, const FrameReadout& frame) const;
};

}  // namespace posefusion
