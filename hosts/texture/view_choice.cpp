#include "hosts/texture/view_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace posefusion {
namespace {

constexpr std::uint32_t kNoView = std::numeric_limits<std::uint32_t>::max();
constexpr int kSweeps = 10;  // few vertices change in later ones
/// A view that all neighbours have may have e^-1 of the best quality.
constexpr float kSmoothness = 1;

/// The neighbours of each vertex, one after the other.
struct Neighbours {
    std::vector<std::uint32_t> begin, all;

    explicit Neighbours(const Mesh& mesh) : begin(mesh.vertices.size() + 1) {
        std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
        edges.reserve(6 * mesh.faces.size());
        for (const auto& face : mesh.faces)
            for (std::size_t k = 0; k < 3; ++k)
                for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) edges.emplace_back(face[k], face[other]);
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
        for (const auto& [from, to] : edges) {
            ++begin[from + 1];
            all.push_back(to);
        }
        for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
    }

    template <class Visit>
    void for_each(std::size_t vertex, Visit&& visit) const {
        for (std::uint32_t i = begin[vertex]; i < begin[vertex + 1]; ++i) visit(all[i]);
    }
};

std::uint32_t best_view(std::size_t vertex, const ViewCandidates& candidates, const Neighbours& neighbours,
                        const std::vector<std::uint32_t>& view_of) {
    const ViewCandidates::List& list = candidates.of(vertex);
    std::uint32_t best = kNoView;
    float best_score = -std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < list.count; ++i) {
        float same = 0, all = 0;
        neighbours.for_each(vertex, [&](std::uint32_t other) {
            if (view_of[other] == kNoView) return;
            all += 1;
            if (view_of[other] == list.all[i].view) same += 1;
        });
        const float score = std::log(list.all[i].quality) + (all > 0 ? kSmoothness * same / all : 0);
        if (score > best_score) {
            best_score = score;
            best = list.all[i].view;
        }
    }
    return best;
}

}  // namespace

void ViewCandidates::add(std::size_t vertex, std::uint32_t view, float quality) {
    if (!(quality > 0)) return;
    List& list = of_[vertex];
    if (list.count == kMost && !(quality > list.all[kMost - 1].quality)) return;
    std::size_t at = std::min(list.count, kMost - 1);
    for (; at > 0 && quality > list.all[at - 1].quality; --at) list.all[at] = list.all[at - 1];
    list.all[at] = {view, quality};
    list.count = std::min(list.count + 1, kMost);
}

std::vector<std::vector<ViewWeight>> choose_views(const Mesh& mesh, const ViewCandidates& candidates) {
    const std::size_t vertices = mesh.vertices.size();
    const Neighbours neighbours(mesh);
    std::vector<std::uint32_t> view_of(vertices, kNoView);
    for (std::size_t i = 0; i < vertices; ++i)
        if (candidates.of(i).count > 0) view_of[i] = candidates.of(i).all[0].view;
    bool changed = true;
    for (int sweep = 0; changed && sweep < kSweeps; ++sweep) {
        changed = false;
        for (std::size_t i = 0; i < vertices; ++i) {
            const std::uint32_t view = best_view(i, candidates, neighbours, view_of);
            changed = changed || view != view_of[i];
            view_of[i] = view;
        }
    }

    std::vector<std::vector<ViewWeight>> weights(vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
        const ViewCandidates::List& list = candidates.of(i);
        float sum = 0;
        for (std::size_t c = 0; c < list.count; ++c) {
            float votes = list.all[c].view == view_of[i] ? 1 : 0;
            neighbours.for_each(
                i, [&](std::uint32_t other) { votes += view_of[other] == list.all[c].view ? 1.0f : 0.0f; });
            if (votes > 0) weights[i].push_back({list.all[c].view, votes});
            sum += votes;
        }
        for (ViewWeight& w : weights[i]) w.weight /= sum;
    }
    return weights;
}

}  // namespace posefusion
