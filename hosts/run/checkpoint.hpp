#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "engine/slam/map_piece.hpp"
#include "hosts/config/run_config.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/run/run_record.hpp"

/// The state of a run between two frames, in a file: a killed run continues from it and ends with the same trajectory
/// and map as an uninterrupted one.
namespace posefusion {

/// The identity of a run. Only the same run can be resumed.
struct RunIdentity {
    std::string recording;      ///< absolute path
    std::vector<Stamp> stamps;  ///< of all frames of the recording
    std::vector<std::pair<std::string, std::string>>
        options;  ///< key and value of those that determine trajectory or map
};
[[nodiscard]] RunIdentity identity_of(const RunConfig& config, const Recording& recording);

struct Checkpoint {
    AtlasState engine;
    ByteArray people;                     ///< PeopleFinder::state() after the last of the frames
    std::vector<FrameRecord> frames;      ///< done so far
    std::vector<SampleFrame> samples;     ///< pictures for the report
    std::optional<LoopGraph> loop_graph;  ///< of the last loop that bent the map
    double wall_seconds = 0;              ///< time that these frames took
};

/// The checkpoint file in the output folder of a run.
[[nodiscard]] std::filesystem::path checkpoint_file(const RunConfig& config);

/// Atomically: there is always a whole checkpoint. Throws Error. @param record  frames and samples so far
void write_checkpoint(const std::filesystem::path& file, const RunIdentity& identity, const AtlasState& engine,
                      const ByteArray& people, const RunRecord& record, double wall_seconds);
/// Throws Error for files that cannot be used, see read_sections(), and for those of another run, naming the first
/// difference.
[[nodiscard]] Checkpoint read_checkpoint(const std::filesystem::path& file, const RunIdentity& identity);

}  // namespace posefusion
