#include "hosts/cli/map_input.hpp"

#include <fmt/format.h>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "engine/map/map_config.hpp"
#include "hosts/io/map_file.hpp"
#include "hosts/io/ply.hpp"

namespace posefusion {

std::vector<Surfel> read_wanted_surfels(const std::filesystem::path& file, std::optional<float> min_confidence) {
    const bool all_states = is_map_file(file);
    std::vector<Surfel> surfels = all_states ? surfels_of(read_map(file).map, 0) : read_ply(file);
    if (surfels.empty()) throw Error(file.string() + ": the map is empty; `posefusion run` said why");
    const std::size_t all = surfels.size();
    const float least = min_confidence.value_or(all_states ? MapConfig{}.stable_confidence : 0);
    std::erase_if(surfels, [&](const Surfel& s) { return s.confidence < least; });
    fmt::print(stderr, "{}: {}, {} with a confidence of at least {}\n", file.string(), counted(all, "surfel"),
               surfels.size(), least);
    if (surfels.empty())
        throw Error(
            fmt::format("{}: no surfel has a confidence of at least {}; lower --min-confidence", file.string(), least));
    return surfels;
}

}  // namespace posefusion
