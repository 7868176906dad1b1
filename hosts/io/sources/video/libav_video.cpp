// The module of video_file.hpp: FFmpeg's libraries stay in here.
extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>

#include "engine/core/error.hpp"
#include "hosts/io/sources/video/video_file.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr int kMostPixelsPerSide = 1 << 14;
/// An image so few after the last one is found by reading on, not by a jump to the key image before it.
constexpr std::size_t kReadOn = 60;

template <auto free_it>
struct Freed {
    template <class T>
    void operator()(T* pointer) const {
        free_it(&pointer);
    }
};
using Container = std::unique_ptr<AVFormatContext, Freed<avformat_close_input>>;
using Decoder = std::unique_ptr<AVCodecContext, Freed<avcodec_free_context>>;
using Packet = std::unique_ptr<AVPacket, Freed<av_packet_free>>;
using Picture = std::unique_ptr<AVFrame, Freed<av_frame_free>>;
struct FreedScaler {
    void operator()(SwsContext* scaler) const { sws_freeContext(scaler); }
};

std::string text_of(int fault) {
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(fault, text, sizeof text);
    return text;
}

/// Only files, and only of these formats: others may name further files.
Container open_container(const fs::path& file) {
    AVDictionary* options = nullptr;
    av_dict_set(&options, "format_whitelist", "matroska,webm,mov,mp4,m4a,3gp,3g2,mj2", 0);
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    AVFormatContext* container = nullptr;
    const int fault = avformat_open_input(&container, ("file:" + file.string()).c_str(), nullptr, &options);
    av_dict_free(&options);
    if (fault < 0) throw Error(file.string() + ": is no video that can be read (" + text_of(fault) + ")");
    return Container(container);
}

std::string entry(const AVDictionary* dictionary, const char* key) {
    const AVDictionaryEntry* found = av_dict_get(dictionary, key, nullptr, 0);
    return found == nullptr ? "" : found->value;
}

