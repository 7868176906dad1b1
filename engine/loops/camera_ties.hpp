#pragma once
#include "engine/loops/deformation_graph.hpp"

/// How certain the relative pose of two cameras is, by direction. Where a view does not determine the pose (a bare wall
/// fills it), drift accumulates along the undetermined directions, and there a closed loop must deform most. World
/// axes; an error (v, w) moves a camera's centre by v and rotates it by w.
namespace posefusion {

/// Covariance of the step to cameras[i] from the frame before, about its centre. Without information: that of an
/// unknown step (DeformationConfig::step_*_sigma).
[[nodiscard]] Matrix6d step_covariance(std::span<const GraphCamera> cameras, size_t i, const DeformationConfig& config);
/// ... of the whole way from cameras[from] to cameras[to], about the latter's centre: the covariances of the steps add
/// up, and a rotation error of one step displaces all later ones. from < to.
[[nodiscard]] Matrix6d way_covariance(std::span<const GraphCamera> cameras, size_t from, size_t to,
                                      const DeformationConfig& config);
/// Variance of the translation, mean of the three directions, m^2.
[[nodiscard]] double translation_variance(const Matrix6d& covariance);
/// Whitens an error: its product with this has the unit covariance.
[[nodiscard]] Matrix6d whitening(const Matrix6d& covariance);

}  // namespace posefusion
