#pragma once
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/intrinsics.hpp"
#include "hosts/io/lens.hpp"

/// The `name: value` lines of a camera file, in any of the formats.
namespace posefusion {

/// All functions throw Error that names the file and the key.
class CameraKeys {
public:
    /// Throws Error when a key occurs twice.
    CameraKeys(std::filesystem::path file, const YAML::Node& map);

    [[nodiscard]] bool has(const std::string& key) const;
    [[nodiscard]] bool has_prefix(std::string_view prefix) const;
    [[nodiscard]] float number(const std::string& key) const;
    [[nodiscard]] float number(const std::string& key, float fallback) const;
    [[nodiscard]] float positive(const std::string& key) const;
    [[nodiscard]] float positive(const std::string& key, float fallback) const;
    [[nodiscard]] int side(const std::string& key) const;  ///< of an image, pixels
    [[nodiscard]] std::string text(const std::string& key) const;
    /// A list, a list of lists, or a matrix of OpenCV or ROS (rows, cols, data).
    [[nodiscard]] std::vector<double> numbers(const std::string& key) const;
    [[nodiscard]] CameraKeys map(const std::string& key) const;

    /// Throws Error, with the nearest known name, for a key that is neither in `known` nor begins with one of
    /// `passed_over` (settings of other programs that do not describe the camera).
    void expect_only(const std::vector<std::string>& known, const std::vector<std::string>& passed_over = {}) const;

    /// The intrinsics from a 3x3 (or larger) matrix. @param by_columns  as Open3D and Eigen store it
    [[nodiscard]] Intrinsics matrix(const std::string& key, bool by_columns) const;
    /// The lens from a list of 0, 4, 5 or 8 coefficients in OpenCV's order; if all are 0 there is no distortion,
    /// whatever the model.
    /// @param model  its name if the file has one, or ""
    [[nodiscard]] LensCoefficients lens(const std::string& key, const std::string& model) const;

    [[noreturn]] void fail(const std::string& what) const;

private:
    [[nodiscard]] YAML::Node node(const std::string& key) const;
    [[nodiscard]] float convert(const YAML::Node& node, const std::string& key) const;

    std::filesystem::path file_;
    YAML::Node map_;
};

}  // namespace posefusion
