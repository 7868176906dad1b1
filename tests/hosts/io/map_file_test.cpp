#include "hosts/io/map_file.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;
using test::read_all;
using test::TempFolder;

ByteArray bytes_of(std::size_t count, int first) {
    ByteArray bytes;
    for (std::size_t i = 0; i < count; ++i) bytes.push_back(static_cast<std::byte>(first + static_cast<int>(i)));
    return bytes;
}

Eigen::Isometry3d pose_at(double x) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation().x() = x;
    return pose;
}

/// Every field holds something of its own.
SlamState small_state() {
    SlamState s;
    s.camera = {100.5f, 101.5f, 31.25f, 23.75f, 64, 48};
    s.frames = 3;
    s.map = {1024, 2, 1, bytes_of(20, 1), bytes_of(32, 2), bytes_of(32, 3), bytes_of(32, 4)};
    s.tracking = {bytes_of(9, 5), bytes_of(8, 6), bytes_of(7, 7)};
    s.back_end.ferns = {4, 8, 7, 5.5f};
    s.back_end.keyframes = {{1, pose_at(0.1), {{1, 2, FernCode::kNoCode, 15}, 3}, 44},
                            {2, pose_at(1.0 / 3), {{}, 0}, 0}};
    s.back_end.trajectory = {pose_at(0), pose_at(0.1), pose_at(-0.0)};
    s.back_end.information = {Matrix6d::Zero(), Matrix6d::Identity(), 3 * Matrix6d::Identity()};
    LoopConstraint constraint;
    constraint.source = {1, 2, 3};
    constraint.source_time = 4;
    constraint.target = {5, 6, 7};
    constraint.target_time = 8;
    constraint.relative = constraint.by_camera = true;
    s.back_end.relative_constraints = {constraint};
    s.back_end.relocalisation.failures = 9;
    s.back_end.pending_loop.overlap = 0.25f;
    s.back_end.pending_loop.last_seen = 10;
    s.back_end.pending_loop.since = 13;
    s.back_end.relocalisation.found = pose_at(11);
    s.back_end.relocalisation.proposal = 12;
    return s;
}

class MapFile : public testing::Test {
protected:
    void SetUp() override {
        write_map(file(), small_state());
        content_ = read_all(file());
    }
    [[nodiscard]] std::filesystem::path file() const { return folder_ / "room.pfmap"; }
    /// What reading a file of this content says.
    [[nodiscard]] std::string error_of(const std::string& content) const {
        folder_.write("bad.pfmap", content);
        return message_of<Error>([&] { (void)read_map(folder_ / "bad.pfmap"); });
    }
    TempFolder folder_;
    std::string content_;
};

TEST_F(MapFile, ComesBackAsItWas) {
    const SlamState was = small_state(), is = read_map(file());
    EXPECT_EQ(is.camera, was.camera);
    EXPECT_EQ(is.frames, was.frames);
    EXPECT_EQ(is.map.capacity, was.map.capacity);
    EXPECT_EQ(is.map.slots, was.map.slots);
    EXPECT_EQ(is.map.alive, was.map.alive);
    EXPECT_EQ(is.map.counters, was.map.counters);
    EXPECT_EQ(is.map.position_confidence, was.map.position_confidence);
    EXPECT_EQ(is.map.normal_radius, was.map.normal_radius);
    EXPECT_EQ(is.map.appearance, was.map.appearance);
    EXPECT_EQ(is.tracking.record, was.tracking.record);
    EXPECT_EQ(is.tracking.previous_live, was.tracking.previous_live);
    EXPECT_EQ(is.tracking.model, was.tracking.model);
    EXPECT_EQ(is.back_end.ferns, was.back_end.ferns);
    ASSERT_EQ(is.back_end.keyframes.size(), 2u);
    EXPECT_EQ(is.back_end.keyframes[0].code.ferns, was.back_end.keyframes[0].code.ferns);
    EXPECT_EQ(is.back_end.keyframes[0].code.good, 3);
    EXPECT_EQ(is.back_end.keyframes[0].blocked_until, 44u);
    EXPECT_EQ(is.back_end.keyframes[1].frame, 2u);
    EXPECT_EQ(is.back_end.keyframes[1].T_world_camera.matrix(), pose_at(1.0 / 3).matrix());
    ASSERT_EQ(is.back_end.trajectory.size(), 3u);
    EXPECT_EQ(is.back_end.trajectory[1].matrix(), pose_at(0.1).matrix());
    EXPECT_TRUE(std::signbit(is.back_end.trajectory[2].translation().x())) << "bits, not values";
    EXPECT_EQ(is.back_end.information, was.back_end.information);
    ASSERT_EQ(is.back_end.relative_constraints.size(), 1u);
    EXPECT_EQ(is.back_end.relative_constraints[0].target.z(), 7);
    EXPECT_EQ(is.back_end.relative_constraints[0].target_time, 8u);
    EXPECT_TRUE(is.back_end.relative_constraints[0].relative);
    EXPECT_FALSE(is.back_end.relative_constraints[0].pin);
    EXPECT_TRUE(is.back_end.relative_constraints[0].by_camera);
    EXPECT_EQ(is.back_end.relocalisation.failures, 9);
    EXPECT_EQ(is.back_end.pending_loop.overlap, 0.25f);
    EXPECT_EQ(is.back_end.pending_loop.last_seen, 10u);
    EXPECT_EQ(is.back_end.pending_loop.since, 13u);
    ASSERT_TRUE(is.back_end.relocalisation.found.has_value());
    EXPECT_EQ(is.back_end.relocalisation.found->translation().x(), 11);
    EXPECT_EQ(is.back_end.relocalisation.proposal, 12u);

    write_map(folder_ / "again.pfmap", is);
    EXPECT_EQ(read_all(folder_ / "again.pfmap"), content_);
}

