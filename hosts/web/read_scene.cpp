#include "hosts/web/read_scene.hpp"

#include <utility>

#include "hosts/run/finished_run.hpp"
#include "hosts/web/keyframe_images.hpp"
#include "hosts/web/run_results.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// The last name of a path, whether or not it ends with a slash.
std::string name_of_place(const fs::path& place) {
    const fs::path whole = fs::absolute(place).lexically_normal();
    return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

}  // namespace

WebScene read_scene(const fs::path& source, std::vector<Surfel> map, const fs::path& recording,
                    const std::function<void(const std::string&)>& remark, const std::function<bool()>& cancelled) {
    if (!fs::is_directory(source)) return make_scene(source.stem().string(), std::move(map), nullptr);
    if (!fs::exists(source / "trajectory.txt")) {
        remark("there is no trajectory.txt in " + source.string() + "; the page shows the map alone");
        return make_scene(name_of_place(source), std::move(map), nullptr);
    }
    const RunResults results = read_run_results(source);
    const fs::path recorded = recording.empty() ? recording_of_run(source) : recording;
    const std::string title = name_of_place(recorded.empty() ? source : recorded);
    WebScene scene = make_scene(title, std::move(map), &results);
    const std::string why_none = add_keyframe_images(scene, source, recording, cancelled);
    if (!why_none.empty()) remark("the page shows no images: " + why_none);
    return scene;
}

}  // namespace posefusion
