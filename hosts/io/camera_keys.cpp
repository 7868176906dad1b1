#include "hosts/io/camera_keys.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/nearest_name.hpp"
#include "hosts/io/image_header.hpp"
#include "hosts/io/input_file.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kMaxNumbers = 4096;  ///< in a list that is read whole

/// Whatever the locale, and finite; nullopt otherwise.
template <class Number>
std::optional<Number> parse(const YAML::Node& value) {
    if (!value.IsScalar()) return std::nullopt;
    std::string_view text = value.Scalar();
    if (text.starts_with('+')) text.remove_prefix(1);
    Number number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
    return number;
}

std::string quoted(const std::string& key) {
    std::string text = "'";
    text += printable(key);
    text += "'";
    return text;
}

}  // namespace

CameraKeys::CameraKeys(std::filesystem::path file, const YAML::Node& map) : file_(std::move(file)), map_(map) {
    if (!map_.IsMap()) fail("is not a list of `name: value` lines");
    std::map<std::string, int> lines;
    for (const auto& entry : map_) {
        if (!entry.first.IsScalar()) fail("is not a list of `name: value` lines");
        const int line = entry.first.Mark().line + 1;
        const auto [first, is_new] = lines.emplace(entry.first.Scalar(), line);
        if (!is_new)
            fail(quoted(first->first) + " is given twice (lines " + std::to_string(first->second) + " and " +
                 std::to_string(line) + "); leave one of them");
    }
}

void CameraKeys::fail(const std::string& what) const { throw Error(file_.string() + ": " + what); }

YAML::Node CameraKeys::node(const std::string& key) const { return std::as_const(map_)[key]; }

bool CameraKeys::has(const std::string& key) const { return node(key).IsDefined(); }

bool CameraKeys::has_prefix(std::string_view prefix) const {
    return std::any_of(map_.begin(), map_.end(),
                       [&](const auto& entry) { return entry.first.Scalar().starts_with(prefix); });
}

float CameraKeys::convert(const YAML::Node& value, const std::string& key) const {
    const auto number = parse<float>(value);
    if (!number) fail(quoted(key) + " is not a number");
    return *number;
}

float CameraKeys::number(const std::string& key) const {
    if (!has(key)) fail(quoted(key) + " is missing");
    return convert(node(key), key);
}

float CameraKeys::number(const std::string& key, float fallback) const { return has(key) ? number(key) : fallback; }

float CameraKeys::positive(const std::string& key) const {
    const float value = number(key);
    if (!(value > 0)) fail(quoted(key) + " must be positive");
    return value;
}

float CameraKeys::positive(const std::string& key, float fallback) const { return has(key) ? positive(key) : fallback; }

int CameraKeys::side(const std::string& key) const {
    const float value = positive(key);
    if (value != std::floor(value) || value > static_cast<float>(kMaxImageSide))
        fail(quoted(key) + " must be a whole number of pixels up to " + std::to_string(kMaxImageSide));
    return static_cast<int>(value);
}

std::string CameraKeys::text(const std::string& key) const {
    const YAML::Node value = node(key);
    if (!value.IsDefined() || !value.IsScalar()) fail(quoted(key) + " is missing or no text");
    return printable(value.Scalar());
}

std::vector<double> CameraKeys::numbers(const std::string& key) const {
    const YAML::Node value = node(key);
    const YAML::Node list = value.IsDefined() && value.IsMap() ? value["data"] : value;
    if (!list.IsDefined() || !list.IsSequence()) fail(quoted(key) + " is missing or no list of numbers");
    std::vector<double> all;
    const auto take = [&](const YAML::Node& element) {
        const auto number = parse<double>(element);
        if (!number || all.size() == kMaxNumbers) fail(quoted(key) + " is not a list of numbers");
        all.push_back(*number);
    };
    for (const auto& row : list) {
        if (!row.IsSequence()) {
            take(row);
        } else {
            for (const auto& element : row) take(element);
        }
    }
    return all;
}

CameraKeys CameraKeys::map(const std::string& key) const {
    if (!has(key) || !node(key).IsMap()) fail(quoted(key) + " is missing or has no `name: value` lines");
    return {file_, node(key)};
}

void CameraKeys::expect_only(const std::vector<std::string>& known, const std::vector<std::string>& passed_over) const {
    for (const auto& entry : map_) {
        const std::string& key = entry.first.Scalar();
        const bool expected = std::find(known.begin(), known.end(), key) != known.end() ||
                              std::any_of(passed_over.begin(), passed_over.end(),
                                          [&](const std::string& prefix) { return key.starts_with(prefix); });
        if (!expected)
            fail(quoted(key) + " (line " + std::to_string(entry.first.Mark().line + 1) +
                 ") is not known; the nearest known name is '" + nearest_name(key, known) + "'");
    }
}

Intrinsics CameraKeys::matrix(const std::string& key, bool by_columns) const {
    const std::vector<double> m = numbers(key);
    if (m.size() != 9) fail(quoted(key) + " must hold the 9 numbers of a 3x3 matrix, not " + std::to_string(m.size()));
    const auto at = [&](std::size_t row, std::size_t column) {
        return static_cast<float>(by_columns ? m[3 * column + row] : m[3 * row + column]);
    };
    if (at(0, 1) != 0 || at(1, 0) != 0 || at(2, 0) != 0 || at(2, 1) != 0 || at(2, 2) != 1)
        fail(quoted(key) + " is no camera matrix fx 0 cx, 0 fy cy, 0 0 1" +
             (by_columns ? " stored column by column (transpose it)" : " stored row by row (transpose it)"));
    if (!(at(0, 0) > 0) || at(1, 1) == 0) fail(quoted(key) + ": the focal lengths must be positive");
    return {at(0, 0), at(1, 1), at(0, 2), at(1, 2), 0, 0};
}

LensCoefficients CameraKeys::lens(const std::string& key, const std::string& model) const {
    LensCoefficients lens{};
    if (!has(key)) return lens;
    const std::vector<double> all = numbers(key);
    if (std::all_of(all.begin(), all.end(), [](double d) { return d == 0; })) return lens;
    if (is_wide_angle_model(model)) fail("the lens model is '" + model + "'; " + kWideAngleAdvice);
    if (all.size() != 4 && all.size() != 5 && all.size() != 8)
        fail(quoted(key) + " must hold 4, 5 or 8 coefficients (k1 k2 p1 p2 k3 k4 k5 k6), not " +
             std::to_string(all.size()));
    std::transform(all.begin(), all.end(), lens.begin(), [](double d) { return static_cast<float>(d); });
    return lens;
}

}  // namespace posefusion
