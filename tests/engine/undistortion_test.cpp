#include "engine/preprocess/undistortion.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <thread>

#include "engine/core/error.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"

// What undoes the distortion of a lens, against its header comment.
namespace posefusion::test {
namespace {

constexpr double kPositionError = 1.0 / 64;  // pixels: positions are rounded to 1/32
constexpr double kValueError = 0.5;          // grey levels: the result is a whole number

struct Images {
    ColorImage color;
    DepthImage depth;
};

/// Neither smooth nor empty: colours and depths at random, a tenth without measurement.
Images random_images(int width, int height, unsigned seed) {
    Random random(seed);
    Images images{ColorImage(width, height), DepthImage(width, height)};
    const auto level = [&] { return static_cast<std::uint8_t>(random.uniform(0, 255.999)); };
    for (Rgb8& c : images.color) c = {level(), level(), level()};
    for (float& z : images.depth) z = random.uniform(0, 1) < 0.1 ? 0.0f : static_cast<float>(random.uniform(0.3, 8));
    return images;
}

template <class Position>
LensMap lens_of(int width, int height, Position position) {
    LensMap lens(width, height);
    for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u) lens(u, v) = position(u, v);
    return lens;
}

LensMap identity(int width, int height) {
    return lens_of(width, height, [](int u, int v) {
        return PixelPosition{static_cast<float>(u), static_cast<float>(v)};
    });
}

/// Far beyond any lens: the corners look for pixels a whole image outside, the middle is magnified.
LensMap strong(int width, int height) {
    return lens_of(width, height, [=](int u, int v) {
        const double x = 2.0 * u / width - 1, y = 2.0 * v / height - 1, bend = 0.3 + 1.1 * (x * x + y * y);
        return PixelPosition{static_cast<float>((x * bend + 0.06 * y * y + 1) * width / 2),
                             static_cast<float>((y * bend - 0.04 * x * y + 1) * height / 2)};
    });
}

/// Positions at which rounding is a tie, at the border and on both sides of it, and as far away as floats go.
LensMap awkward(int width, int height) {
    constexpr float kHuge = std::numeric_limits<float>::max();
    const std::array<float, 12> offsets{0,     0.5f,   1.5f, 1.0f / 64, 3.0f / 64, 0.49999f,
                                        -0.5f, -0.51f, -1,   -2.5f,     -kHuge,    kHuge};
    return lens_of(width, height, [&](int u, int v) {
        const auto pick = [&](std::size_t at, int size) {
            const float offset = offsets[at % offsets.size()];
            return at / offsets.size() % 2 == 0 ? offset : static_cast<float>(size - 1) - offset;
        };
        const auto i = static_cast<std::size_t>(v * width + u);
        return PixelPosition{pick(i, width), pick(i / 7, height)};
    });
}

/// Rounds as IEEE does: ties to the even number.
long long nearest_whole(double value) { return std::llrint(value); }

std::array<int, 3> channels(Rgb8 c) { return {c.r, c.g, c.b}; }

/// The definition, in whole numbers.
Images reference(const Images& distorted, const LensMap& lens) {
    const int width = lens.width(), height = lens.height();
    const auto at = [&](long long u, long long v) {
        return channels(distorted.color(static_cast<int>(std::clamp<long long>(u, 0, width - 1)),
                                        static_cast<int>(std::clamp<long long>(v, 0, height - 1))));
    };
    Images result{ColorImage(width, height), DepthImage(width, height)};
    for (std::size_t i = 0; i < lens.size(); ++i) {
        const double u = std::clamp(static_cast<double>(lens[i].u), -1e6, 1e6),
                     v = std::clamp(static_cast<double>(lens[i].v), -1e6, 1e6);
        const long long fine_u = nearest_whole(u * 32), fine_v = nearest_whole(v * 32);
        const long long u0 = (fine_u - ((fine_u % 32) + 32) % 32) / 32, v0 = (fine_v - ((fine_v % 32) + 32) % 32) / 32;
        const long long a = fine_u - 32 * u0, b = fine_v - 32 * v0;
        std::array<std::uint8_t, 3> mean{};
        for (std::size_t c = 0; c < mean.size(); ++c) {
            const long long sum = (32 - b) * ((32 - a) * at(u0, v0)[c] + a * at(u0 + 1, v0)[c]) +
                                  b * ((32 - a) * at(u0, v0 + 1)[c] + a * at(u0 + 1, v0 + 1)[c]);
            mean[c] = static_cast<std::uint8_t>((sum + 512) / 1024);
        }
        result.color[i] = {mean[0], mean[1], mean[2]};
        const long long near_u = nearest_whole(u), near_v = nearest_whole(v);
        const bool inside = near_u >= 0 && near_v >= 0 && near_u < width && near_v < height;
        result.depth[i] = inside ? distorted.depth(static_cast<int>(near_u), static_cast<int>(near_v)) : 0.0f;
    }
    return result;
}

/// The kernel on its own, with guard zones about all its buffers.
Images by_kernel(const Images& distorted, const LensMap& lens) {
    const std::size_t n = lens.size();
    std::vector<std::uint32_t> colors;
    for (const Rgb8 c : distorted.color) colors.push_back(pack_rgb(c) | 0xab000000u);  // the last byte means nothing
    Launch launch("preprocess/undistort");
    launch.input("lens", std::span(lens.data(), n));
    launch.input("distorted_color", colors).input("distorted_depth", std::span(distorted.depth.data(), n));
    launch.output<std::uint32_t>("color", n).output<float>("depth", n);
    launch.run_over(n, {{"width", lens.width()}, {"height", lens.height()}});
    Images result{ColorImage(lens.width(), lens.height()), DepthImage(lens.width(), lens.height())};
    const auto color = launch.read<std::uint32_t>("color");
    const auto depth = launch.read<float>("depth");
    for (std::size_t i = 0; i < n; ++i) {
        EXPECT_EQ(color[i] >> 24, 0u);
        result.color[i] = unpack_rgb(color[i]);
        result.depth[i] = depth[i];
    }
    return result;
}

std::size_t differences(const Images& a, const Images& b) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.color.size(); ++i) count += a.color[i] != b.color[i] || a.depth[i] != b.depth[i];
    return count;
}

