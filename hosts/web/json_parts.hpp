#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "hosts/web/map_pieces.hpp"
#include "hosts/web/scene.hpp"

/// What the scripts of the page are told of a run, whether it has finished or goes on. Metres, seconds, page frame.
namespace posefusion {

using WebJson = nlohmann::ordered_json;

/// Number of surfels, bounds, the frames in which they were first and last seen, greatest confidence.
/// @param surfels  may be none
[[nodiscard]] WebJson map_facts_json(const std::vector<Surfel>& surfels);
[[nodiscard]] WebJson coding_json(const MapCoding& coding);
/// Flat lists: three numbers per position, four (x y z w) per rotation.
[[nodiscard]] WebJson poses_json(std::span<const ScenePose> poses);
[[nodiscard]] WebJson camera_json(const std::optional<Intrinsics>& camera);
/// The limbs, and per person joints as flat lists of three whole numbers, millimetres; null: not seen.
[[nodiscard]] WebJson people_json(const std::vector<ScenePerson>& people);

}  // namespace posefusion
