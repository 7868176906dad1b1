#include "hosts/io/pose_matrix.hpp"

#include <cmath>

#include "engine/core/error.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

constexpr double kRotationError = 0.02;  ///< tolerance for matrices with few digits or from many products
constexpr std::size_t kMatrix = 16, kUpperRows = 12;

}  // namespace

std::optional<Eigen::Isometry3d> rigid_motion(std::span<const double> numbers) {
    if (numbers.size() != kMatrix && numbers.size() != kUpperRows) return std::nullopt;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < kUpperRows; ++i) {
        if (!std::isfinite(numbers[i])) return std::nullopt;
        T.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = numbers[i];
    }
    if (numbers.size() == kMatrix && !(numbers[12] == 0 && numbers[13] == 0 && numbers[14] == 0 && numbers[15] == 1))
        return std::nullopt;
    const Eigen::Matrix3d R = T.linear();
    if (!(R.transpose() * R).isIdentity(kRotationError) || R.determinant() < 0) return std::nullopt;
    T.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
    return T;
}

std::vector<double> read_numbers(const std::filesystem::path& file) {
    std::vector<double> numbers;
    for (const TextLine& line : read_text_table(file)) {
        for (const std::string& field : line.fields) {
            const auto number = parse_number(field);
            if (!number) return {};
            numbers.push_back(*number);
        }
    }
    return numbers;
}

Eigen::Isometry3d read_rigid_motion(const std::filesystem::path& file) {
    const auto motion = rigid_motion(read_numbers(file));
    if (!motion) throw Error(file.string() + ": holds no rigid motion (a 4x4 matrix, row by row)");
    return *motion;
}

}  // namespace posefusion
