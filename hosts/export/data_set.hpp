#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/map/surfel.hpp"
#include "hosts/export/chosen_views.hpp"
#include "hosts/export/keyframes.hpp"
#include "hosts/run/finished_run.hpp"

/// The views of a finished run as data sets for programs that learn scenes from images.
namespace posefusion {

struct DataSetConfig {
    std::filesystem::path nerfstudio, colmap;  ///< folders to make; empty = none
    KeyframeConfig keyframes;
    bool undistort = false;  ///< images as an ideal lens would give them; else as recorded, with the lens described
    std::size_t points = 100'000;  ///< of the map, at most

    [[nodiscard]] bool wanted() const { return !nerfstudio.empty() || !colmap.empty(); }
};

/// Throws Error for values that are not possible.
void check(const DataSetConfig& config);

struct DataSet {
    std::size_t frames = 0;  ///< of the run, to choose from
    std::size_t views = 0;   ///< chosen
    std::size_t points = 0;
    bool cancelled = false;  ///< nothing has been written
};

/// Writes folders that are complete or not there. Throws Error.
/// @param map  surfels of the run
DataSet write_data_sets(const FinishedRun& run, const std::vector<Surfel>& map, const DataSetConfig& config,
                        const ViewObserver& observer);

}  // namespace posefusion
