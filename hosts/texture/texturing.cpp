#include "hosts/texture/texturing.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/texture/atlas_layout.hpp"
#include "hosts/texture/baking.hpp"
#include "hosts/texture/charts.hpp"
#include "hosts/texture/exposure.hpp"
#include "hosts/texture/seen_in_view.hpp"
#include "hosts/texture/view_choice.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kExposurePlaces = 10'000;  // vertices at which the views are compared
constexpr float kNearPlaces = 0.8f;              // quantile of the quality that the texture keeps
constexpr float kTexelsPerPixel = 1.5f;          // along a side: resampling loses little
constexpr float kUsedArea = 0.5f;                // of a texture; the rest is between the charts
constexpr float kWidestChart = 0.5f;             // of the side of the texture: more are hard to pack

/// What the views say about the mesh before any of their colours is used.
struct Survey {
    ViewCandidates candidates;
    std::vector<ColorSample> samples;
    std::vector<Eigen::Vector3f> map;  ///< colours of the places of the samples

    explicit Survey(const Mesh& mesh) : candidates(mesh.vertices.size()) {
        stride = std::max<std::size_t>(1, mesh.vertices.size() / kExposurePlaces);
        for (std::size_t i = 0; i < mesh.vertices.size(); i += stride) {
            const Rgb8 c = mesh.vertices[i].color;
            map.emplace_back(c.r, c.g, c.b);
        }
    }

    void add(const Mesh& mesh, const std::vector<Eigen::Vector3f>& normals, std::uint32_t number, const View& view,
             const Intrinsics& camera) {
        const SeenInView seen(mesh, view, camera);
        for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
            const Eigen::Vector3f& position = mesh.vertices[i].position;
            const float quality = seen.quality(position, normals[i]);
            candidates.add(i, number, quality);
            if (quality > 0 && i % stride == 0)
                samples.push_back(
                    {static_cast<std::uint32_t>(i / stride), number, seen.color_at(*seen.pixel_of(position))});
        }
    }

    /// Metres per texel that show what the views do, where they are nearer than in most places.
    [[nodiscard]] float texel(std::size_t vertices) const {
        std::vector<float> best;
        for (std::size_t i = 0; i < vertices; ++i)
            if (candidates.of(i).count > 0) best.push_back(candidates.of(i).all[0].quality);
        if (best.empty()) throw Error("no view shows the surface; is it the map of another run?");
        const auto near = best.begin() + static_cast<std::ptrdiff_t>(kNearPlaces * static_cast<float>(best.size()));
        std::nth_element(best.begin(), near, best.end());
        return 1 / (kTexelsPerPixel * std::sqrt(*near));
    }

private:
    std::size_t stride = 1;
};

float area_of(const Mesh& mesh) {
    double twice = 0;
    for (const auto& face : mesh.faces) {
        const Eigen::Vector3f& a = mesh.vertices[face[0]].position;
        const Eigen::Vector3f normal = (mesh.vertices[face[1]].position - a).cross(mesh.vertices[face[2]].position - a);
        twice += static_cast<double>(normal.norm());
    }
    return static_cast<float>(twice / 2);
}

/// The mesh with its vertices in the texture: one for each chart that a vertex is in.
void add_surface(TexturedMesh& result, const Mesh& mesh, const std::vector<Eigen::Vector3f>& normals,
                 const std::vector<Chart>& charts, const AtlasLayout& layout) {
    struct Copy {
        std::size_t chart = 0;
        std::uint32_t vertex = 0;
    };
    std::vector<std::optional<Copy>> newest(mesh.vertices.size());
    const auto size = static_cast<float>(layout.size);
    for (std::size_t chart = 0; chart < charts.size(); ++chart) {
        for (const std::uint32_t face : charts[chart].faces) {
            auto& corners = result.faces.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t vertex = mesh.faces[face][k];
                std::optional<Copy>& copy = newest[vertex];
                if (!copy || copy->chart != chart) {
                    copy = {chart, static_cast<std::uint32_t>(result.vertices.size())};
                    const Eigen::Vector3f& position = mesh.vertices[vertex].position;
                    const Eigen::Vector2f texel = layout.texel_of(charts[chart], chart, position);
                    constexpr float kCentre = 0.5f;  // of a texel, counted from the corner of the texture
                    result.vertices.push_back(
                        {position, normals[vertex], (texel + Eigen::Vector2f::Constant(kCentre)) / size});
                }
                corners[k] = copy->vertex;
            }
        }
    }
}

}  // namespace

TexturedMesh make_texture(const Mesh& mesh, const TextureViews& views, const TextureConfig& config,
                          const TextureObserver& observer) {
    const std::vector<Eigen::Vector3f> normals = vertex_normals(mesh);
    const auto for_each_view = [&](const char* what, const auto& wanted, const auto& use) {
        for (std::size_t i = 0; i < views.count; ++i) {
            try {
                if (wanted(i)) use(static_cast<std::uint32_t>(i), views.load(i));
            } catch (const Error& error) {
                observer.warning(error.what());
            }
            observer.progress(what, i + 1, views.count);
        }
    };
    Survey survey(mesh);
    for_each_view(
        "comparing views", [](std::size_t) { return true; },
        [&](std::uint32_t i, const View& view) { survey.add(mesh, normals, i, view, views.camera); });
    const std::vector<Eigen::Vector3f> gains = level_exposure(survey.samples, survey.map, views.count);
    const auto weights = choose_views(mesh, survey.candidates);

    const auto side = static_cast<float>(config.size);
    const float texel =
        std::max(survey.texel(mesh.vertices.size()), std::sqrt(area_of(mesh) / (kUsedArea * side * side)));
    const std::vector<Chart> charts = cut_into_charts(mesh, texel, kWidestChart * side * texel);
    const AtlasLayout layout = lay_out(charts, texel, config.size);

    std::vector<bool> used(views.count);
    for (const auto& of_vertex : weights)
        for (const ViewWeight& w : of_vertex) used[w.view] = true;
    Baking baking(mesh, charts, layout, weights);
    for_each_view(
        "painting", [&](std::size_t i) { return used[i]; },
        [&](std::uint32_t i, const View& view) { baking.add(i, view, views.camera, gains[i]); });

    TexturedMesh result;
    add_surface(result, mesh, normals, charts, layout);
    result.texture = baking.finish();
    result.texel = layout.texel;
    result.views = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
    return result;
}

}  // namespace posefusion
