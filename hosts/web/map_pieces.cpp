#include "hosts/web/map_pieces.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr double kStep = 0.0005;  // m: at most 0.25 mm off on an axis, 0.43 mm in space
constexpr std::size_t kPositionBytes = 3, kFrameBytes = 3;
constexpr std::uint32_t kLargestCode = (1u << 8 * kPositionBytes) - 1;
constexpr double kLeastRadius = 0.0005, kLargestRadius = 0.2;  // m; surfels have 1 mm to 5 cm
constexpr double kLargestByte = 255;
constexpr std::size_t kBytesPerSurfel = 3 * kPositionBytes + 2 + 3 + 1 + 1 + 2 * kFrameBytes;
constexpr double kMostConfidence = 65'535;  // of an unknown map
/// The first pieces are small: something is to be seen at once.
constexpr std::array<std::size_t, 2> kFirstPieces{16'384, 32'768};
constexpr std::size_t kPieceSurfels = 65'536;

using Codes = std::array<std::uint32_t, 3>;

/// SplitMix64 (Steele et al., 2014): numbers without a pattern that are the same everywhere.
std::uint64_t scattered(std::uint64_t number) {
    number += 0x9e3779b97f4a7c15;
    number = (number ^ number >> 30) * 0xbf58476d1ce4e5b9;
    number = (number ^ number >> 27) * 0x94d049bb133111eb;
    return number ^ number >> 31;
}

/// Every third bit of the result is one of the lowest 21 bits of `code`.
std::uint64_t spread(std::uint32_t code) {
    std::uint64_t bits = code & 0x1fffff;
    bits = (bits | bits << 32) & 0x1f00000000ffff;
    bits = (bits | bits << 16) & 0x1f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
}

/// Place on the Z-order curve.
std::uint64_t morton(const Codes& c) {
    constexpr std::uint32_t kSpareBits =
        3;  // the curve takes 21 of 24 bits; what is finer does not matter for an order
    return spread(c[0] >> kSpareBits) | spread(c[1] >> kSpareBits) << 1 | spread(c[2] >> kSpareBits) << 2;
}

std::uint8_t byte_of(double value) { return static_cast<std::uint8_t>(std::clamp(value, 0.0, kLargestByte) + 0.5); }

/// A unit vector on the octahedron |x| + |y| + |z| = 1, unfolded into a square.
std::array<std::uint8_t, 2> octahedral(const Eigen::Vector3f& normal) {
    const float sum = normal.cwiseAbs().sum();
    Eigen::Vector2f p = sum > 0 ? Eigen::Vector2f(normal.head<2>() / sum) : Eigen::Vector2f(0, 0);
    if (normal.z() < 0) {
        const Eigen::Vector2f sign(p.x() < 0 ? -1.0f : 1.0f, p.y() < 0 ? -1.0f : 1.0f);
        p = (Eigen::Vector2f(1, 1) - Eigen::Vector2f(std::abs(p.y()), std::abs(p.x()))).cwiseProduct(sign);
    }
    const auto coded = [](float v) { return static_cast<std::uint8_t>(std::lround(128 + 127 * v)); };
    return {coded(p.x()), coded(p.y())};
}

