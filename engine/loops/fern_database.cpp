#include "engine/loops/fern_database.hpp"

#include <algorithm>
#include <random>
#include <string>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr float kNearestThreshold = 0.4f;  // metres, ElasticFusion

/// Not std::uniform_*_distribution: what those return differs between standard libraries.
class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    std::uint32_t below(std::uint32_t end) {
        return static_cast<std::uint32_t>((std::uint64_t{engine_()} * end) >> 32);
    }
    float uniform() { return static_cast<float>(engine_() >> 8) / static_cast<float>(1 << 24); }

private:
    std::mt19937 engine_;
};

}  // namespace

FernDatabase::FernDatabase(int width, int height, float depth_max, const FernConfig& config)
    : width_(width), height_(height), config_(config) {
    Random random(config.seed);
    const auto pixels = static_cast<std::uint32_t>(width * height);
    for (int i = 0; i < config.ferns; ++i) {
        Fern fern{};
        fern.pixel = random.below(pixels);
        fern.r = static_cast<std::uint8_t>(random.below(256));
        fern.g = static_cast<std::uint8_t>(random.below(256));
        fern.b = static_cast<std::uint8_t>(random.below(256));
        fern.depth = kNearestThreshold + (depth_max - kNearestThreshold) * random.uniform();
        ferns_.push_back(fern);
    }
}

FernCode FernDatabase::encode(const Thumbnail& view) const {
    if (view.width != width_ || view.height != height_ ||
        view.pixels.size() != static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {
        throw Error("fern database: the view has " + std::to_string(view.width) + "x" + std::to_string(view.height) +
                    " pixels, not " + std::to_string(width_) + "x" + std::to_string(height_));
    }
    FernCode code;
    code.ferns.reserve(ferns_.size());
    for (const Fern& fern : ferns_) {
        const ThumbnailPixel& pixel = view.pixels[fern.pixel];
        if (!(pixel.depth > 0)) {
            code.ferns.push_back(FernCode::kNoCode);
            continue;
        }
        code.ferns.push_back(static_cast<std::uint8_t>((pixel.r > fern.r) | (pixel.g > fern.g) << 1 |
                                                       (pixel.b > fern.b) << 2 | (pixel.depth > fern.depth) << 3));
        ++code.good;
    }
    return code;
}

float FernDatabase::similarity(const FernCode& a, const FernCode& b) {
    int both = 0, equal = 0;
    const std::size_t n = std::min(a.ferns.size(), b.ferns.size());
    for (std::size_t i = 0; i < n; ++i) {
        const bool good = a.ferns[i] != FernCode::kNoCode && b.ferns[i] != FernCode::kNoCode;
        both += good;
        equal += good && a.ferns[i] == b.ferns[i];
    }
    // a few common ferns may agree by chance
    if (both == 0 || 2 * both < std::min(a.good, b.good)) return 0;
    return static_cast<float>(equal) / static_cast<float>(both);
}

bool FernDatabase::usable(const FernCode& code) const {
    return static_cast<float>(code.good) >= FernConfig::kMinGood * static_cast<float>(config_.ferns);
}

bool FernDatabase::add(const FernCode& code, const Eigen::Isometry3d& T_world_camera, std::uint32_t frame) {
    if (!usable(code)) return false;
    for (const Keyframe& keyframe : keyframes_) {
        if (1 - similarity(code, keyframe.code) <= config_.keyframe_dissimilarity) return false;
    }
    keyframes_.push_back({frame, T_world_camera, code, 0});
    return true;
}

std::vector<FernMatch> FernDatabase::query(const FernCode& code, std::span<const Keyframe> keyframes, std::size_t most,
                                           std::uint32_t now, std::uint32_t before) const {
    std::vector<FernMatch> matches;
    if (!usable(code)) return matches;
    for (std::size_t i = 0; i < keyframes.size(); ++i) {
        if (keyframes[i].frame >= before || keyframes[i].blocked_until > now) continue;
        const float alike = similarity(code, keyframes[i].code);
        if (alike >= config_.query_similarity) matches.push_back({i, alike});
    }
    std::stable_sort(matches.begin(), matches.end(),
                     [](const FernMatch& a, const FernMatch& b) { return a.similarity > b.similarity; });
    matches.resize(std::min(matches.size(), most));
    return matches;
}

}  // namespace posefusion
