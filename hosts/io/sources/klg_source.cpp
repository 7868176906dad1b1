#include "hosts/io/sources/klg_source.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "hosts/io/input_file.hpp"
#include "hosts/io/sources/time_order.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr float kMillimetres = 1000.0f;
constexpr std::size_t kCountBytes = sizeof(std::int32_t);
constexpr std::size_t kFrameHeaderBytes = sizeof(std::int64_t) + 2 * sizeof(std::int32_t);
/// Three days at 15 Hz; the index of more would take more memory than the images of a run.
constexpr std::size_t kMaxFrames = std::size_t{1} << 22;
/// Bytes that zlib and JPEG may need beyond the raw image: tables and headers for incompressible noise.
constexpr std::int64_t kOverhead = 65536;

/// Of logs without colour: a grey on which shading can be seen, without texture to track.
constexpr Rgb8 kNoColor{128, 128, 128};

/// ElasticFusion's default camera.
Camera default_camera() { return {{528, 528, 320, 240, 640, 480}, kMillimetres, {}}; }

/// Position of a frame in the file.
struct Place {
    Stamp stamp{};
    std::size_t number = 0;  ///< in the file, from 0
    std::uint64_t offset = 0;
    std::size_t depth_bytes = 0, color_bytes = 0;
};

class KlgFile final : public FrameSource {
public:
    KlgFile(const fs::path& file, const SourceOptions& options)
        : path_(file), file_(file), flip_colors_(options.flip_colors) {
        facts_.location = file.string();
        facts_.name = file.stem().string();
        facts_.camera = find_camera(options);
        const Intrinsics& K = facts_.camera.intrinsics;
        pixels_ = static_cast<std::size_t>(K.width) * static_cast<std::size_t>(K.height);
        read_index();
        sort_index();
        has_color_ =
            std::any_of(places_.begin(), places_.end(), [](const Place& place) { return place.color_bytes > 0; });
        if (!has_color_)
            facts_.warnings.push_back(file_.name() +
                                      ": holds no colour; the camera is tracked on depth alone, the map is grey, and "
                                      "people can only be known from --masks");
        for (const Place& place : places_) facts_.frames.push_back(entry_at(place.stamp));
    }

    [[nodiscard]] RawFrame read(std::size_t i) const override {
        const FrameEntry& entry = facts_.frames.at(i);
        const Place& place = places_[i];
        const std::string name = frame_name(place.number);
        const ByteBuffer bytes = file_.read(place.offset, place.depth_bytes + place.color_bytes);
        const ByteView all(bytes);
        RawFrame frame{entry.stamp, entry.stamp_text, entry.depth_delay, {}, {}, name + ", colour", name + ", depth"};
        frame.depth = decode_depth(all.first(place.depth_bytes), frame.depth_name);
        frame.color = decode_color(all.subspan(place.depth_bytes), frame.color_name);
        return frame;
    }

    [[nodiscard]] std::optional<Trajectory> groundtruth() const override {
        const fs::path file = klg_groundtruth_file(path_);
        if (!fs::exists(file)) return std::nullopt;
        return read_trajectory(file);
    }

private:
    [[nodiscard]] std::string frame_name(std::size_t number) const {
        return file_.name() + ", frame " + std::to_string(number + 1);
    }

    Camera find_camera(const SourceOptions& options) {
        if (!options.camera_file.empty()) return read_camera_file(options.camera_file, kMillimetres);
        const fs::path beside = klg_camera_file(path_);
        if (fs::exists(beside)) return read_camera_file(beside, kMillimetres);
        facts_.warnings.push_back(file_.name() + ": the camera is not known (no " + beside.filename().string() +
                                  " beside it); ElasticFusion's default is assumed (528 528 320 240, 640x480, "
                                  "millimetres); give the right one with --camera FILE");
        return default_camera();
    }

    /// Finds all frames. The logger writes the number at the start of the file last, so it is only used to report
    /// missing frames.
    void read_index() {
        if (file_.size() < kCountBytes + kFrameHeaderBytes) throw Error(file_.name() + ": is too short for a .klg log");
        const ByteBuffer head = file_.read(0, kCountBytes);
        const auto announced = ByteReader(head, file_.name()).take<std::int32_t>();
        std::uint64_t at = kCountBytes;
        std::string fault;  // in the data after the last frame
        while (at < file_.size() && fault.empty()) {
            Place place;
            fault = places_.size() == kMaxFrames ? "is one too many" : find_place(at, place);
            if (!fault.empty()) break;
            at = place.offset + place.depth_bytes + place.color_bytes;
            places_.push_back(place);
        }
        if (places_.empty()) throw Error(file_.name() + ": is no .klg log: its first frame " + fault);
        warn_of_count(announced, fault);
    }

