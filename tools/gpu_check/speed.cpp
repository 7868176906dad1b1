#include "tools/gpu_check/speed.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "engine/slam/slam_state.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

namespace {

constexpr float kNextRoom = 200;  // metres: beyond every depth that is measured

template <class Record>
std::vector<Record> records_of(const ByteArray& bytes) {
    std::vector<Record> records(bytes.size() / sizeof(Record));
    std::memcpy(records.data(), bytes.data(), records.size() * sizeof(Record));
    return records;
}

template <class Record>
ByteArray bytes_of(const std::vector<Record>& records) {
    ByteArray bytes(records.size() * sizeof(Record));
    std::memcpy(bytes.data(), records.data(), bytes.size());
    return bytes;
}

MapState enlarged(const MapState& map, std::uint32_t surfels, float stable_confidence) {
    auto positions = records_of<gpu::vec4>(map.position_confidence);
    auto normals = records_of<gpu::vec4>(map.normal_radius);
    auto appearances = records_of<gpu::uvec4>(map.appearance);
    const std::size_t scene = positions.size();
    const bool any = std::any_of(positions.begin(), positions.end(),
                                 [&](const gpu::vec4& position) { return position.w >= stable_confidence; });
    MapState result = map;
    for (int room = 1; any && result.alive < surfels; ++room) {
        for (std::size_t i = 0; i < scene && result.alive < surfels; ++i) {
            if (positions[i].w < stable_confidence) continue;
            gpu::vec4 position = positions[i];
            position.x += kNextRoom * static_cast<float>(room);
            positions.push_back(position);
            normals.push_back(gpu::vec4(normals[i]));
            appearances.push_back(gpu::uvec4(appearances[i]));
            ++result.alive;
        }
    }
    result.slots = static_cast<std::uint32_t>(positions.size());
    result.capacity = std::max(map.capacity, result.slots);
    gpu::MapRecord counters{};
    std::memcpy(&counters, map.counters.data(), sizeof(counters));
    counters.count = result.slots;
    counters.alive = result.alive;
    std::memcpy(result.counters.data(), &counters, sizeof(counters));
    result.position_confidence = bytes_of(positions);
    result.normal_radius = bytes_of(normals);
    result.appearance = bytes_of(appearances);
    return result;
}

}  // namespace

std::vector<MapTimes> time_in_maps(const PackedRecording& recording, const std::string& device,
                                   const std::vector<std::uint32_t>& surfels) {
    SlamConfig config;
    const auto pixels = static_cast<std::uint32_t>(recording.camera.width * recording.camera.height);
    const std::uint32_t largest = surfels.empty() ? 0 : *std::max_element(surfels.begin(), surfels.end());
    config.map.max_capacity = std::max(config.map.max_capacity, largest + 4 * pixels);
    Slam slam(recording.camera, config, device);
    const std::size_t half = recording.frames.size() / 2;
    (void)replay(slam, recording, 0, half);
    const SlamState start = slam.state();
    std::vector<MapTimes> result;
    for (const std::uint32_t size : surfels) {
        SlamState state = start;
        state.map = enlarged(start.map, size, config.map.stable_confidence);
        slam.restore(state);
        const Replay timed = replay(slam, recording, half, recording.frames.size());
        result.push_back({timed.surfels, timed.times});
    }
    return result;
}

std::string table_of(const std::vector<std::string>& titles, const std::vector<FrameTimes>& times) {
    std::vector<std::string> stages;
    for (const FrameTimes& column : times) {
        for (const auto& [name, milliseconds] : column.stages) {
            if (std::find(stages.begin(), stages.end(), name) == stages.end()) stages.push_back(name);
        }
    }
    std::string text = fmt::format("  {:<24}", "ms per frame, medians");
    for (const std::string& title : titles) text += fmt::format("{:>12}", title);
    const auto line = [&](const std::string& name, auto&& of_column) {
        text += fmt::format("\n  {:<24}", name);
        for (const FrameTimes& column : times) text += fmt::format("{:>12.3f}", of_column(column));
    };
    line("images in to pose out", [](const FrameTimes& column) { return column.host; });
    line("GPU, all stages", [](const FrameTimes& column) { return column.gpu; });
    for (const std::string& stage : stages) {
        line("  " + stage, [&](const FrameTimes& column) {
            const auto found = std::find_if(column.stages.begin(), column.stages.end(),
                                            [&](const auto& entry) { return entry.first == stage; });
            return found == column.stages.end() ? 0.0 : found->second;
        });
    }
    return text + "\n";
}

}  // namespace posefusion
