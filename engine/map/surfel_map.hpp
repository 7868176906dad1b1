#pragma once
#include <memory>

#include "engine/map/map_config.hpp"
#include "engine/map/map_state.hpp"
#include "engine/preprocess/preprocessing.hpp"

namespace posefusion {

/// Copies the map's configuration into the kernels' parameters.
void set_params(gpu::Params& params, const MapConfig& config);

/// CELL_STRIDE of the kernels that read SurfelMap::seen_surfels() (shaders/include/depth_test_read.glsl).
[[nodiscard]] int cell_stride(const vulkan::Context& context);

/// The three streams of the surfel pool (shaders/include/surfel.glsl).
struct SurfelStreams {
    vulkan::Buffer position_confidence, normal_radius, appearance;
    SurfelStreams(vulkan::Context& context, std::uint32_t capacity);
    /// Copies the first `slots` surfels into `to`.
    void enqueue_copy(vulkan::Sequence& sequence, const SurfelStreams& to, std::uint32_t slots) const;
};

/// The map: a growing pool of surfels on the device, the kernels that fuse a frame into it, clean it, and predict
/// what a camera sees of it.
class SurfelMap {
public:
    SurfelMap(vulkan::Context& context, const Intrinsics& camera, const MapConfig& config);

    /// Associates, fuses, appends and cleans. @param record  tracking record with the camera pose
    void enqueue_fusion(vulkan::Sequence& sequence, const vulkan::Buffer& params, const vulkan::Buffer& record,
                        const Preprocessing& frame) const;
    /// Renders the map into the level-0 buffers of `model`. @param fill_in  the live frame fills pixels without a
    /// surfel
    void enqueue_prediction(vulkan::Sequence& sequence, const vulkan::Buffer& params, const vulkan::Buffer& record,
                            const Preprocessing& frame, bool fill_in, const ImagePyramid& model,
                            const vulkan::Buffer& model_color) const;

    /// Makes room for the next frame before it runs: compacts when many slots are dead, grows when full. Returns true
    /// if the buffers have changed, so that commands which use them must be recorded again. Throws Error at
    /// max_capacity.
    bool make_room();
    /// Takes over the device's counters after a frame.
    void update(std::uint32_t slots, std::uint32_t alive) { slots_ = slots, alive_ = alive; }

    /// All slots, dead ones too, byte by byte. Waits for the device.
    [[nodiscard]] MapState state() const;
    /// The state of an empty map with the capacity of this one.
    [[nodiscard]] MapState empty_state() const;
    /// Throws Error if the state is inconsistent or larger than allowed.
    void check(const MapState& state) const;
    /// Replaces the map; the buffers change. The state must have passed check().
    void restore(const MapState& state);

    [[nodiscard]] const MapConfig& config() const { return config_; }
    [[nodiscard]] std::uint32_t slots() const { return slots_; }
    /// Slots that there can be at most: as many as allowed, and as the device's memory holds.
    [[nodiscard]] std::uint64_t largest_capacity() const;
    [[nodiscard]] const SurfelStreams& streams() const { return *streams_; }
    [[nodiscard]] const vulkan::Buffer& counters() const { return counters_; }
    /// gpu::DispatchArguments of kernels that visit every slot.
    [[nodiscard]] const vulkan::Buffer& surfel_groups() const { return arguments_; }
    /// Which surfel each cell of the last depth test shows (each pixel of a prediction), as
    /// shaders/include/depth_test_read.glsl reads it.
    [[nodiscard]] const vulkan::Buffer& seen_surfels() const {
        return context_.int64_atomics() ? cells_ : cell_indices_;
    }

private:
    void resize(std::uint32_t capacity);
    /// Counts the appended surfels and sets the dispatch arguments of the kernels that visit every slot.
    void enqueue_grow(vulkan::Sequence& sequence) const;
    /// @param buffers  of the kernel, without the cells
    void enqueue_depth_test(vulkan::Sequence& sequence, const vulkan::Kernel& kernel, std::uint32_t cells,
                            vulkan::NamedBuffers buffers) const;

    vulkan::Context& context_;
    Intrinsics camera_;
    MapConfig config_;
    std::uint32_t capacity_ = 0, slots_ = 0, alive_ = 0;
    std::unique_ptr<SurfelStreams> streams_;
    vulkan::Buffer counters_;              ///< gpu::MapRecord
    vulkan::Buffer cells_, cell_indices_;  ///< depth test: 64-bit keys, or depths and indices apart
    vulkan::Buffer association_, owner_, chunk_offsets_, arguments_;
    vulkan::Kernel index_map_, associate_, fuse_, find_duplicates_, count_new_, count_live_, prefix_sum_, append_,
        grow_, compact_, clean_, splat_, resolve_;
};

}  // namespace posefusion
