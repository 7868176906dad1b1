#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "pose/detector.hpp"
#include "pose/image_rotation.hpp"
#include "pose/people.hpp"
#include "pose/rotating_detector.hpp"
#include "pose/rotation_search.hpp"
#include "tests/pose/support.hpp"

namespace posefusion {
namespace {

using testing::exact_text;
using testing::load_color;
using testing::shared_data;

constexpr std::array kRotations{ImageRotation::None, ImageRotation::Clockwise90, ImageRotation::Half,
                                ImageRotation::Clockwise270};
constexpr std::array kOthers{ImageRotation::Half, ImageRotation::Clockwise90, ImageRotation::Clockwise270};
constexpr Sighting kNobody{0, 0}, kClear{10, 0.8f}, kPoor{4, 0.45f}, kFurniture{4, 0.42f};

/// A spot of one colour at (u, v) in an image of 5 x 3.
ColorImage spot(int u, int v) {
    ColorImage image(5, 3);
    image(u, v) = {200, 100, 50};
    return image;
}

TEST(ImageRotation, OfAPixelAndBackInEveryRotation) {
    EXPECT_EQ(rotated(spot(4, 0), ImageRotation::Clockwise90)(2, 4), (Rgb8{200, 100, 50}))
        << "right top to right bottom";
    for (const ImageRotation rotation : kRotations) {
        const ColorImage turned = rotated(spot(3, 0), rotation);
        int found = 0;
        for (int v = 0; v < turned.height(); ++v) {
            for (int u = 0; u < turned.width(); ++u) {
                if (turned(u, v) != Rgb8{200, 100, 50}) continue;
                Person person;
                person.joints[Nose] = {static_cast<float>(u), static_cast<float>(v), 0.5f};
                const People back = rotated_back({person}, rotation, 5, 3);
                EXPECT_EQ(back[0].joints[Nose].u, 3) << degrees_of(rotation);
                EXPECT_EQ(back[0].joints[Nose].v, 0) << degrees_of(rotation);
                EXPECT_EQ(back[0].joints[Neck].p, 0) << "not found stays not found";
                ++found;
            }
        }
        EXPECT_EQ(found, 1);
    }
}

TEST(ImageRotation, OfABox) {
    Person person;
    person.box = {0, 1, 1, 4};  // in an image of 3 x 5
    EXPECT_EQ(rotated_back({person}, ImageRotation::Clockwise90, 5, 3)[0].box.u_min, 1);
    EXPECT_EQ(rotated_back({person}, ImageRotation::Clockwise90, 5, 3)[0].box.v_min, 1);
    EXPECT_EQ(rotated_back({person}, ImageRotation::Clockwise90, 5, 3)[0].box.u_max, 4);
    EXPECT_EQ(rotated_back({person}, ImageRotation::Clockwise90, 5, 3)[0].box.v_max, 2);
    person.box = {};
    EXPECT_TRUE(rotated_back({person}, ImageRotation::Half, 5, 3)[0].box.empty()) << "none stays none";
}

/// Shows `images` in which people are seen so in each rotation. @return how many were looked at twice
int show(RotationSearch& search, int images, const std::array<Sighting, 4>& seen) {
    int twice = 0;
    for (int i = 0; i < images; ++i) {
        const Sighting now = seen[static_cast<std::size_t>(search.present())];
        const auto other = search.other_to_try(now);
        if (!other) continue;
        EXPECT_NE(*other, search.present());
        search.compare(now, seen[static_cast<std::size_t>(*other)]);
        ++twice;
    }
    return twice;
}

TEST(RotationSearch, StaysUprightAtTheCostOfFewImages) {
    RotationSearch search;
    EXPECT_EQ(show(search, 8, {kClear, kPoor, kPoor, kPoor}), 3);
    EXPECT_LE(show(search, 640, {kClear, kPoor, kPoor, kPoor}), 14);
    EXPECT_EQ(search.present(), ImageRotation::None);
}

TEST(RotationSearch, LooksMoreOftenWhereNobodyIsSeenAndTakesFurnitureForNobody) {
    RotationSearch search;
    EXPECT_EQ(show(search, 16, {kNobody, kFurniture, kFurniture, kNobody}), 16);
    EXPECT_EQ(show(search, 640, {kNobody, kFurniture, kFurniture, kNobody}), 80);
    EXPECT_EQ(search.present(), ImageRotation::None);
}

TEST(RotationSearch, FindsEveryRotationInTheFirstImages) {
    for (const ImageRotation truth : kOthers) {
        RotationSearch search;
        std::array<Sighting, 4> seen{kPoor, kPoor, kPoor, kPoor};
        seen[static_cast<std::size_t>(truth)] = kClear;
        show(search, truth == ImageRotation::Half ? 2 : 5, seen);
        EXPECT_EQ(search.present(), truth) << degrees_of(truth);
        show(search, 300, seen);
        EXPECT_EQ(search.present(), truth) << "and keeps it";
    }
}

TEST(RotationSearch, FollowsACameraThatIsTurnedLater) {
    RotationSearch search;
    show(search, 500, {kClear, kPoor, kPoor, kPoor});
    show(search, 3 * 64 + 1, {kPoor, kPoor, kClear, kPoor});
    EXPECT_EQ(search.present(), ImageRotation::Half);
}

TEST(RotationSearch, FindsWhoComesIntoAnEmptyView) {
    RotationSearch search;
    show(search, 300, {kNobody, kNobody, kNobody, kNobody});
    show(search, 2 * 8 + 1, {kNobody, kPoor, kClear, kPoor});
    EXPECT_EQ(search.present(), ImageRotation::Half);
}

TEST(RotationSearch, OneBetterImageIsNotEnough) {
    RotationSearch search;
    for (int i = 0; i < 100; ++i) {
        const auto other = search.other_to_try(kPoor);
        if (other) search.compare(kPoor, i % 2 == 0 ? kClear : kPoor);
        ASSERT_EQ(search.present(), ImageRotation::None);
    }
    EXPECT_FALSE(RotationSearch().compare(kClear, {12, 0.8f})) << "hardly better";
}

TEST(RotationSearch, GoesOnWhereItsStateWasTaken) {
    const std::array<Sighting, 4> seen{kPoor, kPoor, kClear, kPoor};
    RotationSearch first;
    show(first, 1, seen);
    RotationSearch second;
    second.restore(first.state());
    EXPECT_EQ(second.state(), first.state());
    show(second, 1, seen);
    EXPECT_EQ(second.present(), ImageRotation::Half);
    ByteArray damaged = first.state();
    damaged[0] = std::byte{9};
    EXPECT_THROW(second.restore(damaged), Error);
    EXPECT_THROW(second.restore({}), Error);
    EXPECT_EQ(second.present(), ImageRotation::Half) << "nothing has changed";
}

std::vector<ColorImage> photographs() {
    const std::filesystem::path folder = shared_data() / "house" / "walk_xyz";
    const nlohmann::json truth = nlohmann::json::parse(std::ifstream(folder / "joints.json"));
    std::vector<ColorImage> images;
    for (std::size_t i = 20; i < 44; i += 2) {
        const std::string name = truth.at("frames").at(i).at("rgb").get<std::string>() + ".jpg";
        images.push_back(load_color(folder / "rgb" / name));
    }
    return images;
}

std::vector<People> detect(const PoseConfig& config, const std::vector<ColorImage>& images) {
    const auto detector = make_joint_detector(config);
    std::vector<People> all;
    for (const ColorImage& image : images) all.push_back(detector->detect(image));
    return all;
}

PoseConfig with_rotation(std::optional<ImageRotation> rotation) {
    PoseConfig config;
    config.rotate = rotation;
    return config;
}

TEST(RotatingDetector, PeopleAreTheSameHoweverTheCameraIsHeld) {
    POSEFUSION_REQUIRE_DATA(shared_data() / "house");
    const std::vector<ColorImage> upright = photographs();
    const std::vector<People> expected = detect(with_rotation(ImageRotation::None), upright);
    for (std::size_t i = 0; i < upright.size(); ++i) {
        EXPECT_EQ(exact_text(detect(with_rotation(std::nullopt), upright)[i]), exact_text(expected[i]))
            << "upright, the search changes nothing";
    }
    for (const ImageRotation rotation : kOthers) {
        std::vector<ColorImage> turned;
        for (const ColorImage& image : upright) turned.push_back(rotated(image, rotation));
        const ImageRotation back = static_cast<ImageRotation>((4 - static_cast<int>(rotation)) % 4);
        const std::vector<People> told = detect(with_rotation(back), turned);
        const std::vector<People> found = detect(with_rotation(std::nullopt), turned);
        for (std::size_t i = 0; i < upright.size(); ++i) {
            const People in_upright = rotated_back(told[i], rotation, upright[i].width(), upright[i].height());
            EXPECT_LT(testing::largest_difference(in_upright, expected[i]), 1e-3f) << degrees_of(rotation);
        }
        EXPECT_EQ(exact_text(found.back()), exact_text(told.back())) << degrees_of(rotation) << " was not recognised";
    }
}

TEST(RotatingDetector, SaysHowItLooks) {
    const auto description = [](std::optional<ImageRotation> rotation) {
        return make_joint_detector(with_rotation(rotation))->description();
    };
    EXPECT_EQ(description(std::nullopt), description(ImageRotation::None));
    EXPECT_NE(description(ImageRotation::Half).find("rotated by 180 degrees"), std::string::npos);
}

}  // namespace
}  // namespace posefusion
