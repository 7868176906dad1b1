#pragma once
#include "hosts/io/frame_source.hpp"

/// What all recordings made of single image files share.
namespace posefusion {

struct FramePaths {
    FrameEntry entry;
    std::filesystem::path color, depth;
};

/// Last part of the full name of a folder.
[[nodiscard]] std::string folder_name(const std::filesystem::path& folder);

/// options.camera_file, else camera.yaml in the folder, else the camera that the folder name tells. Throws Error.
[[nodiscard]] Camera folder_camera(const std::filesystem::path& folder, const SourceOptions& options);

/// groundtruth.txt of the folder, else the *.gt.freiburg of an ICL-NUIM recording.
[[nodiscard]] std::optional<Trajectory> folder_groundtruth(const std::filesystem::path& folder);

/// Frames that are a colour and a depth image file each.
class ImageFiles final : public FrameSource {
public:
    ImageFiles(const std::filesystem::path& folder, const SourceOptions& options, std::vector<FramePaths> frames,
               std::vector<std::string> warnings);
    [[nodiscard]] RawFrame read(std::size_t i) const override;
    [[nodiscard]] std::optional<Trajectory> groundtruth() const override { return folder_groundtruth(folder_); }

private:
    struct Files {
        std::filesystem::path color, depth;
    };
    std::filesystem::path folder_;
    std::vector<Files> files_;
};

}  // namespace posefusion
