#include "hosts/io/camera_file.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>

#include "engine/core/error.hpp"

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

Camera read_camera_file(const std::filesystem::path& file) {
    const CameraReader yaml(file);
    Camera camera;
    camera.intrinsics = {yaml.positive("fx"), yaml.positive("fy"), yaml.number("cx"),
                         yaml.number("cy"),   yaml.side("width"),  yaml.side("height")};
    camera.depth_scale = yaml.positive("depth_scale", camera.depth_scale);
    camera.distortion = {yaml.number("k1", 0), yaml.number("k2", 0), yaml.number("p1", 0), yaml.number("p2", 0),
                         yaml.number("k3", 0)};
    return camera;
}

std::optional<Camera> tum_camera(const std::string& folder_name) {
    std::string name = folder_name;
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
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

}  // namespace posefusion
