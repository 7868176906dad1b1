#pragma once
#include <cstddef>
#include <vector>

namespace posefusion {

struct ErrorStatistics {
    std::size_t count = 0;
    double rmse = 0, mean = 0, median = 0, std = 0, min = 0, max = 0;  ///< std over count, not count - 1
};
/// All zero for no errors.
[[nodiscard]] ErrorStatistics error_statistics(std::vector<double> errors);

/// The median; of an even number of values the mean of the two in the middle. @param values  at least one
[[nodiscard]] double median_of(std::vector<double> values);

}  // namespace posefusion
