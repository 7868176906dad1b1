#include "hosts/io/camera_file.hpp"

#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/camera_dialects.hpp"
#include "hosts/io/camera_keys.hpp"
#include "hosts/io/input_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/pose_matrix.hpp"
#include "hosts/io/text_file.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxCameraBytes = std::uintmax_t{1}
                                           << 22;  ///< OpenCV's files may contain all corners of the calibration board
constexpr std::array<const char*, 8> kLensNames{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
/// Focal length over the side of the image, or the inverse: from 0.6 to 179 degrees of view. Cropped images may have
/// their principal point outside, by up to their size.
constexpr float kLongestLens = 100;
/// The cameras of one device are closer together than this, metres; larger values are probably in millimetres.
constexpr double kMaxBaseline = 1.0;

/// The numbers of a file that holds nothing else; empty for any other.
std::vector<double> numbers_only(const std::string& text) {
    std::vector<double> numbers;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
        if (word.ends_with(',')) word.pop_back();
        const auto number = parse_number(word);
        if (!number || !std::isfinite(*number) || numbers.size() > 16) return {};
        numbers.push_back(*number);
    }
    return numbers;
}

/// OpenCV's YAML begins with %YAML:1.0, which other YAML readers reject.
std::string without_directives(std::string text) {
    for (std::size_t at = 0; at < text.size() && text[at] == '%'; at = text.find('\n', at) + 1) {
        text[at] = '#';
        if (text.find('\n', at) == std::string::npos) break;
    }
    return text;
}

CameraKeys parse(const fs::path& file, const std::string& text) {
    const auto fail = [&](const std::string& what) { throw Error(file.string() + ": " + what); };
    if (text.starts_with("<?xml"))
        fail("is XML; save the calibration as YAML (OpenCV: a file name that ends in .yaml)");
    try {
        return {file, YAML::Load(without_directives(text))};
    } catch (const YAML::Exception& e) {
        fail("is not YAML (line " + std::to_string(e.mark.line + 1) + "): " + printable(e.msg));
        throw;  // not reached
    }
}

Eigen::Isometry3f motion_between_cameras(const CameraKeys& keys, const std::string& key) {
    const auto motion = rigid_motion(keys.numbers(key));
    if (!motion)
        keys.fail("'" + key +
                  "' is no rigid motion: 16 numbers, a rotation and a translation row by row, the last row " +
                  "0 0 0 1");
    const double baseline = motion->translation().norm();
    if (baseline > kMaxBaseline)
        keys.fail("'" + key + "' puts the cameras " + shortest_text(baseline) + " m apart; it must be in metres");
    return motion->cast<float>();
}

LensCoefficients lens_of(const CameraKeys& keys, const std::string& prefix) {
    LensCoefficients lens{};
    for (std::size_t i = 0; i < lens.size(); ++i) lens[i] = keys.number(prefix + kLensNames[i], 0);
    return lens;
}

DepthDeformation deformation_of(const CameraKeys& keys) {
    constexpr const char* kKey = "depth_deformation";
    /// 1/m: more would move a wall at 1 m by half a metre
    constexpr double kLargest = 0.5;
    DepthDeformation deformation;
    if (!keys.has(kKey)) return deformation;
    const std::vector<double> nodes = keys.numbers(kKey);
    if (nodes.size() != DepthDeformation::kNodes)
        keys.fail(std::string("'") + kKey + "' must hold " + std::to_string(DepthDeformation::kNodes) +
                  " numbers, not " + std::to_string(nodes.size()));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!(std::abs(nodes[i]) <= kLargest))
            keys.fail(std::string("'") + kKey + "' holds " + shortest_text(nodes[i]) + "; its unit is 1/m, and " +
                      shortest_text(kLargest) + " is the largest");
        deformation.nodes[i] = static_cast<float>(nodes[i]);
    }
    return deformation;
}

std::optional<DepthCamera> describe_depth_camera(const CameraKeys& keys, const Camera& color) {
    const bool own = keys.has("depth_fx") || keys.has("depth_fy") || keys.has("depth_cx") || keys.has("depth_cy");
    if (!own && !keys.has("depth_width") && !keys.has("depth_height")) {
        for (const char* key : {"T_color_depth", "depth_k1", "depth_k2", "depth_p1", "depth_p2"})
            if (keys.has(key))
                keys.fail(std::string("'") + key +
                          "' belongs to a depth camera; give depth_fx depth_fy depth_cx depth_cy depth_width "
                          "depth_height, too");
        return std::nullopt;
    }
    DepthCamera depth;
    const int width = keys.side("depth_width"), height = keys.side("depth_height");
    if (own) {
        depth.intrinsics = {keys.positive("depth_fx"),
                            keys.positive("depth_fy"),
                            keys.number("depth_cx"),
                            keys.number("depth_cy"),
                            width,
                            height};
        depth.distortion = lens_of(keys, "depth_");
    } else {
        depth.intrinsics = resized(color.intrinsics, width, height);
        depth.distortion = color.distortion;
    }
    if (keys.has("T_color_depth")) depth.T_color_depth = motion_between_cameras(keys, "T_color_depth");
    return depth;
}

