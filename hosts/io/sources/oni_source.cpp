#include "hosts/io/sources/oni_source.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>

#include "hosts/io/association.hpp"
#include "hosts/io/image_header.hpp"
#include "hosts/io/sources/time_order.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kMagic = "NI10";
constexpr std::size_t kFileHeaderBytes = 24;
constexpr std::uint32_t kRecordMagic = 0x0052494E;  ///< "NIR\0"
constexpr std::size_t kRecordHeaderBytes = 28;      ///< magic, type, node, bytes of fields and payload, link back
enum RecordType : std::uint32_t { kIntProperty = 3, kGeneralProperty = 6, kNewData = 10, kEnd = 11, kNodeAdded = 13 };
enum NodeType : std::uint32_t { kDepthNode = 2, kImageNode = 3 };
enum PixelFormat : std::uint64_t { kDepthMillimetres = 100, kDepthTenthMillimetres = 101, kRgb888 = 200 };
constexpr std::uint32_t kMaxFieldBytes = 1U << 20;
constexpr std::uint32_t kMaxImageBytes = 1U << 28;
constexpr std::uint32_t kMaxNodes = 64;
/// A day at 30 Hz.
constexpr std::size_t kMaxImages = std::size_t{1} << 22;
constexpr std::uint64_t kMaxMicroseconds = kFarthestStamp / std::chrono::microseconds(1);

struct Place {
    Stamp stamp{};
    std::uint64_t offset = 0;
    std::uint32_t bytes = 0;
};

/// A stream of the file.
struct Node {
    std::uint32_t type = 0;
    std::string codec;
    std::uint32_t width = 0, height = 0;
    std::uint64_t format = 0;
    double horizontal_view = 0, vertical_view = 0;  ///< radians; 0 = not said
    std::vector<Place> images;
};

class OniFile final : public FrameSource {
public:
    OniFile(const fs::path& file, const SourceOptions& options) : file_(file) {
        facts_.location = file.string();
        facts_.name = file.stem().string();
        read_records();
        color_ = stream(kImageNode, "colour");
        depth_ = stream(kDepthNode, "depth");
        check_codecs();
        find_camera(options);
        pair();
        nodes_.clear();
    }

    [[nodiscard]] RawFrame read(std::size_t i) const override {
        const FrameEntry& entry = facts_.frames.at(i);
        const auto& [color, depth] = pairs_[i];
        RawFrame frame{entry.stamp, entry.stamp_text, entry.depth_delay, {}, {}, {}, {}};
        frame.color_name = file_.name() + ", colour at " + entry.stamp_text;
        frame.depth_name = file_.name() + ", depth at " + entry.stamp_text;
        frame.color = decode_color(file_.read(color.offset, color.bytes), frame.color_name);
        frame.depth = decode_depth(file_.read(depth.offset, depth.bytes), frame.depth_name);
        return frame;
    }

private:
    [[noreturn]] void fail(const std::string& what) const { throw Error(file_.name() + ": " + what); }

    void read_records() {
        if (file_.size() < kFileHeaderBytes) fail("is too short for an .oni file");
        const ByteBuffer start = file_.read(0, kMagic.size());
        if (!std::equal(start.begin(), start.end(), kMagic.begin())) fail("is no .oni file of OpenNI2");
        try {
            for (std::uint64_t at = kFileHeaderBytes; at != 0;) at = read_record(at);
        } catch (const Error& error) {
            if (images_ == 0) throw;
            facts_.warnings.push_back(std::string(error.what()) + "; what comes before is used");
        }
    }

