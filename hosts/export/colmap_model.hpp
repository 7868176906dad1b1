#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "hosts/io/camera_file.hpp"

/// A sparse model of COLMAP: https://colmap.github.io/format.html
namespace posefusion {

struct ColmapImage {
    std::string name;  ///< of the file, relative to the folder of the images
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    struct Point {
        Eigen::Vector2f pixel;    ///< whole numbers are centres of pixels; the files count from the corner of the image
        std::uint32_t point = 0;  ///< position in ColmapModel::points
    };
    std::vector<Point> points{};
};

struct ColmapPoint {
    Eigen::Vector3f position;  ///< world, metres
    Rgb8 color;
};

struct ColmapModel {
    Camera camera;  ///< of all images
    std::vector<ColmapImage> images;
    std::vector<ColmapPoint> points;
};

/// Writes cameras, images and points3D, each as .bin and as .txt. Images and points are numbered from 1 on. The camera
/// is a PINHOLE, OPENCV or FULL_OPENCV, whatever its lens needs. The errors of points are 0: their positions in images
/// are projections. Throws Error.
void write_colmap_model(const std::filesystem::path& folder, const ColmapModel& model);

}  // namespace posefusion
