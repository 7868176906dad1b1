#include "tools/evaluate_objects/run_objects.hpp"

#include <algorithm>
#include <charconv>
#include <string>

#include "engine/core/error.hpp"
#include "hosts/io/ply.hpp"

namespace posefusion {

std::vector<EstimatedObject> read_run_objects(const std::filesystem::path& run) {
    namespace fs = std::filesystem;
    const fs::path folder = run / "objects";
    std::vector<EstimatedObject> objects;
    if (!fs::is_directory(folder)) return objects;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        int number = 0;
        const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
        if (error != std::errc{} || end != name.data() + name.size() || number < 1)
            throw Error(entry.path().string() + ": not the folder of an object, whose name is its number");
        objects.push_back({number < kFirstObjectLabel ? number + kFirstObjectLabel - 1 : number,
                           read_trajectory(entry.path() / "trajectory.txt"), read_ply(entry.path() / "map.ply")});
    }
    std::sort(objects.begin(), objects.end(),
              [](const EstimatedObject& a, const EstimatedObject& b) { return a.label < b.label; });
    return objects;
}

}  // namespace posefusion
