#pragma once
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

/// Writes Matroska files as k4arecorder does: https://www.rfc-editor.org/rfc/rfc8794 and rfc9559.
namespace posefusion::test {

class MkvWriter {
public:
    /// An element: its number as it stands in the file, the size, the content.
    static std::string element(std::uint32_t id, const std::string& content) {
        std::string out;
        for (int shift = 24; shift >= 0; shift -= 8)
            if (id >> shift != 0) out += static_cast<char>(id >> shift);
        out += '\x01';  // seven bytes of size follow
        for (int shift = 48; shift >= 0; shift -= 8) out += static_cast<char>(content.size() >> shift);
        return out + content;
    }
    static std::string number(std::uint32_t id, std::uint64_t value) {
        std::string bytes;
        for (int shift = 56; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
        return element(id, bytes);
    }

    /// A track of images. @param fourcc  of Microsoft's header, or MJPG
    void add_track(const std::string& name, const std::string& fourcc, int width, int height) {
        std::string header(40, '\0');  // BITMAPINFOHEADER
        const auto put = [&](std::size_t at, std::uint32_t value) { std::memcpy(&header[at], &value, sizeof value); };
        put(0, 40), put(4, static_cast<std::uint32_t>(width)), put(8, static_cast<std::uint32_t>(height));
        std::memcpy(&header[16], fourcc.data(), 4);
        ++tracks_;
        content_of_tracks_ +=
            element(0xAE, number(0xD7, tracks_) + number(0x73C5, tracks_) + number(0x83, 1) + number(0x9C, 0) +
                              element(0x536E, name) + element(0x86, "V_MS/VFW/FOURCC") + element(0x63A2, header) +
                              element(0xE0, number(0xB0, static_cast<std::uint64_t>(width)) +
                                                number(0xBA, static_cast<std::uint64_t>(height))));
    }
    void attach(const std::string& name, const std::string& bytes) {
        attachments_ += element(0x61A7, element(0x466E, name) + element(0x4660, "application/octet-stream") +
                                            element(0x465C, bytes) + number(0x46AE, 1));
    }
    /// @param track  from 1  @param microseconds  since the beginning
    void add(unsigned track, std::uint64_t microseconds, const std::string& bytes) {
        std::string block(1, static_cast<char>(0x80 | track));
        block += std::string("\0\0\x80", 3);  // at the time of its cluster; a key image
        clusters_ += element(0x1F43B675, number(0xE7, microseconds) + element(0xA3, block + bytes));
    }
    [[nodiscard]] std::string finish() const {
        const std::string start =
            element(0x1A45DFA3, number(0x4286, 1) + number(0x42F7, 1) + number(0x42F2, 4) + number(0x42F3, 8) +
                                    element(0x4282, "matroska") + number(0x4287, 4) + number(0x4285, 2));
        constexpr std::uint64_t kMicrosecond = 1000;  // the unit of time, ns
        return start +
               element(0x18538067, element(0x1549A966, number(0x2AD7B1, kMicrosecond) + element(0x4D80, "test") +
                                                           element(0x5741, "test")) +
                                       element(0x1654AE6B, content_of_tracks_) +
                                       (attachments_.empty() ? "" : element(0x1941A469, attachments_)) + clusters_);
    }

private:
    unsigned tracks_ = 0;
    std::string content_of_tracks_, attachments_, clusters_;
};

}  // namespace posefusion::test
