#include "hosts/io/known_cameras.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>

namespace posefusion {
namespace {

std::string lower_case(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

/// 1, 2 or 3 for names like fr1_desk and rgbd_dataset_freiburg1_xyz, 0 for others: fr10, frame1, afr1ca.
int camera_number(const std::string& name) {
    const auto is = [&](std::size_t at, int (*kind)(int)) {
        return at < name.size() && kind(static_cast<unsigned char>(name[at])) != 0;
    };
    for (const std::string_view prefix : {"freiburg", "fr"}) {
        for (std::size_t at = 0; (at = name.find(prefix, at)) != std::string::npos; ++at) {
            const std::size_t digit = at + prefix.size();
            const bool alone =
                (at == 0 || !is(at - 1, std::isalpha)) && is(digit, std::isdigit) && !is(digit + 1, std::isdigit);
            if (alone && name[digit] >= '1' && name[digit] <= '3') return name[digit] - '0';
        }
    }
    return 0;
}

}  // namespace

std::optional<Camera> tum_camera(const std::string& folder_name) {
    const std::string name = lower_case(folder_name);
    // Calibration of the colour cameras, https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
    switch (camera_number(name)) {
        case 1:
            return Camera{
                {517.3f, 516.5f, 318.6f, 255.3f, 640, 480}, 5000, {0.2624f, -0.9531f, -0.0054f, 0.0026f, 1.1633f}};
        case 2:
            return Camera{
                {520.9f, 521.0f, 325.1f, 249.7f, 640, 480}, 5000, {0.2312f, -0.7849f, -0.0033f, -0.0001f, 0.9172f}};
        case 3:
            return Camera{{535.4f, 539.2f, 320.1f, 247.6f, 640, 480}, 5000, {}};
        default:
            return std::nullopt;
    }
}

Camera icl_camera() {
    // https://www.doc.ic.ac.uk/~ahanda/VaFRIC/iclnuim.html: K = (481.20, -480.00, 319.50, 239.50); fy is negative there
    // because y points up.
    return {{481.2f, 480.0f, 319.5f, 239.5f, 640, 480}, 5000, {}};
}

Camera bonn_camera() {
    // https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset/
    return {{542.822841f, 542.576870f, 315.593520f, 237.756098f, 640, 480},
            5000,
            {0.039903f, -0.099343f, -0.000730f, -0.000144f, 0.0f}};
}

Camera replica_camera() {
    // cam_params.json of the data: https://cvg-data.inf.ethz.ch/nice-slam/data/Replica.zip
    return {{600.0f, 600.0f, 599.5f, 339.5f, 1200, 680}, 6553.5f, {}};
}

std::optional<Camera> known_camera(const std::string& folder_name) {
    if (const auto camera = tum_camera(folder_name)) return camera;
    const std::string name = lower_case(folder_name);
    const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
    const bool icl =
        name.starts_with("icl") && (name.size() == 3 || std::isalpha(static_cast<unsigned char>(name[3])) == 0);
    if (icl || has("living_room_traj") || has("office_room_traj") || has("frei_png")) return icl_camera();
    if (has("rgbd_bonn")) return bonn_camera();
    return std::nullopt;
}

}  // namespace posefusion
