#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "hosts/config/run_config.hpp"
#include "hosts/io/frame_source.hpp"
#include "hosts/io/trajectory.hpp"

namespace posefusion {

/// What `posefusion run` has left in its output folder.
struct FinishedRun {
    std::filesystem::path folder;
    std::filesystem::path recording;  ///< that it was a run of
    RunConfig config;
    Trajectory trajectory;
    std::vector<std::string> warnings;

    [[nodiscard]] std::filesystem::path map() const { return folder / "map.ply"; }
    [[nodiscard]] std::filesystem::path masks() const { return folder / "masks"; }
    [[nodiscard]] bool saved_masks() const;
    /// Whether it looked for people or movers at all.
    [[nodiscard]] bool looked_for_people() const { return !config.no_people || !config.no_motion; }
    /// How to read its recording, in the full size of its images, with the camera that it was run with.
    [[nodiscard]] SourceOptions source_options() const;
};

/// The recording that the stats.json of a run names; empty: it names none, or is not there.
[[nodiscard]] std::filesystem::path recording_of_run(const std::filesystem::path& folder);

/// @param recording  where the recording is now; empty = where it was. Throws Error: no folder of a run, a run with a
/// camera, whose frames are gone, or without a record of its recording.
[[nodiscard]] FinishedRun read_finished_run(const std::filesystem::path& folder,
                                            const std::filesystem::path& recording = {});

}  // namespace posefusion
