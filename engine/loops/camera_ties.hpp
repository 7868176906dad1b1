#pragma once
#include "engine/loops/deformation_graph.hpp"

/// How firmly tracking has tied cameras to each other, and in which directions: where a view did not fix the pose (a
/// bare wall fills it) drift has crept in along what it left open, and there a closed loop has to bend. World axes; an
/// error (v, w) takes a camera's centre by v and turns it by w.
namespace posefusion {

/// Covariance of the step to cameras[i] from the frame before, about its centre. Without any information: that of a
/// step which is not known at all (DeformationConfig::step_*_sigma).
[[nodiscard]] Matrix6d step_covariance(std::span<const GraphCamera> cameras, size_t i, const DeformationConfig& config);
/// ... of the whole way from cameras[from] to cameras[to], about the latter's centre: steps add up, and where one has
/// turned wrongly all later ones go astray. from < to.
[[nodiscard]] Matrix6d way_covariance(std::span<const GraphCamera> cameras, size_t from, size_t to,
                                      const DeformationConfig& config);
/// Variance of the translation, mean of the three directions, m^2.
[[nodiscard]] double translation_variance(const Matrix6d& covariance);
/// Whitens an error: its product with this has the unit covariance.
[[nodiscard]] Matrix6d whitening(const Matrix6d& covariance);

}  // namespace posefusion
