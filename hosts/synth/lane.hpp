#pragma once
#include <Eigen/Core>
#include <vector>

#include "hosts/synth/mesh.hpp"

namespace posefusion::synth {

/// A closed path around a block: a rectangle with rounded corners, walked clockwise as seen from above (west along the
/// south side first). Everything in metres; positions on it are given in turns, 0 = 1 = the start.
class Lane {
public:
    /// @param start_x  start of the path on the south side, between the corners
    Lane(const Vector2f& middle, const Vector2f& half, float corner, float start_x);

    [[nodiscard]] float length() const;
    [[nodiscard]] Vector2f at(double turns) const;
    /// Direction of walking, unit, turning smoothly.
    [[nodiscard]] Vector2f heading(double turns) const;

private:
    std::vector<Vector2f> points_;  ///< evenly spaced, closed
    float spacing_ = 0;
};

}  // namespace posefusion::synth
