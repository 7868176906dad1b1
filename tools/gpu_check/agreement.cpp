#include "tools/gpu_check/agreement.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "engine/core/angle.hpp"
#include "engine/core/error.hpp"

namespace posefusion {

namespace {

double percent_off(std::uint32_t found, std::uint32_t expected) {
    return 100.0 * (static_cast<double>(found) - expected) / std::max(1.0, static_cast<double>(expected));
}

}  // namespace

AgreementLimits AgreementLimits::for_width(int width) {
    const double factor = std::max(1.0, std::pow(kReferenceWidth / static_cast<double>(width), 2));
    AgreementLimits limits;
    limits.translation_mm *= factor;
    limits.rotation_deg *= factor;
    return limits;
}

void write_expected(const Replay& replay, const std::filesystem::path& file) {
    auto poses = nlohmann::ordered_json::array();
    for (const Eigen::Isometry3d& pose : replay.T_world_camera) {
        const Eigen::Vector3d t = pose.translation();
        const Eigen::Quaterniond q(pose.rotation());
        poses.push_back({t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()});
    }
    const nlohmann::ordered_json json = {{"surfels", replay.surfels},
                                         {"stable_surfels", replay.stable_surfels},
                                         {"T_world_camera", "tx ty tz qx qy qz qw, metres"},
                                         {"poses", poses}};
    std::ofstream stream(file);
    stream << json.dump() << '\n';
    if (!stream.flush()) throw Error("cannot write '" + file.string() + "'");
}

Replay read_expected(const std::filesystem::path& file) {
    std::ifstream stream(file);
    if (!stream) throw Error("cannot read '" + file.string() + "'; this size was not packed");
    Replay result;
    try {
        const auto json = nlohmann::json::parse(stream);
        result.surfels = json.at("surfels");
        result.stable_surfels = json.at("stable_surfels");
        for (const auto& p : json.at("poses")) {
            Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
            pose.translation() = Eigen::Vector3d(p.at(0), p.at(1), p.at(2));
            pose.linear() = Eigen::Quaterniond(p.at(6), p.at(3), p.at(4), p.at(5)).normalized().toRotationMatrix();
            result.T_world_camera.push_back(pose);
        }
    } catch (const nlohmann::json::exception& fault) {
        throw Error("'" + file.string() + "': " + fault.what() + "; unpack the folder again");
    }
    return result;
}

Agreement compare(const Replay& found, const Replay& expected, const AgreementLimits& limits) {
    constexpr double kMillimetres = 1000;
    Agreement result;
    const std::size_t frames = std::min(found.T_world_camera.size(), expected.T_world_camera.size());
    for (std::size_t i = 0; i < frames; ++i) {
        const Eigen::Isometry3d difference = found.T_world_camera[i].inverse() * expected.T_world_camera[i];
        const double angle = Eigen::AngleAxisd(difference.rotation()).angle();
        result.translation_mm = std::max(result.translation_mm, difference.translation().norm() * kMillimetres);
        result.rotation_deg = std::max(result.rotation_deg, angle / radians(1.0));
    }
    if (found.T_world_camera.size() == expected.T_world_camera.size()) {
        result.surfels_percent = percent_off(found.surfels, expected.surfels);
        result.stable_percent = percent_off(found.stable_surfels, expected.stable_surfels);
    }
    result.within = frames > 0 && found.lost == 0 && result.translation_mm <= limits.translation_mm &&
                    result.rotation_deg <= limits.rotation_deg &&
                    std::abs(result.surfels_percent) <= limits.surfels_percent &&
                    std::abs(result.stable_percent) <= limits.surfels_percent;
    return result;
}

}  // namespace posefusion