    /// @return position of the next record; 0 after the last
    std::uint64_t read_record(std::uint64_t at) {
        const ByteBuffer header = file_.read(at, kRecordHeaderBytes);
        ByteReader reader(header, file_.name());
        const auto magic = reader.take<std::uint32_t>(), type = reader.take<std::uint32_t>();
        const auto node = reader.take<std::uint32_t>(), fields = reader.take<std::uint32_t>();
        const auto payload = reader.take<std::uint32_t>();
        if (magic != kRecordMagic || node > kMaxNodes || fields < kRecordHeaderBytes || fields > kMaxFieldBytes ||
            payload > kMaxImageBytes)
            fail("is damaged: a record of it is none");
        if (type == kEnd) return 0;
        const ByteBuffer bytes = file_.read(at + kRecordHeaderBytes, fields - kRecordHeaderBytes);
        ByteReader values(bytes, file_.name());
        const std::uint64_t data = at + fields;
        if (file_.size() < data || file_.size() - data < payload) fail("ends early; was the recording closed?");
        if (type == kNodeAdded) {
            (void)values.take_block();  // its name
            nodes_[node].type = values.take<std::uint32_t>();
            const ByteView codec = values.take(sizeof(std::uint32_t));
            nodes_[node].codec.assign(codec.begin(), codec.end());
        } else if (type == kIntProperty || type == kGeneralProperty) {
            read_property(nodes_[node], values);
        } else if (type == kNewData) {
            if (++images_ > kMaxImages) fail("holds too many images");
            const auto microseconds = values.take<std::uint64_t>();
            if (microseconds > kMaxMicroseconds) fail("is damaged: an image is of no time");
            nodes_[node].images.push_back({std::chrono::microseconds(microseconds), data, payload});
        }
        return data + payload;
    }

    static void read_property(Node& node, ByteReader& values) {
        const ByteView label = values.take_block();
        const std::string name(label.begin(), std::find(label.begin(), label.end(), std::uint8_t{0}));
        const ByteView block = values.take_block();
        ByteReader value(block, "property " + printable(label));
        if (name == "xnMapOutputMode") {
            node.width = value.take<std::uint32_t>();
            node.height = value.take<std::uint32_t>();
        } else if (name == "oniPixelFormat") {
            node.format = value.take<std::uint64_t>();
        } else if (name == "xnFOV") {
            node.horizontal_view = value.take<double>();
            node.vertical_view = value.take<double>();
        }
    }

    /// The stream of that type with the most images.
    [[nodiscard]] Node stream(std::uint32_t type, const char* what) const {
        const Node* best = nullptr;
        for (const auto& [number, node] : nodes_)
            if (node.type == type && (best == nullptr || node.images.size() > best->images.size())) best = &node;
        if (best == nullptr || best->images.empty()) fail(std::string("holds no ") + what + " images");
        return *best;
    }

    void check_codecs() const {
        const auto known = [](const Node& node, const auto& codecs) {
            return std::find(codecs.begin(), codecs.end(), node.codec) != codecs.end();
        };
        if (!known(color_, std::array<std::string_view, 2>{"NONE", "JPEG"}) || color_.format != kRgb888)
            fail("its colour images are of a kind that cannot be read; record RGB888");
        const bool unit = depth_.format == kDepthMillimetres || depth_.format == kDepthTenthMillimetres;
        if (!known(depth_, std::array<std::string_view, 3>{"NONE", "16zP", "16zT"}) || !unit)
            fail("its depth images are of a kind that cannot be read; record depth of 1 or 0.1 mm");
        const bool possible =
            color_.width > 0 && color_.height > 0 && std::max(color_.width, color_.height) <= kMaxImageSide;
        if (!possible || color_.width != depth_.width || color_.height != depth_.height)
            fail("its colour and depth images differ in size, or have an impossible one");
    }

