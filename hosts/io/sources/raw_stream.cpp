#include "hosts/io/sources/raw_stream.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <functional>
#include <mutex>
#include <string_view>
#include <utility>

#include "hosts/io/depth_registration.hpp"
#include "hosts/io/input_file.hpp"
#include "hosts/io/sources/patience.hpp"

namespace posefusion {
namespace {

constexpr std::string_view kFirstLine = "posefusion-raw 1\n";
constexpr std::uint32_t kMaxCameraBytes = 1U << 20;
constexpr std::size_t kFrameHeadBytes = 8 + 8 + 4;  ///< two stamps and the length of the colour image
/// Encoded images are smaller than raw ones, but for their headers.
constexpr std::size_t kMaxImageHeaderBytes = 1U << 16;
/// The year 2116: differences of such times do not overflow.
constexpr std::uint64_t kLatest = std::uint64_t{1} << 62;
/// So long nothing may come, e.g. while a camera starts.
constexpr std::chrono::seconds kPatience{30};

/// A pipe.
class Input {
public:
    Input(int descriptor, std::string name, std::function<bool()> cancelled)
        : descriptor_(descriptor), name_(std::move(name)), cancelled_(std::move(cancelled)) {}

    /// Up to `count` bytes: fewer at the end of the stream only. Throws SourceLost: nothing comes, cannot be read,
    /// cancelled.
    [[nodiscard]] std::size_t read(std::uint8_t* to, std::size_t count) const {
        std::size_t done = 0;
        while (done < count) {
            await();
            const ssize_t got = ::read(descriptor_, to + done, count - done);
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) throw SourceLost(name_ + ": cannot be read: " + std::strerror(errno));
            if (got == 0) break;
            done += static_cast<std::size_t>(got);
        }
        return done;
    }

private:
    void await() const {
        const bool ready = wait_with_patience(kPatience, cancelled_, name_, [&](std::chrono::milliseconds pause) {
            pollfd input{descriptor_, POLLIN, 0};
            return ::poll(&input, 1, static_cast<int>(pause.count())) > 0;
        });
        if (!ready)
            throw SourceLost(name_ + ": nothing has come for " + std::to_string(kPatience.count()) +
                             " s; does the program that feeds it still run?");
    }

    int descriptor_;
    std::string name_;
    std::function<bool()> cancelled_;
};

class RawStream final : public FrameSource {
public:
    RawStream(int descriptor, const std::string& location, const SourceOptions& options)
        : input_(descriptor, location, options.cancelled) {
        facts_.location = location;
        facts_.name = location;
        facts_.live = true;
        std::string line(kFirstLine.size(), '\0');
        line.resize(input_.read(reinterpret_cast<std::uint8_t*>(line.data()), line.size()));
        if (line != kFirstLine)
            throw Error(location + ": does not begin with the line '" +
                        std::string(kFirstLine.substr(0, kFirstLine.size() - 1)) + "'; see docs/raw_stream.md");
        find_camera(options);
    }

    [[nodiscard]] RawFrame read(std::size_t) const override {
        const std::lock_guard lock(mutex_);
        const auto block = take_block(most_bytes_, "a frame");
        if (!block) throw SourceEnded(facts_.location + ": the stream has ended");
        const std::string number = facts_.location + ", frame " + std::to_string(frames_++);
        ByteReader reader(*block, number);
        const Stamp color_stamp = take_stamp(reader, number), depth_stamp = take_stamp(reader, number);
        if (frames_ > 1 && color_stamp <= last_)
            throw Error(number + ": its time stamp is not later than the one before it");
        last_ = color_stamp;
        FrameEntry entry = entry_at(color_stamp, depth_stamp);
        RawFrame frame{entry.stamp, std::move(entry.stamp_text), entry.depth_delay, {}, {}, {}, {}};
        frame.color_name = number + ", colour";
        frame.depth_name = number + ", depth";
        const ByteView color = reader.take_block();
        frame.color = color_image(color, frame.color_name);
        frame.depth = depth_image(reader.take(reader.left()), frame.depth_name);
        return frame;
    }

private:
    [[nodiscard]] static Stamp take_stamp(ByteReader& reader, const std::string& frame) {
        const auto nanoseconds = reader.take<std::uint64_t>();
        if (nanoseconds > kLatest) throw Error(frame + ": its time stamp is no time in nanoseconds");
        return Stamp{static_cast<std::int64_t>(nanoseconds)};
    }

