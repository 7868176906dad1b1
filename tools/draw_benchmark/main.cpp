// How long the viewer takes to draw a map of this many surfels: draw_benchmark [SURFELS [WIDTH HEIGHT [FRAMES]]]
// The map is the inside of a room, seen from where the viewer looks at the start, all of it in front of the camera.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/median.hpp"
#include "engine/slam/map_snapshot.hpp"
#include "engine/vulkan/sequence.hpp"
#include "engine/vulkan/shared_types.hpp"
#include "hosts/viewer/frame_drawer.hpp"
#include "hosts/viewer/gui.hpp"
#include "hosts/viewer/scene_renderer.hpp"
#include "hosts/viewer/view_camera.hpp"
#include "hosts/viewer/window.hpp"

namespace {

using namespace posefusion;
using namespace posefusion::vulkan;

constexpr float kRoom = 5, kHeight = 2.6f, kNearWall = -1;  // metres
constexpr float kOverlap = 1.5f;                            // radius of a disc, in spacings of a square grid
constexpr std::uint32_t kStableWeight = 100;                // frames a surfel has been seen

struct Streams {
    std::vector<gpu::vec4> positions, normals;
    std::vector<std::array<std::uint32_t, 4>> looks;
};

/// A wall of a regular grid of surfels. @param across, along  its sides;  @param normal  into the room
void add_wall(Streams& room, std::size_t surfels, const Eigen::Vector3f& corner, const Eigen::Vector3f& across,
              const Eigen::Vector3f& along, const Eigen::Vector3f& normal) {
    const float spacing = std::sqrt(across.norm() * along.norm() / static_cast<float>(surfels));
    const auto columns = static_cast<std::size_t>(across.norm() / spacing),
               rows = surfels / std::max<std::size_t>(1, columns);
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < columns; ++column) {
            const float a = static_cast<float>(column) / static_cast<float>(columns);
            const float b = static_cast<float>(row) / static_cast<float>(rows);
            const Eigen::Vector3f p = corner + a * across + b * along;
            room.positions.push_back({p.x(), p.y(), p.z(), static_cast<float>(kStableWeight)});
            room.normals.push_back({normal.x(), normal.y(), normal.z(), kOverlap * spacing / 2});
            const auto red = static_cast<std::uint32_t>(65535 * a), green = static_cast<std::uint32_t>(65535 * b);
            room.looks.push_back({red | green << 16, 32768, 0, kStableWeight});
        }
    }
}

Streams make_room(std::size_t surfels) {
    Streams room;
    const Eigen::Vector3f x{kRoom, 0, 0}, y{0, kHeight, 0}, z{0, 0, kRoom};
    const Eigen::Vector3f corner{-kRoom / 2, -kHeight / 2, kNearWall};
    const float area = 2 * kRoom * kHeight + kRoom * kRoom;
    const auto share = [&](float part) { return static_cast<std::size_t>(static_cast<float>(surfels) * part / area); };
    add_wall(room, share(kRoom * kHeight), corner + z, x, y, -Eigen::Vector3f::UnitZ());
    add_wall(room, share(kRoom * kHeight), corner + x, z, y, -Eigen::Vector3f::UnitX());
    add_wall(room, share(kRoom * kRoom), corner + y, x, z, -Eigen::Vector3f::UnitY());
    return room;
}

template <class T>
void upload(Context& context, const std::vector<T>& values, const Buffer& to) {
    const Buffer from = host_buffer<T>(context, values.size(), "upload");
    std::copy(values.begin(), values.end(), from.host<T>().begin());
    Sequence sequence(context);
    sequence.copy(from, to, values.size() * sizeof(T));
    sequence.finish();
    sequence.run();
}

void measure(std::size_t surfels, WindowSize size, int frames) {
    Window window("PoseFusion: how fast it draws", size);
    ContextOptions options;
    options.sharing = {window.instance_extensions(), {VK_KHR_SWAPCHAIN_EXTENSION_NAME}, true};
    const auto context = std::make_shared<Context>(options);
    FrameDrawer drawer(*context, window);
    const Gui gui(*context, window, drawer.pass(), drawer.images());  // for the window's events
    SceneRenderer scene(*context, drawer.pass());

    const Streams room = make_room(surfels);
    const Intrinsics camera{.fx = 525, .fy = 525, .cx = 319.5f, .cy = 239.5f, .width = 640, .height = 480};
    const auto slots = static_cast<std::uint32_t>(room.positions.size());
    const auto snapshot = std::make_shared<MapSnapshot>(context, camera, slots);
    snapshot->slots = slots;
    snapshot->frame = kStableWeight;
    upload(*context, room.positions, snapshot->surfels.position_confidence);
    upload(*context, room.normals, snapshot->surfels.normal_radius);
    upload(*context, room.looks, snapshot->surfels.appearance);
    scene.set_snapshot(snapshot);

    SceneView view;
    view.T_camera_world = ViewCamera().T_camera_world(glm::mat4(1));
    view.size = {size.width, size.height};
    view.stable_confidence = 10;
    std::vector<double> device, whole;
    for (int i = 0; i < frames + 1; ++i) {  // the first compiles the shaders
        window.events(0);
        const auto begin = std::chrono::steady_clock::now();
        while (!drawer.draw(window.size(), [&](VkCommandBuffer commands) { scene.enqueue(commands, view, {}); }))
            window.events(0.01);
        drawer.wait();
        if (i == 0) continue;
        device.push_back(drawer.device_ms());
        whole.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    }
    fmt::print(
        "{} surfels at {} x {} on {}: {:.1f} ms per drawn frame, of that {:.1f} ms on the device (medians of {})\n",
        slots, size.width, size.height, context->info().name, upper_median(whole), upper_median(device), frames);
}

std::size_t argument(int argc, char** argv, int i, std::size_t otherwise) {
    return i < argc ? std::strtoul(argv[i], nullptr, 10) : otherwise;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        const auto width = static_cast<int>(argument(argc, argv, 2, 1280));
        const auto height = static_cast<int>(argument(argc, argv, 3, 720));
        measure(std::max<std::size_t>(argument(argc, argv, 1, 1'000'000), 100), {width, height},
                std::max(1, static_cast<int>(argument(argc, argv, 4, 10))));
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "draw_benchmark: {}\n", error.what());
        return 1;
    }
}
