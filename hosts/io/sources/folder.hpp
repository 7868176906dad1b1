#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/frame_source.hpp"
#include "hosts/io/sources/depth_files.hpp"
#include "hosts/io/sources/folder_poses.hpp"

/// Common parts of all recordings that consist of single image files.
namespace posefusion {

struct FramePaths {
    FrameEntry entry;
    std::filesystem::path color, depth;
};

/// Frames that consist of a colour and a depth image file each. The camera is that of find_folder_camera(), the ground
/// truth that of folder_groundtruth(). Depth images of another camera or size are registered to colour.
class ImageFiles final : public FrameSource {
public:
    /// Throws Error: the camera is not known, or does not fit the images.
    ImageFiles(const std::filesystem::path& folder, const SourceOptions& options, std::vector<FramePaths> frames,
               std::vector<std::string> warnings);
    [[nodiscard]] RawFrame read(std::size_t i) const override;
    [[nodiscard]] std::optional<Trajectory> groundtruth() const override;

private:
    std::filesystem::path folder_;
    std::vector<std::filesystem::path> color_, depth_;
    bool y_up_ = false;  ///< in the ground truth
    std::optional<DepthFiles> depth_files_;
};

}  // namespace posefusion
