#include "engine/map/surfel_map.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/angle.hpp"
#include "engine/core/error.hpp"
#include "engine/vulkan/transfer.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr std::uint32_t kChunk = 16;              // shaders/include/chunks.glsl
constexpr std::uint32_t kSurfelsPerGroup = 1024;  // kernels that run once per surfel
constexpr std::uint32_t kEmptyCell = 0xffffffffu;
constexpr double kDeadShare = 0.25;             // of the slots; more are worth a compaction
constexpr std::uint32_t kMaxPixels = 1u << 22;  // shaders/include/association.glsl

struct PassPush {
    std::uint32_t pass;
};
struct PrefixPush {
    std::uint32_t mode, pixels;
};
struct GrowPush {
    std::uint32_t surfels_per_group;
};
struct CompactPush {
    std::uint32_t slots;
};
struct FillInPush {
    std::uint32_t fill_in;
};

std::string depth_test_shader(const Context& context, const std::string& name) {
    return context.int64_atomics() ? name + ".int64" : name;
}

std::uint32_t cell_count(const Intrinsics& camera, const MapConfig& config) {
    return pixels_at(camera, 0) * static_cast<std::uint32_t>(config.index_map_scale * config.index_map_scale);
}

}  // namespace

void set_params(gpu::Params& params, const MapConfig& config) {
    params.speed_scale = config.speed_scale;
    params.association_depth = config.association_depth;
    params.association_sigmas = config.association_sigmas;
    params.association_cosine = std::cos(radians(MapConfig::kAssociationAngleDeg));
    params.stable_confidence = config.stable_confidence;
    params.predict_confidence = config.predict_confidence;
    params.max_weight = config.max_weight;
    params.unstable_timeout = static_cast<gpu::uint>(config.unstable_timeout);
    params.duplicate_spacing = config.duplicate_spacing;
    params.duplicate_age = static_cast<gpu::uint>(config.duplicate_age);
    params.duplicate_depth = config.duplicate_depth;
    params.duplicate_sigmas = config.duplicate_sigmas;
    params.free_space_margin = config.free_space_margin;
    params.free_space_sigmas = config.free_space_sigmas;
    params.free_space_decay = config.free_space_decay;
}

SurfelStreams::SurfelStreams(Context& context, std::uint32_t capacity)
    : position_confidence(device_buffer<gpu::vec4>(context, capacity, "surfel positions")),
      normal_radius(device_buffer<gpu::vec4>(context, capacity, "surfel normals")),
      appearance(device_buffer<gpu::uvec4>(context, capacity, "surfel appearances")) {}

void SurfelStreams::enqueue_copy(Sequence& sequence, const SurfelStreams& to, std::uint32_t slots) const {
    if (slots == 0) return;
    const std::size_t bytes = std::size_t{slots} * kSurfelStreamBytes;
    sequence.copy(position_confidence, to.position_confidence, bytes);
    sequence.copy(normal_radius, to.normal_radius, bytes);
    sequence.copy(appearance, to.appearance, bytes);
}