class UndistortKernel : public DeviceTest, public testing::WithParamInterface<std::array<int, 2>> {
protected:
    const int width = GetParam()[0], height = GetParam()[1];
    const Images distorted = random_images(width, height, 5);
};

INSTANTIATE_TEST_SUITE_P(Sizes, UndistortKernel,
                         testing::Values(std::array{160, 120}, std::array{101, 77}, std::array{37, 1},
                                         std::array{1, 300}, std::array{1, 1}),
                         [](const auto& test) {
                             return std::to_string(test.param[0]) + "x" + std::to_string(test.param[1]);
                         });

TEST_P(UndistortKernel, WithoutDistortionChangesNothing) {
    EXPECT_EQ(differences(by_kernel(distorted, identity(width, height)), distorted), 0u);
}

// No tolerance: all is done in whole numbers, on floats whose products by 32 are exact.
TEST_P(UndistortKernel, IsTheReferenceToTheLastBit) {
    for (const LensMap& lens : {strong(width, height), awkward(width, height)}) {
        EXPECT_EQ(differences(by_kernel(distorted, lens), reference(distorted, lens)), 0u);
    }
}

TEST_P(UndistortKernel, ReadsNothingOfPlacesThatAreNoNumbers) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const LensMap lens = lens_of(width, height, [](int, int) { return PixelPosition{kNan, kNan}; });
    Images full = distorted;
    for (float& z : full.depth) z = 1;
    const Images result =
        by_kernel(full, lens);  // Undistortion refuses such a lens; the kernel must stay within its buffers
    for (const float z : result.depth) ASSERT_TRUE(z == 0.0f || z == 1.0f) << z;
}

