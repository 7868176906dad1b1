#include "tests/engine/support/reference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace posefusion::test {

int Camera::clamped_index(int u, int v) const {
    return index(std::clamp(u, 0, width - 1), std::clamp(v, 0, height - 1));
}

Camera camera_at(const gpu::Params& p, int level) {
    const double s = 1.0 / (1 << level);
    return {p.fx * s,
            p.fy * s,
            (p.cx + 0.5) * s - 0.5,
            (p.cy + 0.5) * s - 0.5,
            static_cast<int>(p.width >> level),
            static_cast<int>(p.height >> level)};
}

double depth_sigma(const gpu::Params& p, double z) { return p.noise_a + p.noise_b * (z - p.noise_c) * (z - p.noise_c); }

double luma(const Vector3d& rgb) { return Vector3d(gpu::LUMA_RED, gpu::LUMA_GREEN, gpu::LUMA_BLUE).dot(rgb); }

double luma(std::uint32_t rgb) { return luma(color_of(rgb)); }

std::uint32_t pack(const Vector3d& rgb) {
    const auto byte = [](double x) { return static_cast<std::uint32_t>(std::lround(x * 255)); };
    return byte(rgb.x()) | byte(rgb.y()) << 8 | byte(rgb.z()) << 16;
}

Vector3d color_of(std::uint32_t rgb) { return Vector3d(rgb & 255u, rgb >> 8 & 255u, rgb >> 16 & 255u) / 255.0; }

Vector3d in_map_exposure(const gpu::TrackingRecord& record, std::uint32_t rgb) {
    return color_of(rgb).cwiseProduct(xyz(record.exposure)).cwiseMin(1.0);
}

gpu::Pose to_device(const Isometry3d& T) {
    const auto row = [&](int i) { return vec4_of(T.linear().row(i).transpose(), T.translation()(i)); };
    return {row(0), row(1), row(2)};
}

Isometry3d from_device(const gpu::Pose& pose) {
    Isometry3d T = Isometry3d::Identity();
    const gpu::vec4* rows[] = {&pose.row0, &pose.row1, &pose.row2};
    for (int i = 0; i < 3; ++i) {
        T.linear().row(i) = xyz(*rows[i]).transpose();
        T.translation()(i) = rows[i]->w;
    }
    return T;
}

Isometry3d exp_pose(const Vector3d& v, const Vector3d& w) {
    Isometry3d T = Isometry3d::Identity();
    const double angle = w.norm();
    if (angle > 0) T.linear() = Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
    T.translation() = v;
    return T;
}

Isometry3d exp_twist(const Vector3d& v, const Vector3d& w) {
    constexpr int kTerms = 20;  // far more than small motions need
    Eigen::Matrix4d twist = Eigen::Matrix4d::Zero();
    twist.topLeftCorner<3, 3>() << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    twist.topRightCorner<3, 1>() = v;
    Eigen::Matrix4d term = Eigen::Matrix4d::Identity(), sum = term;
    for (int k = 1; k < kTerms; ++k) {
        term = (term * twist / k).eval();
        sum += term;
    }
    return Isometry3d(sum);
}

Isometry3d motion(const Vector3d& translation, const Vector3d& axis, double degrees) {
    return exp_pose(translation, axis.normalized() * degrees * std::numbers::pi / 180.0);
}

