#include "tools/mask_accuracy/sequence.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion::mask_accuracy {
namespace fs = std::filesystem;
namespace {

constexpr double kPairingTolerance = 0.02;  // seconds, as the TUM tools pair colour, depth and poses

struct Stamped {
    double time;
    std::string stamp, rest;
};

std::vector<Stamped> read_stamped(const fs::path& file) {
    std::ifstream in(file);
    std::vector<Stamped> lines;
    for (std::string line; std::getline(in, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream words(line);
        Stamped entry;
        words >> entry.stamp;
        std::getline(words >> std::ws, entry.rest);
        while (!entry.rest.empty() && (entry.rest.back() == '\r' || entry.rest.back() == ' ')) entry.rest.pop_back();
        entry.time = std::stod(entry.stamp);
        lines.push_back(std::move(entry));
    }
    return lines;
}

const Stamped* nearest(const std::vector<Stamped>& list, double time) {
    const Stamped* best = nullptr;
    for (const Stamped& s : list) {
        const double distance = std::abs(s.time - time);
        if (distance <= kPairingTolerance && (!best || distance < std::abs(best->time - time))) best = &s;
    }
    return best;
}

void read_camera(const fs::path& file, Sequence& sequence) {
    std::ifstream in(file);
    if (!in) throw Error("no camera.yaml in " + file.parent_path().string());
    std::map<std::string, float> values;
    for (std::string line; std::getline(in, line);) {
        const auto colon = line.find(':');
        if (line.empty() || line[0] == '#' || colon == std::string::npos) continue;
        values[line.substr(0, colon)] = std::stof(line.substr(colon + 1));
    }
    sequence.camera = {values["fx"],
                       values["fy"],
                       values["cx"],
                       values["cy"],
                       static_cast<int>(values["width"]),
                       static_cast<int>(values["height"])};
    if (values.count("depth_scale")) sequence.depth_scale = values["depth_scale"];
    if (!sequence.camera.valid()) throw Error("camera.yaml without fx, fy, cx, cy, width, height: " + file.string());
}

Eigen::Isometry3f parse_pose(const std::string& text) {
    std::istringstream in(text);
    float tx, ty, tz, qx, qy, qz, qw;
    in >> tx >> ty >> tz >> qx >> qy >> qz >> qw;
    if (!in) throw Error("not a pose line in groundtruth.txt: " + text);
    Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
    pose.linear() = Eigen::Quaternionf(qw, qx, qy, qz).normalized().toRotationMatrix();
    pose.translation() = Eigen::Vector3f(tx, ty, tz);
    return pose;
}

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

}  // namespace

Sequence open_sequence(const fs::path& folder) {
    Sequence sequence;
    read_camera(folder / "camera.yaml", sequence);
    const auto depths = read_stamped(folder / "depth.txt");
    const auto poses = read_stamped(folder / "groundtruth.txt");
    for (const Stamped& color : read_stamped(folder / "rgb.txt")) {
        const Stamped* depth = nearest(depths, color.time);
        if (!depth) continue;
        Entry entry;
        entry.stamp = color.stamp;
        entry.color = folder / color.rest;
        entry.depth = folder / depth->rest;
        const fs::path mask = folder / "masks" / (color.stamp + ".png");
        if (fs::exists(mask)) entry.mask = mask;
        if (const Stamped* pose = nearest(poses, color.time)) entry.T_world_camera = parse_pose(pose->rest);
        sequence.frames.push_back(std::move(entry));
    }
    if (sequence.frames.empty()) throw Error("no pairs of colour and depth in " + folder.string());
    sequence.joints = read_joints(folder / "joints.json");
    if (!sequence.joints.empty() && sequence.joints.size() != sequence.frames.size())
        throw Error("joints.json has another number of frames than rgb.txt: " + folder.string());
    return sequence;
}

ColorImage read_color(const fs::path& file) {
    const cv::Mat bgr = cv::imread(file.string(), cv::IMREAD_COLOR);
    if (bgr.empty()) throw Error("cannot read " + file.string());
    ColorImage image(bgr.cols, bgr.rows);
    for (int v = 0; v < bgr.rows; ++v)
        for (int u = 0; u < bgr.cols; ++u) {
            const auto& p = bgr.at<cv::Vec3b>(v, u);
            image(u, v) = {p[2], p[1], p[0]};
        }
    return image;
}

DepthImage read_depth(const fs::path& file, float depth_scale) {
    const cv::Mat raw = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
    if (raw.empty() || raw.type() != CV_16UC1) throw Error("not a 16-bit depth image: " + file.string());
    DepthImage image(raw.cols, raw.rows);
    for (int v = 0; v < raw.rows; ++v)
        for (int u = 0; u < raw.cols; ++u) image(u, v) = static_cast<float>(raw.at<std::uint16_t>(v, u)) / depth_scale;
    return image;
}

LabelImage read_mask(const fs::path& file) {
    const cv::Mat raw = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
    if (raw.empty()) throw Error("cannot read " + file.string());
    LabelImage image(raw.cols, raw.rows);
    for (int v = 0; v < raw.rows; ++v)
        for (int u = 0; u < raw.cols; ++u) image(u, v) = raw.at<std::uint8_t>(v, u);
    return image;
}

}  // namespace posefusion::mask_accuracy
