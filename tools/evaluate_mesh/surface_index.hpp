#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "tools/evaluate_objects/object_truth.hpp"

namespace posefusion {

/// The triangles of a surface in the cells of a grid: distances to the nearest one, as far as they are short.
class SurfaceIndex {
public:
    /// @param limit  distances up to here are known, metres
    SurfaceIndex(const TrueMesh& mesh, float limit);
    /// To the nearest triangle, metres; nullopt: it is farther than the limit.
    [[nodiscard]] std::optional<float> distance(const Eigen::Vector3f& point) const;

private:
    using Cell = std::array<int, 3>;
    struct Hash {
        std::size_t operator()(const Cell& cell) const;
    };
    using Corners = std::array<Eigen::Vector3f, 3>;
    void add(const Corners& corners);
    [[nodiscard]] Cell cell_of(const Eigen::Vector3f& point) const;

    float limit_;
    std::vector<Corners> triangles_;
    std::unordered_map<Cell, std::vector<std::uint32_t>, Hash> cells_;
};

}  // namespace posefusion