Vector3d Random::direction() {
    const double z = uniform(-1, 1), angle = uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

std::vector<float> rough_depth(const Camera& c, unsigned seed) {
    Random random(seed);
    std::vector<float> depth(static_cast<std::size_t>(c.pixels()));
    for (int v = 0; v < c.height; ++v) {
        for (int u = 0; u < c.width; ++u) {
            const double x = (u + 0.5) / c.width, y = (v + 0.5) / c.height;
            double z = 1 / (0.55 + 0.35 * x - 0.3 * y);                   // a slanted plane ...
            if (x > 0.55 && y < 0.5) z = 0.75 + 0.2 * x;                  // ... a box in front of it
            if (x < 0.3 && y > 0.6) z = 3.2 + 1.2 * std::sin(9 * x) * y;  // ... and a curved thing behind
            z += random.uniform(-1, 1) * (0.001 + 0.002 * (z - 0.4) * (z - 0.4));
            const bool hole = random.chance(0.04) || (std::abs(x - 0.7) < 0.06 && std::abs(y - 0.75) < 0.08);
            const double odd = random.uniform(0, 1);
            if (odd < 0.01) z = 7.0;  // out of range
            if (odd > 0.99) z = 0.15;
            depth[static_cast<std::size_t>(c.index(u, v))] = hole ? 0.0f : static_cast<float>(z);
        }
    }
    return depth;
}

std::vector<std::uint32_t> smooth_colors(const Camera& c, unsigned seed) {
    Random random(seed);
    const double a = random.uniform(0, 6), b = random.uniform(0, 6);
    std::vector<std::uint32_t> colors;
    for (int v = 0; v < c.height; ++v) {
        for (int u = 0; u < c.width; ++u) {
            const auto channel = [&](double phase) {
                const double value =
                    127 + 80 * std::sin(0.21 * u + phase + a) * std::cos(0.17 * v + b) + random.uniform(-20, 20);
                return static_cast<std::uint32_t>(std::clamp(value, 0.0, 255.0));
            };
            const std::uint32_t r = channel(0), g = channel(0.8);
            colors.push_back(r | g << 8 | channel(1.9) << 16);
        }
    }
    return colors;
}

std::vector<std::uint8_t> blobs(const Camera& c, unsigned seed) {
    Random random(seed);
    std::vector<std::uint8_t> labels(static_cast<std::size_t>(c.pixels()), 0);
    for (std::uint8_t label = 1; label <= 3; ++label) {
        const double u0 = random.uniform(0, c.width), v0 = random.uniform(0, c.height),
                     r = random.uniform(1, c.width / 8.0);
        for (int v = 0; v < c.height; ++v) {
            for (int u = 0; u < c.width; ++u) {
                if (std::hypot(u - u0, v - v0) < r) labels[static_cast<std::size_t>(c.index(u, v))] = label;
            }
        }
    }
    for (int v = 0; v < c.height; v += 2) labels[static_cast<std::size_t>(c.index(c.width / 3, v))] = 255;
    for (int k = 0; k < 5; ++k) labels[random.below(static_cast<std::uint32_t>(c.pixels()))] = 1;
    labels[static_cast<std::size_t>(c.index(c.width - 1, c.height - 1))] = 1;
    labels[0] = 2;
    return labels;
}

std::vector<gpu::vec4> rough_geometry(const Camera& c, const std::vector<float>& depth, unsigned seed) {
    Random random(seed);
    std::vector<gpu::vec4> geometry;
    for (int i = 0; i < c.pixels(); ++i) {
        const double u = i % c.width, v = i / c.width;
        Vector3d n = Vector3d(0.4 * std::sin(0.1 * u), 0.4 * std::cos(0.13 * v), -1).normalized();
        n = (n + 0.1 * random.direction()).normalized();
        if (depth[static_cast<std::size_t>(i)] <= 0 || random.chance(0.03)) n.setZero();
        geometry.push_back(vec4_of(n, depth[static_cast<std::size_t>(i)]));
    }
    return geometry;
}

namespace {

/// Judges how many of `size` items differ, and names the first.
template <class Differs, class Describe>
void judge(std::size_t size, std::size_t may_differ, const std::string& what, Differs differs, Describe describe) {
    std::size_t count = 0, first = 0;
    for (std::size_t i = 0; i < size; ++i) {
        if (!differs(i)) continue;
        if (count++ == 0) first = i;
    }
    if (count > may_differ) {
        ADD_FAILURE() << count << " of " << size << " (at most " << may_differ << " may) differ, first " << what << ' '
                      << first << ": " << describe(first);
    }
}

}  // namespace

void expect_near(const std::vector<float>& actual, const std::vector<double>& expected, double tolerance,
                 std::size_t may_differ, const std::string& what) {
    ASSERT_EQ(actual.size(), expected.size());
    judge(
        actual.size(), may_differ, what,
        [&](std::size_t i) { return !(std::abs(static_cast<double>(actual[i]) - expected[i]) <= tolerance); },
        [&](std::size_t i) { return std::to_string(actual[i]) + ", expected " + std::to_string(expected[i]); });
}

void expect_near(const std::vector<gpu::vec4>& actual, const std::vector<Eigen::Vector4d>& expected, double tolerance,
                 std::size_t may_differ, const std::string& what) {
    ASSERT_EQ(actual.size(), expected.size());
    const auto value = [&](std::size_t i) {
        return Eigen::Vector4d(actual[i].x, actual[i].y, actual[i].z, actual[i].w);
    };
    judge(
        actual.size(), may_differ, what,
        [&](std::size_t i) { return !((value(i) - expected[i]).cwiseAbs().maxCoeff() <= tolerance); },
        [&](std::size_t i) {
            std::ostringstream text;
            text << value(i).transpose() << ", expected " << expected[i].transpose();
            return text.str();
        });
}

}  // namespace posefusion::test
