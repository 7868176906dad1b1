#pragma once
#include <memory>
#include <mutex>
#include <vector>

#include "engine/map/surfel_map.hpp"
#include "engine/preprocess/preprocessing.hpp"
#include "engine/vulkan/context.hpp"

/// For who draws with the engine's device (DeviceSharing): needs Vulkan's headers, knows no window.
namespace posefusion {

/// The map and the images of one frame, copied on the device, so that they can be drawn while the next frame changes
/// the originals. May be read by the device and host of any thread until the last owner lets go of it, which must be
/// after the device has finished with it; the memory is then used again.
struct MapSnapshot {
    std::shared_ptr<vulkan::Context> context;  ///< keeps the device
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

/// Holds snapshots: at most one that has not been taken yet, and those that can be filled again.
class SnapshotExchange : public std::enable_shared_from_this<SnapshotExchange> {
public:
    /// An unused one with room for `slots`.
    [[nodiscard]] std::shared_ptr<MapSnapshot> blank(const std::shared_ptr<vulkan::Context>& context,
                                                     const Intrinsics& camera, std::uint32_t slots);
    void offer(std::shared_ptr<MapSnapshot> snapshot);
    /// What was offered last and not taken; nullptr if there is none.
    [[nodiscard]] std::shared_ptr<const MapSnapshot> take();
    void clear() { offer(nullptr); }

private:
    std::mutex mutex_;
    std::shared_ptr<MapSnapshot> offered_;
    std::vector<std::unique_ptr<MapSnapshot>> unused_;
};

}  // namespace posefusion
