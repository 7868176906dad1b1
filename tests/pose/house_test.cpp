#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "pose/detector.hpp"
#include "tests/pose/support.hpp"

/// The default detector against rendered sequences with exact joints.
namespace posefusion {
namespace {

constexpr int kVisible = 2;      // "visibility" of the joints file
constexpr int kEveryFrame = 12;  // a few frames of each sequence
constexpr int kWellVisible = 6;  // joints

struct TrueJoint {
    float u, v;
    bool visible;
};
struct TruePerson {
    std::array<TrueJoint, kJointCount> joints{};
    [[nodiscard]] bool torso_visible() const {
        const auto visible = [](const TrueJoint& joint) { return joint.visible; };
        return joints[Neck].visible && std::count_if(joints.begin(), joints.end(), visible) >= kWellVisible;
    }
};

TruePerson read_person(const nlohmann::json& json) {
    TruePerson person;
    for (int j = 0; j < kJointCount; ++j) {
        const auto& joint = json.at("joints").at(j);
        person.joints[j] = {joint.at(0).get<float>(), joint.at(1).get<float>(), joint.at(3).get<int>() == kVisible};
    }
    return person;
}

std::vector<float> errors_of(const Person& found, const TruePerson& truth) {
    std::vector<float> errors;
    for (int j = 0; j < kJointCount; ++j) {
        if (!truth.joints[j].visible || found.joints[j].p <= 0) continue;
        errors.push_back(std::hypot(found.joints[j].u - truth.joints[j].u, found.joints[j].v - truth.joints[j].v));
    }
    return errors;
}

float median(std::vector<float> values) {
    if (values.empty()) return 1e6f;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    return values[values.size() / 2];
}

class House : public ::testing::Test {
protected:
    struct Tally {
        int visible = 0, visible_found = 0, detections = 0;
        std::vector<float> errors;  ///< px
    };

    Tally run(const std::string& sequence) {
        const std::filesystem::path folder = shared_data() / "house" / sequence;
        const auto detector = make_joint_detector({});
        const nlohmann::json truth = nlohmann::json::parse(std::ifstream(folder / "joints.json"));
        Tally tally;
        for (std::size_t i = 0; i < truth.at("frames").size(); i += kEveryFrame) {
            const auto& frame = truth.at("frames").at(i);
            const People people =
                detector->detect(testing::load_color(folder / "rgb" / (frame.at("rgb").get<std::string>() + ".jpg")));
            tally.detections += static_cast<int>(people.size());
            for (const auto& json : frame.at("persons")) compare(read_person(json), people, tally);
        }
        return tally;
    }

    static std::filesystem::path shared_data() { return testing::shared_data(); }

private:
    static void compare(const TruePerson& truth, const People& people, Tally& tally) {
        constexpr float kSamePerson = 40;  // px, median over the joints
        std::vector<float> best;
        for (const Person& person : people) {
            const std::vector<float> errors = errors_of(person, truth);
            if (best.empty() || median(errors) < median(best)) best = errors;
        }
        const bool found = median(best) < kSamePerson;
        if (truth.torso_visible()) {
            ++tally.visible;
            tally.visible_found += found;
        }
        if (found) tally.errors.insert(tally.errors.end(), best.begin(), best.end());
    }
};

TEST_F(House, PeopleWithVisibleTorsosAreFoundWithAccurateJoints) {
    POSEFUSION_REQUIRE_DATA(shared_data() / "house");
    Tally all;
    for (const char* const sequence : {"walk_xyz", "walk_static", "walk_halfsphere", "sit_halfsphere"}) {
        const Tally tally = run(sequence);
        all.visible += tally.visible;
        all.visible_found += tally.visible_found;
        all.errors.insert(all.errors.end(), tally.errors.begin(), tally.errors.end());
    }
    ASSERT_GT(all.visible, 20);
    EXPECT_GE(all.visible_found, 0.9 * all.visible) << all.visible_found << " of " << all.visible;
    EXPECT_LT(median(all.errors), 9) << "px";
}

TEST_F(House, FurnitureIsHardlyEverSomebody) {
    POSEFUSION_REQUIRE_DATA(shared_data() / "house");
    EXPECT_LE(run("static_xyz").detections, 1);
}

}  // namespace
}  // namespace posefusion
