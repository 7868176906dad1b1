#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "engine/core/image.hpp"

namespace posefusion {

/// Colours of people in pictures and in the viewer, distinguishable for colour-blind people as well (Okabe and Ito).
inline constexpr std::array<Rgb8, 7> kPersonColors{
    {{230, 159, 0}, {86, 180, 233}, {0, 158, 115}, {240, 228, 66}, {213, 94, 0}, {204, 121, 167}, {0, 114, 178}}};

/// @param person  0, 1, ...; the colours repeat
[[nodiscard]] constexpr Rgb8 person_color(std::size_t person) { return kPersonColors[person % kPersonColors.size()]; }
/// @param label  of a person or an object in a label image, from 1 on
[[nodiscard]] constexpr Rgb8 label_color(std::uint8_t label) { return person_color(label - std::size_t{1}); }

}  // namespace posefusion
