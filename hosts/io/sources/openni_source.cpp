#include "hosts/io/sources/openni_source.hpp"

#include <OpenNI.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "hosts/io/association.hpp"
#include "hosts/io/sources/patience.hpp"

namespace posefusion {
namespace {

Stamp stamp_of(const openni::VideoFrameRef& image) { return std::chrono::microseconds(image.getTimestamp()); }

constexpr std::chrono::seconds kPatience{3};  ///< a camera without frames for so long is considered lost
constexpr int kWidth = 640, kHeight = 480, kFramesPerSecond = 30;  ///< preferred

/// OpenNI2 is started once and never stopped: OpenNI::shutdown() unloads drivers whose threads still run.
class Library {
public:
    explicit Library(const std::string& location) {
        static const openni::Status status = openni::OpenNI::initialize();
        if (status != openni::STATUS_OK) throw Error(location + ": OpenNI2 cannot be started: " + last_message());
    }

    /// OpenNI2's own words, in one line.
    static std::string last_message() {
        std::string text = openni::OpenNI::getExtendedError();
        for (char& c : text)
            if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
        text.erase(0, text.find_first_not_of(' '));
        text.erase(text.find_last_not_of(' ') + 1);
        return text;
    }
};

/// A device and its streams.
struct Hardware {
    openni::Device device;
    openni::VideoStream color, depth;
    ~Hardware() {
        color.destroy();
        depth.destroy();
        device.close();
    }
};

/// Drivers may call back once more after a stream was stopped: what has run is kept until the process ends.
void retire(std::unique_ptr<Hardware> hardware) {
    static std::mutex mutex;
    static auto& retired = *new std::vector<std::unique_ptr<Hardware>>;
    const std::lock_guard lock(mutex);
    retired.push_back(std::move(hardware));
}

class OpenNiSource final : public FrameSource {
public:
    /// @param uri  of a device; empty = the first one
    OpenNiSource(const std::string& location, const std::string& uri, const SourceOptions& options)
        : library_(location), cancelled_(options.cancelled) {
        facts_.location = location;
        facts_.name = location;
        if (device_.open(uri.empty() ? openni::ANY_DEVICE : uri.c_str()) != openni::STATUS_OK)
            throw Error((uri.empty() ? "openni2" : location) + ": no such camera (" + Library::last_message() +
                        "); is it plugged in, and may you use it (udev rules of OpenNI2)?");
        open_stream(color_, openni::SENSOR_COLOR, openni::PIXEL_FORMAT_RGB888, "colour");
        open_stream(depth_, openni::SENSOR_DEPTH, openni::PIXEL_FORMAT_DEPTH_1_MM, "depth");
        register_depth();
        find_camera(options);
        facts_.live = true;
        start(color_, "colour");
        start(depth_, "depth");
    }
    ~OpenNiSource() override {
        color_.stop();
        depth_.stop();
        retire(std::move(hardware_));
    }

    /// The next two images that belong together.
    [[nodiscard]] RawFrame read(std::size_t) const override {
        const std::lock_guard lock(mutex_);
        openni::VideoFrameRef color, depth;
        const auto difference = [&] { return std::chrono::abs(stamp_of(color) - stamp_of(depth)); };
        do {
            // The older one of a pair that does not fit is replaced.
            const bool next_color =
                !color.isValid() || (depth.isValid() && color.getTimestamp() < depth.getTimestamp());
            next(next_color ? color_ : depth_, next_color ? color : depth);
        } while (!color.isValid() || !depth.isValid() || difference() >= kMaxStampDifference);

        RawFrame frame;
        FrameEntry time = entry_at(stamp_of(color));
        frame.stamp = time.stamp;
        frame.stamp_text = std::move(time.stamp_text);
        frame.color_name = facts_.location + ", colour at " + frame.stamp_text;
        frame.depth_name = facts_.location + ", depth at " + frame.stamp_text;
        frame.color = color_image(color, frame.color_name);
        frame.depth = depth_image(depth, frame.depth_name);
        return frame;
    }

private:
    void open_stream(openni::VideoStream& stream, openni::SensorType sensor, openni::PixelFormat format,
                     const char* what) {
        if (!device_.hasSensor(sensor) || stream.create(device_, sensor) != openni::STATUS_OK)
            throw Error(facts_.location + ": gives no " + what + " images: " + Library::last_message());
        // The mode nearest to the preferred one; simple devices have only one.
        const auto& modes = stream.getSensorInfo().getSupportedVideoModes();
        const auto distance = [&](const openni::VideoMode& mode) {
            return std::abs(mode.getResolutionX() - kWidth) + std::abs(mode.getResolutionY() - kHeight) +
                   std::abs(mode.getFps() - kFramesPerSecond);
        };
        const openni::VideoMode* best = nullptr;
        for (int i = 0; i < modes.getSize(); ++i)
            if (modes[i].getPixelFormat() == format && (best == nullptr || distance(modes[i]) < distance(*best)))
                best = &modes[i];
        if (best != nullptr) stream.setVideoMode(*best);
        if (stream.getVideoMode().getPixelFormat() != format)
            throw Error(facts_.location + ": gives " + what + " images of a kind that cannot be read");
        stream.setMirroringEnabled(false);
    }

