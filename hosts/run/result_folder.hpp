#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "hosts/config/run_config.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {

inline constexpr const char* kBackgroundFolder = "background";  ///< of --save-background
inline constexpr const char* kObjectsFolder = "objects";        ///< of --objects

/// Names of the results for a piece of map that was not joined to the main one.
struct PieceFiles {
    std::string trajectory, map;
};
/// @param piece  1: the first beside the main one
[[nodiscard]] PieceFiles files_of_piece(std::size_t piece);

/// The output folder of a run. It holds the results of one run only: those of an earlier one are removed, only results
/// are replaced, and no second run can write at the same time.
class ResultFolder {
public:
    /// Checks that are possible before the recording is opened. Throws Error: the folder is a recording, the masks to
    /// be written would replace those that are read or some that no run wrote, or another run is writing here.
    ResultFolder(const RunConfig& config, const std::filesystem::path& recording);

    /// A folder that was made for nothing goes again.
    ~ResultFolder();
    ResultFolder(const ResultFolder&) = delete;
    ResultFolder& operator=(const ResultFolder&) = delete;

    /// Creates the folders and locks them against other runs. Throws Error: they cannot be created or written to.
    void open();

    /// Called with the first result. Removes the results of an earlier run (a resumed run keeps its checkpoint and
    /// masks) and writes `configuration`, which marks the folder as the output of a run.
    void begin(const std::string& configuration);

    /// Of a run that could not begin, for those who read no console: `stats`, the text of stats.json, with the
    /// configuration. Nothing if the recording is not there at all, if results of an earlier run are here, which stay
    /// as they are, or if it cannot be written.
    void leave_failure(const std::string& configuration, const std::string& stats);

    /// Called when all frames are done: removes a checkpoint that is not of this run.
    void finish() const;

    [[nodiscard]] std::filesystem::path masks() const { return config_.out / "masks"; }
    [[nodiscard]] std::filesystem::path objects() const { return config_.out / kObjectsFolder; }
    [[nodiscard]] std::filesystem::path background() const { return config_.out / kBackgroundFolder; }

private:
    /// Of save_masks, save_background or objects: whether an earlier run wrote that folder.
    [[nodiscard]] bool is_ours(const std::string& option) const;
    void check_masks() const;
    void remove_masks() const;
    void remove_objects() const;
    void remove(const std::string& name) const;

    const RunConfig& config_;
    const bool recording_exists_;
    std::optional<FolderLock> lock_;
    bool made_ = false;  ///< by open()
    bool begun_ = false;
};

}  // namespace posefusion
