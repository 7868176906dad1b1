#include "hosts/io/masks.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;
using test::TempFolder;

constexpr int kWidth = 32, kHeight = 24;

/// A recording of one frame that is never opened: only its camera matters here.
class Masks : public testing::Test {
protected:
    void SetUp() override {
        folder.write("camera.yaml", "fx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\nwidth: 32\nheight: 24\n");
        folder.write("associations.txt", "1.0 a.png 1.0 b.png\n");
        std::filesystem::create_directories(folder / "masks");
        LabelImage labels(kWidth, kHeight);
        for (int v = 8; v < 16; ++v)
            for (int u = 4; u < 12; ++u) labels(u, v) = 3;
        write_labels(folder / "masks/1.000000.png", labels);
        write_labels(folder / "masks/1.033333.png", LabelImage(kWidth, kHeight, 7));
        folder.write("masks/readme.png", "not a mask");
    }
    Recording open(float scale = 1) const {
        SourceOptions options;
        options.scale = scale;
        return Recording(folder.path(), options);
    }
    TempFolder folder;
};

TEST_F(Masks, AreFoundByStamp) {
    const Recording recording = open();
    const MaskFolder masks(folder / "masks", recording);
    EXPECT_EQ(masks.size(), 2u);
    EXPECT_EQ((*masks.load(stamp_of(1.01)))(5, 9), 3);
    EXPECT_EQ((*masks.load(stamp_of(1.01)))(3, 9), 0);
    EXPECT_EQ((*masks.load(stamp_of(1.05)))(3, 9), 7);
    EXPECT_FALSE(masks.load(stamp_of(1.06)));
    EXPECT_FALSE(masks.load(stamp_of(-5)));
}

/// Of single frames, so that the names alone would not tell.
TEST_F(Masks, MayBeNamedByStampsOfAnyUnit) {
    folder.write("associations.txt", "1305031102.175304 a.png 1 b.png\n1305031109.211214 a.png 1 b.png\n");
    const Recording recording = open();
    for (const char* name : {"1305031109.211214", "1305031109211", "1305031109211214", "1305031109211214000"}) {
        const std::filesystem::path masks = folder / (std::string("masks_") + name);
        std::filesystem::create_directories(masks);
        write_labels(masks / (std::string(name) + ".png"), LabelImage(kWidth, kHeight, 7));
        const MaskFolder found(masks, recording);
        EXPECT_EQ(found.frames_without(), 1u) << name;
        EXPECT_TRUE(found.load(recording.frames()[1].stamp)) << name;
    }
}

/// Masks with the labels 1, 2 ... under these names, and which of them each frame of the recording gets (0: none).
std::vector<int> labels_of_frames(const TempFolder& folder, const Recording& recording,
                                  const std::vector<std::string>& names) {
    const std::filesystem::path masks = folder / ("masks_" + names.front());
    std::filesystem::create_directories(masks);
    for (std::size_t i = 0; i < names.size(); ++i)
        write_labels(masks / (names[i] + ".png"), LabelImage(kWidth, kHeight, static_cast<std::uint8_t>(i + 1)));
    const MaskFolder found(masks, recording);
    std::vector<int> labels;
    for (const FrameEntry& frame : recording.frames()) {
        const auto mask = found.load(frame.stamp);
        labels.push_back(mask ? (*mask)(0, 0) : 0);
    }
    return labels;
}

TEST_F(Masks, MayBeNamedByTheNumberOfTheFrame) {
    std::string pairs;
    for (int i = 0; i < 5; ++i) pairs += "1305031102." + std::to_string(100000 + 50000 * i) + " a.png 1 b.png\n";
    folder.write("associations.txt", pairs);
    const Recording recording = open();
    ASSERT_EQ(recording.size(), 5u);
    EXPECT_EQ(labels_of_frames(folder, recording, {"000000", "000001", "000002", "000003", "000004"}),
              (std::vector{1, 2, 3, 4, 5}));
    EXPECT_EQ(labels_of_frames(folder, recording, {"0", "4"}), (std::vector{1, 0, 0, 0, 2}))
        << "from 0, if either fits";
    EXPECT_EQ(labels_of_frames(folder, recording, {"1", "2", "3", "4", "5"}), (std::vector{1, 2, 3, 4, 5}));
    EXPECT_EQ(labels_of_frames(folder, recording, {"1305031102.200000", "1"}), (std::vector{0, 0, 1, 0, 0}))
        << "stamps go before numbers";

    SourceOptions options;
    options.selection = {{1, {}}, 2};
    const Recording selected(folder.path(), options);
    EXPECT_EQ(labels_of_frames(folder, selected, {"000000", "000001", "000002", "000003", "000004"}),
              (std::vector{2, 4}))
        << "numbers are those of the whole recording";
}

TEST_F(Masks, OfNumberedImagesHaveTheirNumbers) {
    std::filesystem::remove(folder / "associations.txt");
    for (const char* part : {"color", "depth"}) std::filesystem::create_directories(folder / part);
    for (const int number : {10, 20, 25}) {
        write_png(folder / ("color/" + std::to_string(number) + ".png"), ColorImage(kWidth, kHeight));
        write_raw_depth(folder / ("depth/" + std::to_string(number) + ".png"), RawDepth(kWidth, kHeight));
    }
    const Recording recording = open();
    EXPECT_EQ(labels_of_frames(folder, recording, {"10", "20", "25"}), (std::vector{1, 2, 3}));
    EXPECT_EQ(labels_of_frames(folder, recording, {"00020"}), (std::vector{0, 1, 0}));
    EXPECT_EQ(labels_of_frames(folder, recording, {"0.333333", "0.833333"}), (std::vector{1, 0, 2}))
        << "as they are saved";
}

