#pragma once
#include <array>
#include <cmath>
#include <random>

#include "engine/core/pinhole.hpp"
#include "hosts/adjust/bundle.hpp"

namespace posefusion {

/// How a hand turns and moves a camera during a frame: some 40 deg/s and 0.3 m/s, changing from frame to frame.
inline FrameReadout shaking(std::size_t frame) {
    const double a = static_cast<double>(frame), interval = 1.0 / 30;
    const auto motion = [&](double speed) {
        Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
        T.translation() = 0.01 * speed * Eigen::Vector3d(std::cos(2.1 * a), std::sin(1.7 * a + 1), std::cos(2.9 * a));
        T.linear() = Eigen::AngleAxisd(
                         0.023 * speed,
                         Eigen::Vector3d(std::sin(1.3 * a + 2), std::cos(2.3 * a), std::sin(2.7 * a + 1)).normalized())
                         .toRotationMatrix();
        return T;
    };
    const std::array<ReadoutMotion::Neighbour, 2> neighbours{{{-interval, motion(-1)}, {interval, motion(1.1)}}};
    return {ReadoutMotion(neighbours), 0.004 * std::sin(1.9 * a)};
}

/// What a camera is really like, how it moves among random points, and how exactly it sees them.
struct SyntheticBundle {
    CameraParameters camera = parameters_of(Intrinsics{525, 520, 322, 238, 640, 480}, DepthDeformation{});
    std::size_t keyframes = 20, points = 400;
    double step = 1;           ///< how far the camera moves: 0 stands still
    double pixel_sigma = 0.1;  ///< noise; that of depth is 2 mm at 1 m and grows with the square
    bool rolls = false;        ///< the camera moves while its rows are read
    unsigned seed = 1;

    /// Poses and points as they are, observations of the true camera; the camera of the bundle is `given`.
    [[nodiscard]] Bundle make(const CameraParameters& given) const {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> uniform(-1, 1);
        std::normal_distribution<double> normal;
        Bundle bundle;
        bundle.width = 640, bundle.height = 480;
        bundle.camera = given;
        for (std::size_t k = 0; k < keyframes; ++k) {
            const double a = step * 0.7 * static_cast<double>(k);
            Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
            T.translation() << 0.25 * step * std::sin(a), 0.2 * step * std::sin(1.3 * a),
                0.2 * step * std::sin(0.6 * a);
            T.linear() = (Eigen::AngleAxisd(0.25 * step * std::sin(0.8 * a), Eigen::Vector3d::UnitY()) *
                          Eigen::AngleAxisd(0.2 * step * std::sin(1.1 * a), Eigen::Vector3d::UnitX()) *
                          Eigen::AngleAxisd(0.3 * step * std::sin(0.5 * a), Eigen::Vector3d::UnitZ()))
                             .toRotationMatrix();
            bundle.T_camera_world.push_back(T.inverse());
            if (rolls) bundle.readouts.push_back(shaking(k));
        }
        const Intrinsics image = intrinsics_of(camera, bundle.width, bundle.height);
        const RowCamera rows{image, times_of(camera, bundle.stamp_row)};
        for (std::uint32_t i = 0; i < points; ++i) {
            const double z = 1.8 + 0.9 * uniform(random);
            const Eigen::Vector3d point(0.9 * z * uniform(random), 0.7 * z * uniform(random), z);
            bundle.landmarks.push_back(point);
            for (std::uint32_t k = 0; k < keyframes; ++k) {
                const FrameReadout readout = rolls ? bundle.readouts[k] : FrameReadout{};
                Eigen::Vector3d p = bundle.T_camera_world[k] * point;
                if (p.z() < 0.5) continue;
                Observation o;
                o.keyframe = k, o.landmark = i;
                const auto seen = rows.pixel_of(p, readout);
                if (!seen) continue;
                o.pixel = *seen + pixel_sigma * Eigen::Vector2d(normal(random), normal(random));
                if (!in_image(o.pixel, image)) continue;
                const DeformationCell cell = deformation_cell(o.pixel.x(), o.pixel.y(), bundle.width, bundle.height);
                o.pixel_sigma = pixel_sigma;
                o.inverse_depth_sigma = 0.002;
                p = readout.motion.seen(p, rows.times.of_depth(o.pixel.y(), bundle.height, readout)).point;
                o.inverse_depth = 1 / p.z() + o.inverse_depth_sigma * normal(random);
                for (std::size_t n = 0; n < cell.nodes.size(); ++n)
                    o.inverse_depth -=
                        cell.weights[n] * camera(kIntrinsicParameters + static_cast<Eigen::Index>(cell.nodes[n]));
                bundle.observations.push_back(o);
            }
        }
        return bundle;
    }
};

/// A deformation as Kinects have it: smooth, stronger towards the corners, 1/m.
inline CameraParameters with_deformation(CameraParameters camera, double size) {
    for (int r = 0; r < DepthDeformation::kRows; ++r) {
        for (int c = 0; c < DepthDeformation::kColumns; ++c) {
            const double x = c / 2.0 - 1, y = r / 1.5 - 1;
            camera(kIntrinsicParameters + r * DepthDeformation::kColumns + c) =
                size * (0.5 * (x * x + y * y) - 0.4 + 0.2 * x);
        }
    }
    return camera;
}

}  // namespace posefusion
