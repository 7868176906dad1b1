#include "hosts/io/exr_image.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>

#include <cstring>
#include <exception>
#include <stdexcept>
#include <string_view>

#include "engine/core/error.hpp"
#include "hosts/io/image_header.hpp"

namespace posefusion {
namespace {

/// The bytes as OpenEXR reads them.
class ByteStream final : public Imf::IStream {
public:
    explicit ByteStream(ByteView bytes) : IStream("image"), bytes_(bytes) {}
    bool read(char to[], int count) override {
        const auto wanted = static_cast<std::size_t>(count);
        if (count < 0 || at_ > bytes_.size() || wanted > bytes_.size() - at_) throw std::runtime_error("ends early");
        std::memcpy(to, bytes_.data() + at_, wanted);
        at_ += wanted;
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t place) override { at_ = place; }

private:
    ByteView bytes_;
    std::uint64_t at_ = 0;
};

/// Calls `use` with the opened image; any exception means a damaged image.
template <class Use>
auto with_exr(ByteView bytes, const std::string& name, Use use) {
    static const bool limited = [] {
        Imf::Header::setMaxImageSize(kMaxImageSide, kMaxImageSide);
        Imf::Header::setMaxTileSize(kMaxImageSide, kMaxImageSide);
        return true;
    }();
    (void)limited;
    try {
        ByteStream stream(bytes);
        Imf::InputFile file(stream, 0);  // no threads
        return use(file);
    } catch (const Error&) {
        throw;
    } catch (const std::exception&) {
        throw Error(name + ": EXR image is damaged or truncated");
    }
}

ImageSize size_of(const Imf::InputFile& file) {
    const Imath::Box2i& window = file.header().dataWindow();
    return {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1};
}

std::string depth_channel(const Imf::ChannelList& channels, const std::string& name) {
    std::string all, only;
    std::size_t count = 0;
    const auto ends_with = [](const std::string& text, std::string_view part) { return text.ends_with(part); };
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        only = channel.name();
        all += (all.empty() ? "" : ", ") + printable(only);
        ++count;
        if (only == "Z" || ends_with(only, ".Z") || only == "depth" || ends_with(only, "epth.V")) return only;
    }
    for (const char* likely : {"Y", "V", "R"})
        if (channels.findChannel(likely) != nullptr) return likely;
    if (count == 1) return only;
    throw Error(name + ": EXR image has no channel of depth (Z, Y, V or R), only " + all);
}

}  // namespace

bool is_exr(ByteView bytes) {
    constexpr std::uint8_t kMagic[]{0x76, 0x2F, 0x31, 0x01};
    return bytes.size() > sizeof kMagic && std::memcmp(bytes.data(), kMagic, sizeof kMagic) == 0;
}

ImageSize exr_size(ByteView bytes, const std::string& name) {
    return with_exr(bytes, name, [](const Imf::InputFile& file) { return size_of(file); });
}

Image<float> decode_exr_depth(ByteView bytes, const std::string& name) {
    return with_exr(bytes, name, [&](Imf::InputFile& file) {
        const ImageSize size = size_of(file);
        const Imath::Box2i& window = file.header().dataWindow();
        Image<float> depth(size.width, size.height);
        Imf::FrameBuffer frame;
        frame.insert(depth_channel(file.header().channels(), name),
                     Imf::Slice::Make(Imf::FLOAT, depth.data(), window.min, size.width, size.height));
        file.setFrameBuffer(frame);
        file.readPixels(window.min.y, window.max.y);
        return depth;
    });
}

}  // namespace posefusion
