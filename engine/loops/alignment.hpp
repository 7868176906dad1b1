#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/loops/loop_config.hpp"
#include "engine/loops/loop_event.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

/// The result of aligning a live image with the model: a pose, or the reason for rejection.
struct Alignment {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    bool accepted = false;
    std::string reason;      ///< empty where accepted
    float overlap = 0;       ///< share of the image in which both live depth and the model show something
    float inlier_ratio = 0;  ///< of the overlap
    float icp_rmse_m = 0, photometric_rmse = 0;
    float gain = 1;         ///< intensity of the model over that of the live image
    float correlation = 0;  ///< of live and model intensities, -1..1
    /// Direction in which the position is least certain, in the camera's frame.
    Eigen::Vector3d least_certain = Eigen::Vector3d::Zero();
    std::vector<gpu::LoopSample> samples;  ///< gpu::LOOP_GRID_WIDTH * gpu::LOOP_GRID_HEIGHT
};

/// How alike live image and model look where their surfaces agree, whatever the exposure: correlation of the
/// intensities, -1..1; 1 where there are too few samples, or too little contrast, to say.
[[nodiscard]] float correlation_of(std::span<const gpu::LoopSample> samples);

/// Is this the same place, and is the pose certain?
/// @param record    the tracking record of the alignment  @param samples  live image and model, sampled on a grid
/// @param proposed  initial pose of the alignment  @param min_overlap  share of the image that must show the model
[[nodiscard]] Alignment judge(const gpu::TrackingRecord& record, std::span<const gpu::LoopSample> samples,
                              const Eigen::Isometry3d& proposed, float min_overlap, const AlignmentConfig& config);

/// Where, of several places that one live image was aligned with and that all fit, it was taken: where it looks most
/// like the model. A pattern that repeats itself almost fits elsewhere, too.
/// @return nullopt: another place explains the image nearly as well
[[nodiscard]] std::optional<std::size_t> most_alike(std::span<const Alignment> places);

/// The alignment as a LoopEvent, for statistics and reports.
[[nodiscard]] LoopEvent event_of(LoopKind kind, std::uint32_t frame, const Alignment& alignment);

}  // namespace posefusion