    /// @return the fault of the frame that begins there; empty: none
    std::string find_place(std::uint64_t at, Place& place) const {
        if (file_.size() - at < kFrameHeaderBytes) return "ends early";
        const ByteBuffer header = file_.read(at, kFrameHeaderBytes);
        ByteReader numbers(header, file_.name());
        const auto microseconds = numbers.take<std::int64_t>();
        const std::int64_t depth = numbers.take<std::int32_t>(), color = numbers.take<std::int32_t>();
        const auto limit = static_cast<std::int64_t>(3 * pixels_) + kOverhead;
        if (depth <= 0 || color < 0 || depth > limit || color > limit || microseconds < 0 ||
            microseconds > std::chrono::duration_cast<std::chrono::microseconds>(kFarthestStamp).count())
            return "is damaged, or not of the size that the camera file says";
        place.offset = at + kFrameHeaderBytes;
        if (file_.size() - place.offset < static_cast<std::uint64_t>(depth + color)) return "ends early";
        place.stamp = std::chrono::microseconds(microseconds);
        place.number = places_.size();
        place.depth_bytes = static_cast<std::size_t>(depth);
        place.color_bytes = static_cast<std::size_t>(color);
        return {};
    }

    void warn_of_count(std::int32_t announced, const std::string& fault) {
        const auto found = static_cast<std::int64_t>(places_.size());
        const std::string frames = count_text(places_.size(), "frame");
        std::string warning;
        if (announced <= 0)
            warning = "no frames announced (was the logger killed?), " + frames + " found and used";
        else if (announced != found)
            warning = count_text(static_cast<std::size_t>(announced), "frame") + " announced, " +
                      std::to_string(found) + (announced < found ? " found and used" : " can be used");
        if (!fault.empty())
            warning += (warning.empty() ? "after its " + frames + " comes something that is left out: it "
                                        : ": the next one ") +
                       fault;
        else if (announced > found)
            warning += ": the file ends";
        if (!warning.empty()) facts_.warnings.push_back(file_.name() + ": " + warning);
    }

    void sort_index() {
        if (say_nothing(stamps_of(places_))) {
            for (Place& place : places_) place.stamp = stamp_of_number(place.number);
            facts_.warnings.push_back(file_.name() + ": its time stamps are all alike; 30 frames a second are assumed");
        }
        put_in_order(places_, file_.name(), "frame", facts_.warnings);
    }

    [[nodiscard]] RawDepth decode_depth(ByteView bytes, const std::string& name) const {
        const Intrinsics& K = facts_.camera.intrinsics;
        RawDepth depth(K.width, K.height);
        const std::size_t raw_bytes = pixels_ * sizeof(std::uint16_t);
        if (bytes.size() == raw_bytes) {
            std::memcpy(depth.data(), bytes.data(), raw_bytes);
            return depth;
        }
        auto unpacked = static_cast<uLongf>(raw_bytes);
        const int result = ::uncompress(reinterpret_cast<Bytef*>(depth.data()), &unpacked, bytes.data(),
                                        static_cast<uLong>(bytes.size()));
        if (result == Z_BUF_ERROR || (result == Z_OK && unpacked != raw_bytes))
            throw Error(name + ": is not of " + std::to_string(K.width) + "x" + std::to_string(K.height) +
                        " pixels as in the camera file, or damaged");
        if (result != Z_OK)
            throw Error(name + ": is neither zlib nor raw of " + std::to_string(K.width) + "x" +
                        std::to_string(K.height) +
                        " pixels; it is damaged, or of another size than the camera file says");
        return depth;
    }

    [[nodiscard]] ColorImage decode_color(ByteView bytes, const std::string& name) const {
        const Intrinsics& K = facts_.camera.intrinsics;
        if (!has_color_) return {K.width, K.height, kNoColor};
        if (bytes.empty()) throw Error(name + ": is missing, though other frames of the log have it");
        ColorImage color(K.width, K.height);
        if (bytes.size() == 3 * pixels_) {
            for (std::size_t i = 0; i < pixels_; ++i) color[i] = {bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]};
        } else {
            color = posefusion::decode_color(bytes, name, {K.width, K.height});
        }
        if (flip_colors_)
            for (Rgb8& c : color) std::swap(c.r, c.b);
        return color;
    }

    fs::path path_;
    InputFile file_;
    bool flip_colors_, has_color_ = true;
    std::size_t pixels_ = 0;
    std::vector<Place> places_;
};

}  // namespace

std::unique_ptr<FrameSource> open_klg(const fs::path& file, const SourceOptions& options) {
    return std::make_unique<KlgFile>(file, options);
}

fs::path klg_camera_file(fs::path klg) { return klg.replace_extension(".yaml"); }
fs::path klg_groundtruth_file(fs::path klg) { return klg.replace_extension(".groundtruth.txt"); }

}  // namespace posefusion