    void find_camera(const SourceOptions& options) {
        const float scale = depth_.format == kDepthMillimetres ? 1000.0f : 10000.0f;
        if (!options.camera_file.empty()) {
            facts_.camera = read_camera_file(options.camera_file, scale);
            return;
        }
        const Node& node = color_.horizontal_view > 0 ? color_ : depth_;
        constexpr double kWidest = 3;  // radians
        const auto possible = [](double view) { return view > 0 && view < kWidest; };
        if (!possible(node.horizontal_view) || !possible(node.vertical_view))
            fail("does not say what its camera is; give it with --camera FILE");
        const double w = color_.width, h = color_.height;
        facts_.camera = {
            {static_cast<float>(w / 2 / std::tan(node.horizontal_view / 2)),
             static_cast<float>(h / 2 / std::tan(node.vertical_view / 2)), static_cast<float>((w - 1) / 2),
             static_cast<float>((h - 1) / 2), static_cast<int>(color_.width), static_cast<int>(color_.height)},
            scale,
            {}};
        facts_.warnings.push_back(file_.name() +
                                  ": the camera is known by its nominal field of view only; a calibration is better "
                                  "(--camera FILE)");
    }

    void pair() {
        const auto stamps = [this](std::vector<Place>& images, const char* what) {
            if (say_nothing(stamps_of(images)))
                fail(std::string("the time stamps of its ") + what + " images are all alike");
            put_in_order(images, file_.name(), std::string(what) + " image", facts_.warnings);
            return stamps_of(images);
        };
        for (const auto& [c, d] : associate(stamps(color_.images, "colour"), stamps(depth_.images, "depth"))) {
            const Place& color = color_.images[c];
            facts_.frames.push_back(entry_at(color.stamp, depth_.images[d].stamp));
            pairs_.emplace_back(color, depth_.images[d]);
        }
        if (pairs_.empty()) fail("no colour image has a depth image within 20 ms");
        if (pairs_.size() < color_.images.size())
            facts_.warnings.push_back(file_.name() + ": " +
                                      count_text(color_.images.size() - pairs_.size(), "colour image") +
                                      " without a depth image within 20 ms left out");
    }

    [[nodiscard]] std::size_t pixels(const std::string& name) const {
        const Intrinsics& K = facts_.camera.intrinsics;
        if (static_cast<std::uint32_t>(K.width) != color_.width ||
            static_cast<std::uint32_t>(K.height) != color_.height)
            throw Error(name + ": image is " + std::to_string(color_.width) + "x" + std::to_string(color_.height) +
                        ", the camera file says something else");
        return std::size_t{color_.width} * color_.height;
    }

    [[nodiscard]] ColorImage decode_color(const ByteBuffer& bytes, const std::string& name) const {
        const Intrinsics& K = facts_.camera.intrinsics;
        const std::size_t count = pixels(name);
        if (color_.codec == "JPEG") return posefusion::decode_color(bytes, name, {K.width, K.height});
        if (bytes.size() != 3 * count) throw Error(name + ": is damaged: it has not as much data as pixels");
        ColorImage color(K.width, K.height);
        for (std::size_t i = 0; i < count; ++i) color[i] = {bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]};
        return color;
    }

    [[nodiscard]] RawDepth decode_depth(const ByteBuffer& bytes, const std::string& name) const {
        const Intrinsics& K = facts_.camera.intrinsics;
        const std::size_t count = pixels(name);
        RawDepth depth(K.width, K.height);
        if (depth_.codec != "NONE") {
            decode_oni_depth(bytes, depth_.codec == "16zT", {depth.data(), depth.size()}, name);
            return depth;
        }
        if (bytes.size() != count * sizeof(std::uint16_t))
            throw Error(name + ": is damaged: it has not as much data as pixels");
        std::memcpy(depth.data(), bytes.data(), bytes.size());
        return depth;
    }

    InputFile file_;
    std::map<std::uint32_t, Node> nodes_;
    std::size_t images_ = 0;
    Node color_, depth_;
    std::vector<std::pair<Place, Place>> pairs_;
};

}  // namespace

std::unique_ptr<FrameSource> open_oni(const fs::path& file, const SourceOptions& options) {
    return std::make_unique<OniFile>(file, options);
}

}  // namespace posefusion
