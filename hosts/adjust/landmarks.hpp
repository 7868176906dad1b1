#pragma once
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/depth_noise.hpp"
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "hosts/adjust/bundle.hpp"

namespace posefusion {

/// A frame that takes part in bundle adjustment.
struct KeyframeImages {
    ColorImage color;
    DepthImage depth;                                                  ///< metres
    LabelImage labels;                                                 ///< 0 static; of any size; empty: all is static
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< at the stamp
    FrameReadout readout;
};

struct LandmarkConfig {
    static constexpr int kPerKeyframe = 1500;       ///< new landmarks at most
    static constexpr double kSpacing = 6;           ///< pixels; a landmark that is seen already keeps others away
    static constexpr double kMostScale = 1.5;       ///< between the sizes in which a patch is seen
    static constexpr double kMostTurn = 0.6;        ///< rad, between the directions from which a landmark is seen
    static constexpr double kMostDepthStep = 0.05;  ///< of the depth, from what is expected: something else is in front
    static constexpr double kPixelSigma = 0.1;      ///< pixels, of a patch found again, besides its own
    static constexpr double kMostSigma = 0.3;       ///< pixels; patches that can slide along an edge are left out
    static constexpr std::size_t kFewestViews = 3;  ///< a landmark seen less often says little
    static constexpr std::size_t kPerFrame = 250;   ///< landmarks looked for in one more frame, at most
};

/// Finds static points in keyframes and follows them through all later ones that show them: corners on surfaces that
/// are plane round them, found again by aligning patches (find_patch()).
class LandmarkSearch {
public:
    /// @param keyframes  must outlive this object
    /// @param camera     of the images; the bundle begins with it and with the poses of the keyframes
    /// @param times      of its rows, as far as they are known; nullopt: all pixels of a frame are taken at its stamp
    LandmarkSearch(const std::vector<KeyframeImages>& keyframes, const Intrinsics& camera, const DepthNoise& noise,
                   const std::optional<RowTimes>& times = std::nullopt);
    ~LandmarkSearch();
    LandmarkSearch(const LandmarkSearch&) = delete;
    LandmarkSearch& operator=(const LandmarkSearch&) = delete;

    /// Call once. @param keyframe_done  called after each
    [[nodiscard]] Bundle find(const std::function<void()>& keyframe_done = [] {});
    /// The landmarks of find() in one more frame: those that some keyframes saw, evenly chosen. May be called from
    /// several threads. @param near  keyframes with about the same view
    [[nodiscard]] std::vector<Observation> find_in(const KeyframeImages& frame,
                                                   std::span<const std::size_t> near) const;

private:
    class Tracks;
    std::unique_ptr<Tracks> tracks_;
};

/// LandmarkSearch::find()
[[nodiscard]] Bundle find_landmarks(const std::vector<KeyframeImages>& keyframes, const Intrinsics& camera,
                                    const DepthNoise& noise, const std::optional<RowTimes>& times = std::nullopt);

}  // namespace posefusion
