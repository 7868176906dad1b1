#include "hosts/io/frame_selection.hpp"

#include <gtest/gtest.h>

#include "hosts/io/recording.hpp"
#include "hosts/io/sources/selected_frames.hpp"
#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

using std::chrono::milliseconds;

TEST(FrameStart, IsAFrameOrATime) {
    EXPECT_EQ(parse_frame_start("40"), (FrameStart{40, {}}));
    EXPECT_EQ(parse_frame_start("1.5s"), (FrameStart{0, milliseconds(1500)}));
    EXPECT_EQ(parse_frame_start("0s"), FrameStart{});
    for (const char* text : {"0", "7", "1.5s", "0.001s"}) EXPECT_EQ(text_of(parse_frame_start(text)), text);
    for (const char* text : {"", "-1", "1.5", "s", "-2s", "nans", "1e99s", "1 s", "x", "99999999999999999999"})
        EXPECT_TRUE(
            has(message_of<Error>([&] { (void)parse_frame_start(text); }), "give a frame (40) or seconds (1.5s)"))
            << text;
}

/// Ten frames a second, each with its number as colour.
class Numbered final : public FrameSource {
public:
    explicit Numbered(std::size_t frames, bool live = false) {
        facts_.location = "room";
        facts_.camera.intrinsics = {4, 4, 2, 2, 4, 4};
        facts_.live = live;
        for (std::size_t i = 0; i < frames && !live; ++i) facts_.frames.push_back(entry_at(stamp(i)));
    }
    RawFrame read(std::size_t i) const override {
        if (facts_.live) i = arrived_++;
        RawFrame frame;
        frame.stamp = stamp(i);
        frame.color = ColorImage(1, 1, {static_cast<std::uint8_t>(i), 0, 0});
        return frame;
    }
    std::optional<Trajectory> groundtruth() const override { return Trajectory(3); }

private:
    static Stamp stamp(std::size_t i) { return milliseconds(5000 + 100 * i); }
    mutable std::size_t arrived_ = 0;
};

std::vector<int> numbers_of(const FrameSource& source, std::size_t count) {
    std::vector<int> numbers;
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(source.read(i).color(0, 0).r);
    return numbers;
}

std::vector<int> selected(const FrameSelection& selection) {
    const auto source = select_frames(std::make_unique<Numbered>(10), selection);
    EXPECT_EQ(source->size(), source->facts().frames.size());
    for (std::size_t i = 0; i < source->size(); ++i) EXPECT_EQ(source->facts().frames[i].stamp, source->read(i).stamp);
    return numbers_of(*source, source->size());
}

TEST(FrameSelection, OfARecordingIsByNumberAndTime) {
    EXPECT_EQ(selected({}), (std::vector{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
    EXPECT_EQ(selected({{7, {}}, 1}), (std::vector{7, 8, 9}));
    EXPECT_EQ(selected({{0, milliseconds(650)}, 1}), (std::vector{7, 8, 9}));
    EXPECT_EQ(selected({{0, milliseconds(700)}, 1}), (std::vector{7, 8, 9})) << "exactly then";
    EXPECT_EQ(selected({{0, {}}, 4}), (std::vector{0, 4, 8}));
    EXPECT_EQ(selected({{1, {}}, 4}), (std::vector{1, 5, 9}));
    EXPECT_EQ(selected({{9, {}}, std::numeric_limits<std::size_t>::max()}), std::vector{9});
    EXPECT_TRUE(select_frames(std::make_unique<Numbered>(10), {{9, {}}, 1})->groundtruth());
}

TEST(FrameSelection, KnowsThePlacesInTheRecording) {
    const Recording all(std::make_unique<Numbered>(10));
    EXPECT_EQ(all.frame_at(4), &all.frames()[4]);
    EXPECT_EQ(all.frame_at(10), nullptr);
    const Recording some(select_frames(std::make_unique<Numbered>(10), {{1, {}}, 4}));
    EXPECT_EQ(some.frame_at(5), &some.frames()[1]);
    for (const std::size_t other : {0, 4, 6, 10}) EXPECT_EQ(some.frame_at(other), nullptr);
}

TEST(FrameSelection, LeavesSomething) {
    const auto refusal = [](const FrameStart& start) {
        return message_of<Error>([&] { (void)select_frames(std::make_unique<Numbered>(10), {start, 1}); });
    };
    EXPECT_EQ(refusal({10, {}}), "room: --start 10 leaves nothing of its 10 frames (0.9 s); give an earlier one");
    EXPECT_EQ(refusal({0, milliseconds(901)}),
              "room: --start 0.901s leaves nothing of its 10 frames (0.9 s); give an earlier one");
}

TEST(FrameSelection, OfACameraIsByArrival) {
    const auto first_three = [](const FrameSelection& selection) {
        return numbers_of(*select_frames(std::make_unique<Numbered>(0, true), selection), 3);
    };
    EXPECT_EQ(first_three({{0, {}}, 5}), (std::vector{0, 5, 10}));
    EXPECT_EQ(first_three({{4, {}}, 2}), (std::vector{4, 6, 8}));
    EXPECT_EQ(first_three({{0, milliseconds(250)}, 1}), (std::vector{3, 4, 5}));
}

}  // namespace
}  // namespace posefusion::test
