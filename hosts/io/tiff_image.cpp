#include "hosts/io/tiff_image.hpp"

#include <tiffio.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/io/image_header.hpp"

namespace posefusion {
namespace {

constexpr tmsize_t kMostMemory = tmsize_t{1} << 28;  ///< bytes that a file may make the library take at once

/// The bytes as libtiff reads them.
struct ByteStream {
    ByteView bytes;
    toff_t at = 0;

    static tmsize_t read(thandle_t handle, void* to, tmsize_t count) {
        auto& stream = *static_cast<ByteStream*>(handle);
        if (count < 0 || stream.at >= stream.bytes.size()) return 0;
        const auto part = std::min<std::size_t>(static_cast<std::size_t>(count), stream.bytes.size() - stream.at);
        std::memcpy(to, stream.bytes.data() + stream.at, part);
        stream.at += part;
        return static_cast<tmsize_t>(part);
    }
    static tmsize_t write(thandle_t, void*, tmsize_t) { return 0; }
    static toff_t seek(thandle_t handle, toff_t offset, int from) {
        auto& stream = *static_cast<ByteStream*>(handle);
        const toff_t base = from == SEEK_CUR ? stream.at : from == SEEK_END ? stream.bytes.size() : 0;
        return stream.at = base + offset;
    }
    static int close(thandle_t) { return 0; }
    static toff_t size(thandle_t handle) { return static_cast<ByteStream*>(handle)->bytes.size(); }
};

int no_message(TIFF*, void*, const char*, const char*, va_list) { return 1; }

/// An opened file. It reports faults by what its functions return and says nothing on the console.
class TiffFile {
public:
    TiffFile(ByteView bytes, std::string name) : stream_{bytes}, name_(std::move(name)) {
        const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(),
                                                                                       &TIFFOpenOptionsFree);
        TIFFOpenOptionsSetErrorHandlerExtR(options.get(), no_message, nullptr);
        TIFFOpenOptionsSetWarningHandlerExtR(options.get(), no_message, nullptr);
        TIFFOpenOptionsSetMaxSingleMemAlloc(options.get(), kMostMemory);
        // m: the bytes are not mapped
        tiff_.reset(TIFFClientOpenExt("image", "rm", &stream_, ByteStream::read, ByteStream::write, ByteStream::seek,
                                      ByteStream::close, ByteStream::size, nullptr, nullptr, options.get()));
        if (!tiff_) fail();
        std::uint32_t width = 0, height = 0;
        if (TIFFGetField(get(), TIFFTAG_IMAGEWIDTH, &width) != 1 ||
            TIFFGetField(get(), TIFFTAG_IMAGELENGTH, &height) != 1)
            fail();
        if (width == 0 || height == 0 || width > kMaxImageSide || height > kMaxImageSide)
            throw Error(name_ + ": has an impossible size, " + std::to_string(width) + "x" + std::to_string(height));
        header_ = {ImageFormat::Tiff,
                   {static_cast<int>(width), static_cast<int>(height)},
                   field(TIFFTAG_BITSPERSAMPLE),
                   field(TIFFTAG_PHOTOMETRIC) == PHOTOMETRIC_PALETTE ? 3 : field(TIFFTAG_SAMPLESPERPIXEL),
                   field(TIFFTAG_SAMPLEFORMAT) == SAMPLEFORMAT_IEEEFP};
    }

    [[nodiscard]] TIFF* get() const { return tiff_.get(); }
    [[nodiscard]] const ImageHeader& header() const { return header_; }
    [[noreturn]] void fail() const { throw Error(name_ + ": TIFF image is damaged or truncated"); }

    /// Rows of values as they are, of an image of one channel.
    template <class Value>
    [[nodiscard]] Image<Value> values() const {
        if (TIFFIsTiled(get()) != 0)
            throw Error(name_ + ": is a tiled TIFF image, which is not read; save it in strips");
        Image<Value> image(header_.size.width, header_.size.height);
        const auto row_bytes = static_cast<tmsize_t>(sizeof(Value)) * image.width();
        if (TIFFScanlineSize(get()) != row_bytes) fail();
        for (int v = 0; v < image.height(); ++v)
            if (TIFFReadScanline(get(), &image(0, v), static_cast<std::uint32_t>(v), 0) != 1) fail();
        return image;
    }

private:
    [[nodiscard]] int field(std::uint32_t tag) const {
        std::uint16_t value = 0;
        return TIFFGetFieldDefaulted(get(), tag, &value) == 1 ? value : 0;
    }

    ByteStream stream_;
    std::string name_;
    std::unique_ptr<TIFF, decltype(&TIFFClose)> tiff_{nullptr, &TIFFClose};
    ImageHeader header_;
};

}  // namespace

bool is_tiff(ByteView bytes) {
    return bytes.size() > 4 &&
           (std::memcmp(bytes.data(), "II*\0", 4) == 0 || std::memcmp(bytes.data(), "MM\0*", 4) == 0);
}

ImageHeader read_tiff_header(ByteView bytes, const std::string& name) { return TiffFile(bytes, name).header(); }

Image<std::uint16_t> decode_tiff_short(ByteView bytes, const std::string& name) {
    return TiffFile(bytes, name).values<std::uint16_t>();
}

Image<float> decode_tiff_float(ByteView bytes, const std::string& name) {
    return TiffFile(bytes, name).values<float>();
}

ColorImage decode_tiff_color(ByteView bytes, const std::string& name) {
    const TiffFile file(bytes, name);
    const ImageSize size = file.header().size;
    ColorImage color(size.width, size.height);
    std::vector<std::uint32_t> pixels(color.size());
    constexpr int kStopOnError = 1;
    if (TIFFReadRGBAImageOriented(file.get(), static_cast<std::uint32_t>(size.width),
                                  static_cast<std::uint32_t>(size.height), pixels.data(), ORIENTATION_TOPLEFT,
                                  kStopOnError) != 1)
        file.fail();
    for (std::size_t i = 0; i < color.size(); ++i)
        color[i] = {static_cast<std::uint8_t>(TIFFGetR(pixels[i])), static_cast<std::uint8_t>(TIFFGetG(pixels[i])),
                    static_cast<std::uint8_t>(TIFFGetB(pixels[i]))};
    return color;
}

}  // namespace posefusion