SurfelMap::SurfelMap(Context& context, const Intrinsics& camera, const MapConfig& config)
    : context_(context),
      camera_(camera),
      config_(config),
      counters_(device_buffer<gpu::MapRecord>(context, 1, "map counters")),
      cells_(device_buffer<std::uint32_t>(context, cell_count(camera, config) * (context.int64_atomics() ? 2 : 1),
                                          "depth test cells")),
      cell_indices_(context.int64_atomics()
                        ? Buffer()
                        : device_buffer<std::uint32_t>(context, cell_count(camera, config), "depth test indices")),
      association_(device_buffer<std::uint32_t>(context, pixels_at(camera, 0), "association")),
      arguments_(device_buffer<gpu::DispatchArguments>(context, 1, "map dispatch arguments")),
      index_map_(context, depth_test_shader(context, "map/index_map"), context.int64_atomics() ? 6 : 7,
                 sizeof(PassPush), {static_cast<std::uint32_t>(config.index_map_scale)}),
      associate_(context, "map/associate", 9, 0,
                 {context.int64_atomics() ? 2u : 1u, static_cast<std::uint32_t>(config.index_map_scale)}),
      fuse_(context, "map/fuse", 10),
      find_duplicates_(context, "map/find_duplicates",
                       {{"CELL_STRIDE", context.int64_atomics() ? 2 : 1}, {"INDEX_SCALE", config.index_map_scale}}),
      count_new_(context, "map/count_new", 3),
      count_live_(context, "map/count_live", 3),
      prefix_sum_(context, "map/prefix_sum", 2, sizeof(PrefixPush)),
      append_(context, "map/append", 11),
      grow_(context, "map/grow", 2, sizeof(GrowPush)),
      compact_(context, "map/compact", 7, sizeof(CompactPush)),
      clean_(context, "map/clean", 9),
      splat_(context, depth_test_shader(context, "map/splat"), context.int64_atomics() ? 7 : 8, sizeof(PassPush)),
      resolve_(context, "map/resolve", 14, sizeof(FillInPush), {context.int64_atomics() ? 2u : 1u}) {
    if (pixels_at(camera, 0) > kMaxPixels) {
        throw Error("images of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                    " are too large, at most 4 million pixels are possible; use --scale 0.5");
    }
    const std::uint64_t holds = context.max_buffer_bytes() / sizeof(gpu::vec4);
    if (config.initial_capacity > holds) {
        throw Error("map.initial_capacity is " + std::to_string(config.initial_capacity) +
                    " surfels, more than the device's memory can hold (" + std::to_string(holds) + "); lower it");
    }
    resize(static_cast<std::uint32_t>(
        std::min<std::uint64_t>(std::max(config.initial_capacity, 2 * pixels_at(camera, 0)), largest_capacity())));
    Sequence clear(context);
    clear.fill(counters_, 0, sizeof(gpu::MapRecord));
    clear.dispatch(grow_, {inout(counters_), out(arguments_)}, GrowPush{kSurfelsPerGroup}, 1);
    clear.finish();
    clear.run();
}

void SurfelMap::resize(std::uint32_t capacity) {
    auto grown = std::make_unique<SurfelStreams>(context_, capacity);
    auto offsets =
        device_buffer<std::uint32_t>(context_, std::max(capacity, pixels_at(camera_, 0)) / kChunk + 1, "chunk offsets");
    if (slots_ > 0) {
        // live surfels keep their order, dead slots fall away
        Sequence sequence(context_);
        const auto groups = Groups::covering(Groups::covering(slots_, kChunk).x, 64);
        sequence.dispatch(count_live_, {in(counters_), in(streams_->position_confidence), out(offsets)}, groups);
        sequence.dispatch(prefix_sum_, {inout(counters_), inout(offsets)}, PrefixPush{1, 0}, 1);
        sequence.dispatch(
            compact_,
            {in(offsets), in(streams_->position_confidence), in(streams_->normal_radius), in(streams_->appearance),
             out(grown->position_confidence), out(grown->normal_radius), out(grown->appearance)},
            CompactPush{slots_}, groups);
        sequence.dispatch(grow_, {inout(counters_), out(arguments_)}, GrowPush{kSurfelsPerGroup}, 1);
        sequence.finish();
        sequence.run();
        slots_ = alive_;
    }
    streams_ = std::move(grown);
    chunk_offsets_ = std::move(offsets);
    owner_ = device_buffer<std::uint32_t>(context_, capacity, "owner");
    capacity_ = capacity;
}

std::uint64_t SurfelMap::largest_capacity() const {
    return std::min<std::uint64_t>(config_.max_capacity, context_.max_buffer_bytes() / sizeof(gpu::vec4));
}

bool SurfelMap::make_room() {
    const std::uint64_t frame = pixels_at(camera_, 0);  // a frame appends at most one surfel per pixel
    const bool full = slots_ + frame > capacity_;
    const bool sparse = slots_ - alive_ > kDeadShare * slots_ && slots_ > frame;
    if (!full && !sparse) return false;
    const std::uint64_t largest = largest_capacity();
    if (alive_ + frame > largest) {
        throw Error("the map is full: " + std::to_string(alive_) + " surfels, at most " + std::to_string(largest) +
                    " are allowed; raise map.max_capacity or use --scale 0.5");
    }
    std::uint64_t capacity = capacity_;
    while (alive_ + frame > capacity) capacity = std::min(largest, 2 * capacity);
    // nearly full with few dead: grow now rather than compact every frame
    if (alive_ + 2 * frame > capacity) capacity = std::min(largest, 2 * capacity);
    resize(static_cast<std::uint32_t>(capacity));
    return true;
}

MapState SurfelMap::state() const {
    const std::size_t bytes = std::size_t{slots_} * kSurfelStreamBytes;
    MapState state;
    state.capacity = capacity_;
    state.slots = slots_;
    state.alive = alive_;
    state.counters = read_back(context_, counters_, sizeof(gpu::MapRecord));
    state.position_confidence = read_back(context_, streams_->position_confidence, bytes);
    state.normal_radius = read_back(context_, streams_->normal_radius, bytes);
    state.appearance = read_back(context_, streams_->appearance, bytes);
    return state;
}

MapState SurfelMap::empty_state() const {
    MapState state;
    state.capacity = capacity_;
    state.counters.resize(sizeof(gpu::MapRecord));
    return state;
}

void SurfelMap::check(const MapState& state) const {
    static_assert(sizeof(gpu::vec4) == kSurfelStreamBytes);
    const std::size_t bytes = std::size_t{state.slots} * kSurfelStreamBytes;
    gpu::MapRecord counters{};
    if (state.counters.size() == sizeof(counters))
        std::copy_n(state.counters.data(), sizeof(counters), reinterpret_cast<std::byte*>(&counters));
    const bool whole = state.counters.size() == sizeof(counters) && state.position_confidence.size() == bytes &&
                       state.normal_radius.size() == bytes && state.appearance.size() == bytes;
    if (!whole || counters.count != state.slots || counters.appended != 0 || state.alive > state.slots ||
        state.capacity < state.slots) {
        throw Error("the map to be restored contradicts itself; use another file");
    }
    if (state.slots > largest_capacity()) {
        throw Error("the map to be restored has " + std::to_string(state.slots) + " surfels, at most " +
                    std::to_string(largest_capacity()) + " are allowed; raise map.max_capacity");
    }
}

void SurfelMap::restore(const MapState& state) {
    slots_ = alive_ = 0;  // nothing of the old map is taken along
    // the same capacity where possible: it decides when dead slots are dropped
    resize(static_cast<std::uint32_t>(std::clamp<std::uint64_t>(state.capacity, 1, largest_capacity())));
    slots_ = state.slots;
    alive_ = state.alive;
    write(context_, state.position_confidence, streams_->position_confidence);
    write(context_, state.normal_radius, streams_->normal_radius);
    write(context_, state.appearance, streams_->appearance);
    write(context_, state.counters, counters_);
    Sequence sequence(context_);
    sequence.dispatch(grow_, {inout(counters_), out(arguments_)}, GrowPush{kSurfelsPerGroup}, 1);
    sequence.finish();
    sequence.run();
    write(context_, state.counters, counters_);  // grow_ has begun to count anew
}

void SurfelMap::enqueue_depth_test(Sequence& sequence, const Kernel& kernel, std::uint32_t cells,
                                   std::initializer_list<Access> inputs) const {
    const bool wide = context_.int64_atomics();
    sequence.fill(cells_, kEmptyCell, std::size_t{cells} * (wide ? 8 : 4));
    std::vector<Access> buffers(inputs);
    buffers.push_back(inout(cells_));
    if (!wide) {
        sequence.fill(cell_indices_, kEmptyCell, std::size_t{cells} * 4);
        buffers.push_back(inout(cell_indices_));
    }
    for (std::uint32_t pass = 0; pass < (wide ? 1u : 2u); ++pass) {
        sequence.dispatch_indirect(kernel, buffers, PassPush{pass}, arguments_, 0);
    }
}

void SurfelMap::enqueue_fusion(Sequence& sequence, const Buffer& params, const Buffer& record,
                               const Preprocessing& frame) const {
    const Buffer& indices = context_.int64_atomics() ? cells_ : cell_indices_;
    const std::uint32_t n = pixels_at(camera_, 0);
    const auto pixel_groups = Groups::covering(n, 64);
    const auto chunk_groups = Groups::covering(Groups::covering(n, kChunk).x, 64);
    const auto& s = *streams_;

    sequence.stage("index map");
    enqueue_depth_test(sequence, index_map_, cell_count(camera_, config_),
                       {in(params), in(record), in(counters_), in(s.position_confidence), in(s.appearance)});

    sequence.stage("associate");
    sequence.fill(owner_, 0xffffffffu, owner_.bytes());
    sequence.dispatch(associate_,
                      {in(params), in(record), in(frame.static_depth), in(frame.live.geometry[0]), in(cells_),
                       in(indices), in(s.normal_radius), out(association_), inout(owner_)},
                      pixel_groups);

    sequence.stage("fuse");
    sequence.dispatch(
        fuse_,
        {in(params), in(record), in(frame.static_depth), in(frame.live.geometry[0]), in(frame.color), in(association_),
         in(owner_), inout(s.position_confidence), inout(s.normal_radius), inout(s.appearance)},
        pixel_groups);
    sequence.dispatch(find_duplicates_,
                      {{"params", params},
                       {"static_depth", frame.static_depth},
                       {"association", association_},
                       {"cell_indices", indices},
                       {"position_confidence", s.position_confidence},
                       {"normal_radius", s.normal_radius},
                       {"appearance", s.appearance},
                       {"owner", owner_}},
                      find_duplicates_.groups_for(n));
    sequence.dispatch(count_new_, {in(params), in(association_), out(chunk_offsets_)}, chunk_groups);
    sequence.dispatch(prefix_sum_, {inout(counters_), inout(chunk_offsets_)}, PrefixPush{0, n}, 1);
    sequence.dispatch(
        append_,
        {in(params), in(record), in(frame.static_depth), in(frame.live.geometry[0]), in(frame.color), in(association_),
         in(chunk_offsets_), in(counters_), inout(s.position_confidence), inout(s.normal_radius), inout(s.appearance)},
        chunk_groups);
    sequence.dispatch(grow_, {inout(counters_), out(arguments_)}, GrowPush{kSurfelsPerGroup}, 1);

    sequence.stage("clean");
    sequence.dispatch_indirect(clean_,
                               {in(params), in(record), in(frame.static_depth), in(frame.depth), in(frame.dilated_mask),
                                inout(counters_), inout(s.position_confidence), in(s.appearance), in(owner_)},
                               arguments_, 0);
}

void SurfelMap::enqueue_prediction(Sequence& sequence, const Buffer& params, const Buffer& record,
                                   const Preprocessing& frame, bool fill_in, const ImagePyramid& model,
                                   const Buffer& model_color) const {
    const Buffer& indices = context_.int64_atomics() ? cells_ : cell_indices_;
    const std::uint32_t n = pixels_at(camera_, 0);
    const auto& s = *streams_;
    enqueue_depth_test(
        sequence, splat_, n,
        {in(params), in(record), in(counters_), in(s.position_confidence), in(s.normal_radius), in(s.appearance)});
    sequence.dispatch(resolve_,
                      {in(params), in(record), in(indices), in(s.position_confidence), in(s.normal_radius),
                       in(s.appearance), in(frame.live.geometry[0]), in(frame.live.intensity[0]), in(frame.color),
                       out(model.geometry[0]), out(model.intensity[0]), out(model.depth[0]), out(model_color)},
                      FillInPush{fill_in}, Groups::covering(n, 64));
}

}  // namespace posefusion