    /// A length of 32 bit and so many bytes; nullopt at the end of the stream. Throws SourceLost.
    [[nodiscard]] std::optional<ByteBuffer> take_block(std::size_t at_most, const std::string& what) const {
        std::uint32_t length = 0;
        const std::size_t got = input_.read(reinterpret_cast<std::uint8_t*>(&length), sizeof length);
        if (got == 0) return std::nullopt;
        if (got == sizeof length && length > at_most)
            throw SourceLost(facts_.location + ": announces " + what + " of " + std::to_string(length) +
                             " bytes, more than the " + std::to_string(at_most) + " that it can have");
        ByteBuffer bytes(got == sizeof length ? length : 0);
        if (got < sizeof length || input_.read(bytes.data(), bytes.size()) < bytes.size())
            throw SourceLost(facts_.location + ": ends within " + what);
        return bytes;
    }

    void find_camera(const SourceOptions& options) {
        const auto text = take_block(kMaxCameraBytes, "a camera");
        if (!text) throw SourceLost(facts_.location + ": ends before its camera");
        if (options.camera_file.empty() && text->empty())
            throw Error(facts_.location + ": does not say its camera; give it with --camera FILE");
        const CameraDescription description =
            options.camera_file.empty()
                ? parse_camera_description(std::string(text->begin(), text->end()), facts_.location + ", camera")
                : read_camera_description(options.camera_file);
        facts_.camera = description.camera;
        const Intrinsics& K = facts_.camera.intrinsics;
        if (K.width == 0) throw Error(facts_.location + ": its camera does not say how large the images are");
        registration_ = registration_for(description, std::nullopt, facts_.location, facts_.warnings);
        color_bytes_ = static_cast<std::size_t>(K.width) * static_cast<std::size_t>(K.height) * sizeof(Rgb8);
        depth_size_ = registration_ ? registration_->depth_size() : ImageSize{K.width, K.height};
        depth_bytes_ = static_cast<std::size_t>(depth_size_.width) * static_cast<std::size_t>(depth_size_.height) *
                       sizeof(std::uint16_t);
        most_bytes_ = kFrameHeadBytes + color_bytes_ + depth_bytes_ + 2 * kMaxImageHeaderBytes;
    }

    [[nodiscard]] ColorImage color_image(ByteView bytes, const std::string& name) const {
        const Intrinsics& K = facts_.camera.intrinsics;
        if (bytes.size() != color_bytes_) return decode_color(bytes, name, {K.width, K.height});
        ColorImage color(K.width, K.height);
        std::memcpy(color.data(), bytes.data(), bytes.size());
        return color;
    }

    [[nodiscard]] RawDepth depth_image(ByteView bytes, const std::string& name) const {
        RawDepth depth(depth_size_.width, depth_size_.height);
        if (bytes.size() == depth_bytes_)
            std::memcpy(depth.data(), bytes.data(), bytes.size());
        else
            depth = decode_raw_depth(bytes, name, depth_size_);
        return registration_ ? registration_->apply(depth, facts_.camera.depth_scale) : depth;
    }

    Input input_;
    std::optional<DepthRegistration> registration_;
    ImageSize depth_size_;  ///< of the stream, not registered
    std::size_t color_bytes_ = 0, depth_bytes_ = 0, most_bytes_ = 0;
    mutable std::mutex mutex_;  ///< guards what follows, and the place in the stream
    mutable std::size_t frames_ = 0;
    mutable Stamp last_{};
};

}  // namespace

std::unique_ptr<FrameSource> open_raw_stream(int descriptor, const std::string& location,
                                             const SourceOptions& options) {
    return std::make_unique<RawStream>(descriptor, location, options);
}

std::unique_ptr<FrameSource> open_raw_stream(const SourceOptions& options) {
    constexpr const char* kLocation = "raw:-";
    if (::isatty(STDIN_FILENO) == 1)
        throw Error(std::string(kLocation) +
                    ": standard input is a terminal; pipe frames into it, see "
                    "docs/raw_stream.md");
    return open_raw_stream(STDIN_FILENO, kLocation, options);
}

}  // namespace posefusion
