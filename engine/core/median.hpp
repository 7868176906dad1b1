#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

namespace posefusion {

/// The median of at least one value; of an even number the upper of the two in the middle. Reorders the values.
template <class T>
[[nodiscard]] T upper_median(std::vector<T>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace posefusion
