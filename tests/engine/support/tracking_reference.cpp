#include "tests/engine/support/tracking_reference.hpp"

#include <algorithm>
#include <cmath>

namespace posefusion::test {

using gpu::vec4;

namespace {

constexpr double kStep = 1e-5;  // of the numeric derivatives, metres and radians: central differences are good to 1e-10

/// Derivative of residual(exp(twist)) at 0 in each of the six directions (translation, rotation).
template <class Residual>
Vector6d numeric_jacobian(Residual residual) {
    Vector6d J;
    for (int k = 0; k < 6; ++k) {
        Vector6d twist = Vector6d::Zero();
        twist(k) = kStep;
        const auto at = [&](const Vector6d& x) { return residual(exp_pose(x.head<3>(), x.tail<3>())); };
        J(k) = (at(twist) - at(-twist)) / (2 * kStep);
    }
    return J;
}

double wave(double u, double v) { return 1.6 + 0.25 * std::sin(0.06 * u) * std::cos(0.05 * v) + 0.002 * u; }

Vector3d wave_normal(const Camera& c, double u, double v) {
    const Vector3d du = c.back_project(u + 0.5, v, wave(u + 0.5, v)) - c.back_project(u - 0.5, v, wave(u - 0.5, v));
    const Vector3d dv = c.back_project(u, v + 0.5, wave(u, v + 0.5)) - c.back_project(u, v - 0.5, wave(u, v - 0.5));
    return dv.cross(du).normalized();  // towards the camera
}

std::vector<vec4> wave_geometry(const Camera& c, Random& random) {
    std::vector<vec4> geometry;
    for (int v = 0; v < c.height; ++v) {
        for (int u = 0; u < c.width; ++u) {
            double z = wave(u, v) + random.uniform(-0.006, 0.006);
            if (random.chance(0.03)) z += 0.3;
            if (random.chance(0.05)) z = 0;
            Vector3d n = (wave_normal(c, u, v) + 0.1 * random.direction()).normalized();
            if (random.chance(0.02)) n = random.direction();
            if (random.chance(0.02) || z == 0) n.setZero();
            geometry.push_back(vec4_of(n, z));
        }
    }
    return geometry;
}

ImagePair geometry_pair(const Camera& c, unsigned seed) {
    Random random(seed);
    ImagePair pair;
    pair.live_geometry = wave_geometry(c, random);
    pair.model_geometry = wave_geometry(c, random);
    return pair;
}

}  // namespace

std::vector<vec4> photometric_of(const Camera& c, const std::vector<double>& intensity) {
    std::vector<vec4> result;
    const auto at = [&](int u, int v) { return intensity[static_cast<std::size_t>(c.clamped_index(u, v))]; };
    for (int v = 0; v < c.height; ++v) {
        for (int u = 0; u < c.width; ++u) {
            bool known = u > 0 && v > 0 && u + 1 < c.width && v + 1 < c.height;
            for (const double s : {at(u, v), at(u - 1, v), at(u + 1, v), at(u, v - 1), at(u, v + 1)})
                known = known && s >= 0;
            result.push_back(vec4_of(
                {known ? at(u, v) : -1.0, 0.5 * (at(u + 1, v) - at(u - 1, v)), 0.5 * (at(u, v + 1) - at(u, v - 1))},
                0));
        }
    }
    return result;
}

ImagePair wavy_pair(const gpu::Params& params, int level, unsigned seed) {
    const Camera c = camera_at(params, level);
    ImagePair pair = geometry_pair(c, seed);
    Random random(seed + 1);
    const auto texture = [&](double shift) {
        std::vector<double> intensity;
        for (int v = 0; v < c.height; ++v) {
            for (int u = 0; u < c.width; ++u) {
                const double s =
                    0.5 + 0.25 * std::sin(0.31 * (u + shift)) * std::cos(0.23 * v) + random.uniform(-0.02, 0.02);
                intensity.push_back(random.chance(0.01) ? -1.0 : s);
            }
        }
        return photometric_of(c, intensity);
    };
    pair.live_photometric = texture(0.0);
    pair.model_photometric = texture(0.7);
    return pair;
}

ImagePair ramp_pair(const gpu::Params& params, int level, unsigned seed) {
    const Camera c = camera_at(params, level);
    ImagePair pair = geometry_pair(c, seed);
    const double a = 0.6 / c.width, b = -0.35 / c.height;
    const auto ramp = [&](double offset, double exposure) {
        std::vector<double> intensity;
        for (int i = 0; i < c.pixels(); ++i)
            intensity.push_back(exposure * (0.37 + offset + a * (i % c.width) + b * (i / c.width)));
        return photometric_of(c, intensity);
    };
    pair.live_photometric = ramp(0.0, 1 / static_cast<double>(kGain));
    pair.model_photometric = ramp(0.013, 1);
    return pair;
}

gpu::TrackingRecord tracking_record(const Isometry3d& model_live) {
    gpu::TrackingRecord record{};
    record.model_live = to_device(model_live);
    record.world_live = record.world_model = to_device(Isometry3d::Identity());
    record.so3 = record.so3_best = to_device(Isometry3d::Identity());
    record.so3_error = gpu::UNBOUNDED;
    record.icp_scale = 1.3f;
    record.photometric_scale = 0.03f;
    record.photometric_gain = kGain;
    record.exposure = vec4(1.0f);
    record.fusion_weight = 1;
    return record;
}

TrackSums reference_track_sums(const gpu::Params& params, int level, const gpu::TrackingRecord& record,
                               const ImagePair& images, Shade shade, unsigned step, bool rolling, TimingSums* timing,
                               TurnSums* turn) {
    const Camera c = camera_at(params, level);
    const Vector3d moves = xyz(record.motion_error.translation), turns = xyz(record.motion_error.rotation),
                   acceleration = xyz(record.turn_acceleration);
    // seen at the time of its row: the pose there is exp(time motion_error) seen from the frame's
    const auto at_stamp = [&](int row, const Vector3d& p, float first_row, float per_row) -> Vector3d {
        const double full_row = (row + 0.5) * (1 << level) - 0.5;
        const double time = static_cast<double>(first_row) + full_row * static_cast<double>(per_row);
        return rolling ? exp_twist(time * moves, time * turns + 0.5 * time * time * acceleration) * p : p;
    };
    const Isometry3d T = from_device(record.model_live);
    TrackSums sums;
    const auto add = [&](const Vector6d& J, double w, double r) {
        sums.H += w * J * J.transpose();
        sums.g += w * J * r;
        sums.g_scale += (w * J * r).cwiseAbs();
    };
    // the slope of a residual of (times after the stamp of the live point and of the model's) over the time `rows`: the
    // share of the read-out that has passed at the live row and at the model's
    const auto add_times = [&](const Vector6d& J, double w, double r, const Vector3d& slopes) {
        timing->both += w * J * slopes.transpose();
        timing->times += w * slopes * slopes.transpose();
        timing->gradient += w * r * slopes;
        timing->gradient_scale += (w * r * slopes).cwiseAbs();
    };
    // rows turn by their time, and by half of its square, about the axes of the model's camera
    const auto add_turn = [&](const Vector6d& J, double w, double r, int row, float first_row, float per_row) {
        const double full_row = (row + 0.5) * (1 << level) - 0.5;
        const double time = static_cast<double>(first_row) + full_row * static_cast<double>(per_row);
        Vector6d slopes;
        slopes << time * J.tail<3>(), 0.5 * time * time * J.tail<3>();
        turn->both += w * J * slopes.transpose();
        turn->turn += w * slopes * slopes.transpose();
        turn->gradient += w * r * slopes;
        turn->gradient_scale += (w * r * slopes).cwiseAbs();
    };
    const auto moved = [](const gpu::Twist& motion, double time, const Vector3d& p) -> Vector3d {
        return exp_twist(time * xyz(motion.translation), time * xyz(motion.rotation)) * p;
    };
    const auto slope = [](const auto& residual, double live_share, double model_share) {
        constexpr double kStep = 1e-5;  // seconds
        return (residual(live_share * kStep, model_share * kStep) -
                residual(-live_share * kStep, -model_share * kStep)) /
               (2 * kStep);
    };
    const auto share_of = [&](double row) { return (row + 0.5) / c.height - static_cast<double>(params.stamp_row); };
    for (int i = 0; i < c.pixels(); ++i) {
        if (step == 2 && (i % c.width + i / c.width) % 2 != 0) continue;
        const auto& live = images.live_geometry[static_cast<std::size_t>(i)];
        const double z = live.w;
        if (z <= 0) continue;
        sums.live_count += 1;
        const Vector3d p = c.back_project(i % c.width, i / c.width, z);
        const Vector3d p_depth = at_stamp(i / c.width, p, params.depth_first_row, params.depth_per_row);
        const Vector3d q = T * p_depth;
        if (q.z() <= gpu::NEAR_PLANE) continue;
        const Vector2d uv = c.project(q);
        const int u = static_cast<int>(std::floor(uv.x() + 0.5)), v = static_cast<int>(std::floor(uv.y() + 0.5));
        if (!c.contains(u, v)) continue;
        const auto& model = images.model_geometry[static_cast<std::size_t>(c.index(u, v))];
        const Vector3d m = c.back_project(u, v, model.w), normal = xyz(model);
        const double sigma_z = depth_sigma(params, z);

        // geometric: r = n . (q - m), whitened by the noise along and across the ray
        const bool associated = model.w > 0 && (q - m).norm() <= static_cast<double>(params.icp_max_distance) &&
                                normal.dot(T.linear() * xyz(live)) >= static_cast<double>(params.icp_min_cosine);
        if (associated && params.icp_enabled > 0) {
            const auto residual = [&](const Isometry3d& D) { return normal.dot(D * q - m); };
            const double cosine = normal.dot(q.normalized()),
                         lateral = params.lateral_noise * z / static_cast<double>(params.fx);
            const double sigma =
                std::sqrt(sigma_z * sigma_z * cosine * cosine + lateral * lateral * (1 - cosine * cosine) +
                          static_cast<double>(params.noise_floor) * static_cast<double>(params.noise_floor));
            const double r = residual(Isometry3d::Identity()), scale = record.icp_scale * sigma,
                         cut = params.icp_robust * scale;
            const double w = 1 / (scale * scale * (1 + r * r / (cut * cut)));
            add(numeric_jacobian(residual), w, r);
            if (timing) {
                const auto at = [&](double live_time, double model_time) {
                    return normal.dot(T * moved(record.last_motion, live_time, p_depth) -
                                      moved(record.expected_motion, model_time, m));
                };
                add_times(numeric_jacobian(residual), w, r,
                          {slope(at, 1, 1), slope(at, share_of(i / c.width), share_of(v)), 0});
            }
            if (turn)
                add_turn(numeric_jacobian(residual), w, r, i / c.width, params.depth_first_row, params.depth_per_row);
            sums.icp_abs += std::abs(r) / sigma;
            sums.icp_count += 1;
            sums.icp_squares += r * r;
        }

        // photometric: r = I_model(pi(q)) - gain I_live, the point seen when colour was taken
        const Vector3d p_shade = at_stamp(i / c.width, p, params.color_first_row, params.color_per_row);
        const Vector3d q_shade = T * p_shade;
        const Vector2d uv_shade = c.project(q_shade);
        const int u0 = static_cast<int>(std::floor(uv_shade.x())), v0 = static_cast<int>(std::floor(uv_shade.y()));
        if (!c.contains(u0, v0) || !c.contains(u0 + 1, v0 + 1) || params.photometric_weight <= 0) continue;
        bool known = images.live_photometric[static_cast<std::size_t>(i)].x >= 0;
        for (int k = 0; k < 4; ++k) {
            known = known && images.model_photometric[static_cast<std::size_t>(c.index(u0 + k % 2, v0 + k / 2))].x >= 0;
        }
        // bilinear at any place, from the corners of this cell
        const auto sample = [&](const Vector2d& at) {
            const double fu = at.x() - u0, fv = at.y() - v0;
            const auto corner = [&](int du, int dv) {
                return xyz(images.model_photometric[static_cast<std::size_t>(c.index(u0 + du, v0 + dv))]);
            };
            return Vector3d((1 - fv) * ((1 - fu) * corner(0, 0) + fu * corner(1, 0)) +
                            fv * ((1 - fu) * corner(0, 1) + fu * corner(1, 1)));
        };
        const Vector3d s = sample(uv_shade), here = xyz(images.live_photometric[static_cast<std::size_t>(i)]);
        const double gain = record.photometric_gain;
        const Vector2d gradient = 0.5 * (s.tail<2>() + gain * here.tail<2>());
        const double gate = gpu::VISIBLE_DEPTH + gpu::SAME_SURFACE_SIGMAS * sigma_z;
        const bool visible = model.w > 0 && std::abs(q_shade.z() - static_cast<double>(model.w)) < gate;
        if (!known || !visible || gradient.norm() <= static_cast<double>(params.min_gradient)) continue;
        const auto residual = [&](const Isometry3d& D) {
            const Vector2d at = c.project(D * q_shade);
            const double seen = shade == Shade::Image ? sample(at).x() : s.x() + gradient.dot(at - uv_shade);
            return seen - gain * here.x();
        };
        const double r = residual(Isometry3d::Identity());
        const double sigma = record.photometric_scale, cut = params.photometric_robust * sigma;
        const double robust = 1 / (1 + r * r / (cut * cut));
        const double w = params.photometric_weight / (sigma * sigma) * robust;
        add(numeric_jacobian(residual), w, r);
        if (timing) {
            const auto at = [&](double live_time, double model_time) {
                const Vector3d there =
                    moved(record.expected_motion, -model_time, T * moved(record.last_motion, live_time, p_shade));
                return s.x() + gradient.dot(c.project(there) - uv_shade) - gain * here.x();
            };
            add_times(numeric_jacobian(residual), w, r,
                      {0, 0, slope(at, share_of(i / c.width), share_of(uv_shade.y()))});
        }
        if (turn) add_turn(numeric_jacobian(residual), w, r, i / c.width, params.color_first_row, params.color_per_row);
        sums.photometric_abs += std::abs(r);
        sums.photometric_count += 1;
        sums.photometric_squares += r * r;
        sums.live_intensity += robust * here.x();
        sums.model_intensity += robust * s.x();
    }
    return sums;
}

So3Sums reference_so3_sums(const gpu::Params& params, int level, const gpu::TrackingRecord& record,
                           const std::vector<vec4>& live, const std::vector<vec4>& previous) {
    const Camera c = camera_at(params, level);
    const Eigen::Matrix3d R = from_device(record.so3).linear();
    So3Sums sums;
    for (int i = 0; i < c.pixels(); ++i) {
        const Vector3d ray = R * c.back_project(i % c.width, i / c.width, 1);
        if (ray.z() <= gpu::NEAR_PLANE) continue;
        const Vector2d uv = c.project(ray);
        const Vector2d cell(std::floor(uv.x() + 0.5), std::floor(uv.y() + 0.5));
        if (!c.contains(static_cast<int>(cell.x()), static_cast<int>(cell.y()))) continue;
        const Vector3d a = xyz(live[static_cast<std::size_t>(i)]);
        const Vector3d b =
            xyz(previous[static_cast<std::size_t>(c.index(static_cast<int>(cell.x()), static_cast<int>(cell.y())))]);
        if (a.x() < 0 || b.x() < 0) continue;
        const Vector2d gradient = 0.5 * (a.tail<2>() + b.tail<2>());
        const double r = b.x() + b.tail<2>().dot(uv - cell) - a.x();
        const Vector3d J = numeric_jacobian([&](const Isometry3d& D) {
                               return gradient.dot(c.project(D.linear() * ray) - uv);
                           }).tail<3>();
        sums.H += J * J.transpose();
        sums.g += J * r;
        sums.g_scale += (J * r).cwiseAbs();
        sums.squares += r * r;
        sums.count += 1;
    }
    return sums;
}

namespace {

std::size_t reduction_groups(const Camera& camera, unsigned step) {
    return vulkan::ceil_div(static_cast<std::uint32_t>(camera.pixels()) / step, gpu::REDUCTION_PIXELS_PER_GROUP);
}

constexpr std::size_t kMostColumns = std::max(gpu::TIMING_COLUMNS, gpu::TURN_COLUMNS);

/// Adds the rows of all groups; a row that a subgroup did not write is a NaN and spoils the sum.
/// @param stride  from row to row  @param columns  that are written
std::array<double, kMostColumns> add_rows(const std::vector<float>& rows, const std::vector<std::uint32_t>& counts,
                                          std::size_t stride, std::size_t columns) {
    std::array<double, kMostColumns> sums{};
    for (std::size_t g = 0; g < counts.size(); ++g) {
        EXPECT_GE(counts[g], 1u);
        EXPECT_LE(counts[g], gpu::REDUCTION_MAX_ROWS);
        for (std::size_t r = 0; r < std::min(counts[g], gpu::REDUCTION_MAX_ROWS); ++r) {
            for (std::size_t k = 0; k < columns; ++k)
                sums[k] += static_cast<double>(rows[(g * gpu::REDUCTION_MAX_ROWS + r) * stride + k]);
        }
    }
    return sums;
}

}  // namespace

TrackSums kernel_track_sums(const gpu::Params& params, int level, const gpu::TrackingRecord& record,
                            const ImagePair& images, unsigned step, bool rolling, TimingSums* timing, TurnSums* turn) {
    const std::size_t groups = reduction_groups(camera_at(params, level), step);
    const std::size_t stride = timing ? gpu::TIMING_COLUMNS : turn ? gpu::TURN_COLUMNS : gpu::REDUCTION_COLUMNS;
    Launch launch("tracking/track_reduce",
                  {{"ROLLING", rolling ? 1u : 0u}, {"TIMING", timing ? 1u : 0u}, {"TURN", turn ? 1u : 0u}});
    launch.input("params", params).input("record", record);
    launch.input("live_geometry", images.live_geometry).input("live_photometric", images.live_photometric);
    launch.input("model_geometry", images.model_geometry).input("model_photometric", images.model_photometric);
    launch.output<float>("rows", groups * gpu::REDUCTION_MAX_ROWS * stride).output<std::uint32_t>("row_counts", groups);
    launch.run(static_cast<std::uint32_t>(groups), {{"level", level}, {"step", step}});
    const auto s = add_rows(launch.read<float>("rows"), launch.read<std::uint32_t>("row_counts"), stride,
                            timing || turn ? stride : gpu::TRACK_COLUMNS);
    if (turn) {
        const auto block = [&](std::size_t first, int rows) {
            Eigen::Matrix<double, Eigen::Dynamic, 3> values(rows, 3);
            for (int i = 0; i < rows; ++i)
                for (int j = 0; j < 3; ++j) values(i, j) = s[first + static_cast<std::size_t>(3 * i + j)];
            return values;
        };
        const auto symmetric = [&](std::size_t first) {
            Eigen::Matrix3d values;
            for (int i = 0; i < 3; ++i)
                for (int j = i; j < 3; ++j) values(i, j) = values(j, i) = s[first++];
            return values;
        };
        const Eigen::Matrix3d squares = symmetric(gpu::COLUMN_TURN), cubes = symmetric(gpu::COLUMN_TURN_ACCELERATION),
                              fourths = symmetric(gpu::COLUMN_ACCELERATION);
        turn->both.leftCols<3>() = block(gpu::COLUMN_POSE_TURN, 6);
        turn->both.topRightCorner<3, 3>() = 0.5 * block(gpu::COLUMN_TRANSLATION_ACCELERATION, 3);
        turn->both.bottomRightCorner<3, 3>() = 0.5 * squares;
        turn->turn << squares, 0.5 * cubes, 0.5 * cubes, 0.25 * fourths;
        turn->gradient << block(gpu::COLUMN_TURN_GRADIENT, 1).transpose(),
            0.5 * block(gpu::COLUMN_ACCELERATION_GRADIENT, 1).transpose();
    }
    if (timing) {
        for (std::size_t row = 0; row < 6; ++row) {
            timing->both.row(static_cast<Eigen::Index>(row)) << s[gpu::COLUMN_POSE_DELAY + row],
                s[gpu::COLUMN_POSE_DEPTH_READOUT + row], s[gpu::COLUMN_POSE_COLOR_READOUT + row];
        }
        timing->times(0, 0) = s[gpu::COLUMN_TIMES];
        timing->times(0, 1) = timing->times(1, 0) = s[gpu::COLUMN_TIMES + 1];
        timing->times(1, 1) = s[gpu::COLUMN_TIMES + 2];
        timing->times(2, 2) = s[gpu::COLUMN_TIMES + 3];
        for (std::size_t t = 0; t < 3; ++t)
            timing->gradient(static_cast<Eigen::Index>(t)) = s[gpu::COLUMN_TIMES_GRADIENT + t];
    }
    TrackSums sums;
    std::size_t k = gpu::COLUMN_HESSIAN;
    for (int i = 0; i < 6; ++i) {
        for (int j = i; j < 6; ++j) sums.H(i, j) = sums.H(j, i) = s[k++];
    }
    for (int i = 0; i < 6; ++i) sums.g(i) = s[gpu::COLUMN_GRADIENT + i];
    sums.icp_abs = s[gpu::COLUMN_ICP_ABS];
    sums.icp_count = s[gpu::COLUMN_ICP_COUNT];
    sums.icp_squares = s[gpu::COLUMN_ICP_SQUARES];
    sums.photometric_abs = s[gpu::COLUMN_PHOTOMETRIC_ABS];
    sums.photometric_count = s[gpu::COLUMN_PHOTOMETRIC_COUNT];
    sums.photometric_squares = s[gpu::COLUMN_PHOTOMETRIC_SQUARES];
    sums.live_intensity = s[gpu::COLUMN_LIVE_INTENSITY];
    sums.model_intensity = s[gpu::COLUMN_MODEL_INTENSITY];
    sums.live_count = s[gpu::COLUMN_LIVE];
    return sums;
}

So3Sums kernel_so3_sums(const gpu::Params& params, int level, const gpu::TrackingRecord& record,
                        const std::vector<vec4>& live, const std::vector<vec4>& previous) {
    const std::size_t groups = reduction_groups(camera_at(params, level), 1);
    Launch launch("tracking/so3_reduce");
    launch.input("params", params).input("record", record);
    launch.input("live_photometric", live).input("previous_photometric", previous);
    launch.output<float>("rows", groups * gpu::REDUCTION_MAX_ROWS * gpu::REDUCTION_COLUMNS)
        .output<std::uint32_t>("row_counts", groups);
    launch.run(static_cast<std::uint32_t>(groups), {{"level", level}});
    const auto s = add_rows(launch.read<float>("rows"), launch.read<std::uint32_t>("row_counts"),
                            gpu::REDUCTION_COLUMNS, gpu::REDUCTION_COLUMNS);
    So3Sums sums;
    std::size_t k = gpu::COLUMN_SO3_HESSIAN;
    for (int i = 0; i < 3; ++i) {
        for (int j = i; j < 3; ++j) sums.H(i, j) = sums.H(j, i) = s[k++];
    }
    for (int i = 0; i < 3; ++i) sums.g(i) = s[gpu::COLUMN_SO3_GRADIENT + i];
    sums.squares = s[gpu::COLUMN_SO3_SQUARES], sums.count = s[gpu::COLUMN_SO3_COUNT];
    for (std::size_t unused = gpu::SO3_COLUMNS; unused < gpu::REDUCTION_COLUMNS; ++unused) EXPECT_EQ(s[unused], 0.0);
    return sums;
}

}  // namespace posefusion::test
