#include "engine/map/surfel_map.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/angle.hpp"
#include "engine/core/error.hpp"
#include "engine/vulkan/transfer.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr double kDeadShare = 0.25;  // of the slots; more are worth a compaction

std::string depth_test_shader(const Context& context, const std::string& name) {
    return context.int64_atomics() ? name + ".int64" : name;
}

std::uint32_t cell_count(const Intrinsics& camera, const MapConfig& config) {
    return pixels_at(camera, 0) * static_cast<std::uint32_t>(config.index_map_scale * config.index_map_scale);
}

}  // namespace

int cell_stride(const Context& context) { return context.int64_atomics() ? 2 : 1; }

void set_params(gpu::Params& params, const MapConfig& config) {
    params.speed_scale = MapConfig::kSpeedScale;
    params.association_depth = config.association_depth;
    params.association_sigmas = config.association_sigmas;
    params.association_cosine = std::cos(radians(MapConfig::kAssociationAngleDeg));
    params.stable_confidence = config.stable_confidence;
    params.predict_confidence = config.predict_confidence;
    params.max_weight = config.max_weight;
    params.unstable_timeout = static_cast<gpu::uint>(MapConfig::kUnstableTimeout);
    params.duplicate_spacing = config.duplicate_spacing;
    params.duplicate_age = static_cast<gpu::uint>(MapConfig::kDuplicateAge);
    params.duplicate_depth = MapConfig::kDuplicateDepth;
    params.duplicate_sigmas = MapConfig::kDuplicateSigmas;
    params.free_space_margin = config.free_space_margin;
    params.free_space_sigmas = MapConfig::kFreeSpaceSigmas;
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
      index_map_(context, depth_test_shader(context, "map/index_map"), {{"INDEX_SCALE", config.index_map_scale}}),
      associate_(context, "map/associate",
                 {{"CELL_STRIDE", cell_stride(context)}, {"INDEX_SCALE", config.index_map_scale}}),
      fuse_(context, "map/fuse"),
      find_duplicates_(context, "map/find_duplicates",
                       {{"CELL_STRIDE", cell_stride(context)}, {"INDEX_SCALE", config.index_map_scale}}),
      count_new_(context, "map/count_new"),
      count_live_(context, "map/count_live"),
      prefix_sum_(context, "map/prefix_sum"),
      append_(context, "map/append"),
      grow_(context, "map/grow"),
      compact_(context, "map/compact"),
      clean_(context, "map/clean"),
      splat_(context, depth_test_shader(context, "map/splat")),
      resolve_(context, "map/resolve", {{"CELL_STRIDE", cell_stride(context)}}) {
    if (pixels_at(camera, 0) > gpu::MAX_PIXELS) {
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
    enqueue_grow(clear);
    clear.finish();
    clear.run();
}

void SurfelMap::resize(std::uint32_t capacity) {
    auto grown = std::make_unique<SurfelStreams>(context_, capacity);
    auto offsets = device_buffer<std::uint32_t>(
        context_, ceil_div(std::max(capacity, pixels_at(camera_, 0)), gpu::CHUNK), "chunk offsets");
    if (slots_ > 0) {
        // live surfels keep their order, dead slots are dropped
        Sequence sequence(context_);
        const std::uint32_t chunks = ceil_div(slots_, gpu::CHUNK);
        sequence.dispatch(count_live_,
                          {{"counters", counters_},
                           {"position_confidence", streams_->position_confidence},
                           {"chunk_counts", offsets}},
                          count_live_.groups_for(chunks));
        sequence.dispatch(prefix_sum_, {{"counters", counters_}, {"chunk_counts", offsets}},
                          {{"counts_of", gpu::COUNTS_OF_SLOTS}, {"pixels", 0}}, 1);
        sequence.dispatch(compact_,
                          {{"chunk_offsets", offsets},
                           {"position_confidence", streams_->position_confidence},
                           {"normal_radius", streams_->normal_radius},
                           {"appearance", streams_->appearance},
                           {"new_position_confidence", grown->position_confidence},
                           {"new_normal_radius", grown->normal_radius},
                           {"new_appearance", grown->appearance}},
                          {{"slots", slots_}}, compact_.groups_for(chunks));
        enqueue_grow(sequence);
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
    // nearly full and few are dead: grow now rather than compact in every frame
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
    slots_ = alive_ = 0;  // nothing of the old map is copied
    // the same capacity where possible: it decides when dead slots are dropped
    resize(static_cast<std::uint32_t>(std::clamp<std::uint64_t>(state.capacity, 1, largest_capacity())));
    slots_ = state.slots;
    alive_ = state.alive;
    write(context_, state.position_confidence, streams_->position_confidence);
    write(context_, state.normal_radius, streams_->normal_radius);
    write(context_, state.appearance, streams_->appearance);
    write(context_, state.counters, counters_);
    Sequence sequence(context_);
    enqueue_grow(sequence);
    sequence.finish();
    sequence.run();
    write(context_, state.counters, counters_);  // grow_ has reset them
}

void SurfelMap::enqueue_grow(Sequence& sequence) const {
    sequence.dispatch(grow_, {{"counters", counters_}, {"arguments", arguments_}}, 1);
}

void SurfelMap::enqueue_depth_test(Sequence& sequence, const Kernel& kernel, std::uint32_t cells,
                                   NamedBuffers buffers) const {
    const bool wide = context_.int64_atomics();
    const std::size_t bytes = std::size_t{cells} * sizeof(std::uint32_t);
    sequence.fill(cells_, gpu::EMPTY_CELL, wide ? 2 * bytes : bytes);
    buffers.emplace_back(wide ? "cells" : "cell_keys", cells_);
    if (!wide) {
        sequence.fill(cell_indices_, gpu::EMPTY_CELL, bytes);
        buffers.emplace_back("cell_indices", cell_indices_);
    }
    for (const int pass : {0, 1}) {
        if (pass == 1 && wide) continue;
        sequence.dispatch_indirect(kernel, buffers, {{"pass", pass}}, arguments_, 0);
    }
}

void SurfelMap::enqueue_fusion(Sequence& sequence, const Buffer& params, const Buffer& record,
                               const Preprocessing& frame) const {
    const std::uint32_t n = pixels_at(camera_, 0), chunks = ceil_div(n, gpu::CHUNK);
    const auto& s = *streams_;

    sequence.stage("index map");
    enqueue_depth_test(sequence, index_map_, cell_count(camera_, config_),
                       {{"params", params},
                        {"record", record},
                        {"counters", counters_},
                        {"position_confidence", s.position_confidence},
                        {"appearance", s.appearance}});

    sequence.stage("associate");
    sequence.fill(owner_, gpu::NO_OWNER, owner_.bytes());
    sequence.dispatch(associate_,
                      {{"params", params},
                       {"record", record},
                       {"static_depth", frame.static_depth},
                       {"live_geometry", frame.live.geometry[0]},
                       {"cell_keys", cells_},
                       {"cell_indices", seen_surfels()},
                       {"normal_radius", s.normal_radius},
                       {"association", association_},
                       {"owner", owner_}},
                      associate_.groups_for(n));

    sequence.stage("fuse");
    sequence.dispatch(fuse_,
                      {{"params", params},
                       {"record", record},
                       {"static_depth", frame.static_depth},
                       {"live_geometry", frame.live.geometry[0]},
                       {"color", frame.color},
                       {"association", association_},
                       {"owner", owner_},
                       {"position_confidence", s.position_confidence},
                       {"normal_radius", s.normal_radius},
                       {"appearance", s.appearance}},
                      fuse_.groups_for(n));
    sequence.dispatch(find_duplicates_,
                      {{"params", params},
                       {"static_depth", frame.static_depth},
                       {"association", association_},
                       {"cell_indices", seen_surfels()},
                       {"position_confidence", s.position_confidence},
                       {"normal_radius", s.normal_radius},
                       {"appearance", s.appearance},
                       {"owner", owner_}},
                      find_duplicates_.groups_for(n));
    sequence.dispatch(count_new_, {{"params", params}, {"association", association_}, {"chunk_counts", chunk_offsets_}},
                      count_new_.groups_for(chunks));
    sequence.dispatch(prefix_sum_, {{"counters", counters_}, {"chunk_counts", chunk_offsets_}},
                      {{"counts_of", gpu::COUNTS_OF_PIXELS}, {"pixels", n}}, 1);
    sequence.dispatch(append_,
                      {{"params", params},
                       {"record", record},
                       {"static_depth", frame.static_depth},
                       {"live_geometry", frame.live.geometry[0]},
                       {"color", frame.color},
                       {"association", association_},
                       {"chunk_offsets", chunk_offsets_},
                       {"counters", counters_},
                       {"position_confidence", s.position_confidence},
                       {"normal_radius", s.normal_radius},
                       {"appearance", s.appearance}},
                      append_.groups_for(chunks));
    enqueue_grow(sequence);

    sequence.stage("clean");
    sequence.dispatch_indirect(clean_,
                               {{"params", params},
                                {"record", record},
                                {"static_depth", frame.static_depth},
                                {"depth", frame.depth},
                                {"color", frame.color},
                                {"mask", frame.mask},
                                {"counters", counters_},
                                {"position_confidence", s.position_confidence},
                                {"appearance", s.appearance},
                                {"owner", owner_}},
                               arguments_, 0);
}

void SurfelMap::enqueue_prediction(Sequence& sequence, const Buffer& params, const Buffer& record,
                                   const Preprocessing& frame, bool fill_in, const ImagePyramid& model,
                                   const Buffer& model_color) const {
    const std::uint32_t n = pixels_at(camera_, 0);
    const auto& s = *streams_;
    enqueue_depth_test(sequence, splat_, n,
                       {{"params", params},
                        {"record", record},
                        {"counters", counters_},
                        {"position_confidence", s.position_confidence},
                        {"normal_radius", s.normal_radius},
                        {"appearance", s.appearance}});
    sequence.dispatch(resolve_,
                      {{"params", params},
                       {"record", record},
                       {"cell_indices", seen_surfels()},
                       {"position_confidence", s.position_confidence},
                       {"normal_radius", s.normal_radius},
                       {"appearance", s.appearance},
                       {"live_geometry", frame.live.geometry[0]},
                       {"color", frame.color},
                       {"model_geometry", model.geometry[0]},
                       {"model_intensity", model.intensity[0]},
                       {"model_depth", model.depth[0]},
                       {"model_color", model_color}},
                      {{"fill_in", fill_in}}, resolve_.groups_for(n));
}

}  // namespace posefusion
