#include "hosts/io/camera_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <string_view>

#include "engine/core/error.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {
namespace {

/// No RGB-D camera is larger; a size beyond this is a slip of the pen.
constexpr int kMaxImageSide = 8192;

class CameraReader {
public:
    explicit CameraReader(const std::filesystem::path& file) : file_(file) {
        std::error_code error;
        if (!std::filesystem::is_regular_file(file, error)) fail("camera file not found");
        try {
            root_ = YAML::LoadFile(file.string());
        } catch (const YAML::Exception& e) {
            fail("is not YAML (line " + std::to_string(e.mark.line + 1) + "): " + e.msg);
        }
        if (!root_.IsMap()) fail("is not a list of `name: value` lines");
    }

    [[nodiscard]] float number(const char* key) const {
        const YAML::Node node = root_[key];
        if (!node) fail(std::string("'") + key + "' is missing");
        return convert(node, key);
    }
    [[nodiscard]] float number(const char* key, float fallback) const {
        const YAML::Node node = root_[key];
        return node ? convert(node, key) : fallback;
    }
    [[nodiscard]] float positive(const char* key) const { return checked_positive(key, number(key)); }
    [[nodiscard]] float positive(const char* key, float fallback) const {
        return checked_positive(key, number(key, fallback));
    }
    [[nodiscard]] int side(const char* key) const {
        const float value = positive(key);
        if (value != std::floor(value) || value > static_cast<float>(kMaxImageSide))
            fail(std::string("'") + key + "' must be a whole number of pixels up to " + std::to_string(kMaxImageSide));
        return static_cast<int>(value);
    }

private:
    [[noreturn]] void fail(const std::string& what) const { throw Error(file_.string() + ": " + what); }

    [[nodiscard]] float convert(const YAML::Node& node, const char* key) const {
        float value = 0;
        if (!YAML::convert<float>::decode(node, value) || !std::isfinite(value))
            fail(std::string("'") + key + "' is not a number");
        return value;
    }
    [[nodiscard]] float checked_positive(const char* key, float value) const {
        if (!(value > 0)) fail(std::string("'") + key + "' must be positive");
        return value;
    }

    const std::filesystem::path& file_;
    YAML::Node root_;
};

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

Camera read_camera_file(const std::filesystem::path& file, float default_depth_scale) {
    const CameraReader yaml(file);
    Camera camera;
    camera.intrinsics = {yaml.positive("fx"), yaml.positive("fy"), yaml.number("cx"),
                         yaml.number("cy"),   yaml.side("width"),  yaml.side("height")};
    camera.depth_scale = yaml.positive("depth_scale", default_depth_scale);
    camera.distortion = {yaml.number("k1", 0), yaml.number("k2", 0), yaml.number("p1", 0), yaml.number("p2", 0),
                         yaml.number("k3", 0)};
    return camera;
}

void write_camera_file(const std::filesystem::path& file, const Camera& camera) {
    std::ostringstream yaml;
    yaml << std::setprecision(std::numeric_limits<float>::max_digits10);
    const Intrinsics& K = camera.intrinsics;
    yaml << "# the centre of the top left pixel is (0, 0)\nwidth: " << K.width << "\nheight: " << K.height
         << "\nfx: " << K.fx << "\nfy: " << K.fy << "\ncx: " << K.cx << "\ncy: " << K.cy
         << "\ndepth_scale: " << camera.depth_scale << '\n';
    constexpr std::array<const char*, 5> kNames{"k1", "k2", "p1", "p2", "k3"};
    for (std::size_t i = 0; camera.distorted() && i < kNames.size(); ++i)
        yaml << kNames[i] << ": " << camera.distortion[i] << '\n';
    write_file_atomically(file, yaml.str());
}

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

std::optional<Camera> known_camera(const std::string& folder_name) {
    if (const auto camera = tum_camera(folder_name)) return camera;
    const std::string name = lower_case(folder_name);
    const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
    const bool icl =
        name.starts_with("icl") && (name.size() == 3 || std::isalpha(static_cast<unsigned char>(name[3])) == 0);
    if (icl || has("living_room_traj") || has("office_room_traj") || has("frei_png")) return icl_camera();
    return std::nullopt;
}

}  // namespace posefusion
