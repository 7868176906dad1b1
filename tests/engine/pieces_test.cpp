#include <algorithm>
#include <cstring>
#include <optional>
#include <span>

#include "engine/core/byte_elements.hpp"
#include "engine/core/error.hpp"
#include "engine/slam/map_piece.hpp"
#include "engine/vulkan/pose_conversion.hpp"
#include "engine/vulkan/shared_types.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// A camera that is lost and goes on to places it has not seen: a new piece of map begins, and joins the old one where
// both show the same.
namespace posefusion::test {
namespace {

constexpr double kMaxError = 0.03;              // metres; as loops_test.cpp
constexpr double kMaxSurfelError = 0.06;        // metres, of the worst surfel, at the far end of what has drifted
constexpr int kLostAfter = 3, kBeginAfter = 8;  // frames

/// Camera on a circle of 0.3 m, looking outwards, `degrees` from the start.
Isometry3d around(double degrees) {
    const Isometry3d turn = motion({0, 0, 0}, {0, 1, 0}, degrees), out = motion({0, 0, 0.3}, {0, 1, 0}, 0);
    return out.inverse() * turn * out;
}

class PiecesTest : public SlamTest {
protected:
    static SlamConfig config() {
        SlamConfig config = test_config();
        config.loops.time_window = 50;
        config.loops.interval = 3;
        config.map.stable_confidence = 4;  // a place is seen for few frames here
        config.relocalisation.lost_after = kLostAfter;
        config.pieces.begin_after = kBeginAfter;
        return config;
    }
    FrameResult see(Slam& slam, double degrees, std::span<const StartPose> starts = {}) {
        truth.push_back(around(degrees));
        const Frame frame = render_room(kSmall, truth.back());
        results.push_back(slam.process(frame.color, frame.depth, {}, {}, starts));
        return results.back();
    }
    /// Maps a part of the room, is lost, and begins a new piece where it has been before, which it does not leave.
    /// @param by_features  degrees from there to where features say that it is; nullopt: they recognise nothing
    void stand_where_it_has_been(Slam& slam, std::optional<double> by_features) {
        turn(slam, 0, 80);
        for (int k = 1; k < kBeginAfter; ++k) (void)see(slam, 180);
        constexpr double kPlace = 10;
        for (int k = 0; k < 20; ++k) {
            StartPose start;
            start.age = static_cast<std::uint32_t>(results.size());  // since the first frame
            start.T_earlier_current = around(0).inverse() * around(kPlace + by_features.value_or(0));
            (void)see(slam, kPlace, std::span(&start, by_features ? 1 : 0));
        }
        ASSERT_EQ(count(MapChange::NewPiece), 1);
        EXPECT_EQ(frame_of(MapChange::NewPiece), 40u + kBeginAfter - 1);
    }
    void turn(Slam& slam, double from, double to, double step = 2) {
        for (double degrees = from; step > 0 ? degrees < to : degrees > to; degrees += step) (void)see(slam, degrees);
    }
    [[nodiscard]] std::ptrdiff_t count(MapChange change) const {
        return std::count_if(results.begin(), results.end(),
                             [&](const FrameResult& result) { return result.map_change == change; });
    }
    [[nodiscard]] std::uint32_t frame_of(MapChange change) const {
        const auto found = std::find_if(results.begin(), results.end(),
                                        [&](const FrameResult& result) { return result.map_change == change; });
        return static_cast<std::uint32_t>(found - results.begin());
    }
    /// Every pose of the piece that was found at the time must be where the camera was, as seen from its first camera.
    void expect_true_poses(const std::vector<std::uint32_t>& frames, const std::vector<Isometry3d>& poses) const {
        ASSERT_EQ(frames.size(), poses.size());
        for (std::size_t i = 0; i < frames.size(); ++i) {
            if (!has_pose(results[frames[i]].tracking)) continue;
            const Isometry3d expected = truth[frames.front()].inverse() * truth[frames[i]];
            const Isometry3d found = poses.front().inverse() * poses[i];
            EXPECT_LT((expected.inverse() * found).translation().norm(), kMaxError) << "frame " << frames[i];
        }
    }
    void expect_true_surfels(const std::vector<Surfel>& surfels, std::uint32_t first_frame) const {
        EXPECT_GT(surfels.size(), 1000u);
        for (const Surfel& surfel : surfels)
            ASSERT_LT(distance_to_room(truth[first_frame] * surfel.position.cast<double>()), kMaxSurfelError);
    }