std::string gzip(const std::string& bytes) {
    constexpr int kGzip = 15 + 16, kMemory = 8, kLevel = 6;  // zlib's own defaults, with the header of a .gz file
    z_stream stream{};
    if (deflateInit2(&stream, kLevel, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
        throw Error("the map cannot be compressed: out of memory");
    std::string out(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const int result = deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    if (result != Z_STREAM_END) throw Error("the map cannot be compressed");
    return out;
}

MapCoding coding_from(const Eigen::Vector3d& origin, double most_confidence) {
    MapCoding coding;
    coding.origin = origin;
    coding.step = kStep;
    coding.least_radius = kLeastRadius;
    coding.radius_growth = std::pow(kLargestRadius / kLeastRadius, 1 / kLargestByte);
    coding.confidence_scale = std::log2(1 + most_confidence) / kLargestByte;
    coding.bytes_per_surfel = kBytesPerSurfel;
    return coding;
}

MapCoding coding_of(const std::vector<Surfel>& surfels) {
    Eigen::Vector3f low = surfels.front().position, high = low;
    float confidence = 0;
    for (const Surfel& s : surfels) {
        low = low.cwiseMin(s.position);
        high = high.cwiseMax(s.position);
        confidence = std::max(confidence, s.confidence);
    }
    if (!low.allFinite() || !high.allFinite()) throw Error("the map has surfels that are nowhere");
    if (static_cast<double>((high - low).maxCoeff()) / kStep > kLargestCode)
        throw Error("the map is wider than 8 km, which a page cannot show; is its unit the metre?");
    return coding_from(low.cast<double>(), static_cast<double>(std::max(confidence, 1.0f)));
}

Codes position_codes(const MapCoding& coding, const Surfel& surfel) {
    Codes codes{};
    for (int axis = 0; axis < 3; ++axis)
        codes[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(
            std::lround((static_cast<double>(surfel.position[axis]) - coding.origin[axis]) / coding.step));
    return codes;
}

/// Fills one place of the rows of a piece, in their order.
class Rows {
public:
    explicit Rows(std::size_t surfels) : surfels_(surfels), bytes_(surfels * kBytesPerSurfel, '\0') {}
    void begin(std::size_t surfel) { at_ = surfel; }
    void put(std::uint32_t number, std::size_t bytes = 1) {
        for (std::size_t i = 0; i < bytes; ++i, at_ += surfels_)
            bytes_[at_] = static_cast<char>(static_cast<unsigned char>(number >> 8 * i));
    }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::size_t surfels_, at_ = 0;
    std::string bytes_;
};

std::string rows_of(const MapCoding& coding, const std::vector<Surfel>& surfels, std::span<const std::size_t> chosen) {
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    for (const std::size_t i : chosen) order.emplace_back(morton(position_codes(coding, surfels[i])), i);
    std::sort(order.begin(), order.end());
    Rows rows(chosen.size());
    for (std::size_t place = 0; place < order.size(); ++place) {
        const Surfel& s = surfels[order[place].second];
        rows.begin(place);
        for (const std::uint32_t code : position_codes(coding, s)) rows.put(code, kPositionBytes);
        for (const std::uint8_t code : octahedral(s.normal)) rows.put(code);
        for (const std::uint8_t channel : {s.color.r, s.color.g, s.color.b}) rows.put(channel);
        const double radius = std::max(static_cast<double>(s.radius), coding.least_radius);
        rows.put(byte_of(std::log(radius / coding.least_radius) / std::log(coding.radius_growth)));
        const double confidence = std::max(static_cast<double>(s.confidence), 0.0);
        rows.put(byte_of(std::log2(1 + confidence) / coding.confidence_scale));
        rows.put(s.created, kFrameBytes);
        rows.put(s.last_seen, kFrameBytes);
    }
    return rows.bytes();
}

bool has_room(const MapCoding& coding, const Surfel& surfel) {
    const Eigen::Vector3d offset = (surfel.position.cast<double>() - coding.origin) / coding.step;
    return offset.allFinite() && offset.minCoeff() > -0.5 && offset.maxCoeff() < kLargestCode + 0.5;
}

}  // namespace

MapCoding coding_of_unknown_map() {
    return coding_from(Eigen::Vector3d::Constant(-kStep * 0.5 * kLargestCode), kMostConfidence);
}

EncodedPiece encode_piece(const MapCoding& coding, const std::vector<Surfel>& surfels,
                          std::span<const std::size_t> chosen) {
    for (const std::size_t i : chosen)
        if (!has_room(coding, surfels[i])) throw Error("the map is wider than a page can show");
    return {chosen.size(), gzip(rows_of(coding, surfels, chosen))};
}

EncodedMap encode_map(const std::vector<Surfel>& surfels) {
    EncodedMap result;
    if (surfels.empty()) return result;
    result.coding = coding_of(surfels);
    std::vector<std::size_t> order(surfels.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [](std::size_t a, std::size_t b) { return scattered(a) < scattered(b); });
    for (std::size_t at = 0; at < order.size();) {
        const std::size_t wanted =
            result.pieces.size() < kFirstPieces.size() ? kFirstPieces[result.pieces.size()] : kPieceSurfels;
        const std::size_t count = std::min(wanted, order.size() - at);
        result.pieces.push_back(encode_piece(result.coding, surfels, std::span(order).subspan(at, count)));
        at += count;
    }
    return result;
}

}  // namespace posefusion
