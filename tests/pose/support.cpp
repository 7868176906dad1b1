#include "tests/pose/support.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

namespace posefusion::testing {

std::filesystem::path shared_data() {
    const char* const override_path = std::getenv("POSEFUSION_SHARED_DATA");
    return override_path ? std::filesystem::path(override_path)
                         : std::filesystem::path(POSEFUSION_SOURCE_DIR).parent_path() / "shared" / "data";
}

ColorImage load_color(const std::filesystem::path& file) {
    const cv::Mat image = cv::imread(file.string(), cv::IMREAD_COLOR);
    ColorImage color(image.cols, image.rows);
    for (int v = 0; v < image.rows; ++v) {
        for (int u = 0; u < image.cols; ++u) {
            const cv::Vec3b& bgr = image.at<cv::Vec3b>(v, u);
            color(u, v) = {bgr[2], bgr[1], bgr[0]};
        }
    }
    return color;
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "posefusion-pose-XXXXXX").string();
    path_ = mkdtemp(name.data());
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

void write_file(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

std::string read_file(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::string exact_text(const People& people) {
    std::ostringstream text;
    text << std::hexfloat;
    for (const Person& person : people) {
        text << person.score << ' ' << person.box.u_min << ' ' << person.box.v_min << ' ' << person.box.u_max << ' '
             << person.box.v_max << '\n';
        for (const JointObservation& joint : person.joints) text << joint.u << ' ' << joint.v << ' ' << joint.p << '\n';
    }
    return text.str();
}

float largest_difference(const People& a, const People& b) {
    if (a.size() != b.size()) return std::numeric_limits<float>::infinity();
    float largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (int j = 0; j < kJointCount; ++j) {
            const JointObservation &x = a[i].joints[j], &y = b[i].joints[j];
            if (x.p > 0 && y.p > 0) largest = std::max(largest, std::hypot(x.u - y.u, x.v - y.v));
        }
    }
    return largest;
}

}  // namespace posefusion::testing