Stamp stamp_at(std::int64_t time, AVRational unit) {
    constexpr AVRational kNanosecond{1, 1'000'000'000};
    return Stamp{av_rescale_q(time, unit, kNanosecond)};
}

/// One track, read by a container of its own.
class Track {
public:
    Track(fs::path file, int stream, std::vector<std::int64_t> times)
        : file_(std::move(file)), stream_(stream), times_(std::move(times)) {}

    ColorImage color(std::size_t i) {
        const std::lock_guard lock(mutex_);
        begin();
        if (!decoder_) open_decoder();
        const std::int64_t wanted = times_.at(i);
        const bool near = next_ && *next_ <= i && i < *next_ + kReadOn;
        if (!near) jump(i);
        next_.reset();
        const Picture picture(av_frame_alloc());
        while (receive(*picture, i)) {
            if (picture->best_effort_timestamp < wanted) continue;
            if (picture->best_effort_timestamp > wanted) break;
            next_ = i + 1;
            return rgb(*picture, i);
        }
        throw Error(name(i) + ": is damaged");
    }

    RawDepth grey16(std::size_t i) {
        const std::lock_guard lock(mutex_);
        begin();
        const AVCodecParameters& format = *container_->streams[stream_]->codecpar;
        const bool big_endian = format.codec_tag == MKTAG('b', '1', '6', 'g');
        if (!big_endian && format.codec_tag != MKTAG('Y', '1', '6', ' '))
            throw Error(name(i) + ": is not an uncompressed image of 16 bit");
        const bool near = next_ && *next_ <= i && i < *next_ + kReadOn;
        if (!near) jump(i);
        next_.reset();
        const Packet packet(av_packet_alloc());
        while (read(*packet)) {
            if (packet->pts < times_.at(i)) continue;
            if (packet->pts > times_.at(i)) break;
            const auto pixels = static_cast<std::size_t>(format.width) * static_cast<std::size_t>(format.height);
            if (static_cast<std::size_t>(packet->size) != 2 * pixels) break;
            RawDepth depth(format.width, format.height);
            for (std::size_t p = 0; p < depth.size(); ++p) {
                const std::uint8_t first = packet->data[2 * p], second = packet->data[2 * p + 1];
                depth[p] = static_cast<std::uint16_t>(big_endian ? first << 8 | second : second << 8 | first);
            }
            next_ = i + 1;
            return depth;
        }
        throw Error(name(i) + ": is damaged");
    }

private:
    [[nodiscard]] std::string name(std::size_t i) const {
        return file_.string() + ", track " + std::to_string(stream_) + ", image " + std::to_string(i);
    }

    void begin() {
        if (container_) return;
        container_ = open_container(file_);
        for (unsigned s = 0; s < container_->nb_streams; ++s)
            if (static_cast<int>(s) != stream_) container_->streams[s]->discard = AVDISCARD_ALL;
    }

    void open_decoder() {
        const AVCodecParameters& format = *container_->streams[stream_]->codecpar;
        const AVCodec* codec = avcodec_find_decoder(format.codec_id);
        if (codec == nullptr) throw Error(file_.string() + ": the coding of its images is not known");
        decoder_.reset(avcodec_alloc_context3(codec));
        int fault = avcodec_parameters_to_context(decoder_.get(), &format);
        if (fault >= 0) fault = avcodec_open2(decoder_.get(), codec, nullptr);
        if (fault < 0) throw Error(file_.string() + ": its images cannot be decoded (" + text_of(fault) + ")");
    }

    /// To the last key image up to that one, or, in a file without an index, to its beginning.
    void jump(std::size_t i) {
        const bool at_the_beginning = i == 0 && fresh_;
        if (!at_the_beginning && av_seek_frame(container_.get(), stream_, times_.at(i), AVSEEK_FLAG_BACKWARD) < 0) {
            container_.reset();
            begin();
        }
        if (decoder_) avcodec_flush_buffers(decoder_.get());
        drained_ = false;
    }

    /// The next packet of the track.
    bool read(AVPacket& packet) {
        fresh_ = false;
        do av_packet_unref(&packet);
        while (av_read_frame(container_.get(), &packet) >= 0 && packet.stream_index != stream_);
        return packet.buf != nullptr;
    }

    bool receive(AVFrame& picture, std::size_t i) {
        const Packet packet(av_packet_alloc());
        for (;;) {
            const int state = avcodec_receive_frame(decoder_.get(), &picture);
            if (state == 0) return true;
            if (state != AVERROR(EAGAIN) || drained_) return false;
            drained_ = !read(*packet);
            const int fault = avcodec_send_packet(decoder_.get(), drained_ ? nullptr : packet.get());
            if (fault < 0) throw Error(name(i) + ": cannot be decoded (" + text_of(fault) + ")");
        }
    }

    ColorImage rgb(const AVFrame& picture, std::size_t i) {
        const AVCodecParameters& format = *container_->streams[stream_]->codecpar;
        if (picture.width != format.width || picture.height != format.height)
            throw Error(name(i) + ": is of another size than the others");
        scaler_.reset(sws_getContext(picture.width, picture.height, static_cast<AVPixelFormat>(picture.format),
                                     picture.width, picture.height, AV_PIX_FMT_RGB24,
                                     SWS_BICUBIC | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_BITEXACT, nullptr,
                                     nullptr, nullptr));
        if (!scaler_) throw Error(name(i) + ": its pixels are of a kind that is not known");
        constexpr int kOne = 1 << 16;
        sws_setColorspaceDetails(scaler_.get(), sws_getCoefficients(picture.colorspace),
                                 picture.color_range == AVCOL_RANGE_JPEG ? 1 : 0, sws_getCoefficients(SWS_CS_DEFAULT),
                                 1, 0, kOne, kOne);
        ColorImage image(picture.width, picture.height);
        std::uint8_t* const rows[] = {reinterpret_cast<std::uint8_t*>(image.data())};
        const int stride[] = {static_cast<int>(sizeof(Rgb8)) * picture.width};
        if (sws_scale(scaler_.get(), picture.data, picture.linesize, 0, picture.height, rows, stride) != picture.height)
            throw Error(name(i) + ": is damaged");
        return image;
    }

    fs::path file_;
    int stream_;
    std::vector<std::int64_t> times_;  // of the images, ascending, in the unit of the track
    std::mutex mutex_;
    Container container_;
    Decoder decoder_;
    std::unique_ptr<SwsContext, FreedScaler> scaler_;
    std::optional<std::size_t> next_;  // the image that comes when reading goes on
    bool fresh_ = true, drained_ = false;
};

using Times = std::vector<std::int64_t>;

/// The times of the images of all streams, in their units, ascending; those that no clock can have are left out.
std::vector<Times> times_of_images(AVFormatContext& container) {
    std::vector<Times> times(container.nb_streams);
    const Packet packet(av_packet_alloc());
    while (av_read_frame(&container, packet.get()) >= 0) {
        const auto stream = static_cast<std::size_t>(packet->stream_index);
        if (stream < times.size() && packet->pts != AV_NOPTS_VALUE) {
            const Stamp stamp = stamp_at(packet->pts, container.streams[stream]->time_base);
            if (stamp >= -kFarthestStamp && stamp <= kFarthestStamp) times[stream].push_back(packet->pts);
        }
        av_packet_unref(packet.get());
    }
    for (Times& of_stream : times) {
        std::sort(of_stream.begin(), of_stream.end());
        of_stream.erase(std::unique(of_stream.begin(), of_stream.end()), of_stream.end());
    }
    return times;
}

bool holds_images(const AVCodecParameters& format) {
    return format.codec_type == AVMEDIA_TYPE_VIDEO && format.width > 0 && format.height > 0 &&
           format.width <= kMostPixelsPerSide && format.height <= kMostPixelsPerSide;
}

}  // namespace

extern "C" void open_video_by_libav(const fs::path& file, VideoFile& video) {
    av_log_set_level(AV_LOG_QUIET);  // faults are Errors
    const Container container = open_container(file);
    std::vector<Times> times = times_of_images(*container);
    const auto readers = std::make_shared<std::vector<std::unique_ptr<Track>>>();
    for (std::size_t s = 0; s < times.size(); ++s) {
        const AVStream& stream = *container->streams[s];
        const AVCodecParameters& format = *stream.codecpar;
        if (format.codec_type == AVMEDIA_TYPE_ATTACHMENT && format.extradata != nullptr)
            video.attachments[entry(stream.metadata, "filename")].assign(
                reinterpret_cast<const char*>(format.extradata), static_cast<std::size_t>(format.extradata_size));
        if (!holds_images(format) || times[s].empty()) continue;
        VideoTrack& track = video.tracks.emplace_back();
        track.name = entry(stream.metadata, "title");
        track.size = {format.width, format.height};
        for (const std::int64_t time : times[s]) track.stamps.push_back(stamp_at(time, stream.time_base));
        readers->push_back(std::make_unique<Track>(file, static_cast<int>(s), std::move(times[s])));
    }
    if (video.tracks.empty()) throw Error(file.string() + ": holds no image");
    video.color = [readers](std::size_t track, std::size_t i) { return readers->at(track)->color(i); };
    video.grey16 = [readers](std::size_t track, std::size_t i) { return readers->at(track)->grey16(i); };
}

}  // namespace posefusion
