// Stands in for OpenCV's imgcodecs in the Python wheel: images by libpng, libjpeg, libwebp and stb. Debian's imgcodecs
// needs GDAL and with it eighty libraries, some of them under the GPL, none of which the module uses. Only what
// hosts/io calls is here, with the results of OpenCV (cv::imdecode, cv::imencode).
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
// clang-format off
#include <jpeglib.h>  // after <cstdio>, which it needs
#include <png.h>
#include <webp/decode.h>
// clang-format on
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_BMP
#include <stb/stb_image.h>

namespace {

constexpr int kMaxSide = 1 << 16;    // pixels
constexpr int kDefaultQuality = 95;  // of a JPEG, as in OpenCV
constexpr unsigned char kPngSignature[] = {0x89, 'P', 'N', 'G'};
constexpr unsigned char kJpegSignature[] = {0xff, 0xd8, 0xff};
constexpr unsigned char kWebPSignature[] = {'R', 'I', 'F', 'F'};
constexpr unsigned char kBmpSignature[] = {'B', 'M'};

struct Bytes {
    const unsigned char* data;
    std::size_t size, at;
};

template <std::size_t Size>
bool starts_with(const Bytes& file, const unsigned char (&signature)[Size]) {
    return file.size >= Size && std::memcmp(file.data, signature, Size) == 0;
}

// ------------------------------------------------------------------------------------------------------------- PNG

void read_png_bytes(png_structp png, png_bytep to, png_size_t count) {
    Bytes& file = *static_cast<Bytes*>(png_get_io_ptr(png));
    if (file.size - file.at < count) png_error(png, "file ends early");
    std::memcpy(to, file.data + file.at, count);
    file.at += count;
}

void append_png_bytes(png_structp png, png_bytep from, png_size_t count) {
    auto& file = *static_cast<std::vector<uchar>*>(png_get_io_ptr(png));
    file.insert(file.end(), from, from + count);
}

void ignore_png_warning(png_structp, png_const_charp) {}

/// libpng leaves by longjmp, past everything that has a destructor: nothing of the kind is made in here.
bool decode_png(png_structp png, png_infop info, Bytes& file, int flags, cv::Mat& image, std::vector<png_bytep>& rows) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_read_fn(png, &file, read_png_bytes);
    png_set_user_limits(png, kMaxSide, kMaxSide);
    png_read_info(png, info);
    const bool unchanged = flags == cv::IMREAD_UNCHANGED, color = unchanged || (flags & cv::IMREAD_COLOR) != 0;
    const bool keeps_depth = unchanged || (flags & cv::IMREAD_ANYDEPTH) != 0;
    const int type = png_get_color_type(png, info);
    const bool has_color = (type & PNG_COLOR_MASK_COLOR) != 0;
    png_set_expand(png);  // palettes, fewer than 8 bits and transparent colours
    if (!unchanged) png_set_strip_alpha(png);
    if (png_get_bit_depth(png, info) == 16) {
        if (!keeps_depth)
            png_set_strip_16(png);
        else if (std::endian::native == std::endian::little)
            png_set_swap(png);
    }
    if (color && has_color) png_set_bgr(png);
    if (color && !has_color && !unchanged) png_set_gray_to_rgb(png);
    if (!color && has_color) png_set_rgb_to_gray(png, PNG_ERROR_ACTION_NONE, 0.299, 0.587);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    const int depth = png_get_bit_depth(png, info) == 16 ? CV_16U : CV_8U;
    image.create(static_cast<int>(png_get_image_height(png, info)), static_cast<int>(png_get_image_width(png, info)),
                 CV_MAKETYPE(depth, png_get_channels(png, info)));
    rows.resize(static_cast<std::size_t>(image.rows));
    for (int v = 0; v < image.rows; ++v) rows[static_cast<std::size_t>(v)] = image.ptr(v);
    png_read_image(png, rows.data());
    png_read_end(png, nullptr);
    return true;
}

cv::Mat decode_png(Bytes file, int flags) {
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, ignore_png_warning);
    png_infop info = png_create_info_struct(png);
    cv::Mat image;
    std::vector<png_bytep> rows;
    const bool good = decode_png(png, info, file, flags, image, rows);
    png_destroy_read_struct(&png, &info, nullptr);
    return good ? image : cv::Mat();
}

bool encode_png(png_structp png, png_infop info, const cv::Mat& image, std::vector<uchar>& bytes) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_set_write_fn(png, &bytes, append_png_bytes, nullptr);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);  // for speed, as OpenCV sets them
    png_set_compression_level(png, 1);
    png_set_compression_strategy(png, 3);  // runs of equal values
    const int type = image.channels() == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB;
    png_set_IHDR(png, info, static_cast<png_uint_32>(image.cols), static_cast<png_uint_32>(image.rows),
                 image.depth() == CV_16U ? 16 : 8, type, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    if (image.channels() == 3) png_set_bgr(png);
    if (image.depth() == CV_16U && std::endian::native == std::endian::little) png_set_swap(png);
    for (int v = 0; v < image.rows; ++v) png_write_row(png, image.ptr(v));
    png_write_end(png, info);
    return true;
}

bool encode_png(const cv::Mat& image, std::vector<uchar>& bytes) {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, ignore_png_warning);
    png_infop info = png_create_info_struct(png);
    const bool good = encode_png(png, info, image, bytes);
    png_destroy_write_struct(&png, &info);
    return good;
}

// ------------------------------------------------------------------------------------------------------------ JPEG

struct JpegErrors {
    jpeg_error_mgr manager;
    std::jmp_buf leave;
};

[[noreturn]] void leave_jpeg(j_common_ptr jpeg) { std::longjmp(reinterpret_cast<JpegErrors*>(jpeg->err)->leave, 1); }

