#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "engine/slam/map_snapshot.hpp"
#include "hosts/viewer/draw_pipeline.hpp"
#include "hosts/viewer/draw_types.hpp"

namespace posefusion {

/// What the colour of a surfel shows; see shaders/include/viewer_types.h.
enum class ColorMode : std::uint32_t {
    Photo = gpu::COLOR_PHOTO,
    Normal = gpu::COLOR_NORMAL,
    Confidence = gpu::COLOR_CONFIDENCE,
    Age = gpu::COLOR_AGE,
    Time = gpu::COLOR_TIME,
};

/// The viewpoint, and which parts of the map are drawn.
struct SceneView {
    glm::mat4 T_camera_world{1};   ///< viewing camera: x right, y down, z forward
    float field_of_view_deg = 60;  ///< vertical
    glm::vec2 size{1};             ///< of the window, pixels
    glm::vec2 centre{0};           ///< where the optical axis meets the window, pixels from its middle
    ColorMode color_mode = ColorMode::Photo;
    float min_confidence = 0;  ///< surfels below this are not drawn
    float stable_confidence = 1;
    std::uint32_t stride = 1;  ///< every stride-th surfel is drawn, enlarged
    bool show_map = true;
};

using gpu::Segment;

enum class TileContent : std::uint32_t {
    Color = gpu::TILE_COLOR,
    Depth = gpu::TILE_DEPTH,
    PredictedColor = gpu::TILE_PREDICTED_COLOR,
    PredictedDepth = gpu::TILE_PREDICTED_DEPTH,
};

/// An image of the newest frame in a rectangle of the window.
struct Tile {
    float left, top, width, height;  ///< pixels of the window
    TileContent content;
    bool show_mask;   ///< people are tinted
    float depth_max;  ///< metres, far end of the colour scale
};

/// Draws the map, lines and images of a snapshot, straight from its buffers on the device.
class SceneRenderer {
public:
    SceneRenderer(vulkan::Context& context, VkRenderPass pass);
    ~SceneRenderer();

    /// Both only while no recorded frame is in flight.
    void set_snapshot(std::shared_ptr<const MapSnapshot> snapshot);
    void set_segments(std::span<const Segment> segments);
    [[nodiscard]] const MapSnapshot* snapshot() const { return snapshot_.get(); }

    /// Called inside of the render pass; no earlier recording may be in flight. @param tiles  each content at most once
    void enqueue(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles);

private:
    void enqueue_tiles(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles);

    vulkan::Context& context_;
    vulkan::Buffer view_, segments_, tiles_;
    std::uint32_t segment_count_ = 0;
    DrawPipeline draw_surfels_, draw_segments_, draw_tiles_;
    std::shared_ptr<const MapSnapshot> snapshot_;
};

}  // namespace posefusion