CameraDescription describe_own(const CameraKeys& keys) {
    std::vector<std::string> known{"fx",
                                   "fy",
                                   "cx",
                                   "cy",
                                   "width",
                                   "height",
                                   "depth_scale",
                                   "model",
                                   "depth_fx",
                                   "depth_fy",
                                   "depth_cx",
                                   "depth_cy",
                                   "depth_width",
                                   "depth_height",
                                   "T_color_depth",
                                   "depth_deformation"};
    for (const char* name : kLensNames) {
        known.emplace_back(name);
        known.push_back(std::string("depth_") + name);
    }
    for (const char* remark : {"name", "fps", "depth_min", "depth_max"}) known.emplace_back(remark);
    keys.expect_only(known);
    if (keys.has("model") && is_wide_angle_model(keys.text("model")))
        keys.fail("'model' is " + keys.text("model") + "; " + kWideAngleAdvice);

    CameraDescription description;
    Camera& camera = description.camera;
    camera.intrinsics = {keys.positive("fx"), keys.number("fy"),  keys.number("cx"),
                         keys.number("cy"),   keys.side("width"), keys.side("height")};
    if (camera.intrinsics.fy == 0) keys.fail("'fy' must not be 0");
    camera.depth_scale = keys.positive("depth_scale", camera.depth_scale);
    description.says_depth_scale = keys.has("depth_scale");
    camera.distortion = lens_of(keys, "");
    camera.deformation = deformation_of(keys);
    description.depth = describe_depth_camera(keys, camera);
    if (description.depth && camera.intrinsics.fy < 0)
        keys.fail("a depth camera beside a negative 'fy' is not understood; give 'fy' and 'depth_fy' for y down");
    return description;
}

/// Refuses numbers that no camera with images of that size has: most likely they are those of another size or mistyped.
void check_plausible(const fs::path& file, const Intrinsics& K) {
    if (K.width == 0) return;
    const auto width = static_cast<float>(K.width), height = static_cast<float>(K.height);
    const auto refuse = [&](const char* what, float x, float y) {
        throw Error(file.string() + ": the " + what + " (" + shortest_text(x) + ", " + shortest_text(y) +
                    ") is not that of a camera with images of " + std::to_string(K.width) + "x" +
                    std::to_string(K.height) + " pixels; correct it, or the size");
    };
    const auto is_focal_length = [](float f, float side) { return f > side / kLongestLens && f < side * kLongestLens; };
    if (!is_focal_length(K.fx, width) || !is_focal_length(std::abs(K.fy), height))
        refuse("focal length fx, fy", K.fx, K.fy);
    const auto is_near = [](float c, float side) { return c > -side && c < 2 * side; };
    if (!is_near(K.cx, width) || !is_near(K.cy, height)) refuse("principal point cx, cy", K.cx, K.cy);
}

CameraDescription describe(const fs::path& file, const std::string& text) {
    if (const std::vector<double> numbers = numbers_only(text); !numbers.empty())
        return describe_numbers(numbers, file);
    const CameraKeys keys = parse(file, text);
    if (const auto foreign = describe_foreign_camera(keys)) return *foreign;
    return describe_own(keys);
}

}  // namespace

CameraDescription read_camera_description(const fs::path& file) {
    std::error_code error;
    if (!fs::is_regular_file(file, error))
        throw Error(file.string() + ": camera file not found; check the name given with --camera");
    return parse_camera_description(read_text_file(file, kMaxCameraBytes), file.string());
}

CameraDescription parse_camera_description(const std::string& text, const std::string& name) {
    CameraDescription description = with_y_down(describe(name, text));
    check_plausible(name, description.camera.intrinsics);
    return description;
}

Camera read_camera_file(const fs::path& file, float default_depth_scale) {
    const CameraDescription description = read_camera_description(file);
    if (description.depth)
        throw Error(file.string() +
                    ": gives a depth camera ('depth_width' ...), but depth is registered to colour in this recording; "
                    "take these lines out");
    Camera camera = description.camera;
    if (camera.intrinsics.width == 0)
        throw Error(file.string() +
                    ": does not say how large the images are; give a file with `width: ...` and `height: ...`");
    if (!description.says_depth_scale) camera.depth_scale = default_depth_scale;
    return camera;
}

Intrinsics resized(const Intrinsics& K, int width, int height) {
    const float su = static_cast<float>(width) / static_cast<float>(K.width),
                sv = static_cast<float>(height) / static_cast<float>(K.height);
    return {K.fx * su, K.fy * sv, (K.cx + 0.5f) * su - 0.5f, (K.cy + 0.5f) * sv - 0.5f, width, height};
}

void write_camera_file(const fs::path& file, const Camera& camera) {
    const Intrinsics& K = camera.intrinsics;
    std::string yaml = "# the centre of the top left pixel is (0, 0)\n";
    const auto put = [&](const char* key, auto value) {
        yaml += std::string(key) + ": " + shortest_text(value) + "\n";
    };
    put("width", K.width), put("height", K.height);
    put("fx", K.fx), put("fy", K.fy), put("cx", K.cx), put("cy", K.cy);
    put("depth_scale", camera.depth_scale);
    constexpr std::size_t kBrown = 5;  // coefficients of the model without denominator
    const auto& lens = camera.distortion;
    const bool rational = lens[5] != 0 || lens[6] != 0 || lens[7] != 0;
    const std::size_t coefficients = !camera.distorted() ? 0 : rational ? lens.size() : kBrown;
    for (std::size_t i = 0; i < coefficients; ++i) put(kLensNames[i], lens[i]);
    if (!camera.deformation.is_none()) {
        yaml +=
            "# of depth: 1 / z = 1 / measured + c, c in 1/m at nodes over the image, row by row\ndepth_deformation: [";
        for (std::size_t i = 0; i < DepthDeformation::kNodes; ++i)
            yaml += (i > 0 ? ", " : "") + shortest_text(camera.deformation.nodes[i]);
        yaml += "]\n";
    }
    write_file_atomically(file, yaml);
}

}  // namespace posefusion