void ignore_jpeg_message(j_common_ptr) {}

void start_jpeg_errors(JpegErrors& errors) {
    jpeg_std_error(&errors.manager);
    errors.manager.error_exit = leave_jpeg;
    errors.manager.output_message = ignore_jpeg_message;
}

bool decode_jpeg(jpeg_decompress_struct& jpeg, JpegErrors& errors, const Bytes& file, int flags, cv::Mat& image) {
    if (setjmp(errors.leave) != 0) return false;
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, file.data, file.size);
    jpeg_read_header(&jpeg, TRUE);
    const bool color = flags == cv::IMREAD_UNCHANGED ? jpeg.num_components > 1 : (flags & cv::IMREAD_COLOR) != 0;
    if (jpeg.num_components > 3) return false;  // print colours: no camera has them
    jpeg.out_color_space = color ? JCS_EXT_BGR : JCS_GRAYSCALE;
    jpeg_start_decompress(&jpeg);
    image.create(static_cast<int>(jpeg.output_height), static_cast<int>(jpeg.output_width), color ? CV_8UC3 : CV_8UC1);
    while (jpeg.output_scanline < jpeg.output_height) {
        JSAMPROW row = image.ptr(static_cast<int>(jpeg.output_scanline));
        jpeg_read_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_decompress(&jpeg);
    return true;
}

cv::Mat decode_jpeg(const Bytes& file, int flags) {
    jpeg_decompress_struct jpeg{};
    JpegErrors errors;
    start_jpeg_errors(errors);
    jpeg.err = &errors.manager;
    cv::Mat image;
    const bool good = decode_jpeg(jpeg, errors, file, flags, image);
    jpeg_destroy_decompress(&jpeg);
    return good ? image : cv::Mat();
}

bool encode_jpeg(jpeg_compress_struct& jpeg, JpegErrors& errors, const cv::Mat& image, int quality, uchar*& bytes,
                 unsigned long& size) {
    if (setjmp(errors.leave) != 0) return false;
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &bytes, &size);
    jpeg.image_width = static_cast<JDIMENSION>(image.cols);
    jpeg.image_height = static_cast<JDIMENSION>(image.rows);
    jpeg.input_components = image.channels();
    jpeg.in_color_space = image.channels() == 3 ? JCS_EXT_BGR : JCS_GRAYSCALE;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, quality, TRUE);
    jpeg_start_compress(&jpeg, TRUE);
    while (jpeg.next_scanline < jpeg.image_height) {
        JSAMPROW row = const_cast<uchar*>(image.ptr(static_cast<int>(jpeg.next_scanline)));
        jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    return true;
}

bool encode_jpeg(const cv::Mat& image, int quality, std::vector<uchar>& to) {
    jpeg_compress_struct jpeg{};
    JpegErrors errors;
    start_jpeg_errors(errors);
    jpeg.err = &errors.manager;
    uchar* bytes = nullptr;  // libjpeg's
    unsigned long size = 0;
    const bool good = encode_jpeg(jpeg, errors, image, quality, bytes, size);
    if (good) to.assign(bytes, bytes + size);
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);
    return good;
}

// ---------------------------------------------------------------------------------------------- colour images only

cv::Mat decode_webp(const Bytes& file) {
    int width = 0, height = 0;
    if (WebPGetInfo(file.data, file.size, &width, &height) == 0) return {};
    cv::Mat image(height, width, CV_8UC3);
    const std::size_t size = image.total() * image.elemSize();
    const bool good = WebPDecodeBGRInto(file.data, file.size, image.ptr(), size, 3 * width) != nullptr;
    return good ? image : cv::Mat();
}

cv::Mat decode_bmp(const Bytes& file) {
    int width = 0, height = 0, channels = 0;
    unsigned char* const rgb =
        stbi_load_from_memory(file.data, static_cast<int>(file.size), &width, &height, &channels, 3);
    if (rgb == nullptr) return {};
    cv::Mat image;
    cv::cvtColor(cv::Mat(height, width, CV_8UC3, rgb), image, cv::COLOR_RGB2BGR);
    stbi_image_free(rgb);
    return image;
}

}  // namespace

namespace cv {

/// @return empty if the bytes are no whole image
Mat imdecode(InputArray buffer, int flags) {
    const Mat bytes = buffer.getMat();
    const Bytes file{bytes.ptr(), bytes.total() * bytes.elemSize(), 0};
    const int wanted = flags == IMREAD_UNCHANGED ? flags : flags & ~IMREAD_IGNORE_ORIENTATION;
    if (starts_with(file, kPngSignature)) return decode_png(file, wanted);
    if (starts_with(file, kJpegSignature)) return decode_jpeg(file, wanted);
    if (wanted == IMREAD_COLOR && starts_with(file, kWebPSignature)) return decode_webp(file);
    if (wanted == IMREAD_COLOR && starts_with(file, kBmpSignature)) return decode_bmp(file);
    return {};
}

bool imencode(const String& extension, InputArray picture, std::vector<uchar>& bytes,
              const std::vector<int>& parameters) {
    const Mat image = picture.getMat();
    const bool takes = image.channels() == 1 || image.channels() == 3;
    bytes.clear();
    if (extension == ".png" && takes && (image.depth() == CV_8U || image.depth() == CV_16U))
        return encode_png(image, bytes);
    int quality = kDefaultQuality;
    for (std::size_t i = 0; i + 1 < parameters.size(); i += 2)
        if (parameters[i] == IMWRITE_JPEG_QUALITY) quality = parameters[i + 1];
    return extension == ".jpg" && takes && image.depth() == CV_8U && encode_jpeg(image, quality, bytes);
}

}  // namespace cv
