#include "hosts/viewer/scene_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shaders/viewer_segment_frag.h"
#include "shaders/viewer_segment_vert.h"
#include "shaders/viewer_surfel_frag.h"
#include "shaders/viewer_surfel_vert.h"
#include "shaders/viewer_tile_frag.h"
#include "shaders/viewer_tile_vert.h"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr float kNear = 0.05f;                    // metres
constexpr float kAgeScale = 200;                  // frames, until a surfel is as dark as it gets
constexpr std::uint32_t kVerticesPerSegment = 6;  // shaders/viewer/segment.vert
constexpr std::size_t kFirstSegments = 1024;      // room in the buffer at the start
constexpr std::uint32_t kSurfelBuffers = 4, kSegmentBuffers = 2, kTileBuffers = 4;

/// shaders/include/viewer_view.glsl
struct ViewBlock {
    float rows[3][4];
    float focal[2], size[2];
    float near, min_confidence, stable_confidence, now;
    std::uint32_t color_mode;
    float age_scale;
    std::uint32_t stride, unused;
    float centre[2];
};
static_assert(sizeof(ViewBlock) == 104);

/// shaders/include/viewer_tile.glsl
struct TileBlock {
    float place[4];
    float window[2];
    std::uint32_t width, height;
    std::uint32_t content, show_mask;
    float depth_max;
};
static_assert(sizeof(TileBlock) == 44 && sizeof(Segment) == 32);

}  // namespace

SceneRenderer::SceneRenderer(Context& context, VkRenderPass pass)
    : context_(context),
      view_(host_buffer<ViewBlock>(context, 1, "view")),
      segments_(host_buffer<Segment>(context, kFirstSegments, "segments")),
      draw_surfels_(context, pass,
                    {viewer_surfel_vert, viewer_surfel_frag, VK_PRIMITIVE_TOPOLOGY_POINT_LIST, true, kSurfelBuffers, 0,
                     "draw surfels"}),
      draw_segments_(context, pass,
                     {viewer_segment_vert, viewer_segment_frag, VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST, true,
                      kSegmentBuffers, 0, "draw segments"}),
      draw_tiles_(context, pass,
                  {viewer_tile_vert, viewer_tile_frag, VK_PRIMITIVE_TOPOLOGY_TRIANGLE_STRIP, false, kTileBuffers,
                   sizeof(TileBlock), "draw tiles"}) {
    draw_segments_.bind({&view_, &segments_});
}

SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::set_snapshot(std::shared_ptr<const MapSnapshot> snapshot) {
    snapshot_ = std::move(snapshot);
    if (!snapshot_) return;
    const MapSnapshot& s = *snapshot_;
    draw_surfels_.bind({&view_, &s.surfels.position_confidence, &s.surfels.normal_radius, &s.surfels.appearance});
    draw_tiles_.bind({&s.color, &s.depth, &s.model_color, &s.model_depth});
}

void SceneRenderer::set_segments(std::span<const Segment> segments) {
    const std::size_t room = segments_.bytes() / sizeof(Segment);
    if (segments.size() > room) {
        segments_ = host_buffer<Segment>(context_, std::max(segments.size(), 2 * room), "segments");
        draw_segments_.bind({&view_, &segments_});
    }
    std::copy(segments.begin(), segments.end(), segments_.host<Segment>().begin());
    segment_count_ = static_cast<std::uint32_t>(segments.size());
}

void SceneRenderer::enqueue(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles) {
    ViewBlock& block = view_.host<ViewBlock>()[0];
    const Eigen::Matrix4f T = view.T_camera_world.matrix();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 4; ++column) block.rows[row][column] = T(row, column);
    }
    const float half_angle = view.field_of_view_deg * std::numbers::pi_v<float> / 360;
    block.focal[0] = block.focal[1] = view.height / 2 / std::tan(half_angle);
    block.size[0] = view.width, block.size[1] = view.height;
    block.centre[0] = view.centre_x, block.centre[1] = view.centre_y;
    block.stride = view.stride;
    block.near = kNear;
    block.min_confidence = view.min_confidence;
    block.stable_confidence = view.stable_confidence;
    block.now = snapshot_ ? static_cast<float>(snapshot_->frame) : 0.0f;
    block.color_mode = static_cast<std::uint32_t>(view.color_mode);
    block.age_scale = kAgeScale;

    const VkViewport viewport{0, 0, view.width, view.height, 0, 1};
    const VkRect2D scissor{{0, 0}, {static_cast<std::uint32_t>(view.width), static_cast<std::uint32_t>(view.height)}};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &scissor);
    if (snapshot_ && view.show_map && snapshot_->slots > 0)
        draw_surfels_.draw(commands, snapshot_->slots / view.stride);
    if (segment_count_ > 0) draw_segments_.draw(commands, segment_count_ * kVerticesPerSegment);
    if (snapshot_) enqueue_tiles(commands, view, tiles);
}

void SceneRenderer::enqueue_tiles(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles) const {
    for (const Tile& tile : tiles) {
        const TileBlock block{{tile.left, tile.top, tile.width, tile.height},
                              {view.width, view.height},
                              static_cast<std::uint32_t>(snapshot_->camera.width),
                              static_cast<std::uint32_t>(snapshot_->camera.height),
                              static_cast<std::uint32_t>(tile.content),
                              tile.show_mask ? 1u : 0u,
                              tile.depth_max};
        draw_tiles_.draw(commands, 4, std::as_bytes(std::span(&block, 1)));
    }
}

}  // namespace posefusion
