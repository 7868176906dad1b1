#pragma once
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

/// Writes messages of ROS 2 as they are serialised: plain CDR.
namespace posefusion::test {

class CdrWriter {
public:
    explicit CdrWriter(bool big_endian = false) : big_endian_(big_endian) {
        bytes_ = {'\0', big_endian ? '\0' : '\1', '\0', '\0'};
    }
    template <class Number>
    CdrWriter& number(Number value) {
        while ((bytes_.size() - kEncapsulation) % sizeof value != 0) bytes_ += '\0';
        std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
        if (big_endian_) std::reverse(bytes.begin(), bytes.end());
        bytes_ += bytes;
        return *this;
    }
    CdrWriter& text(const std::string& text) {
        number(static_cast<std::uint32_t>(text.size() + 1));
        bytes_ += text + '\0';
        return *this;
    }
    CdrWriter& block(const std::string& bytes) {
        number(static_cast<std::uint32_t>(bytes.size()));
        bytes_ += bytes;
        return *this;
    }
    CdrWriter& header(std::uint64_t nanoseconds, const std::string& frame_id) {
        constexpr std::uint64_t kSecond = 1'000'000'000;
        number(static_cast<std::int32_t>(nanoseconds / kSecond));
        number(static_cast<std::uint32_t>(nanoseconds % kSecond));
        return text(frame_id);
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    static constexpr std::size_t kEncapsulation = 4;
    bool big_endian_;
    std::string bytes_;
};

struct CdrImage {
    std::uint64_t stamp = 0;  ///< nanoseconds
    int width = 0, height = 0;
    std::string encoding, data;
    std::string frame_id = "camera";
    bool big_endian_pixels = false;
};
inline std::string cdr_image(const CdrImage& image, bool big_endian = false) {
    const auto height = static_cast<std::uint32_t>(image.height);
    CdrWriter cdr(big_endian);
    cdr.header(image.stamp, image.frame_id).number(height).number(static_cast<std::uint32_t>(image.width));
    cdr.text(image.encoding).number(static_cast<std::uint8_t>(image.big_endian_pixels ? 1 : 0));
    const std::size_t step = height == 0 ? 0 : image.data.size() / height;
    return cdr.number(static_cast<std::uint32_t>(step)).block(image.data).bytes();
}

inline std::string cdr_compressed_image(std::uint64_t stamp, const std::string& format, const std::string& data) {
    return CdrWriter().header(stamp, "camera").text(format).block(data).bytes();
}

inline std::string cdr_camera_info(int width, int height, const std::vector<double>& K,
                                   const std::vector<double>& D = {}, const std::string& frame_id = "camera",
                                   bool big_endian = false) {
    CdrWriter cdr(big_endian);
    cdr.header(1, frame_id).number(static_cast<std::uint32_t>(height)).number(static_cast<std::uint32_t>(width));
    cdr.text("plumb_bob").number(static_cast<std::uint32_t>(D.size()));
    for (const double d : D) cdr.number(d);
    for (const double k : K) cdr.number(k);
    for (int i = 0; i < 9 + 12; ++i) cdr.number(0.0);          // R and P
    for (int i = 0; i < 6; ++i) cdr.number(std::uint32_t{0});  // binning and region of interest
    return cdr.number(std::uint8_t{0}).bytes();
}

/// tf2_msgs/msg/TFMessage: one shift along x, in metres.
inline std::string cdr_transform(const std::string& parent, const std::string& child, double x) {
    CdrWriter cdr;
    cdr.number(std::uint32_t{1}).header(1, parent).text(child);
    for (const double value : {x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}) cdr.number(value);
    return cdr.bytes();
}

}  // namespace posefusion::test