// What the rounding of positions costs, against interpolation in real numbers.
TEST_F(DeviceTest, UndistortedColourIsBilinearToAFewLevels) {
    const Images distorted = random_images(90, 70, 8);
    const LensMap lens = strong(90, 70);
    const Images result = by_kernel(distorted, lens);
    std::size_t compared = 0;
    for (std::size_t i = 0; i < lens.size(); ++i) {
        const double u = lens[i].u, v = lens[i].v;
        const int u0 = static_cast<int>(std::floor(u)), v0 = static_cast<int>(std::floor(v));
        // one pixel of margin: a position may be rounded across the border between pixels
        if (u0 < 1 || v0 < 1 || u0 + 2 >= 90 || v0 + 2 >= 70) continue;
        ++compared;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto at = [&](int du, int dv) { return channels(distorted.color(u0 + du, v0 + dv))[c]; };
            const double a = u - u0, b = v - v0;
            const double exact =
                (1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) + b * ((1 - a) * at(0, 1) + a * at(1, 1));
            int low = 255, high = 0;
            for (int dv = -1; dv <= 2; ++dv)
                for (int du = -1; du <= 2; ++du) low = std::min(low, at(du, dv)), high = std::max(high, at(du, dv));
            EXPECT_LE(std::abs(channels(result.color[i])[c] - exact), kValueError + 2 * kPositionError * (high - low));
        }
    }
    EXPECT_GT(compared, lens.size() / 3);
}

// ------------------------------------------------------------------------------------------------- with its buffers

std::shared_ptr<vulkan::Context> borrowed_context() {
    return {&shared_context(), [](auto*) {}};
}

class UndistortionOnDevice : public DeviceTest {
protected:
    static constexpr int kWidth = 101, kHeight = 77;
    const LensMap lens = strong(kWidth, kHeight);
};

TEST_F(UndistortionOnDevice, TakesOneFrameAfterTheOther) {
    const Undistortion undistortion(borrowed_context(), lens);
    for (unsigned seed = 0; seed < 4; ++seed) {
        const Images distorted = random_images(kWidth, kHeight, seed);
        Images images = distorted;
        const UndistortTime time = undistortion.apply(images.color, images.depth);
        EXPECT_EQ(differences(images, reference(distorted, lens)), 0u) << "frame " << seed;
        EXPECT_EQ(time.device_ms.has_value(), shared_context().timestamp_mask() != 0);
        for (const double ms : {time.device_ms.value_or(0), time.wait_ms}) EXPECT_TRUE(ms >= 0 && ms < 10000) << ms;
    }
}

TEST_F(UndistortionOnDevice, ServesSeveralThreads) {
    const Undistortion undistortion(borrowed_context(), lens);
    std::array<std::size_t, 3> wrong{};
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < wrong.size(); ++t) {
        threads.emplace_back([&, t] {
            const Images distorted = random_images(kWidth, kHeight, 20 + t), expected = reference(distorted, lens);
            for (int round = 0; round < 10; ++round) {
                Images images = distorted;
                (void)undistortion.apply(images.color, images.depth);
                wrong[t] += differences(images, expected);
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    for (const std::size_t count : wrong) EXPECT_EQ(count, 0u);
}

TEST_F(UndistortionOnDevice, RefusesImagesOfAnotherSize) {
    const Undistortion undistortion(borrowed_context(), lens);
    ColorImage color(kWidth, kHeight), turned_color(kHeight, kWidth);
    DepthImage depth(kWidth, kHeight), turned_depth(kHeight, kWidth);
    EXPECT_THROW((void)undistortion.apply(turned_color, depth), Error);
    EXPECT_THROW((void)undistortion.apply(color, turned_depth), Error);
}

TEST_F(UndistortionOnDevice, RefusesLensesThatMakeNoSense) {
    EXPECT_THROW(Undistortion(borrowed_context(), LensMap()), Error);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        LensMap broken = lens;
        broken(50, 40).v = bad;
        EXPECT_THROW(Undistortion(borrowed_context(), broken), Error);
    }
    const auto most = static_cast<int>(Undistortion::most_pixels(shared_context()));
    EXPECT_GE(most, 4096 * 3072) << "of a camera of today";
    EXPECT_THROW(Undistortion(borrowed_context(), LensMap(most + 1, 1)), Error);
}

}  // namespace
}  // namespace posefusion::test