TEST_F(MapFile, EveryTruncationIsOneClearLine) {
    for (std::size_t length = 0; length < content_.size(); ++length) {
        const std::string error = error_of(content_.substr(0, length));
        ASSERT_NE(error.find("bad.pfmap"), std::string::npos) << length;
        ASSERT_NE(error.find(length == 0 ? "is no map file" : "cut short"), std::string::npos)
            << length << ": " << error;
        ASSERT_EQ(error.find('\n'), std::string::npos);
    }
    EXPECT_EQ(error_of(content_), "") << "the whole file is fine";
    EXPECT_NE(error_of(content_ + "x").find("damaged"), std::string::npos) << "nor may it be longer";
}

TEST_F(MapFile, AFlippedBitInAnyByteIsNoticed) {
    for (std::size_t at = 0; at < content_.size(); ++at) {
        std::string spoilt = content_;
        spoilt[at] = static_cast<char>(spoilt[at] ^ (1 << at % 8));
        ASSERT_FALSE(error_of(spoilt).empty()) << "byte " << at;
    }
}

TEST_F(MapFile, ForeignFilesAndOtherVersionsAreNamed) {
    EXPECT_NE(error_of("ply\nformat binary_little_endian 1.0\n").find("is no map file of PoseFusion"),
              std::string::npos);
    std::string newer = content_;
    newer[12] = static_cast<char>(kStateVersion + 1);
    const std::string versions = "has version " + std::to_string(kStateVersion + 1) + ", this program reads version " +
                                 std::to_string(kStateVersion);
    EXPECT_NE(error_of(newer).find(versions), std::string::npos) << error_of(newer);
    write_sections(folder_ / "other", {{'C', 'H', 'K', 'P'}, 1, "checkpoint"}, {});
    EXPECT_NE(error_of(read_all(folder_ / "other")).find("is no map file"), std::string::npos);
    EXPECT_NE(message_of<Error>([&] { (void)read_map(folder_ / "none"); }).find("there is no such map file"),
              std::string::npos);
    EXPECT_NE(message_of<Error>([&] { (void)read_map(folder_.path()); }).find("is no map file"), std::string::npos);
}

TEST_F(MapFile, CountsThatTheBytesCannotHoldTakeNoMemory) {
    // a valid file whose list of poses claims to have 2^60
    const SlamState state = small_state();
    std::vector<Section> sections = sections_of(state);
    for (Section& section : sections) {
        if (section.name != "poses") continue;
        StateWriter out;
        out.put(std::uint64_t{1} << 60);
        section.own = out.take();
    }
    write_sections(folder_ / "lying", {{'M', 'A', 'P', ' '}, kStateVersion, "map file"}, sections);
    EXPECT_NE(message_of<Error>([&] { (void)read_map(folder_ / "lying"); }).find("'poses' is damaged"),
              std::string::npos);
}

TEST(StateReader, TakesNoMoreMemoryThanThereAreBytes) {
    struct Large {
        std::array<std::byte, 1 << 16> bytes;
    };
    constexpr std::uint64_t kMany = 1 << 24;  // a TiB of them
    StateWriter out;
    out.put(kMany);
    out.raw(ByteArray(kMany).data(), kMany);
    const ByteArray bytes = out.take();
    StateReader in(bytes, "list");
    EXPECT_EQ(message_of<Error>([&] { (void)in.list<Large>(1, [&]() -> Large { in.fail(); }); }),
              "list is damaged; use another file");
}

TEST_F(MapFile, ALackingSectionIsNamed) {
    const SlamState state = small_state();
    std::vector<Section> sections = sections_of(state);
    sections.pop_back();
    write_sections(folder_ / "less", {{'M', 'A', 'P', ' '}, kStateVersion, "map file"}, sections);
    EXPECT_NE(message_of<Error>([&] { (void)read_map(folder_ / "less"); }).find("lacks the section 'model'"),
              std::string::npos);
}

}  // namespace
}  // namespace posefusion
