#pragma once
#include <filesystem>

namespace posefusion {

/// A folder that is either complete or not there: it grows beside the final place under another name, and goes with all
/// that is in it unless it is finished.
class UnfinishedFolder {
public:
    /// Throws Error: there is something at `place` already (an empty folder is fine), or no folder can be made there.
    explicit UnfinishedFolder(const std::filesystem::path& place);
    ~UnfinishedFolder();
    UnfinishedFolder(const UnfinishedFolder&) = delete;
    UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

    [[nodiscard]] const std::filesystem::path& path() const { return path_; }  ///< for the time being
    /// Gives it its name. Throws Error.
    void finish();

private:
    std::filesystem::path place_, path_;
    bool finished_ = false;
};

}  // namespace posefusion
