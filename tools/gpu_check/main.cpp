// Replays the recording of a packed folder on a Vulkan device: does it give what the CPU driver gave, and how fast?
#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "engine/core/error.hpp"
#include "engine/vulkan/device_info.hpp"
#include "tools/gpu_check/agreement.hpp"
#include "tools/gpu_check/speed.hpp"

using namespace posefusion;

namespace {

constexpr std::size_t kLargeFrames =
    30;  // of images larger than the recording's: the CPU driver takes seconds for each

struct Arguments {
    std::filesystem::path folder = ".";
    std::string device;
    std::vector<int> widths = {320, 640, 1280};
    std::vector<double> maps = {0.3, 1, 5};
    std::size_t frames = 0;
    bool write_expected = false;
};

/// Poses and maps of every size; true if all agree.
bool check_sizes(const Arguments& arguments, const PackedRecording& recording) {
    bool all = true;
    std::vector<std::string> titles;
    std::vector<FrameTimes> times;
    fmt::print("Agreement with the CPU driver\n");
    for (const int width : arguments.widths) {
        const PackedRecording sized = resized(recording, width);
        const std::string size = fmt::format("{}x{}", sized.camera.width, sized.camera.height);
        Slam slam(sized.camera, {}, arguments.device);
        const std::size_t all_frames = sized.frames.size();
        const bool large = width > recording.camera.width;
        const Replay found = replay(slam, sized, 0, large ? std::min(kLargeFrames, all_frames) : all_frames);
        const std::filesystem::path file = arguments.folder / ("expected-" + size + ".json");
        titles.push_back(size);
        times.push_back(found.times);
        if (arguments.write_expected) {
            write_expected(found, file);
            continue;
        }
        const AgreementLimits limits = AgreementLimits::for_width(width);
        const Agreement agreement = compare(found, read_expected(file), limits);
        all = all && agreement.within;
        fmt::print(
            "  {:<9} camera {:.4f} mm (at most {:.3f}), {:.5f} deg ({:.4f}); surfels {:+.2f} %, stable {:+.2f} % ({}); "
            "{} lost: {}\n",
            size, agreement.translation_mm, limits.translation_mm, agreement.rotation_deg, limits.rotation_deg,
            agreement.surfels_percent, agreement.stable_percent, limits.surfels_percent, found.lost,
            agreement.within ? "agrees" : "DIFFERS");
        std::fflush(stdout);
    }
    fmt::print("\nSpeed by image size\n{}", table_of(titles, times));
    std::fflush(stdout);
    return all;
}

void time_maps(const Arguments& arguments, const PackedRecording& recording) {
    constexpr double kMillion = 1e6;
    std::vector<std::uint32_t> surfels;
    for (const double millions : arguments.maps) surfels.push_back(static_cast<std::uint32_t>(millions * kMillion));
    std::vector<std::string> titles;
    std::vector<FrameTimes> times;
    for (const MapTimes& map : time_in_maps(recording, arguments.device, surfels)) {
        titles.push_back(fmt::format("{:.2f} M", map.surfels / kMillion));
        times.push_back(map.times);
    }
    fmt::print("\nSpeed by size of the map, {}x{}, the same in view (goal: 1 ms with 1 M surfels on a GPU)\n{}",
               recording.camera.width, recording.camera.height, table_of(titles, times));
}

int run(const Arguments& arguments) {
    const std::vector<DeviceInfo> devices = list_devices();
    if (devices.empty()) throw Error("no Vulkan device found; install the driver of the GPU");
    const DeviceInfo& device = devices[choose_device(devices, arguments.device).index];
    const PackedRecording recording = read_packed_recording(arguments.folder, arguments.frames);
    fmt::print("{} ({}), Vulkan {}, subgroups of {}, 64-bit atomics: {}\n{} frames\n\n", device.name, device.driver,
               device.api_version, device.subgroup_size, device.int64_atomics ? "yes" : "no", recording.frames.size());
    const bool agrees = check_sizes(arguments, recording);
    if (!arguments.maps.empty()) time_maps(arguments, recording);
    return agrees ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    CLI::App app("replays a packed recording on a Vulkan device: does it agree with the CPU driver, and how fast?");
    app.add_option("folder", arguments.folder, "folder that tools/gpu_check/pack made")->capture_default_str();
    app.add_option("--device", arguments.device, "part of the device's name, or its index (default: the best one)");
    app.add_option("--widths", arguments.widths, "of the images, pixels")->delimiter(',')->capture_default_str();
    app.add_option("--maps", arguments.maps, "sizes of maps, million surfels; 0: none")
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--frames", arguments.frames, "the first so many; 0 = all")->capture_default_str();
    app.add_flag("--write-expected", arguments.write_expected, "this device is the one to compare with");
    CLI11_PARSE(app, argc, argv);
    std::erase(arguments.maps, 0.0);
    try {
        return run(arguments);
    } catch (const Error& error) {
        fmt::print(stderr, "gpu_check: {}\n", error.what());
        return 1;
    }
}