    std::vector<Isometry3d> truth;
    std::vector<FrameResult> results;
};

TEST_F(PiecesTest, ANewPieceBeginsWhereTheCameraIsLostAndJoinsWhenItComesBack) {
    Slam slam(kSmall, config(), test_device());
    turn(slam, 0, 80);
    turn(slam, 180, 400);
    ASSERT_EQ(count(MapChange::NewPiece), 1) << "the camera has jumped to where it has never been";
    EXPECT_EQ(count(MapChange::StartedAgain), 0);
    ASSERT_EQ(count(MapChange::Joined), 1) << "it has come back to where it began";
    const std::uint32_t begun = frame_of(MapChange::NewPiece), joined = frame_of(MapChange::Joined);
    EXPECT_EQ(results[begun].tracking, TrackingState::FirstFrame);
    EXPECT_LE(begun, 40u + kBeginAfter);
    EXPECT_GT(joined, begun + 40);
    EXPECT_TRUE(slam.other_pieces().empty());

    const std::vector<std::uint32_t> frames = slam.frames();
    EXPECT_EQ(frames.size(), results.size()) << "all frames are in the one piece";
    expect_true_poses(frames, slam.trajectory());
    expect_true_surfels(slam.surfels(), 0);
    const Isometry3d back = truth[0].inverse() * truth.back();
    EXPECT_LT((back.inverse() * results.back().T_world_camera).translation().norm(), kMaxError)
        << "the world is that of the older piece";
    const auto& events = results[joined].loops;
    const auto event = std::find_if(events.begin(), events.end(), [](const LoopEvent& e) { return e.accepted; });
    ASSERT_NE(event, events.end());
    EXPECT_EQ(event->kind, LoopKind::Join);
    EXPECT_EQ(event->frame, joined);
    EXPECT_LT(event->model_frame, begun);
}

TEST_F(PiecesTest, PiecesThatNeverMeetAreKeptApartAndTheLargestIsTheMap) {
    Slam slam(kSmall, config(), test_device());
    turn(slam, 0, 100);
    turn(slam, 180, 260);
    ASSERT_EQ(count(MapChange::NewPiece), 1);
    EXPECT_EQ(count(MapChange::Joined), 0);
    const std::uint32_t begun = frame_of(MapChange::NewPiece);
    EXPECT_EQ(slam.frames().front(), begun) << "until the end the camera's piece is current";
    slam.choose_main_piece();
    EXPECT_EQ(slam.frames().front(), 0u) << "it has more tracked frames";
    EXPECT_EQ(slam.frames().size(), begun);
    expect_true_poses(slam.frames(), slam.trajectory());
    expect_true_surfels(slam.surfels(), 0);
    const std::vector<MapPiece> others = slam.other_pieces();
    ASSERT_EQ(others.size(), 1u);
    EXPECT_EQ(others[0].frames.front(), begun);
    EXPECT_EQ(others[0].frames.back() + 1, slam.frames_processed());
    expect_true_poses(others[0].frames, others[0].trajectory);
    expect_true_surfels(others[0].surfels, begun);
    slam.choose_main_piece();
    EXPECT_EQ(slam.frames().front(), 0u);
}

TEST_F(PiecesTest, ALostCameraIsFoundInAnotherPiece) {
    Slam slam(kSmall, config(), test_device());
    turn(slam, 0, 80);
    turn(slam, 180, 300);
    turn(slam, 50, 46, -0.5);  // back to the first piece at one blow
    turn(slam, 46, 10, -2);
    ASSERT_EQ(count(MapChange::NewPiece), 1);
    ASSERT_EQ(count(MapChange::OtherPiece), 1);
    const std::uint32_t moved = frame_of(MapChange::OtherPiece), begun = frame_of(MapChange::NewPiece);
    EXPECT_EQ(results[moved].tracking, TrackingState::Relocalised);
    for (std::size_t k = moved; k < results.size(); ++k) {
        const Isometry3d expected = truth[0].inverse() * truth[k];
        EXPECT_LT((expected.inverse() * results[k].T_world_camera).translation().norm(), kMaxError) << k;
    }
    const std::vector<std::uint32_t> frames = slam.frames();
    EXPECT_EQ(frames.front(), 0u);
    EXPECT_TRUE(std::binary_search(frames.begin(), frames.end(), moved));
    EXPECT_FALSE(std::binary_search(frames.begin(), frames.end(), begun));
    expect_true_poses(frames, slam.trajectory());
    turn(slam, 10, 80);
    turn(slam, 80, 280);  // and by way of the unknown to the second piece
    EXPECT_EQ(count(MapChange::Joined), 1);
    EXPECT_TRUE(slam.other_pieces().empty());
    EXPECT_EQ(slam.frames().size(), results.size());
    expect_true_poses(slam.frames(), slam.trajectory());
    expect_true_surfels(slam.surfels(), 0);
}

TEST_F(PiecesTest, OneViewAloneDoesNotJoin) {
    Slam slam(kSmall, config(), test_device());
    stand_where_it_has_been(slam, std::nullopt);
    EXPECT_EQ(count(MapChange::Joined), 0) << "a pattern that repeats itself deceives all frames of one view alike";
}

TEST_F(PiecesTest, OneViewJoinsWhereFeaturesSayTheSame) {
    Slam slam(kSmall, config(), test_device());
    stand_where_it_has_been(slam, 0.5);
    ASSERT_EQ(count(MapChange::Joined), 1);
    EXPECT_LE(frame_of(MapChange::Joined), frame_of(MapChange::NewPiece) + 12);
    EXPECT_TRUE(slam.other_pieces().empty());
    expect_true_poses(slam.frames(), slam.trajectory());
}

TEST_F(PiecesTest, OneViewDoesNotJoinWhereFeaturesSayOtherwise) {
    Slam slam(kSmall, config(), test_device());
    stand_where_it_has_been(slam, 8);
    EXPECT_EQ(count(MapChange::Joined), 0);
}

TEST_F(PiecesTest, NoneBeginsWhereThatIsNotWanted) {
    SlamConfig never = config();
    never.pieces.begin_after = 0;
    Slam slam(kSmall, never, test_device());
    turn(slam, 0, 80);
    turn(slam, 180, 240);
    EXPECT_EQ(count(MapChange::NewPiece), 0);
    EXPECT_EQ(results.back().tracking, TrackingState::Lost);
}

TEST_F(PiecesTest, ARestoredMapStaysTheMainOne) {
    Slam first(kSmall, config(), test_device());
    turn(first, 0, 40);
    const SlamState map = first.state();
    results.clear(), truth.clear();
    Slam slam(kSmall, config(), test_device());
    slam.restore(map);
    slam.lose_camera();
    turn(slam, 180, 300);
    EXPECT_EQ(count(MapChange::NewPiece), 1) << "a small map that was loaded is not given up";
    EXPECT_EQ(count(MapChange::StartedAgain), 0);
    slam.choose_main_piece();
    EXPECT_EQ(slam.frames().front(), 0u);
    EXPECT_EQ(slam.other_pieces().size(), 1u);
}

TEST_F(PiecesTest, ARestoredAtlasGoesOnByteByByte) {
    Slam slam(kSmall, config(), test_device());
    turn(slam, 0, 80);
    turn(slam, 180, 360);
    const AtlasState state = slam.atlas_state();
    ASSERT_EQ(state.others.size(), 1u);
    const std::size_t before = results.size();
    turn(slam, 360, 400);
    EXPECT_EQ(count(MapChange::Joined), 1);
    const std::vector<FrameResult> rest(results.begin() + static_cast<std::ptrdiff_t>(before), results.end());
    const std::vector<Surfel> surfels = slam.surfels(false);
    const std::vector<Isometry3d> poses = slam.trajectory();

    Slam restored(kSmall, config(), test_device());
    restored.restore(state);
    results.clear(), truth.clear();
    turn(restored, 360, 400);
    EXPECT_EQ((Recording{results, restored.surfels(false)}.bytes()), (Recording{rest, surfels}.bytes()));
    EXPECT_EQ(restored.frames(), slam.frames());
    const std::vector<Isometry3d> again = restored.trajectory();
    ASSERT_EQ(again.size(), poses.size());
    for (std::size_t i = 0; i < poses.size(); ++i)
        EXPECT_EQ(std::memcmp(again[i].data(), poses[i].data(), 16 * sizeof(double)), 0) << i;
}

TEST(JoinedPieces, AreInOneExposure) {
    const auto piece = [](std::uint32_t frame, float exposure, std::uint32_t red, std::uint32_t green,
                          std::uint32_t blue) {
        constexpr std::uint32_t kWeight = 0x3c00u << 16;  // a half that must not change
        PieceState state;
        state.frames = {frame};
        state.slam.frames = 1;
        state.slam.map.position_confidence = bytes_of(std::vector{gpu::vec4(0, 0, 2, 9)});
        state.slam.map.normal_radius = bytes_of(std::vector{gpu::vec4(0, 0, -1, 0.01f)});
        state.slam.map.appearance = bytes_of(std::vector{gpu::uvec4(red | green << 16, blue | kWeight, 0, 0)});
        state.slam.back_end.trajectory = {Isometry3d::Identity()};
        state.slam.back_end.information = {Matrix6d::Zero()};
        gpu::TrackingRecord record{};
        record.world_live = record.world_model = to_device(Isometry3d::Identity());
        record.exposure = gpu::vec4(exposure);
        state.slam.tracking.record = bytes_of(std::vector{record});
        return state;
    };
    const PieceState base = piece(0, 1, 100, 200, 300), moved = piece(1, 0.8f, 20000, 40000, 60000);
    const PieceState joined = join(base, moved, Isometry3d::Identity(), 1.5f, true);
    const auto looks = elements_of<gpu::uvec4>(joined.slam.map.appearance);
    ASSERT_EQ(looks.size(), 2u);
    EXPECT_EQ(looks[0].x, 100u | 200u << 16) << "that of the older piece";
    EXPECT_EQ(looks[0].y, 300u | 0x3c00u << 16);
    EXPECT_EQ(looks[1].x, 30000u | 60000u << 16);
    EXPECT_EQ(looks[1].y, 0xffffu | 0x3c00u << 16) << "no more than white";
    const auto exposure_of = [](const PieceState& state) {
        return elements_of<gpu::TrackingRecord>(state.slam.tracking.record)[0].exposure.x;
    };
    EXPECT_FLOAT_EQ(exposure_of(joined), 1.2f) << "and the camera's is relative to it";
    EXPECT_FLOAT_EQ(exposure_of(join(base, moved, Isometry3d::Identity(), 1.5f, false)), 1) << "it was there already";
}

TEST_F(PiecesTest, AtlasesThatContradictThemselvesAreRefused) {
    Slam slam(kSmall, config(), test_device());
    turn(slam, 0, 6);
    const AtlasState state = slam.atlas_state();
    const auto refuses = [&](auto&& spoil) {
        AtlasState spoilt = state;
        spoil(spoilt);
        EXPECT_THROW(slam.restore(spoilt), Error);
    };
    refuses([](AtlasState& s) { s.current.frames.pop_back(); });
    refuses([](AtlasState& s) { s.current.frames.back() = s.frames; });
    refuses([](AtlasState& s) { std::swap(s.current.frames[0], s.current.frames[1]); });
    refuses([](AtlasState& s) { s.others.push_back({s.current.slam, {0}, 1}); });
    refuses([](AtlasState& s) { s.current.slam.back_end.keyframes.at(0).frame = 99; });
    slam.restore(state);
    EXPECT_EQ(slam.frames().size(), 3u);
}

}  // namespace
}  // namespace posefusion::test
