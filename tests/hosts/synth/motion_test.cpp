#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "hosts/synth/choreography.hpp"
#include "hosts/synth/furniture.hpp"
#include "hosts/synth/person_motion.hpp"

/// People walk as people do: on their feet, round the furniture, apart from each other.
namespace posefusion::synth {
namespace {

constexpr double kDuration = 40;  ///< seconds, long enough that everything happens

struct Play {
    explicit Play(std::uint64_t seed)
        : room(seed),
          floor(room),
          bodies{Proportions(1.82f, false), Proportions(1.62f, true)},
          plans(choreograph(room, floor, {{0, room.spots, room.exits}}, bodies, kDuration, seed)) {
        for (std::size_t i = 0; i < bodies.size(); ++i) motions.emplace_back(bodies[i], plans[i], kDuration, seed + i);
    }
    Room room;
    FloorPlan floor;
    std::vector<Proportions> bodies;
    std::vector<MotionPlan> plans;
    std::vector<PersonMotion> motions;
};

TEST(SynthMotion, FeetOnTheFloorDoNotSlide) {
    const Play play(3);
    int standing = 0, sliding = 0;
    float worst = 0;
    for (std::size_t i = 0; i < play.bodies.size(); ++i)
        for (const int toe : {ToeL, ToeR}) {
            Vector3f before = Vector3f::UnitZ();
            for (double t = 0; t < kDuration; t += 0.01) {
                const Vector3f ball =
                    solve_pose(play.bodies[i], play.motions[i].at(t))[static_cast<std::size_t>(toe)].translation();
                if (ball.z() < 0.001f && before.z() < 0.001f) {
                    const float moved = (ball - before).head<2>().norm();
                    worst = std::max(worst, moved);
                    ++standing;
                    sliding += moved > 0.001f;
                }
                before = ball;
            }
        }
    EXPECT_GT(standing, 4000);
    EXPECT_LT(sliding, standing / 200);
    EXPECT_LT(worst, 0.02f);
}

TEST(SynthMotion, NoFootGoesThroughTheFloorAndNoLegIsTornApart) {
    const Play play(4);
    for (std::size_t i = 0; i < play.bodies.size(); ++i)
        for (double t = 0; t < kDuration; t += 0.02) {
            const Posture posture = play.motions[i].at(t);
            const BoneTransforms bones = solve_pose(play.bodies[i], posture);
            for (const int side : {Left, Right}) {
                const Vector3f ankle = bones[static_cast<std::size_t>(thigh(side) + 2)].translation();
                EXPECT_GT(ankle.z(), 0.6f * play.bodies[i].ankle_height);
                EXPECT_LT((ankle - posture.feet[static_cast<std::size_t>(side)].ankle).norm(), 0.03f)
                    << "the leg reaches its foot, t " << t;
            }
        }
}

TEST(SynthMotion, EverythingHappens) {
    bool walked = false, sat = false, talked = false, left = false, turned = false;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const Play play(seed);
        for (const MotionPlan& plan : play.plans) {
            walked |= plan.steps(Left).size() > 10;
            sat |= !plan.sittings().empty();
            talked |= !plan.gestures().empty();
            for (double t = 0; t < kDuration; t += 0.1) {
                for (const Vector2f& exit : play.room.exits) left |= (plan.place_at(t) - exit).norm() < 0.2f;
                turned |= std::abs(plan.foot(Left, t).yaw - plan.foot(Left, 0).yaw) > 2.5f;
            }
        }
    }
    EXPECT_TRUE(walked && sat && talked && left && turned) << walked << sat << talked << left << turned;
}

TEST(SynthMotion, NobodyWalksThroughFurnitureOrTheCamerasSpace) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const Play play(seed);
        for (std::size_t i = 0; i < play.bodies.size(); ++i)
            for (double t = 0; t < kDuration; t += 0.05) {
                bool at_seat = false;  // around a chair that they use they touch it, of course
                for (const Sitting& s : play.plans[i].sittings()) at_seat |= t > s.down - 1.5 && t < s.up + 1.5;
                if (at_seat) continue;
                const Vector3f hips = play.motions[i].at(t).pelvis;
                EXPECT_GT(play.floor.clearance(hips.head<2>()), 0.14f)
                    << "seed " << seed << " person " << i << " t " << t;
            }
    }
}

TEST(SynthMotion, PeopleKeepApart) {
    int close = 0, all = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const Play play(seed);
        for (double t = 0; t < kDuration; t += 0.1, ++all)
            close += (play.motions[0].at(t).pelvis - play.motions[1].at(t).pelvis).head<2>().norm() < 0.5f;
    }
    EXPECT_LT(close, all / 100);
}

TEST(SynthMotion, SittersSitOnTheSeatWithTheirBackToIt) {
    int seen = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const Play play(seed);
        for (std::size_t i = 0; i < play.bodies.size(); ++i)
            for (const Sitting& s : play.plans[i].sittings()) {
                const double t = 0.5 * (s.seated + s.rise);
                if (t > kDuration) continue;
                ++seen;
                const Posture posture = play.motions[i].at(t);
                const Seat& seat = play.room.seats[i];
                EXPECT_LT((posture.pelvis.head<2>() - seat.center).norm(), 0.10f);
                EXPECT_NEAR(posture.pelvis.z(), kSeatHeight + 0.085f, 0.02f);
                EXPECT_GT(std::cos(posture.yaw - seat.yaw), 0.95f);
                EXPECT_TRUE(play.motions[i].sitting(t));
            }
    }
    EXPECT_GE(seen, 3);
}

}  // namespace
}  // namespace posefusion::synth
