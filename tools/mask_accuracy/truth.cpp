#include "tools/mask_accuracy/truth.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/io/association.hpp"
#include "hosts/io/image_file.hpp"

namespace posefusion::mask_accuracy {
namespace fs = std::filesystem;
namespace {

Person parse_person(const nlohmann::json& json) {
    Person person;
    person.score = 1;
    constexpr float kFar = 1e9f;
    person.box = {kFar, kFar, -kFar, -kFar};
    for (int j = 0; j < kJointCount; ++j) {
        const auto& joint = json["joints"][j];
        const float u = joint[0], v = joint[1];
        if (joint[3].get<int>() == 0) continue;  // outside the image or hidden by something else
        person.joints[j] = {u, v, 1};
        person.box = {std::min(person.box.u_min, u), std::min(person.box.v_min, v), std::max(person.box.u_max, u),
                      std::max(person.box.v_max, v)};
    }
    return person;
}

std::vector<People> read_joints(const fs::path& file) {
    std::ifstream in(file);
    std::vector<People> frames;
    if (!in) return frames;
    const auto document = nlohmann::json::parse(in);
    for (const auto& frame : document["frames"]) {
        People people;
        for (const auto& json : frame["persons"]) {
            Person person = parse_person(json);
            if (!person.box.empty()) people.push_back(person);
        }
        frames.push_back(std::move(people));
    }
    return frames;
}

std::vector<Eigen::Isometry3f> poses_of(const Recording& recording) {
    std::vector<Eigen::Isometry3f> poses(recording.size(), Eigen::Isometry3f::Identity());
    const std::optional<Trajectory> groundtruth = recording.groundtruth();
    if (!groundtruth) return poses;
    std::vector<Stamp> stamps;
    for (const StampedPose& pose : *groundtruth) stamps.push_back(pose.stamp);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        if (const auto at = nearest_stamp(stamps, recording.frames()[i].stamp)) {
            poses[i] = (*groundtruth)[*at].T_world_camera.cast<float>();
        }
    }
    return poses;
}

}  // namespace

Truth read_truth(const Recording& recording) {
    const fs::path folder = recording.location();
    Truth truth{poses_of(recording), read_joints(folder / "joints.json"), folder / "masks"};
    if (!truth.joints.empty() && truth.joints.size() != recording.size())
        throw Error("joints.json has another number of frames than the recording: " + folder.string());
    return truth;
}

LabelImage true_mask(const Truth& truth, const Recording& recording, const Frame& frame) {
    const fs::path file = truth.masks / (frame.stamp_text + ".png");
    if (!fs::exists(file)) return {};
    const Intrinsics& recorded = recording.camera().intrinsics;
    return recording.labels_from_source(read_labels(file, {recorded.width, recorded.height}));
}

}  // namespace posefusion::mask_accuracy
