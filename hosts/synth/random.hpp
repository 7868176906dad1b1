#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>

/// Random numbers that are the same on every platform: integers hashed by SplitMix64 (Steele et al., OOPSLA 2014),
/// without the distributions of <random>. Per-pixel noise is a pure function of (seed, frame, pixel), so threads cannot
/// change it.
namespace posefusion::synth {

inline constexpr float kPi = 3.14159265358979f;

[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t x) {
    x += 0x9E3779B97F4A7C15ull;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    return x ^ (x >> 31);
}
[[nodiscard]] constexpr std::uint64_t hash(std::uint64_t a, std::uint64_t b, std::uint64_t c = 0, std::uint64_t d = 0) {
    return mix(mix(mix(mix(a) ^ b) ^ c) ^ d);
}

/// Uniform in [0, 1).
[[nodiscard]] constexpr float to_uniform(std::uint64_t h) { return static_cast<float>(h >> 40) * 0x1.0p-24f; }

/// Zero mean, unit variance, bell shaped: the sum of the four 16-bit fields (Irwin-Hall, |value| < 3.5).
[[nodiscard]] inline float to_normal(std::uint64_t h) {
    const float sum = static_cast<float>((h & 0xFFFF) + ((h >> 16) & 0xFFFF) + ((h >> 32) & 0xFFFF) + (h >> 48));
    return (sum * 0x1.0p-16f - 2.0f) * 1.7320508f;
}

/// A sequence of random numbers for decisions (layout, clothes, routes).
class Rng {
public:
    explicit Rng(std::uint64_t seed) : state_(mix(seed)) {}
    [[nodiscard]] float uniform() { return to_uniform(state_ = mix(state_)); }
    [[nodiscard]] float uniform(float low, float high) { return low + (high - low) * uniform(); }
    [[nodiscard]] int index(int count) { return static_cast<int>(uniform() * static_cast<float>(count)); }
    [[nodiscard]] bool chance(float probability) { return uniform() < probability; }
    [[nodiscard]] std::uint64_t seed() { return state_ = mix(state_); }

private:
    std::uint64_t state_;
};

/// Smooth random motion in about [-1, 1]: sines of incommensurate frequencies with random phases.
class SmoothNoise {
public:
    SmoothNoise(std::uint64_t seed, double base_hz) {
        Rng rng(seed);
        for (int i = 0; i < kTerms; ++i) {
            omega_[i] = 2.0 * 3.14159265358979 * base_hz * (1.0 + 0.73 * i) * rng.uniform(0.85f, 1.15f);
            phase_[i] = rng.uniform(0.0f, 2.0f * kPi);
        }
    }
    [[nodiscard]] double operator()(double t) const {
        double sum = 0;
        for (int i = 0; i < kTerms; ++i) sum += kWeights[i] * std::sin(omega_[i] * t + phase_[i]);
        return sum;
    }

private:
    static constexpr int kTerms = 4;
    static constexpr std::array<double, kTerms> kWeights{0.55, 0.28, 0.15, 0.08};
    std::array<double, kTerms> omega_{}, phase_{};
};

/// Value noise in [0, 1] over the plane, smooth, period-free.
[[nodiscard]] inline float value_noise(std::uint64_t seed, float x, float y) {
    const float fx = std::floor(x), fy = std::floor(y);
    const auto corner = [&](float dx, float dy) {
        return to_uniform(hash(seed, static_cast<std::uint64_t>(static_cast<std::int64_t>(fx + dx)),
                               static_cast<std::uint64_t>(static_cast<std::int64_t>(fy + dy))));
    };
    const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
    const float ax = smooth(x - fx), ay = smooth(y - fy);
    const float low = corner(0, 0) + ax * (corner(1, 0) - corner(0, 0));
    const float high = corner(0, 1) + ax * (corner(1, 1) - corner(0, 1));
    return low + ay * (high - low);
}

/// Sum of `octaves` of value noise, in [0, 1].
[[nodiscard]] inline float fractal_noise(std::uint64_t seed, float x, float y, int octaves) {
    float sum = 0, weight = 0.5f, total = 0;
    for (int i = 0; i < octaves; ++i, weight *= 0.5f, x *= 2, y *= 2) {
        sum += weight * value_noise(seed + static_cast<std::uint64_t>(i), x, y);
        total += weight;
    }
    return sum / total;
}

[[nodiscard]] constexpr float smoothstep(float low, float high, float x) {
    const float t = x <= low ? 0.0f : x >= high ? 1.0f : (x - low) / (high - low);
    return t * t * (3 - 2 * t);
}
[[nodiscard]] constexpr float mix_value(float a, float b, float t) { return a + (b - a) * t; }

}  // namespace posefusion::synth
