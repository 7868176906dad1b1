#include "hosts/viewer/scene_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <glm/trigonometric.hpp>

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
constexpr std::uint32_t kVerticesPerTile = 4;     // shaders/viewer/tile.vert

}  // namespace

SceneRenderer::SceneRenderer(Context& context, VkRenderPass pass)
    : context_(context),
      view_(host_buffer<gpu::View>(context, 1, "view")),
      segments_(host_buffer<Segment>(context, kFirstSegments, "segments")),
      tiles_(host_buffer<gpu::TileView>(context, gpu::TILE_CONTENTS, "tiles")),
      draw_surfels_(context, pass,
                    {"draw surfels", viewer_surfel_vert, viewer_surfel_frag, VK_PRIMITIVE_TOPOLOGY_POINT_LIST}),
      draw_segments_(context, pass, {"draw segments", viewer_segment_vert, viewer_segment_frag}),
      draw_tiles_(context, pass,
                  {"draw tiles", viewer_tile_vert, viewer_tile_frag, VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP, false}) {
    draw_segments_.bind({{"view", view_}, {"segments", segments_}});
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
                      {"model_depth", s.model_depth}});
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

void SceneRenderer::enqueue(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles) {
    const float half_angle = glm::radians(view.field_of_view_deg) / 2;
    gpu::View& block = view_.host<gpu::View>()[0];
    block = {};
    block.T_camera_world = view.T_camera_world;
    block.focal = glm::vec2(view.size.y / 2 / std::tan(half_angle));
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
