#include "hosts/viewer/scene_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>

#include "engine/core/motion_judge.hpp"
#include "engine/objects/object_tracker.hpp"
#include "hosts/report/person_colors.hpp"

namespace posefusion::vulkan {
namespace {

#include "shaders/viewer_segment_frag.h"
#include "shaders/viewer_segment_vert.h"
#include "shaders/viewer_surfel_frag.h"
#include "shaders/viewer_surfel_vert.h"
#include "shaders/viewer_tile_frag.h"
#include "shaders/viewer_tile_vert.h"

}  // namespace
}  // namespace posefusion::vulkan

namespace posefusion {

using namespace vulkan;

namespace {

constexpr float kNear = 0.05f;                    // metres
constexpr float kAgeScale = 200;                  // frames, until a surfel is as dark as it gets
constexpr std::uint32_t kVerticesPerSegment = 6;  // shaders/viewer/segment.vert
constexpr std::size_t kFirstSegments = 1024;      // room in the buffer at the start
constexpr std::size_t kFirstObjectSurfels = 1024;
constexpr std::size_t kLabels = 256;
constexpr Rgb8 kTint{230, 64, 26};             // of people, and of what moves and is no object: orange
constexpr std::uint32_t kVerticesPerTile = 4;  // shaders/viewer/tile.vert

float focal_of(const SceneView& view) { return view.size.y / 2 / std::tan(glm::radians(view.field_of_view_deg) / 2); }

}  // namespace

std::optional<glm::vec2> pixel_of(const glm::vec3& point, const SceneView& view) {
    const glm::vec3 p(view.T_camera_world * glm::vec4(point, 1));
    if (p.z < kNear) return std::nullopt;
    return focal_of(view) / p.z * glm::vec2(p) + view.centre + view.size / 2.0f;
}

SceneRenderer::SceneRenderer(Context& context, VkRenderPass pass)
    : context_(context),
      view_(host_buffer<gpu::View>(context, 1, "view")),
      segments_(host_buffer<Segment>(context, kFirstSegments, "segments")),
      tiles_(host_buffer<gpu::TileView>(context, gpu::TILE_CONTENTS, "tiles")),
      tints_(host_buffer<std::uint32_t>(context, kLabels, "tints")),
      draw_surfels_(context, pass,
                    {"draw surfels", viewer_surfel_vert, viewer_surfel_frag, VK_PRIMITIVE_TOPOLOGY_POINT_LIST}),
      draw_objects_(context, pass,
                    {"draw objects", viewer_surfel_vert, viewer_surfel_frag, VK_PRIMITIVE_TOPOLOGY_POINT_LIST}),
      draw_segments_(context, pass, {"draw segments", viewer_segment_vert, viewer_segment_frag}),
      draw_tiles_(context, pass,
                  {"draw tiles", viewer_tile_vert, viewer_tile_frag, VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP, false}) {
    draw_segments_.bind({{"view", view_}, {"segments", segments_}});
    make_object_room(kFirstObjectSurfels);
    std::ranges::fill(tints_.host<std::uint32_t>(), pack_rgb(kTint));
}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::set_snapshot(std::shared_ptr<const MapSnapshot> snapshot) {
    snapshot_ = std::move(snapshot);
    if (!snapshot_) return;
    const MapSnapshot& s = *snapshot_;
    draw_surfels_.bind({{"view", view_},
                        {"position_confidence", s.surfels.position_confidence},
                        {"normal_radius", s.surfels.normal_radius},
                        {"appearance", s.surfels.appearance}});
    draw_tiles_.bind({{"tiles", tiles_},
                      {"live_color", s.color},
                      {"live_depth", s.depth},
                      {"model_color", s.model_color},
                      {"model_depth", s.model_depth},
                      {"tints", tints_}});
}

void SceneRenderer::set_segments(std::span<const Segment> segments) {
    const std::size_t room = segments_.bytes() / sizeof(Segment);
    if (segments.size() > room) {
        segments_ = host_buffer<Segment>(context_, std::max(segments.size(), 2 * room), "segments");
        draw_segments_.bind({{"view", view_}, {"segments", segments_}});
    }
    std::copy(segments.begin(), segments.end(), segments_.host<Segment>().begin());
    segment_count_ = static_cast<std::uint32_t>(segments.size());
}

void SceneRenderer::make_object_room(std::size_t surfels) {
    object_positions_ = host_buffer<glm::vec4>(context_, surfels, "object positions");
    object_normals_ = host_buffer<glm::vec4>(context_, surfels, "object normals");
    object_appearances_ = host_buffer<glm::uvec4>(context_, surfels, "object appearances");
    draw_objects_.bind({{"view", view_},
                        {"position_confidence", object_positions_},
                        {"normal_radius", object_normals_},
                        {"appearance", object_appearances_}});
}

void SceneRenderer::set_objects(std::span<const Surfel> surfels) {
    const std::size_t room = object_positions_.bytes() / sizeof(glm::vec4);
    if (surfels.size() > room) make_object_room(std::max(surfels.size(), 2 * room));
    const std::span<glm::vec4> positions = object_positions_.host<glm::vec4>(),
                               normals = object_normals_.host<glm::vec4>();
    const std::span<glm::uvec4> appearances = object_appearances_.host<glm::uvec4>();
    const auto unorm16 = [](std::uint8_t value) { return std::uint32_t{value} * 0x101u; };
    for (std::size_t i = 0; i < surfels.size(); ++i) {  // shaders/include/surfel.glsl
        const Surfel& s = surfels[i];
        positions[i] = glm::vec4(to_glm(s.position), s.confidence);
        normals[i] = glm::vec4(to_glm(s.normal), s.radius);
        appearances[i] = {unorm16(s.color.r) | unorm16(s.color.g) << 16, unorm16(s.color.b), 0, 0};
        appearances[i][gpu::CREATED] = s.created;
        appearances[i][gpu::LAST_SEEN] = s.last_seen;
    }
    object_surfels_ = static_cast<std::uint32_t>(surfels.size());
}

void SceneRenderer::tint_objects() {
    const std::span<std::uint32_t> tints = tints_.host<std::uint32_t>();
    for (std::size_t label = kFirstMoverLabel; label < kUnknownMoverLabel; ++label)
        tints[label] = pack_rgb(label_color(static_cast<std::uint8_t>(label)));
}

void SceneRenderer::enqueue(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles) {
    gpu::View& block = view_.host<gpu::View>()[0];
    block = {};
    block.T_camera_world = view.T_camera_world;
    block.focal = glm::vec2(focal_of(view));
    block.size = view.size;
    block.centre = view.centre;
    block.near = kNear;
    block.min_confidence = view.min_confidence;
    block.stable_confidence = view.stable_confidence;
    block.now = snapshot_ ? static_cast<float>(snapshot_->frame) : 0.0f;
    block.age_scale = kAgeScale;
    block.color_mode = static_cast<std::uint32_t>(view.color_mode);
    block.stride = view.stride;

    const VkViewport viewport{0, 0, view.size.x, view.size.y, 0, 1};
    const VkRect2D scissor{{0, 0}, {static_cast<std::uint32_t>(view.size.x), static_cast<std::uint32_t>(view.size.y)}};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &scissor);
    if (snapshot_ && view.show_map && snapshot_->slots > 0)
        draw_surfels_.draw(commands, snapshot_->slots / view.stride);
    if (view.show_objects && object_surfels_ > 0) draw_objects_.draw(commands, object_surfels_ / view.stride);
    if (segment_count_ > 0) draw_segments_.draw(commands, segment_count_ * kVerticesPerSegment);
    if (snapshot_) enqueue_tiles(commands, view, tiles);
}

void SceneRenderer::enqueue_tiles(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles) {
    const std::span<gpu::TileView> blocks = tiles_.host<gpu::TileView>();
    const std::size_t count = std::min(tiles.size(), blocks.size());
    for (std::size_t i = 0; i < count; ++i) {
        const Tile& tile = tiles[i];
        gpu::TileView& block = blocks[i];
        block = {};
        block.place = {tile.left, tile.top, tile.width, tile.height};
        block.window = view.size;
        block.width = static_cast<std::uint32_t>(snapshot_->camera.width);
        block.height = static_cast<std::uint32_t>(snapshot_->camera.height);
        block.content = static_cast<std::uint32_t>(tile.content);
        block.show_mask = tile.show_mask ? 1u : 0u;
        block.depth_max = tile.depth_max;
    }
    if (count > 0) draw_tiles_.draw(commands, kVerticesPerTile, static_cast<std::uint32_t>(count));
}

}  // namespace posefusion
