#include "engine/loops/fern_database.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "engine/core/error.hpp"

// Place recognition: same place, same code; people neither make nor prevent a match; nothing depends on chance.
namespace posefusion {
namespace {

constexpr int kWidth = 80, kHeight = 60;
constexpr float kDepthMax = 5;

/// A view of smooth random colours and depths; the same seed is the same place.
Thumbnail place(unsigned seed) {
    std::mt19937 engine(seed);
    const auto value = [&] { return static_cast<float>(engine() % 1000) / 1000; };
    float phase[8];
    for (float& p : phase) p = value();
    Thumbnail view{kWidth, kHeight, {}};
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
            const auto wave = [&](int k) {
                return 0.5f + 0.5f * std::sin(6.0f * (static_cast<float>(u) / kWidth * phase[k] +
                                                      static_cast<float>(v) / kHeight * phase[k + 1]) +
                                              6.0f * phase[k + 2]);
            };
            const auto byte = [&](int k) { return static_cast<std::uint8_t>(255 * wave(k)); };
            view.pixels.push_back({byte(0), byte(1), byte(2), 0.6f + 4.0f * wave(5)});
        }
    }
    return view;
}

Thumbnail with_noise(Thumbnail view, unsigned seed) {
    std::mt19937 engine(seed);
    for (ThumbnailPixel& p : view.pixels) {
        p.r = static_cast<std::uint8_t>(std::min<unsigned long>(255, p.r + engine() % 6));
        p.depth += 0.0001f * static_cast<float>(engine() % 200);
    }
    return view;
}

/// A person in part of the view: nothing known there, or (unmasked) the person's own look.
Thumbnail with_person(Thumbnail view, bool masked) {
    for (int v = 5; v < kHeight; ++v) {
        for (int u = 25; u < 50; ++u)
            view.pixels[static_cast<std::size_t>(v * kWidth + u)] =
                masked ? ThumbnailPixel{} : ThumbnailPixel{200, 30, 30, 1.2f};
    }
    return view;
}

FernDatabase database(const FernConfig& config = {}) { return FernDatabase(kWidth, kHeight, kDepthMax, config); }

TEST(Ferns, SamePlaceIsAlikeAnotherIsNot) {
    const FernDatabase places = database();
    const FernCode here = places.encode(place(1));
    EXPECT_EQ(here.good, 500);
    EXPECT_FLOAT_EQ(FernDatabase::similarity(here, here), 1.0f);
    EXPECT_GT(FernDatabase::similarity(here, places.encode(with_noise(place(1), 7))), 0.9f);
    for (unsigned other = 2; other < 12; ++other)
        EXPECT_LT(FernDatabase::similarity(here, places.encode(place(other))), 0.6f) << other;
}

TEST(Ferns, SameSeedSameCodesOtherSeedOthers) {
    EXPECT_EQ(database().encode(place(1)).ferns, database().encode(place(1)).ferns);
    FernConfig other;
    other.seed = 2;
    EXPECT_NE(database().encode(place(1)).ferns, database(other).encode(place(1)).ferns);
}

TEST(Ferns, MaskedPersonNeitherMakesNorPreventsAMatch) {
    FernDatabase places = database();
    const FernCode empty = places.encode(place(1)), masked = places.encode(with_person(place(1), true));
    EXPECT_FLOAT_EQ(FernDatabase::similarity(empty, masked), 1.0f);
    const float different = FernDatabase::similarity(places.encode(place(2)), places.encode(place(3)));
    const float both_masked = FernDatabase::similarity(places.encode(with_person(place(2), true)),
                                                       places.encode(with_person(place(3), true)));
    EXPECT_NEAR(both_masked, different, 0.15f);  // other ferns, the same two places
    // unmasked, the same person in front of two places makes them more alike: what the mask is for
    EXPECT_GT(FernDatabase::similarity(places.encode(with_person(place(2), false)),
                                       places.encode(with_person(place(3), false))),
              different + 0.1f);
}

TEST(Ferns, KeyframesAreAddedForNewViewsOnly) {
    FernDatabase places = database();
    const Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
    EXPECT_TRUE(places.add(places.encode(place(1)), origin, 0));
    EXPECT_FALSE(places.add(places.encode(with_noise(place(1), 3)), origin, 1));
    EXPECT_TRUE(places.add(places.encode(place(2)), origin, 2));
    EXPECT_FALSE(
        places.add(places.encode(Thumbnail{kWidth, kHeight, std::vector<ThumbnailPixel>(kWidth * kHeight)}), origin, 3))
        << "nothing is visible";
    ASSERT_EQ(places.keyframes().size(), 2u);
    EXPECT_EQ(places.keyframes()[1].frame, 2u);
}

TEST(Ferns, QueryReturnsOldUnblockedKeyframesMostSimilarFirst) {
    FernDatabase places = database();
    const Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();
    for (unsigned k = 1; k <= 3; ++k) ASSERT_TRUE(places.add(places.encode(place(k)), origin, 10 * k));
    const FernCode view = places.encode(with_noise(place(2), 5));
    auto matches = places.query(view, 5, 100, 100);
    ASSERT_FALSE(matches.empty());
    EXPECT_EQ(matches[0].keyframe, 1u);
    for (std::size_t i = 1; i < matches.size(); ++i) EXPECT_LE(matches[i].similarity, matches[i - 1].similarity);
    EXPECT_EQ(places.query(view, 1, 100, 100).size(), 1u);
    for (const FernMatch& match : places.query(view, 5, 100, 20))
        EXPECT_LT(places.keyframes()[match.keyframe].frame, 20u);
    places.keyframes()[1].blocked_until = 120;
    for (const FernMatch& match : places.query(view, 5, 100, 100)) EXPECT_NE(match.keyframe, 1u);
    EXPECT_EQ(places.query(view, 5, 120, 121)[0].keyframe, 1u);
}

TEST(Ferns, ThumbnailOfAnotherSizeIsRefused) {
    EXPECT_THROW((void)database().encode(Thumbnail{40, 30, std::vector<ThumbnailPixel>(1200)}), Error);
}

}  // namespace
}  // namespace posefusion
