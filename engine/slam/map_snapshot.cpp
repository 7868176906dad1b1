#include "engine/slam/map_snapshot.hpp"

#include <utility>

#include "engine/map/map_reader.hpp"
#include "engine/slam/snapshot_surfels.hpp"

namespace posefusion {

using namespace vulkan;

MapSnapshot::MapSnapshot(std::shared_ptr<Context> shared, const Intrinsics& intrinsics, std::uint32_t surfel_capacity)
    : context(std::move(shared)),
      camera(intrinsics),
      surfels(*context, surfel_capacity),
      color(device_buffer<std::uint32_t>(*context, pixels_at(camera, 0), "snapshot colour")),
      depth(device_buffer<float>(*context, pixels_at(camera, 0), "snapshot depth")),
      model_color(device_buffer<std::uint32_t>(*context, pixels_at(camera, 0), "snapshot model colour")),
      model_depth(device_buffer<float>(*context, pixels_at(camera, 0), "snapshot model depth")),
      capacity(surfel_capacity) {}

void MapSnapshot::copy_from(const SurfelMap& map, const Preprocessing& images, const Buffer& predicted_depth,
                            const Buffer& predicted_color, std::uint32_t frame_number) {
    slots = map.slots();
    frame = frame_number;
    Sequence sequence(*context);
    map.streams().enqueue_copy(sequence, surfels, slots);
    sequence.copy(images.color, color, color.bytes());
    sequence.copy(images.static_depth, depth, depth.bytes());
    sequence.copy(predicted_color, model_color, model_color.bytes());
    sequence.copy(predicted_depth, model_depth, model_depth.bytes());
    sequence.finish();
    sequence.run();
}

std::shared_ptr<MapSnapshot> SnapshotExchange::blank(const std::shared_ptr<Context>& context, const Intrinsics& camera,
                                                     std::uint32_t slots) {
    std::unique_ptr<MapSnapshot> snapshot;
    {
        const std::lock_guard lock(mutex_);
        // drop those that have become too small for the map
        std::erase_if(unused_,
                      [&](const auto& unused) { return unused->capacity < slots || unused->context != context; });
        if (!unused_.empty()) {
            snapshot = std::move(unused_.back());
            unused_.pop_back();
        }
    }
    if (!snapshot) {
        const std::uint32_t room =
            slots + slots / 4 + pixels_at(camera, 0);  // with reserve, so that it suffices for a while
        snapshot = std::make_unique<MapSnapshot>(context, camera, room);
    }
    const auto give_back = [exchange = weak_from_this()](MapSnapshot* used) {
        std::unique_ptr<MapSnapshot> owned(used);
        if (const auto home = exchange.lock()) {
            const std::lock_guard lock(home->mutex_);
            home->unused_.push_back(std::move(owned));
        }
    };
    return {snapshot.release(), give_back};
}

void SnapshotExchange::offer(std::shared_ptr<MapSnapshot> snapshot) {
    {
        const std::lock_guard lock(mutex_);
        std::swap(offered_, snapshot);
    }
    // the previous one is released outside of the lock, which its deleter takes
}

std::shared_ptr<const MapSnapshot> SnapshotExchange::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(offered_, nullptr);
}

std::vector<Surfel> read_surfels(const MapSnapshot& snapshot, float min_confidence) {
    constexpr std::uint32_t kSlice = 65'536;  // 3 MB: well below a millisecond even on a processor
    return read_surfels(*snapshot.context, snapshot.surfels, snapshot.slots, min_confidence, kSlice);
}

}  // namespace posefusion
