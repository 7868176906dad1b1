#include "hosts/run/people_tracks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "hosts/run/people_json.hpp"

namespace posefusion::test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3f;

constexpr double kInterval_s = 1.0 / 30;

/// Head, shoulders and hips of somebody who stands there.
Skeleton somebody_at(const Vector3f& place, JointSource source = JointSource::Measured) {
    Skeleton skeleton;
    const auto put = [&](int joint, float x, float y) {
        skeleton.joint[joint] = place + Vector3f(x, y, 0);
        skeleton.source[joint] = source;
        skeleton.confidence[joint] = source == JointSource::Carried ? 0 : 0.9f;
    };
    put(Nose, 0, -0.7f);
    put(RightShoulder, -0.2f, -0.4f);
    put(LeftShoulder, 0.2f, -0.4f);
    put(RightHip, -0.15f, 0.1f);
    put(LeftHip, 0.15f, 0.1f);
    return skeleton;
}

Isometry3d moved_by(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

/// Tracks with a clock, seen by a camera that stands.
class PeopleTracksTest : public ::testing::Test {
protected:
    std::vector<int> see(const std::vector<Skeleton>& people, const Isometry3d& T_world_camera = Isometry3d::Identity(),
                         std::optional<Isometry3d> T_world_tracked = std::nullopt) {
        seconds_ += kInterval_s;
        return tracks_.update(people, T_world_camera, T_world_tracked.value_or(T_world_camera), stamp_of(seconds_));
    }
    void wait(double seconds) { seconds_ += seconds; }

    PeopleTracks tracks_;
    double seconds_ = 0;
};

TEST_F(PeopleTracksTest, NobodyHasNoId) {
    EXPECT_TRUE(see({}).empty());
    EXPECT_EQ(see({Skeleton{}}), std::vector<int>{0}) << "a label without joints";
    EXPECT_EQ(see({somebody_at({0, 0, 2}, JointSource::Carried)}), std::vector<int>{0}) << "never seen itself";
    EXPECT_EQ(see({somebody_at({0, 0, 2})}), std::vector<int>{1}) << "no id was spent";
}

TEST_F(PeopleTracksTest, PeopleWhoCrossKeepTheirIds) {
    for (int i = 0; i <= 60; ++i) {  // they pass each other at 25 cm, 1 m/s each, and change places in the list
        const float x = static_cast<float>(i - 30) / 30;
        const Skeleton one = somebody_at({x, 0, 2}), other = somebody_at({-x, 0, 2.25f});
        if (i % 2 == 0)
            ASSERT_EQ(see({one, other}), (std::vector<int>{1, 2})) << i;
        else
            ASSERT_EQ(see({other, one}), (std::vector<int>{2, 1})) << i;
    }
}

TEST_F(PeopleTracksTest, WhoIsHiddenForAShortTimeIsTheSameWhereHeIsExpected) {
    float x = 0;
    for (int i = 0; i < 10; ++i) see({somebody_at({x += 0.04f, 0, 2})});
    wait(0.5);  // at 1.2 m/s
    EXPECT_EQ(see({somebody_at({x + 0.5f, 0, 2})}), std::vector<int>{1});
    wait(0.2);
    EXPECT_EQ(see({somebody_at({x + 4, 0, 2})}), std::vector<int>{2}) << "too far";
}

TEST_F(PeopleTracksTest, WhoComesBackAfterLongIsSomebodyElse) {
    see({somebody_at({0, 0, 2})});
    wait(PeopleTracksConfig::kGap_s - 0.1);
    EXPECT_EQ(see({somebody_at({0, 0, 2})}), std::vector<int>{1});
    wait(PeopleTracksConfig::kGap_s + 0.1);
    EXPECT_EQ(see({somebody_at({0, 0, 2})}), std::vector<int>{2});
}

TEST_F(PeopleTracksTest, ACarriedMaskHasTheIdOfItsTrackButDoesNotMoveIt) {
    const Skeleton near = somebody_at({0, 0, 2}), far = somebody_at({0.5f, 0, 2});
    see({near, far});
    EXPECT_EQ(see({somebody_at({0.1f, 0, 2}, JointSource::Carried), far}), (std::vector<int>{1, 2}));
    for (int i = 1; i < 20; ++i) see({somebody_at({-0.1f * static_cast<float>(i), 0, 2}, JointSource::Carried)});
    EXPECT_EQ(see({near}), std::vector<int>{1}) << "where it was last seen";
}

TEST_F(PeopleTracksTest, TheCameraMayMoveAndSoMayTheWorld) {
    see({somebody_at({0, 0, 2})});
    EXPECT_EQ(see({somebody_at({-1, 0, 2})}, moved_by(1, 0, 0)), std::vector<int>{1}) << "the same place in the world";
    // a loop has moved the world by 3 m in this frame, as the pose before and after its correction tell
    EXPECT_EQ(see({somebody_at({-1, 0, 2})}, moved_by(4, 0, 0), moved_by(1, 0, 0)), std::vector<int>{1});
    EXPECT_EQ(see({somebody_at({-1, 0, 2})}, moved_by(1, 0, 0)), std::vector<int>{2}) << "it has not moved back";
}

TEST_F(PeopleTracksTest, ContinuesFromWhatWasRecorded) {
    PeopleTracks replayed;
    for (int i = 0; i < 5; ++i) {
        const std::vector<Skeleton> people{somebody_at({0.03f * static_cast<float>(i), 0, 2}), somebody_at({1, 0, 3}),
                                           somebody_at({2, 0, 3}, JointSource::Carried)};
        const auto ids = see(people);
        replayed.replay(people_in_view(people, ids), Isometry3d::Identity(), Isometry3d::Identity(),
                        stamp_of(seconds_));
    }
    const std::vector<Skeleton> next{somebody_at({1, 0, 3}), somebody_at({0.5f, 0, 2}), somebody_at({-2, 0, 3})};
    wait(0.3);
    EXPECT_EQ(replayed.update(next, Isometry3d::Identity(), Isometry3d::Identity(), stamp_of(seconds_ + kInterval_s)),
              see(next));
}

TEST(PeopleInView, AreThoseSeenNowWithLessConfidenceInWhatIsInferred) {
    Skeleton seen = somebody_at({0, 0, 2});
    seen.source[LeftHip] = JointSource::Inferred;
    seen.source[RightHip] = JointSource::Carried;
    const std::vector<int> ids{4, 7};
    const auto people = people_in_view(std::vector{somebody_at({1, 0, 2}, JointSource::Carried), seen}, ids);
    ASSERT_EQ(people.size(), 1u);
    EXPECT_EQ(people[0].id, 7);
    EXPECT_EQ(people[0].joints[Nose].confidence, 0.9f);
    EXPECT_EQ(people[0].joints[Nose].point, seen.joint[Nose]);
    EXPECT_EQ(people[0].joints[LeftHip].confidence, 0.9f * kInferredConfidence);
    EXPECT_EQ(people[0].joints[RightHip].confidence, 0);
    EXPECT_EQ(people[0].joints[LeftAnkle].confidence, 0);
}

TEST(LabelsById, TakeThePlaceOfNumbers) {
    LabelImage labels(5, 1);
    for (std::uint8_t i = 0; i < 5; ++i) labels[i] = i;
    const std::vector<int> ids{3, 0, 101};
    const LabelImage changed = labels_by_id(labels, ids);
    const std::vector<int> expected{0, 3, 2, 1, 4};  // none; id 3; no id; beyond the last label; not in the list
    EXPECT_TRUE(std::equal(changed.begin(), changed.end(), expected.begin(), expected.end()));
    EXPECT_EQ(labels_by_id(labels, {})[4], 4);
    EXPECT_TRUE(labels_by_id({}, ids).empty());
}

/// A frame each, with somebody in the same place before the camera, of that id.
RunRecord record_of(const std::vector<std::pair<TrackingState, int>>& frames) {
    RunRecord record;
    PieceRecord& piece = record.pieces.emplace_back();
    for (const auto& [tracking, id] : frames) {
        const auto i = record.frames.size();
        FrameRecord& frame = record.frames.emplace_back();
        frame.index = 10 + i;
        frame.stamp = std::chrono::milliseconds(1500 + i);
        frame.result.tracking = tracking;
        frame.in_view = people_in_view(std::vector{somebody_at({0, 0, 2})}, std::vector{id});
        piece.frames.push_back(i);
        piece.poses.push_back(moved_by(0, 0, static_cast<double>(i)));  // not that of the time, which is the identity
    }
    return record;
}

TEST(PeopleJson, FollowsTheFinalPosesOfTheFramesThatHaveOne) {
    using enum TrackingState;
    const auto json = nlohmann::json::parse(
        people_json(record_of({{FirstFrame, 5}, {Lost, 5}, {Ok, 5}, {Relocalised, 5}, {Ok, 2}, {Ok, 2}, {Ok, 2}})));
    EXPECT_EQ(json["format"], "posefusion people");
    EXPECT_EQ(json["version"], 1);
    ASSERT_EQ(json["joints"].size(), static_cast<std::size_t>(kJointCount));
    EXPECT_EQ(json["joints"][RightElbow], "RElbow");
    ASSERT_EQ(json["people"].size(), 2u);
    EXPECT_EQ(json["people"][0]["id"], 2);
    const auto& person = json["people"][1];
    EXPECT_EQ(person["id"], 5);
    ASSERT_EQ(person["frames"].size(), 3u) << "without the lost one";
    EXPECT_EQ(person["frames"][0]["frame"], 10);
    EXPECT_EQ(person["frames"][0]["timestamp"], 1.5);
    EXPECT_TRUE(person["frames"][0]["joints"][LeftKnee].is_null());
    EXPECT_EQ(person["frames"][1]["joints"][LeftShoulder], (nlohmann::json{0.2, -0.4, 4.0, 0.9}));
}

TEST(PeopleJson, LeavesOutGlimpses) {
    using enum TrackingState;
    EXPECT_EQ(nlohmann::json::parse(people_json({}))["people"].size(), 0u) << "no frame";
    EXPECT_EQ(nlohmann::json::parse(people_json(record_of({{Ok, 1}, {Ok, 1}, {Lost, 1}})))["people"].size(), 0u);
}

}  // namespace
}  // namespace posefusion::test
