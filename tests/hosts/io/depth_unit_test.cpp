#include "hosts/io/depth_unit.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

std::optional<std::string> judge(float median_value, float depth_scale) {
    const auto middle = static_cast<std::uint16_t>(median_value);
    return judge_depth_unit({static_cast<std::uint16_t>(middle - 1), middle, static_cast<std::uint16_t>(middle + 1)},
                            depth_scale, "room");
}

std::string refusal(float median_value, float depth_scale) {
    return message_of<Error>([&] { (void)judge(median_value, depth_scale); });
}

TEST(DepthUnit, RoomsOfAnySizeAreInOrder) {
    for (const float metres : {1.1f, 2.0f, 5.0f, 13.0f})
        for (const float scale : {1000.0f, 5000.0f})
            EXPECT_FALSE(judge(metres * scale, scale)) << metres << " m at " << scale;
    EXPECT_FALSE(judge(49.0f * 1000, 1000));
    EXPECT_FALSE(judge(0.3f * 1000, 1000)) << "only TUM's units may be a default";
    std::vector<std::uint16_t> desk(40);  // 0.4 m
    for (std::size_t i = 0; i < desk.size(); ++i) desk[i] = static_cast<std::uint16_t>(2000 + 5 * i);
    EXPECT_FALSE(judge_depth_unit(desk, 5000, "desk")) << "a sensor measured whole millimetres";
    ++desk[3], ++desk[5];
    EXPECT_TRUE(judge_depth_unit(desk, 5000, "desk"));
}

TEST(DepthUnit, NoRoomIsSoSmallOrSoLarge) {
    EXPECT_EQ(refusal(10000, 1),
              "room: the median depth of the first images is 10000.00 m (depth_scale: 1), which no room has; with "
              "depth_scale: 5000 it would be 2.00 m; set depth_scale in the camera file (--camera FILE)");
    EXPECT_TRUE(has(refusal(10000, 0.001f), "(depth_scale: 0.001)")) << refusal(10000, 0.001f);
    EXPECT_TRUE(has(refusal(2000, 1), "with depth_scale: 1000 it would be 2.00 m"));
    EXPECT_TRUE(has(refusal(2, 5000), "with depth_scale: 1 it would be 2.00 m"));
    EXPECT_EQ(refusal(49 * 1000.0f, 1000), "");
    EXPECT_NE(refusal(51 * 1000.0f, 1000), "");
    EXPECT_EQ(refusal(0.051f * 1000, 1000), "");
    EXPECT_NE(refusal(0.049f * 1000, 1000), "");
}

TEST(DepthUnit, MillimetresReadInTumUnitsAreNamed) {
    EXPECT_TRUE(judge(3750, 5000)) << "of large rooms, too";
    const auto warning = judge(2500, 5000);
    ASSERT_TRUE(warning);
    EXPECT_TRUE(has(*warning, "is 0.50 m (depth_scale: 5000)")) << *warning;
    EXPECT_TRUE(has(*warning, "in millimetres (2.50 m), set depth_scale: 1000")) << *warning;
}

/// Frames of one depth each, in units of 1 / 1000 m; 0: the image cannot be read.
class Depths final : public FrameSource {
public:
    explicit Depths(std::vector<std::uint16_t> values, bool live = false) : values_(std::move(values)) {
        facts_.location = "room";
        facts_.camera.depth_scale = 1000;
        facts_.live = live;
        for (std::size_t i = 0; i < values_.size(); ++i) facts_.frames.push_back(entry_at(std::chrono::seconds(i)));
    }
    RawFrame read(std::size_t i) const override {
        if (values_[i] == 0) throw Error("torn");
        RawFrame frame;
        frame.depth = RawDepth(20, 20, values_[i]);
        return frame;
    }

private:
    std::vector<std::uint16_t> values_;
};

TEST(DepthUnit, TheFirstUsableImagesAreMeasured) {
    EXPECT_FALSE(check_depth_unit(Depths({2000, 2000, 2000, 3, 3, 3})));
    EXPECT_THROW((void)check_depth_unit(Depths({0, 3, 2000, 3, 2000})), Error) << "2 of the first 3 that can be read";
    EXPECT_FALSE(check_depth_unit(Depths({0, 0, 65535}))) << "nothing was measured";
    EXPECT_FALSE(check_depth_unit(Depths({}))) << "nothing is there";
    EXPECT_FALSE(check_depth_unit(Depths({3, 3, 3}, true))) << "a camera's driver knows its unit";
}

}  // namespace
}  // namespace posefusion::test
