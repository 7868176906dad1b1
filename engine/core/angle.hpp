#pragma once
#include <concepts>
#include <numbers>

namespace posefusion {

template <std::floating_point T>
[[nodiscard]] constexpr T radians(T degrees) {
    return degrees * std::numbers::pi_v<T> / T{180};
}

}  // namespace posefusion
