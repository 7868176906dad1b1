#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "engine/map/surfel.hpp"
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
    bool show_map = true, show_objects = true;
};

/// Where a point of the world (metres) is in the window, pixels from its top left corner; nullopt: behind the viewer.
[[nodiscard]] std::optional<glm::vec2> pixel_of(const glm::vec3& point, const SceneView& view);

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
    bool show_mask;   ///< people and what else moves are tinted
    float depth_max;  ///< metres, far end of the colour scale
};

/// Draws the map and the images of a snapshot, straight from its buffers on the device, objects and lines.
class SceneRenderer {
public:
    SceneRenderer(vulkan::Context& context, VkRenderPass pass);
    ~SceneRenderer();

    /// All four only while no recorded frame is in flight.
    void set_snapshot(std::shared_ptr<const MapSnapshot> snapshot);
    void set_segments(std::span<const Segment> segments);
    /// Surfels that are no part of the map: of objects, where they are. World frame.
    void set_objects(std::span<const Surfel> surfels);
    /// Objects are tinted in the colours of their labels, which are the same in all frames; else as people are.
    void tint_objects();
    [[nodiscard]] std::uint32_t object_surfels() const { return object_surfels_; }
    [[nodiscard]] const MapSnapshot* snapshot() const { return snapshot_.get(); }

    /// Called inside of the render pass; no earlier recording may be in flight. @param tiles  each content at most once
    void enqueue(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles);

private:
    void make_object_room(std::size_t surfels);
    void enqueue_tiles(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles);

    vulkan::Context& context_;
    vulkan::Buffer view_, segments_, tiles_, tints_;
    vulkan::Buffer object_positions_, object_normals_, object_appearances_;  // as SurfelStreams
    std::uint32_t segment_count_ = 0, object_surfels_ = 0;
    DrawPipeline draw_surfels_, draw_objects_, draw_segments_, draw_tiles_;
    std::shared_ptr<const MapSnapshot> snapshot_;
};

}  // namespace posefusion
