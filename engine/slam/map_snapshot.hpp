#pragma once
#include <memory>
#include <mutex>
#include <vector>

#include "engine/map/surfel_map.hpp"
#include "engine/preprocess/preprocessing.hpp"
#include "engine/vulkan/context.hpp"

/// For renderers that share the engine's device (DeviceSharing): needs Vulkan's headers, but no window.
namespace posefusion {

/// The map and the images of one frame, copied on the device, so that they can be drawn while the next frame changes
/// the originals. May be read by any thread until its last owner releases it, which must not happen before the device
/// has finished reading; the memory is then reused.
struct MapSnapshot {
    std::shared_ptr<vulkan::Context> context;  ///< keeps the device alive
    Intrinsics camera;                         ///< of the images, which have camera.width * camera.height pixels
    SurfelStreams surfels;                     ///< shaders/include/surfel.glsl; `slots` of them, dead ones included
    vulkan::Buffer color;                      ///< uint: pack_rgb() | label << 24 of the live image
    vulkan::Buffer depth;                      ///< float: metres, 0 = none, static parts of the live image
    vulkan::Buffer model_color;                ///< uint: pack_rgb() | source << 24: 0 none, 1 map, 2 live image
    vulkan::Buffer model_depth;                ///< float: metres, 0 = none
    std::uint32_t capacity = 0, slots = 0;
    std::uint32_t frame = 0;  ///< its number; the first is 0

    MapSnapshot(std::shared_ptr<vulkan::Context> shared, const Intrinsics& intrinsics, std::uint32_t surfel_capacity);
    /// `capacity` must be enough for the map. Waits for the device.
    void copy_from(const SurfelMap& map, const Preprocessing& images, const vulkan::Buffer& predicted_depth,
                   const vulkan::Buffer& predicted_color, std::uint32_t frame_number);
};

/// A pool of snapshots: at most one that has not been taken yet, and unused ones to be refilled.
class SnapshotExchange : public std::enable_shared_from_this<SnapshotExchange> {
public:
    /// Returns an unused snapshot with capacity for `slots`.
    [[nodiscard]] std::shared_ptr<MapSnapshot> blank(const std::shared_ptr<vulkan::Context>& context,
                                                     const Intrinsics& camera, std::uint32_t slots);
    void offer(std::shared_ptr<MapSnapshot> snapshot);
    /// Returns the newest snapshot unless it has been taken already; nullptr if there is none.
    [[nodiscard]] std::shared_ptr<const MapSnapshot> take();
    void clear() { offer(nullptr); }

private:
    std::mutex mutex_;
    std::shared_ptr<MapSnapshot> offered_;
    std::vector<std::unique_ptr<MapSnapshot>> unused_;
};

}  // namespace posefusion