TEST_F(Masks, MayLieInTheFolderMasksOfTheGivenOne) {
    const Recording recording = open();
    EXPECT_EQ(MaskFolder(folder.path(), recording).size(), 2u);
}

TEST_F(Masks, FollowTheScaleOfTheRun) {
    const Recording recording = open(0.5f);
    const LabelImage half = *MaskFolder(folder / "masks", recording).load(stamp_of(1.0));
    ASSERT_EQ(half.width(), kWidth / 2);
    EXPECT_EQ(half(2, 4), 3);
    EXPECT_EQ(half(1, 4), 0);
    EXPECT_EQ(half(5, 7), 3);
    EXPECT_EQ(half(6, 8), 0);
}

TEST_F(Masks, WrittenAtHalfScaleReadBackTheSame) {
    const Recording recording = open(0.5f);
    LabelImage labels(kWidth / 2, kHeight / 2);
    for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = static_cast<std::uint8_t>(i % 4);
    std::filesystem::create_directories(folder / "out");
    write_mask(folder / "out", "1.000000", labels, recording);
    EXPECT_EQ(image_file_size(folder / "out/1.000000.png"), (ImageSize{kWidth, kHeight}))
        << "masks have the recording's size";
    const LabelImage read = *MaskFolder(folder / "out", recording).load(stamp_of(1.0));
    EXPECT_TRUE(std::equal(read.begin(), read.end(), labels.begin()));
}

TEST_F(Masks, FaultsAreNamed) {
    const Recording recording = open();
    const auto fault = [&](const char* name) {
        return message_of<Error>([&] { MaskFolder(folder / name, recording); });
    };
    EXPECT_NE(fault("none").find("mask folder not found"), std::string::npos);
    std::filesystem::create_directories(folder / "empty");
    EXPECT_NE(fault("empty").find("holds no masks"), std::string::npos);
    write_labels(folder / "masks/1.000000.png", LabelImage(64, 48));
    const MaskFolder masks(folder / "masks", recording);
    EXPECT_NE(message_of<Error>([&] { (void)masks.load(stamp_of(1.0)); }).find("64x48, expected 32x24"),
              std::string::npos);
}

TEST_F(Masks, ClassesPickTheLabelsThatArePeople) {
    const Recording recording = open();
    std::filesystem::create_directories(folder / "classes");
    LabelImage values(kWidth, kHeight);
    values(1, 1) = 15;
    values(2, 2) = 7;
    values(3, 3) = 255;
    write_labels(folder / "classes/1.000000.png", values);
    const LabelImage some = *MaskFolder(folder / "classes", recording, {255, 15}).load(stamp_of(1.0));
    EXPECT_EQ(some(1, 1), 2) << "the place in the list";
    EXPECT_EQ(some(2, 2), 0) << "another class: static";
    EXPECT_EQ(some(3, 3), 1);
    EXPECT_EQ(some(0, 0), 0);
    const LabelImage background = *MaskFolder(folder / "classes", recording, {0}).load(stamp_of(1.0));
    EXPECT_EQ(background(0, 0), 1) << "0 may be a class of people, too";
    EXPECT_EQ(background(1, 1), 0);
    const LabelImage all = *MaskFolder(folder / "classes", recording).load(stamp_of(1.0));
    EXPECT_EQ(all(1, 1), 15);
    EXPECT_EQ(all(3, 3), 255);
    EXPECT_NE(message_of<Error>([&] { MaskFolder(folder / "classes", recording, std::vector<int>(256, 1)); }), "");
}

TEST_F(Masks, MayHaveSixteenBits) {
    const Recording recording = open();
    std::filesystem::create_directories(folder / "wide");
    RawDepth values(kWidth, kHeight);
    values(1, 1) = 1000;
    values(2, 2) = 3;
    values(3, 3) = 256;
    write_raw_depth(folder / "wide/1.000000.png", values);
    const LabelImage picked = *MaskFolder(folder / "wide", recording, {1000}).load(stamp_of(1.0));
    EXPECT_EQ(picked(1, 1), 1);
    EXPECT_EQ(picked(2, 2), 0);
    const LabelImage all = *MaskFolder(folder / "wide", recording).load(stamp_of(1.0));
    EXPECT_EQ(all(2, 2), 3);
    EXPECT_NE(all(1, 1), 0);
    EXPECT_NE(all(3, 3), 0) << "a value whose low byte is 0 is a person all the same";
    EXPECT_EQ(all(0, 0), 0);
}

TEST_F(Masks, FramesWithoutOneAreCounted) {
    const Recording recording = open();
    EXPECT_EQ(MaskFolder(folder / "masks", recording).frames_without(), 0u);
    std::filesystem::create_directories(folder / "far");
    write_labels(folder / "far/77.000000.png", LabelImage(kWidth, kHeight));
    EXPECT_NE(message_of<Error>([&] { MaskFolder(folder / "far", recording); }).find("no mask belongs to a frame"),
              std::string::npos);
    write_labels(folder / "far/1.000000.png", LabelImage(kWidth, kHeight));
    const MaskFolder masks(folder / "far", recording);
    EXPECT_EQ(masks.frames_without(), recording.size() - 1);
    EXPECT_TRUE(masks.load(stamp_of(1.0)));
    EXPECT_FALSE(masks.load(stamp_of(5.0))) << "nobody is known to be there";
}

}  // namespace
}  // namespace posefusion
