#pragma once
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "engine/vulkan/shared_types.hpp"

/// What the CPU references of the kernels share. All in double: the kernel is compared with the mathematics, not with
/// another rounding of it.
namespace posefusion::test {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

struct Camera {
    double fx, fy, cx, cy;
    int width, height;

    [[nodiscard]] int pixels() const { return width * height; }
    [[nodiscard]] int index(int u, int v) const { return v * width + u; }
    [[nodiscard]] int clamped_index(int u, int v) const;
    [[nodiscard]] bool contains(int u, int v) const { return u >= 0 && v >= 0 && u < width && v < height; }
    [[nodiscard]] Vector3d back_project(double u, double v, double z) const {
        return {(u - cx) * z / fx, (v - cy) * z / fy, z};
    }
    [[nodiscard]] Vector2d project(const Vector3d& p) const {
        return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
    }
};

/// The camera of a pyramid level.
[[nodiscard]] Camera camera_at(const gpu::Params& params, int level = 0);
/// Standard deviation of one depth measurement, metres.
[[nodiscard]] double depth_sigma(const gpu::Params& params, double z);
/// Rec. 601 luma, 0..1, of a packed pixel.
[[nodiscard]] double luma(std::uint32_t rgb);
[[nodiscard]] double luma(const Vector3d& rgb);
/// 0..1 to bytes, tag 0.
[[nodiscard]] std::uint32_t pack(const Vector3d& rgb);
/// Red, green and blue of a packed pixel, 0..1.
[[nodiscard]] Vector3d color_of(std::uint32_t rgb);
/// The same times record.exposure, at most white.
[[nodiscard]] Vector3d in_map_exposure(const gpu::TrackingRecord& record, std::uint32_t rgb);

[[nodiscard]] gpu::Pose to_device(const Isometry3d& T);
[[nodiscard]] Isometry3d from_device(const gpu::Pose& pose);
/// exp of a twist whose translation is taken as it is: (v, w) -> (Exp(w), v).
[[nodiscard]] Isometry3d exp_pose(const Vector3d& v, const Vector3d& w);
/// exp of the constant motion (v, w), series of 4x4 matrices.
[[nodiscard]] Isometry3d exp_twist(const Vector3d& v, const Vector3d& w);
/// What rotating about axis by degrees and then moving does.
[[nodiscard]] Isometry3d motion(const Vector3d& translation, const Vector3d& axis, double degrees);

inline Vector3d xyz(const gpu::vec4& v) { return {v.x, v.y, v.z}; }
inline gpu::vec4 vec4_of(const Vector3d& v, double w) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), static_cast<float>(w)};
}

/// A depth image of everything that is hard: slanted planes, steps, noise, holes of all sizes, values out of range.
[[nodiscard]] std::vector<float> rough_depth(const Camera& camera, unsigned seed);
/// Random colours that vary smoothly, label 0.
[[nodiscard]] std::vector<std::uint32_t> smooth_colors(const Camera& camera, unsigned seed);
/// Labels: some blobs, a thin line, single pixels, the corners.
[[nodiscard]] std::vector<std::uint8_t> blobs(const Camera& camera, unsigned seed);
/// Geometry (normal, depth) of a depth image; some normals are unknown (0).
[[nodiscard]] std::vector<gpu::vec4> rough_geometry(const Camera& camera, const std::vector<float>& depth,
                                                    unsigned seed);

/// Uniform numbers that are the same with every standard library.
class Random {
public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
    }
    std::uint32_t below(std::uint32_t end) { return static_cast<std::uint32_t>(engine_() % end); }
    bool chance(double p) { return uniform(0, 1) < p; }
    Vector3d direction();

private:
    std::mt19937 engine_;
};

/// Counts what differs by more than `tolerance` (NaN and never written always do). A kernel that compares with a
/// threshold may decide otherwise than the reference where both sides agree to the last bits; `may_differ` says how
/// many may.
void expect_near(const std::vector<float>& actual, const std::vector<double>& expected, double tolerance,
                 std::size_t may_differ = 0, const std::string& what = "pixel");
/// Likewise of vectors, all components.
void expect_near(const std::vector<gpu::vec4>& actual, const std::vector<Eigen::Vector4d>& expected, double tolerance,
                 std::size_t may_differ = 0, const std::string& what = "pixel");

}  // namespace posefusion::test
