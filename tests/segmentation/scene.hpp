#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "pose/joints.hpp"

/// Rooms made of a wall, a floor, boxes and people of capsules, rendered to depth, colour and true labels.
/// World: x right, y down, z forward; the first camera is at the origin, the floor at kFloor.
namespace posefusion::test {

inline constexpr float kFloor = 1.4f;  ///< height of the camera above the floor, metres
inline constexpr float kWall = 4.2f;   ///< distance of the wall, metres

struct Box {
    Eigen::Vector3f low, high;
};

struct Mannequin {
    float x = 0, z = 3.2f;  ///< where it stands, metres
};

struct Scene {
    std::vector<Mannequin> people{};
    std::vector<Box> boxes{};
    Eigen::Vector3f camera = Eigen::Vector3f::Zero();  ///< position of the camera, axes as the world's
};

struct Frame {
    ColorImage color;
    DepthImage depth;
    LabelImage truth;  ///< 0 static, 1..n person
    LabelImage parts;  ///< kWallPart ...
    People people;     ///< joints inside the image, p = 1, whether hidden or not
};

enum Part : std::uint8_t { kWallPart, kFloorPart, kBoxPart, kPersonPart };

[[nodiscard]] Intrinsics camera_of(int width, int height);
/// Depth with the noise of a structured-light camera, the same for the same scene.
[[nodiscard]] Frame render(const Scene& scene, const Intrinsics& camera);

struct Score {
    double recall = 0;       ///< share of true person pixels labelled
    double static_lost = 0;  ///< share of true static pixels labelled
    double iou = 0;
};
[[nodiscard]] Score score(const LabelImage& labels, const LabelImage& truth);
/// Share of the pixels of one part of the room that are labelled.
[[nodiscard]] double labelled_share(const LabelImage& labels, const LabelImage& parts, Part part);

}  // namespace posefusion::test
