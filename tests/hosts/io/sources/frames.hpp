#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "hosts/io/frame_source.hpp"
#include "hosts/io/recorders/recorder.hpp"
#include "tests/hosts/support/temp_folder.hpp"

/// Small frames whose every pixel is known.
namespace posefusion::test {

inline constexpr int kWidth = 32, kHeight = 24;

inline Camera test_camera() { return {{30.25f, 30.5f, 15.5f, 11.125f, kWidth, kHeight}, 1000, {}}; }

/// Frame i, i/30 s after 1305031102.175304 s.
inline RawFrame make_frame(int i) {
    RawFrame frame;
    const long long us = 1305031102175304LL + 33333LL * i;
    frame.stamp_text = std::to_string(us / 1000000) + "." + std::to_string(1000000 + us % 1000000).substr(1);
    frame.stamp = std::chrono::microseconds(us);
    frame.color = ColorImage(kWidth, kHeight);
    frame.depth = RawDepth(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < kWidth; ++u) {
            frame.color(u, v) = {static_cast<std::uint8_t>(u * 7 + i), static_cast<std::uint8_t>(v * 9),
                                 static_cast<std::uint8_t>(u * v)};
            frame.depth(u, v) = static_cast<std::uint16_t>((u + 2 * v) % 17 == 0 ? 0 : 900 + 31 * u + 17 * v + i);
        }
    return frame;
}

inline void expect_same(const RawFrame& a, const RawFrame& b) {
    EXPECT_EQ(a.stamp_text, b.stamp_text);
    EXPECT_EQ(a.stamp, b.stamp) << "bit for bit";
    ASSERT_EQ(a.color.size(), b.color.size());
    EXPECT_TRUE(std::equal(a.color.begin(), a.color.end(), b.color.begin()));
    ASSERT_EQ(a.depth.size(), b.depth.size());
    EXPECT_TRUE(std::equal(a.depth.begin(), a.depth.end(), b.depth.begin()));
}

/// A recording of this many frames, made by the recorder of that name (folder or .klg).
inline std::filesystem::path make_recording(const std::filesystem::path& out, int frames = 3,
                                            const RecordOptions& options = {}) {
    const auto recorder = make_recorder(out, test_camera(), options);
    for (int i = 0; i < frames; ++i) recorder->add(make_frame(i));
    recorder->finish(std::nullopt);
    return out;
}

inline void write_bytes(const std::filesystem::path& file, const std::string& content) {
    std::ofstream(file, std::ios::binary) << content;
}

/// What opening it says when it does not work: one line. Empty: it works.
inline std::string open_fault(const std::filesystem::path& location, const SourceOptions& options = {}) {
    const std::string message = message_of<Error>([&] { (void)open_source(location, options); });
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
}

/// Opens it and reads all there is; nothing but Error may come of it.
inline void read_whatever_is_there(const std::filesystem::path& location) {
    try {
        const auto source = open_source(location);
        for (std::size_t i = 0; i < source->size(); ++i) {
            try {
                (void)source->read(i);
            } catch (const Error& error) {
                EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
            }
        }
    } catch (const Error& error) {
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
}

/// The file with every part cut off its end, and with every byte spoilt in turn (or one of `step`).
inline void expect_no_harm_in_damage(const std::filesystem::path& file, std::size_t step) {
    const std::string good = read_all(file);
    for (std::size_t i = 0; i < good.size(); i += step) {
        write_bytes(file, good.substr(0, i));
        read_whatever_is_there(file);
        for (const char spoilt : {'\xFF', '\x7F', '\0'}) {
            std::string bad = good;
            bad[i] = spoilt;
            write_bytes(file, bad);
            read_whatever_is_there(file);
        }
    }
    write_bytes(file, good);
}

inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace posefusion::test
