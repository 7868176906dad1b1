#include "hosts/io/sources/oni_check.hpp"

#include <string_view>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr std::string_view kMagic = "NI10";
constexpr std::size_t kFileHeaderBytes = 24;
constexpr std::uint32_t kRecordMagic = 0x0052494E;  ///< "NIR\0"
constexpr std::size_t kRecordHeaderBytes = 28;      ///< magic, type, node, bytes of fields and payload, link back
constexpr std::uint32_t kNewData = 10, kEnd = 11;   ///< types of records: an image, the end of the file
constexpr std::uint32_t kMaxFieldBytes = 1U << 20;
constexpr std::uint32_t kMaxImageBytes = 1U << 26;  ///< packed; 64 MiB is more than any camera gives
constexpr std::uint32_t kMaxNodes = 64;

}  // namespace

std::size_t check_oni(const InputFile& file) {
    const auto fail = [&](const char* what) { throw Error(file.name() + ": " + what); };
    if (file.size() < kFileHeaderBytes) fail("is too short for an .oni file");
    const ByteBuffer start = file.read(0, kMagic.size());
    if (!std::equal(start.begin(), start.end(), kMagic.begin())) fail("is no .oni file of OpenNI2");
    std::size_t frames = 0;
    for (std::uint64_t at = kFileHeaderBytes;;) {
        if (file.size() - at < kRecordHeaderBytes) fail("ends early; was the recording closed?");
        const ByteBuffer header = file.read(at, kRecordHeaderBytes);
        ByteReader reader(header, file.name());
        const auto magic = reader.take<std::uint32_t>(), type = reader.take<std::uint32_t>();
        const auto node = reader.take<std::uint32_t>(), fields = reader.take<std::uint32_t>();
        const auto payload = reader.take<std::uint32_t>();
        const auto link = reader.take<std::uint64_t>();
        if (magic != kRecordMagic || node > kMaxNodes || fields < kRecordHeaderBytes || fields > kMaxFieldBytes ||
            payload > kMaxImageBytes || link > at)
            fail("is damaged: a record of it is none");
        if (file.size() - at < std::uint64_t{fields} + payload) fail("ends early; was the recording closed?");
        if (type == kEnd) break;
        frames += type == kNewData ? 1 : 0;
        at += std::uint64_t{fields} + payload;
    }
    if (frames == 0) fail("holds no images");
    return frames;
}

}  // namespace posefusion