    void register_depth() {
        const auto mode = openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
        const bool possible = device_.isImageRegistrationModeSupported(mode);
        if (!possible || device_.setImageRegistrationMode(mode) != openni::STATUS_OK)
            facts_.warnings.push_back(facts_.location +
                                      ": the device cannot register depth to colour; edges will not fit each other");
        device_.setDepthColorSyncEnabled(true);
    }

    void find_camera(const SourceOptions& options) {
        constexpr float kMillimetres = 1000.0f;
        const openni::VideoMode color = color_.getVideoMode(), depth = depth_.getVideoMode();
        const int width = color.getResolutionX(), height = color.getResolutionY();
        if (depth.getResolutionX() != width || depth.getResolutionY() != height)
            throw Error(facts_.location + ": colour and depth images differ in size");
        if (!options.camera_file.empty()) {
            facts_.camera = read_camera_file(options.camera_file, kMillimetres);
            return;
        }
        const float horizontal = color_.getHorizontalFieldOfView(), vertical = color_.getVerticalFieldOfView();
        const auto w = static_cast<float>(width), h = static_cast<float>(height);
        constexpr float kWidest = 3.0f;  // radians
        if (!(horizontal > 0 && horizontal < kWidest && vertical > 0 && vertical < kWidest))
            throw Error(facts_.location + ": the device does not say what its camera is; give it with --camera FILE");
        facts_.camera = {
            {w / 2 / std::tan(horizontal / 2), h / 2 / std::tan(vertical / 2), (w - 1) / 2, (h - 1) / 2, width, height},
            kMillimetres,
            {}};
        facts_.warnings.push_back(facts_.location +
                                  ": the camera is known by its nominal field of view only; a calibration is better "
                                  "(--camera FILE)");
    }

    void start(openni::VideoStream& stream, const char* what) const {
        if (stream.start() != openni::STATUS_OK)
            throw Error(facts_.location + ": the " + what + " stream cannot be started: " + Library::last_message());
    }

    void next(openni::VideoStream& stream, openni::VideoFrameRef& frame) const {
        const auto wait = [&](std::chrono::milliseconds pause) {
            openni::VideoStream* streams[] = {&stream};
            int ready = -1;
            const auto status = openni::OpenNI::waitForAnyStream(streams, 1, &ready, static_cast<int>(pause.count()));
            return status == openni::STATUS_OK;
        };
        if (!wait_with_patience(kPatience, cancelled_, facts_.location, wait) ||
            stream.readFrame(&frame) != openni::STATUS_OK || !frame.isValid())
            throw SourceLost(facts_.location + ": no images for " + std::to_string(kPatience.count()) +
                             " s; was the camera unplugged?");
    }

    void check(const openni::VideoFrameRef& frame, std::size_t pixel_bytes, const std::string& name) const {
        const Intrinsics& K = facts_.camera.intrinsics;
        const auto width = static_cast<std::size_t>(K.width), height = static_cast<std::size_t>(K.height);
        const bool row_fits = static_cast<std::size_t>(frame.getStrideInBytes()) >= width * pixel_bytes;
        if (frame.getWidth() != K.width || frame.getHeight() != K.height || !row_fits ||
            static_cast<std::size_t>(frame.getDataSize()) <
                static_cast<std::size_t>(frame.getStrideInBytes()) * (height - 1) + width * pixel_bytes)
            throw Error(name + ": is not of the size that the camera file says");
    }

    [[nodiscard]] ColorImage color_image(const openni::VideoFrameRef& frame, const std::string& name) const {
        check(frame, sizeof(openni::RGB888Pixel), name);
        ColorImage color(frame.getWidth(), frame.getHeight());
        for (int v = 0; v < color.height(); ++v) {
            const auto* row = reinterpret_cast<const openni::RGB888Pixel*>(
                static_cast<const std::uint8_t*>(frame.getData()) + v * frame.getStrideInBytes());
            for (int u = 0; u < color.width(); ++u) color(u, v) = {row[u].r, row[u].g, row[u].b};
        }
        return color;
    }

    [[nodiscard]] RawDepth depth_image(const openni::VideoFrameRef& frame, const std::string& name) const {
        check(frame, sizeof(openni::DepthPixel), name);
        RawDepth depth(frame.getWidth(), frame.getHeight());
        for (int v = 0; v < depth.height(); ++v) {
            const auto* row = reinterpret_cast<const openni::DepthPixel*>(
                static_cast<const std::uint8_t*>(frame.getData()) + v * frame.getStrideInBytes());
            std::copy_n(row, depth.width(), &depth(0, v));
        }
        return depth;
    }

    Library library_;
    std::function<bool()> cancelled_;
    std::unique_ptr<Hardware> hardware_ = std::make_unique<Hardware>();
    openni::Device& device_ = hardware_->device;
    openni::VideoStream &color_ = hardware_->color, &depth_ = hardware_->depth;
    mutable std::mutex mutex_;
};

}  // namespace

std::unique_ptr<FrameSource> open_openni_camera(const std::string& uri, const SourceOptions& options) {
    return std::make_unique<OpenNiSource>("openni2:" + uri, uri, options);
}

bool has_openni() { return true; }

}  // namespace posefusion
