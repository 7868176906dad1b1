#include "hosts/evaluate/error_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace posefusion {

double median_of(std::vector<double> values) {
    const std::size_t middle = values.size() / 2;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle), values.end());
    if (values.size() % 2 == 1) return values[middle];
    const double below = *std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle));
    return (below + values[middle]) / 2;
}

ErrorStatistics error_statistics(std::vector<double> errors) {
    ErrorStatistics s;
    s.count = errors.size();
    if (errors.empty()) return s;
    const auto n = static_cast<double>(errors.size());
    double squares = 0, deviations = 0;
    for (const double e : errors) squares += e * e;
    s.rmse = std::sqrt(squares / n);
    s.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
    for (const double e : errors) deviations += (e - s.mean) * (e - s.mean);
    s.std = std::sqrt(deviations / n);
    const auto [smallest, largest] = std::minmax_element(errors.begin(), errors.end());
    s.min = *smallest;
    s.max = *largest;
    s.median = median_of(std::move(errors));
    return s;
}

}  // namespace posefusion
