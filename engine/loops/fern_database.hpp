#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/loops/keyframe.hpp"
#include "engine/loops/loop_config.hpp"

/// Place recognition by randomised ferns (Glocker et al. 2015), as ElasticFusion uses them: a fern compares one pixel's
/// red, green, blue and depth with thresholds; the results of all ferns are the code of a view.
namespace posefusion {

/// One pixel of a downsampled view. Depth 0: unknown (a person, no measurement); such a pixel has no code.
struct ThumbnailPixel {
    std::uint8_t r = 0, g = 0, b = 0;
    float depth = 0;  ///< metres
};

/// A downsampled view, row by row.
struct Thumbnail {
    int width = 0, height = 0;
    std::vector<ThumbnailPixel> pixels;
};

struct FernMatch {
    std::size_t keyframe = 0;
    float similarity = 0;  ///< share of equal codes among the ferns that are valid in both views, 0..1
};

class FernDatabase {
public:
    /// The same seed and size give the same ferns on every machine. @param depth_max  farthest depth threshold, metres
    FernDatabase(int width, int height, float depth_max, const FernConfig& config);

    /// Throws Error unless the thumbnail has the size of the database.
    [[nodiscard]] FernCode encode(const Thumbnail& view) const;
    /// Share of equal codes among the ferns that are valid in both; 0 if those are fewer than half of either's valid
    /// ferns.
    [[nodiscard]] static float similarity(const FernCode& a, const FernCode& b);
    /// Adds the view as a keyframe if it is unlike all others. @return whether it was added
    bool add(const FernCode& code, const Eigen::Isometry3d& T_world_camera, std::uint32_t frame);
    /// Keyframes of frames before `before`, at least config.query_similarity alike and not blocked at frame `now`: the
    /// most similar (then the oldest) first.
    [[nodiscard]] std::vector<FernMatch> query(const FernCode& code, std::size_t most, std::uint32_t now,
                                               std::uint32_t before) const {
        return query(code, keyframes_, most, now, before);
    }
    /// The same among other keyframes, coded by the same ferns.
    [[nodiscard]] std::vector<FernMatch> query(const FernCode& code, std::span<const Keyframe> keyframes,
                                               std::size_t most, std::uint32_t now, std::uint32_t before) const;

    [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return keyframes_; }
    [[nodiscard]] std::vector<Keyframe>& keyframes() { return keyframes_; }

private:
    struct Fern {
        std::uint32_t pixel;
        std::uint8_t r, g, b;
        float depth;
    };
    [[nodiscard]] bool usable(const FernCode& code) const;

    int width_, height_;
    FernConfig config_;
    std::vector<Fern> ferns_;
    std::vector<Keyframe> keyframes_;
};

}  // namespace posefusion
