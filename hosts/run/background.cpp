#include "hosts/run/background.hpp"

#include <algorithm>
#include <vector>

#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/recorders/recorder.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr std::uint8_t kHole = 255;

/// Depth that a 16 bit image has no room for is a hole, too.
LabelImage holes_of(const RawDepth& depth) {
    LabelImage holes(depth.width(), depth.height());
    std::transform(depth.begin(), depth.end(), holes.begin(), [](std::uint16_t z) { return z == 0 ? kHole : 0; });
    return holes;
}

void blacken(ColorImage& color, const LabelImage& holes) {
    for (std::size_t i = 0; i < holes.size(); ++i)
        if (holes[i] == kHole) color[i] = {};
}

}  // namespace

void write_background(const fs::path& folder, const Slam& slam, const Trajectory& trajectory,
                      const std::function<void(std::size_t)>& progress) {
    if (trajectory.empty()) return;
    const Camera camera{.intrinsics = slam.camera(), .depth_scale = kFloatDepthScale};
    const auto recorder = make_tum_recorder(folder, camera);
    prepare_output_folder(folder / "holes");
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
        ModelView view = slam.render(trajectory[i].T_world_camera);
        RawFrame frame;
        frame.stamp = trajectory[i].stamp;
        frame.depth = quantised(view.depth, 1);
        frame.color = std::move(view.color);
        const LabelImage holes = holes_of(frame.depth);
        blacken(frame.color, holes);
        write_labels(folder / "holes" / (seconds_text(frame.stamp) + ".png"), holes);
        recorder->add(frame);
        progress(i + 1);
    }
    recorder->finish(trajectory);
}

void remove_background(const fs::path& folder) {
    std::error_code ignored;
    for (const char* part : {"rgb", "depth", "holes"}) {
        std::vector<fs::path> images;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder / part, ignored))
            if (entry.path().extension() == ".png") images.push_back(entry.path());
        for (const fs::path& image : images) fs::remove(image, ignored);
        fs::remove(folder / part, ignored);  // if it is empty
    }
    for (const char* file : {"rgb.txt", "depth.txt", "associations.txt", "camera.yaml", "groundtruth.txt"})
        fs::remove(folder / file, ignored);
    fs::remove(folder, ignored);
}

}  // namespace posefusion
