#include "hosts/evaluate/duplicate_surface.hpp"

#include <cmath>
#include <numbers>
#include <unordered_map>

#include "engine/core/error.hpp"
#include "hosts/evaluate/cube.hpp"

namespace posefusion {
namespace {

void check(const DuplicateSurfaceConfig& c) {
    if (!(c.min_offset >= 0 && c.max_offset > c.min_offset && c.lateral_radius > 0))
        throw Error("duplicate surface: the offsets must be 0 <= min < max and the lateral radius above 0, in metres");
    if (!(c.max_angle > 0 && c.max_angle < 90 && c.support >= 1))
        throw Error("duplicate surface: the angle must be between 0 and 90 degrees and the support at least 1");
}

std::uint32_t apart(std::uint32_t a, std::uint32_t b) { return a > b ? a - b : b - a; }

}  // namespace

DuplicateSurface find_duplicate_surface(const std::vector<Surfel>& map, const DuplicateSurfaceConfig& config,
                                        std::vector<std::uint8_t>* is_duplicated) {
    check(config);
    // Cubes of this side: whatever belongs to a surfel's layers lies in its own cube or in one beside it.
    const float side = std::hypot(config.max_offset, config.lateral_radius);
    const float least_cosine = std::cos(config.max_angle * std::numbers::pi_v<float> / 180);
    std::unordered_map<Cube, std::vector<std::size_t>, CubeHash> cubes;
    for (std::size_t i = 0; i < map.size(); ++i) cubes[cube_of(map[i].position.cast<double>(), side)].push_back(i);
    if (is_duplicated != nullptr) is_duplicated->assign(map.size(), 0);

    DuplicateSurface result;
    result.surfels = map.size();
    for (std::size_t i = 0; i < map.size(); ++i) {
        const Surfel& surfel = map[i];
        int layer = 0, other_visit = 0;
        const auto look_at = [&](const Surfel& other) {
            const Eigen::Vector3f to = other.position - surfel.position;
            const float along = to.dot(surfel.normal), offset = std::abs(along);
            if (offset < config.min_offset || offset > config.max_offset) return;
            if (to.squaredNorm() - along * along > config.lateral_radius * config.lateral_radius) return;
            if (other.normal.dot(surfel.normal) < least_cosine) return;
            ++layer;
            if (apart(other.created, surfel.created) >= config.visit_gap) ++other_visit;
        };
        const Cube centre = cube_of(surfel.position.cast<double>(), side);
        for_each_near(centre, [&](const Cube& cube) {
            const auto found = cubes.find(cube);
            if (found == cubes.end()) return;
            for (const std::size_t k : found->second) look_at(map[k]);
        });
        if (layer < config.support) continue;
        ++result.duplicated;
        if (other_visit >= config.support) ++result.revisited;
        if (is_duplicated != nullptr) (*is_duplicated)[i] = 1;
    }
    return result;
}

}  // namespace posefusion
