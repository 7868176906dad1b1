#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "hosts/synth/mesh.hpp"
#include "hosts/synth/texture.hpp"

namespace posefusion::synth {

/// Adds simple solids to a mesh, in a frame of their own. Large faces are cut into small ones, because light is baked
/// per vertex.
class MeshBuilder {
public:
    MeshBuilder(RoomMesh& mesh, const Eigen::Isometry3f& frame) : mesh_(mesh), frame_(frame) {}

    /// @param frame  of the part within this builder's frame
    [[nodiscard]] MeshBuilder at(const Eigen::Isometry3f& frame) const { return {mesh_, frame_ * frame}; }
    [[nodiscard]] MeshBuilder at(const Vector3f& origin, float yaw = 0) const;
    [[nodiscard]] const Eigen::Isometry3f& frame() const { return frame_; }

    /// A rectangle seen from outside: upper left corner, edges to the right and down.
    void quad(const Vector3f& corner, const Vector3f& right, const Vector3f& down, Material material,
              const Vector3f& tint = Vector3f::Ones(), const Vector2f& uv = Vector2f::Zero()) const;
    void box(const Vector3f& low, const Vector3f& high, Material material, const Vector3f& tint = Vector3f::Ones(),
             const Vector2f& uv = Vector2f::Zero()) const;
    /// A solid of revolution about z. @param profile (radius, height), from bottom to top
    void lathe(const std::vector<Vector2f>& profile, Material material, const Vector3f& tint = Vector3f::Ones(),
               int segments = 20) const;
    /// A ribbon along a curve, `width` wide; for leaves. @param side direction of the width
    void ribbon(const std::vector<Vector3f>& curve, const Vector3f& side, float width, Material material,
                const Vector3f& tint = Vector3f::Ones()) const;

private:
    std::uint32_t vertex(const Vector3f& position, const Vector3f& normal, const Vector2f& uv,
                         const Vector3f& tint) const;
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, Material material) const;
    RoomMesh& mesh_;
    Eigen::Isometry3f frame_;
};

}  // namespace posefusion::synth
