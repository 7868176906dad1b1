#include "hosts/web/map_pieces.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"
#include "tests/hosts/web/random_map.hpp"

/// What comes out of the pieces again, read as the page reads them (hosts/web/page/surfel_decoder.js).
namespace posefusion::test {
namespace {

std::string gunzip(const std::string& bytes, std::size_t size) {
    std::string out(size, '\0');
    z_stream stream{};
    EXPECT_EQ(inflateInit2(&stream, 15 + 16), Z_OK);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
    EXPECT_EQ(stream.total_out, size);
    inflateEnd(&stream);
    return out;
}

std::vector<Surfel> decoded(const MapCoding& coding, const EncodedPiece& piece) {
    const std::string bytes = gunzip(piece.bytes, piece.surfels * coding.bytes_per_surfel);
    std::vector<Surfel> surfels(piece.surfels);
    for (std::size_t i = 0; i < piece.surfels; ++i) {
        std::size_t row = 0;
        const auto number = [&](int rows) {
            unsigned value = 0;
            for (int r = 0; r < rows; ++r, ++row)
                value |= static_cast<unsigned>(static_cast<unsigned char>(bytes[row * piece.surfels + i])) << 8 * r;
            return value;
        };
        Surfel& s = surfels[i];
        for (int axis = 0; axis < 3; ++axis)
            s.position[axis] = static_cast<float>(coding.origin[axis] + number(3) * coding.step);
        float x = (static_cast<float>(number(1)) - 128) / 127, y = (static_cast<float>(number(1)) - 128) / 127;
        const float z = 1 - std::abs(x) - std::abs(y);
        if (z < 0) {
            const float old_x = x;
            x = (1 - std::abs(y)) * (x < 0 ? -1.0f : 1.0f);
            y = (1 - std::abs(old_x)) * (y < 0 ? -1.0f : 1.0f);
        }
        s.normal = Eigen::Vector3f(x, y, z).normalized();
        s.color.r = static_cast<std::uint8_t>(number(1));
        s.color.g = static_cast<std::uint8_t>(number(1));
        s.color.b = static_cast<std::uint8_t>(number(1));
        s.radius = static_cast<float>(coding.least_radius * std::pow(coding.radius_growth, number(1)));
        s.confidence = static_cast<float>(std::exp2(number(1) * coding.confidence_scale) - 1);
        s.created = number(3);
        s.last_seen = number(3);
    }
    return surfels;
}

TEST(MapPieces, HoldEverySurfelOnceWithinTheStatedErrors) {
    const std::vector<Surfel> surfels = random_map(60'000);
    const EncodedMap map = encode_map(surfels);
    std::size_t found = 0;
    std::vector<Surfel> by_color(surfels.size());  // the colour is the number of the surfel
    for (const EncodedPiece& piece : map.pieces)
        for (const Surfel& s : decoded(map.coding, piece)) {
            ++found;
            by_color.at(static_cast<std::size_t>(s.color.r | s.color.g << 8)) = s;
        }
    ASSERT_EQ(found, surfels.size());
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        const Surfel &before = surfels[i], &after = by_color[i];
        ASSERT_LE((before.position - after.position).cwiseAbs().maxCoeff(), 0.00025f + 1e-6f);
        ASSERT_LE((before.position - after.position).norm(), 0.001f);
        ASSERT_GT(before.normal.dot(after.normal), std::cos(0.017f)) << "more than a degree";
        ASSERT_NEAR(after.radius / before.radius, 1, 0.013);
        ASSERT_NEAR((1 + after.confidence) / (1 + before.confidence), 1, 0.01);
        ASSERT_EQ(after.created, before.created);
        ASSERT_EQ(after.last_seen, before.last_seen);
        ASSERT_EQ(after.color.b, 7);
    }
}

TEST(MapPieces, TheFirstIsASampleOfTheWholeRoom) {
    const EncodedMap map = encode_map(random_map(200'000));
    ASSERT_GE(map.pieces.size(), 4u);
    EXPECT_LE(map.pieces.front().surfels, 16'384u);
    int octants[8] = {};
    for (const Surfel& s : decoded(map.coding, map.pieces.front()))
        ++octants[(s.position.x() > 0) + 2 * (s.position.y() > 0) + 4 * (s.position.z() > 3)];
    for (const int count : octants) EXPECT_NEAR(count, 16'384 / 8, 200);
}

TEST(MapPieces, AreTheSameForTheSameMap) {
    const std::vector<Surfel> surfels = random_map(20'000);
    const EncodedMap a = encode_map(surfels), b = encode_map(surfels);
    ASSERT_EQ(a.pieces.size(), b.pieces.size());
    for (std::size_t i = 0; i < a.pieces.size(); ++i) EXPECT_EQ(a.pieces[i].bytes, b.pieces[i].bytes);
}

TEST(MapPieces, AreSmallerThanTheMapFile) {
    constexpr std::size_t kPlyBytes = 47;
    const EncodedMap map = encode_map(random_map(100'000));
    std::size_t bytes = 0;
    for (const EncodedPiece& piece : map.pieces) bytes += piece.bytes.size();
    EXPECT_LT(bytes, 100'000 * kPlyBytes * 2 / 5);
}

TEST(MapPieces, OfAMapThatIsNoRoomAreRefused) {
    std::vector<Surfel> surfels = random_map(10);
    surfels[0].position.x() = 9000;
    EXPECT_NE(message_of<Error>([&] { (void)encode_map(surfels); }).find("8 km"), std::string::npos);
    surfels[0].position.x() = std::nanf("");
    EXPECT_NE(message_of<Error>([&] { (void)encode_map(surfels); }).find("nowhere"), std::string::npos);
    surfels.erase(surfels.begin(), surfels.end() - 1);
    EXPECT_EQ(encode_map(surfels).pieces.size(), 1u) << "a single surfel without extent";
    EXPECT_TRUE(encode_map({}).pieces.empty());
}

TEST(MapPieces, OfAMapThatIsNotKnownYetAreAsExact) {
    std::vector<Surfel> surfels = random_map(1'000, 200.0f);
    surfels[0].confidence = 60'000;
    const MapCoding coding = coding_of_unknown_map();
    const std::vector<std::size_t> chosen{0, 999, 17};
    const EncodedPiece piece = encode_piece(coding, surfels, chosen);
    ASSERT_EQ(piece.surfels, chosen.size());
    std::size_t found = 0;
    for (const Surfel& after : decoded(coding, piece)) {
        const auto before =
            std::find_if(surfels.begin(), surfels.end(), [&](const Surfel& s) { return s.color == after.color; });
        ASSERT_NE(before, surfels.end());
        EXPECT_LE((before->position - after.position).cwiseAbs().maxCoeff(), 0.00025f + 1e-5f);
        EXPECT_NEAR((1 + after.confidence) / (1 + before->confidence), 1, 0.023);
        EXPECT_EQ(after.last_seen, before->last_seen);
        ++found;
    }
    EXPECT_EQ(found, chosen.size());
    surfels[17].position.y() = -5'000;
    EXPECT_NE(message_of<Error>([&] { (void)encode_piece(coding, surfels, chosen); }).find("wider"), std::string::npos);
    surfels[17].position.y() = std::nanf("");
    EXPECT_NE(message_of<Error>([&] { (void)encode_piece(coding, surfels, chosen); }).find("wider"), std::string::npos);
}

}  // namespace
}  // namespace posefusion::test
