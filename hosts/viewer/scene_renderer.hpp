#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <span>

#include "engine/slam/map_snapshot.hpp"
#include "hosts/viewer/draw_pipeline.hpp"

namespace posefusion {

enum class ColorMode : std::uint32_t {
    Photo,       ///< as the camera saw it
    Normal,      ///< direction of the surface, world frame
    Confidence,  ///< dark: new; bright: twice the confidence of a stable surfel
    Age,         ///< bright: just seen; dark: not seen for long
    Time,        ///< dark: made early; bright: made late
};

/// What is drawn of the map, and from where.
struct SceneView {
    Eigen::Isometry3f T_camera_world = Eigen::Isometry3f::Identity();  ///< viewing camera: x right, y down, z forward
    float field_of_view_deg = 60;                                      ///< vertical
    float width = 1, height = 1;                                       ///< of the window, pixels
    float centre_x = 0, centre_y = 0;  ///< where the optical axis meets the window, pixels from its middle
    ColorMode color_mode = ColorMode::Photo;
    float min_confidence = 0;  ///< surfels below this are not drawn
    float stable_confidence = 1;
    std::uint32_t stride = 1;  ///< of the surfels every so many-th is drawn, larger
    bool show_map = true;
};

/// A thick line in the world; one without length is drawn as a square. As shaders/viewer/segment.vert reads it.
struct Segment {
    float from[3];        ///< world, metres
    float width;          ///< pixels
    float to[3];          ///< world, metres
    std::uint32_t color;  ///< r | g << 8 | b << 16
};

enum class TileContent : std::uint32_t { Color, Depth, PredictedColor, PredictedDepth };

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

    /// Both only while nothing that was recorded is in flight.
    void set_snapshot(std::shared_ptr<const MapSnapshot> snapshot);
    void set_segments(std::span<const Segment> segments);
    [[nodiscard]] const MapSnapshot* snapshot() const { return snapshot_.get(); }

    /// Inside of the pass. Nothing recorded before may be in flight.
    void enqueue(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles);

private:
    void enqueue_tiles(VkCommandBuffer commands, const SceneView& view, std::span<const Tile> tiles) const;

    vulkan::Context& context_;
    vulkan::Buffer view_, segments_;
    std::uint32_t segment_count_ = 0;
    DrawPipeline draw_surfels_, draw_segments_, draw_tiles_;
    std::shared_ptr<const MapSnapshot> snapshot_;
};

}  // namespace posefusion
