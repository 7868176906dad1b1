#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "hosts/synth/synth.hpp"
#include "pose/detector.hpp"

/// The people are good enough for a network that was trained on photographs.
namespace posefusion {
namespace {

bool torso_visible(const SynthPerson& person) {
    int seen = 0;
    for (const int j : {RightShoulder, LeftShoulder, RightHip, LeftHip})
        seen += person.joints[static_cast<std::size_t>(j)].visibility != JointVisibility::Hidden;
    return seen >= 3;
}

constexpr std::array<int, kJointCount> kMirrored{
    Nose,     Neck,      LeftShoulder, LeftElbow, LeftWrist,  RightShoulder, RightElbow, RightWrist, LeftHip,
    LeftKnee, LeftAnkle, RightHip,     RightKnee, RightAnkle, LeftEye,       RightEye,   LeftEar,    RightEar};

/// Most of the found joints lie within 0.3 trunk lengths of the true ones.
bool fits(const Person& found, const SynthPerson& truth, bool mirrored) {
    const auto at = [&](int j) {
        return truth.joints[static_cast<std::size_t>(mirrored ? kMirrored[static_cast<std::size_t>(j)] : j)];
    };
    const float hips_u = 0.5f * (at(RightHip).u + at(LeftHip).u), hips_v = 0.5f * (at(RightHip).v + at(LeftHip).v);
    const float trunk = std::hypot(at(Neck).u - hips_u, at(Neck).v - hips_v);
    int good = 0, all = 0;
    for (const int j :
         {Nose, RightShoulder, LeftShoulder, RightElbow, LeftElbow, RightHip, LeftHip, RightKnee, LeftKnee}) {
        const JointObservation& o = found.joints[static_cast<std::size_t>(j)];
        if (o.p <= 0) continue;
        ++all;
        good += std::hypot(o.u - at(j).u, o.v - at(j).v) < 0.3f * trunk;
    }
    return good >= 3 && 2 * good >= all;
}

/// Front and back may be mistaken for each other: the person is found all the same.
bool finds(const Person& found, const SynthPerson& truth) {
    return fits(found, truth, false) || fits(found, truth, true);
}

TEST(SynthDetection, TheDefaultNetworkFindsNinetyPercentOfThePeopleWhoseTorsoIsVisible) {
    PoseConfig pose;
    pose.model = std::filesystem::path(POSEFUSION_SOURCE_DIR) / ".deps/models/movenet-multipose.onnx";
    if (!std::filesystem::exists(pose.model)) GTEST_SKIP() << "no " << pose.model << ": run tools/setup";
    const auto detector = make_joint_detector(pose);
    int visible = 0, found = 0;
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        SynthConfig config;
        config.seed = seed;
        config.width = 320;  // the network sees 256 pixels of width anyway
        config.height = 240;
        config.frames = 240;
        const SynthWorld world(config);
        for (int frame = 0; frame < config.frames; frame += 12) {
            const SynthFrame f = world.render(frame);
            const People people = detector->detect(f.color);
            for (const SynthPerson& person : f.people) {
                if (!torso_visible(person)) continue;
                ++visible;
                found += std::any_of(people.begin(), people.end(), [&](const Person& p) { return finds(p, person); });
            }
        }
    }
    ASSERT_GT(visible, 40);
    EXPECT_GE(found, 0.9 * visible) << found << " of " << visible;
}

}  // namespace
}  // namespace posefusion
