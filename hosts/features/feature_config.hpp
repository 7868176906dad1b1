#pragma once
#include <cstddef>
#include <cstdint>

namespace posefusion {

/// Features, and the motion of the camera that they give.
struct FeatureConfig {
    bool sparse_start = true;  ///< find the motion of the camera by features, for tracking to start from
    int count = 400;           ///< most features per frame
    /// Features are sought in an image of at most this width, pixels: larger ones are halved.
    static constexpr int kMaxWidth = 400;
    /// Levels of the image pyramid, and the scale between them: sizes change little between two frames.
    static constexpr int kLevels = 4;
    static constexpr float kLevelScale = 1.3f;
    /// Least difference of intensity (0..255) between a corner and the ring round it (FAST): half of OpenCV's, so that
    /// plain rooms have features, too.
    static constexpr int kFastThreshold = 10;
    /// Corners detected per feature kept: those kept are spread over the image.
    static constexpr int kCandidates = 3;
    /// The image is divided into cells of this side, pixels of the image in which features are sought, over which the
    /// features are spread.
    static constexpr int kCell = 20;

    /// Bits of 256 by which the descriptors of the same point differ at most.
    static constexpr int kMaxBits = 64;
    /// The second best match must differ by more: largest ratio of the best to the second best.
    static constexpr float kMaxRatio = 0.85f;

    /// Standard deviation of a feature's position, pixels of the level of the pyramid that it was found on.
    static constexpr float kPixelSigma = 0.7f;
    /// A match agrees with a motion if it deviates by less, standard deviations along each axis.
    static constexpr float kInlierSigmas = 3.0f;
    /// Least number and share of the matches that must agree with a motion for it to be believed.
    static constexpr int kMinInliers = 25;
    static constexpr float kMinInlierShare = 0.3f;
    /// Random triples of matches: no more than this, and fewer when one free of outliers has been drawn with this
    /// probability.
    static constexpr int kMaxTriples = 500;
    static constexpr double kConfidence = 0.999;
    /// The frame that later ones are compared with, besides the previous one, is replaced when fewer than this share of
    /// its features are found again.
    static constexpr float kMinReferenceShare = 0.25f;

    /// Frames that were such a reference are kept as places, by which the camera is recognised after a break: at most
    /// so many; then every second one is forgotten.
    static constexpr std::size_t kMaxPlaces = 240;
    /// Places compared with a frame after a break, in turn: some 20 ms.
    static constexpr std::size_t kPlacesPerFrame = 24;
    /// Frames after a break for which places are sought although one was found: it may have been another that looks
    /// alike.
    static constexpr std::uint32_t kSearchFrames = 60;
};

}  // namespace posefusion
