#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "hosts/mesh/mesh.hpp"

/// Which view gives a place of the mesh its colour: few views with large regions, so that there are few seams.
namespace posefusion {

/// A view with its share of the colour of a vertex.
struct ViewWeight {
    std::uint32_t view = 0;
    float weight = 0;
};

/// The views in which each vertex is seen best.
class ViewCandidates {
public:
    explicit ViewCandidates(std::size_t vertices) : of_(vertices) {}

    /// @param quality  see SeenInView::quality(); 0 is left out
    void add(std::size_t vertex, std::uint32_t view, float quality);

    struct Candidate {
        std::uint32_t view = 0;
        float quality = 0;
    };
    static constexpr std::size_t kMost = 8;
    struct List {
        std::array<Candidate, kMost> all{};  ///< the best first
        std::size_t count = 0;
    };
    [[nodiscard]] const List& of(std::size_t vertex) const { return of_[vertex]; }

private:
    std::vector<List> of_;
};

/// Weights with a sum of 1 for each vertex; none for one that no view shows. The view of a vertex is that of the best
/// quality unless its neighbours have another one that is nearly as good (a Potts model, optimised by iterated
/// conditional modes; Besag 1986). Next to a vertex with another view both have a share, as far as both show it.
[[nodiscard]] std::vector<std::vector<ViewWeight>> choose_views(const Mesh& mesh, const ViewCandidates& candidates);

}  // namespace posefusion
