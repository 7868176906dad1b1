#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace posefusion {

/// Code of a view: for each fern 4 bits (red, green, blue, depth above their thresholds), or kNoCode.
struct FernCode {
    static constexpr std::uint8_t kNoCode = 0xff;
    std::vector<std::uint8_t> ferns;
    int good = 0;  ///< number of valid ferns (not kNoCode)
};

/// A view that place recognition can find again.
struct Keyframe {
    std::uint32_t frame = 0;
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< deformed together with the map
    FernCode code;
    std::uint32_t blocked_until = 0;  ///< frame until which it is not proposed, after it was tried and did not fit
};

/// What the codes depend on: codes made with other values cannot be compared.
struct FernIdentity {
    std::int32_t ferns = 0, shrink = 0;
    std::uint32_t seed = 0;
    float depth_max = 0;  ///< metres
    friend bool operator==(const FernIdentity&, const FernIdentity&) = default;
};

}  // namespace posefusion
