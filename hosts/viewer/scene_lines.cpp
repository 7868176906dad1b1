#include "hosts/viewer/scene_lines.hpp"

#include <array>

#include "engine/core/image.hpp"
#include "engine/core/pinhole.hpp"
#include "hosts/report/person_colors.hpp"

namespace posefusion {
namespace {

constexpr float kPathWidth = 2, kStartSize = 7, kFrustumWidth = 2.5f, kLimbWidth = 4, kJointSize = 8;  // pixels
constexpr float kFrustumDepth = 0.25f;                                                                 // metres
constexpr std::uint32_t kPathColor = pack_rgb({64, 200, 255}), kFrustumColor = pack_rgb({120, 255, 120}),
                        kLostColor = pack_rgb({255, 60, 60}), kJointColor = pack_rgb({255, 255, 255});

Segment segment(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float width, std::uint32_t color) {
    return {to_glm(from), width, to_glm(to), color};
}

}  // namespace

void add_trajectory(std::vector<Segment>& lines, const std::vector<Eigen::Vector3f>& positions) {
    if (positions.empty()) return;
    lines.push_back(segment(positions.front(), positions.front(), kStartSize, kPathColor));
    for (std::size_t i = 1; i < positions.size(); ++i) {
        lines.push_back(segment(positions[i - 1], positions[i], kPathWidth, kPathColor));
    }
}

void add_frustum(std::vector<Segment>& lines, const Eigen::Isometry3f& T_world_camera, const Intrinsics& camera,
                 bool ok) {
    const std::uint32_t color = ok ? kFrustumColor : kLostColor;
    const auto corner = [&](float u, float v) -> Eigen::Vector3f {
        return T_world_camera * back_project(u, v, kFrustumDepth, camera);
    };
    const float right = static_cast<float>(camera.width), bottom = static_cast<float>(camera.height);
    const std::array<Eigen::Vector3f, 4> corners{corner(0, 0), corner(right, 0), corner(right, bottom),
                                                 corner(0, bottom)};
    for (std::size_t i = 0; i < corners.size(); ++i) {
        lines.push_back(segment(T_world_camera.translation(), corners[i], kFrustumWidth, color));
        lines.push_back(segment(corners[i], corners[(i + 1) % corners.size()], kFrustumWidth, color));
    }
}

void add_object_paths(std::vector<Segment>& lines, const std::vector<ShownObject>& objects) {
    for (const ShownObject& object : objects) {
        const std::uint32_t color = pack_rgb(label_color(object.label));
        const std::vector<Eigen::Vector3f>& path = object.path;
        if (path.empty()) continue;
        lines.push_back(segment(path.front(), path.front(), kStartSize, color));
        for (std::size_t i = 1; i < path.size(); ++i)
            if (path[i - 1].allFinite() && path[i].allFinite())
                lines.push_back(segment(path[i - 1], path[i], kPathWidth, color));
    }
}

void add_skeletons(std::vector<Segment>& lines, const std::vector<Skeleton3d>& skeletons) {
    for (std::size_t person = 0; person < skeletons.size(); ++person) {
        const Skeleton3d& joints = skeletons[person];
        const std::uint32_t color = pack_rgb(person_color(person));
        for (const auto& [a, b] : kLimbs) {
            const auto& from = joints[static_cast<std::size_t>(a)];
            const auto& to = joints[static_cast<std::size_t>(b)];
            if (from && to) lines.push_back(segment(*from, *to, kLimbWidth, color));
        }
        for (const auto& joint : joints) {
            if (joint) lines.push_back(segment(*joint, *joint, kJointSize, kJointColor));
        }
    }
}

}  // namespace posefusion
