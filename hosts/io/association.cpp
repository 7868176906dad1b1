#include "hosts/io/association.hpp"

#include <algorithm>
#include <numeric>

namespace posefusion {
namespace {

struct Candidate {
    Stamp difference;
    std::size_t a, b;
};

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<Stamp>& a, const std::vector<Stamp>& b,
                                                           Stamp max_difference) {
    std::vector<std::size_t> b_order(b.size());
    std::iota(b_order.begin(), b_order.end(), std::size_t{0});
    std::sort(b_order.begin(), b_order.end(), [&](std::size_t i, std::size_t j) { return b[i] < b[j]; });

    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < a.size(); ++i) {
        auto it = std::upper_bound(b_order.begin(), b_order.end(), a[i] - max_difference,
                                   [&](Stamp t, std::size_t j) { return t < b[j]; });
        for (; it != b_order.end() && b[*it] < a[i] + max_difference; ++it)
            candidates.push_back({std::chrono::abs(a[i] - b[*it]), i, *it});
    }
    std::sort(candidates.begin(), candidates.end(), [&](const Candidate& p, const Candidate& q) {
        if (p.difference != q.difference) return p.difference < q.difference;
        return a[p.a] != a[q.a] ? a[p.a] < a[q.a] : b[p.b] < b[q.b];
    });

    std::vector<bool> a_taken(a.size()), b_taken(b.size());
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (const Candidate& c : candidates) {
        if (a_taken[c.a] || b_taken[c.b]) continue;
        a_taken[c.a] = b_taken[c.b] = true;
        pairs.emplace_back(c.a, c.b);
    }
    std::sort(pairs.begin(), pairs.end(), [&](const auto& p, const auto& q) { return a[p.first] < a[q.first]; });
    return pairs;
}

std::optional<std::size_t> nearest_stamp(const std::vector<Stamp>& stamps, Stamp stamp, Stamp max_difference) {
    const auto after = std::lower_bound(stamps.begin(), stamps.end(), stamp);
    auto best = after;
    if (after == stamps.end() || (after != stamps.begin() && stamp - *(after - 1) <= *after - stamp)) {
        if (after == stamps.begin()) return std::nullopt;
        best = after - 1;
    }
    if (!(std::chrono::abs(*best - stamp) < max_difference)) return std::nullopt;
    return static_cast<std::size_t>(best - stamps.begin());
}

}  // namespace posefusion
