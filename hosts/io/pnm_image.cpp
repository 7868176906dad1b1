#include "hosts/io/pnm_image.hpp"

#include <algorithm>
#include <cctype>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr int kMostValue = 65535, kMostSide = 1 << 20;

}  // namespace

bool is_pnm(ByteView bytes) {
    return bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6' && std::isspace(bytes[2]) != 0;
}

PnmHeader read_pnm_header(ByteView bytes, const std::string& name) {
    if (bytes[1] != '5' && bytes[1] != '6')
        throw Error(name + ": is a PGM or PPM image in text form (P" + static_cast<char>(bytes[1]) +
                    "), which is not read; save it in binary form (P5 or P6) or as PNG");
    std::size_t at = 2;
    const auto next = [&](int most) {
        while (at < bytes.size() && (std::isspace(bytes[at]) != 0 || bytes[at] == '#')) {
            if (bytes[at] == '#')
                while (at < bytes.size() && bytes[at] != '\n') ++at;
            else
                ++at;
        }
        int value = 0;
        const std::size_t begin = at;
        for (; at < bytes.size() && std::isdigit(bytes[at]) != 0 && value <= most; ++at)
            value = 10 * value + bytes[at] - '0';
        if (at == begin || value < 1 || value > most) throw Error(name + ": PGM or PPM header is damaged");
        return value;
    };
    PnmHeader header;
    header.channels = bytes[1] == '5' ? 1 : 3;
    header.size.width = next(kMostSide);
    header.size.height = next(kMostSide);
    header.most = next(kMostValue);
    header.data_at = at + 1;  // one blank
    const std::uint64_t needed = static_cast<std::uint64_t>(header.size.width) *
                                 static_cast<std::uint64_t>(header.size.height) *
                                 static_cast<std::uint64_t>(header.channels) * (header.most > 255 ? 2 : 1);
    if (header.data_at > bytes.size() || bytes.size() - header.data_at < needed)
        throw Error(name + ": PGM or PPM image is truncated");
    return header;
}

Image<std::uint16_t> decode_pgm(ByteView bytes, const std::string& name) {
    const PnmHeader header = read_pnm_header(bytes, name);
    Image<std::uint16_t> image(header.size.width, header.size.height);
    const std::uint8_t* from = bytes.data() + header.data_at;
    for (std::size_t i = 0; i < image.size(); ++i)
        image[i] = header.most > 255 ? static_cast<std::uint16_t>(from[2 * i] << 8 | from[2 * i + 1]) : from[i];
    return image;
}

ColorImage decode_ppm(ByteView bytes, const std::string& name) {
    const PnmHeader header = read_pnm_header(bytes, name);
    ColorImage image(header.size.width, header.size.height);
    const auto value = [&](std::size_t i) {
        const int v = std::min<int>(bytes[header.data_at + i], header.most);
        return static_cast<std::uint8_t>((v * 255 + header.most / 2) / header.most);
    };
    for (std::size_t i = 0; i < image.size(); ++i) {
        if (header.channels == 1)
            image[i] = {value(i), value(i), value(i)};
        else
            image[i] = {value(3 * i), value(3 * i + 1), value(3 * i + 2)};
    }
    return image;
}

}  // namespace posefusion
