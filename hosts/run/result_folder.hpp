#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "hosts/config/run_config.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {

/// The folder that a run writes to. Results there are always of one run: nothing of an earlier one stays beside them,
/// nothing but results is replaced, and no second run writes at the same time.
class ResultFolder {
public:
    /// What can be said before the recording is opened. Throws Error: the folder is a recording, the masks to be
    /// written would replace those that are read or some that no run wrote, or another run writes here.
    ResultFolder(const RunConfig& config, const std::filesystem::path& recording);

    /// Makes the folders and keeps other runs out. Throws Error: they cannot be made or written to.
    void open();

    /// With the first result: from here on the folder is this run's. Removes what an earlier run left (a run that is
    /// resumed keeps its checkpoint and masks) and writes `configuration`, which marks the folder as a run's.
    void begin(const std::string& configuration);

    /// All frames are done: a checkpoint that is not of this run is of no use any more.
    void finish() const;

    [[nodiscard]] std::filesystem::path masks() const { return config_.out / "masks"; }

private:
    [[nodiscard]] bool masks_are_ours() const;
    void check_masks() const;
    void remove_masks() const;

    const RunConfig& config_;
    std::optional<FolderLock> lock_;
    bool begun_ = false;
};

}  // namespace posefusion
