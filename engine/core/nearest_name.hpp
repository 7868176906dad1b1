#pragma once
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace posefusion {

/// Levenshtein distance: how many letters differ.
[[nodiscard]] inline std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = std::exchange(row[0], i + 1);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

/// The one of `names` (not empty) that differs least from a misspelt name, the first of several: for messages.
template <class Names>
[[nodiscard]] std::string nearest_name(std::string_view name, const Names& names) {
    return std::string(*std::min_element(std::begin(names), std::end(names), [&](const auto& a, const auto& b) {
        return edit_distance(a, name) < edit_distance(b, name);
    }));
}

}  // namespace posefusion
