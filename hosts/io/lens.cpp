#include "hosts/io/lens.hpp"

#include <algorithm>
#include <cctype>
#include <iterator>

namespace posefusion {
namespace {

/// Parts of the names that programs give to their models of wide lenses.
constexpr const char* kWideAngleModels[] = {"fisheye", "equi", "kannala", "omni", "theta", "double_sphere", "eucm"};

}  // namespace

PlanePoint distort(PlanePoint p, const LensCoefficients& lens) {
    const auto [k1, k2, p1, p2, k3, k4, k5, k6] = lens;
    const float r2 = p.x * p.x + p.y * p.y;
    const float radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / (1 + r2 * (k4 + r2 * (k5 + r2 * k6)));
    return {p.x * radial + 2 * p1 * p.x * p.y + p2 * (r2 + 2 * p.x * p.x),
            p.y * radial + p1 * (r2 + 2 * p.y * p.y) + 2 * p2 * p.x * p.y};
}

PlanePoint undistort(PlanePoint p, const LensCoefficients& lens) {
    constexpr int kIterations = 20;
    PlanePoint ideal = p;
    for (int i = 0; i < kIterations; ++i) {
        const PlanePoint q = distort(ideal, lens);
        ideal = {ideal.x + p.x - q.x, ideal.y + p.y - q.y};
    }
    return ideal;
}

bool is_wide_angle_model(std::string model) {
    std::transform(model.begin(), model.end(), model.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::any_of(std::begin(kWideAngleModels), std::end(kWideAngleModels),
                       [&](const char* part) { return model.find(part) != std::string::npos; });
}

}  // namespace posefusion
