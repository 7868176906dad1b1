#include "hosts/io/section_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "engine/core/error.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr std::array<unsigned char, 8> kMagic{0x89, 'P', 'F', 'U', 'S', 'E', '\r', '\n'};
constexpr std::size_t kNameLetters = 8;
constexpr std::size_t kStartBytes = kMagic.size() + 12, kEntryBytes = kNameLetters + 16, kChecksumBytes = 4;
constexpr std::uint32_t kMostSections = 64;

std::uint32_t checksum(std::span<const std::byte> bytes) {
    return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void write_bytes(std::ostream& out, std::span<const std::byte> bytes) {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// Reads a file from its beginning; knows how much is left.
class Input {
public:
    Input(const fs::path& file, const SectionFormat& format) : file_(file), format_(format) {
        std::error_code error;
        if (!fs::exists(file, error)) throw Error(file.string() + ": there is no such " + format.what);
        if (!fs::is_regular_file(file, error)) foreign();
        left_ = fs::file_size(file, error);
        errno = 0;
        stream_.open(file, std::ios::binary);
        if (!stream_ || error) throw Error(file.string() + ": cannot be opened: " + std::strerror(errno));
    }
    [[nodiscard]] ByteArray read(std::uint64_t bytes) {
        if (bytes > left_) cut_short();
        ByteArray values(static_cast<std::size_t>(bytes));
        stream_.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(bytes));
        if (!stream_) throw Error(file_.string() + ": reading failed; is the disk damaged?");
        left_ -= bytes;
        return values;
    }
    [[nodiscard]] std::uint64_t left() const { return left_; }
    [[noreturn]] void foreign() const { throw Error(file_.string() + ": is no " + format_.what + " of PoseFusion"); }
    [[noreturn]] void cut_short() const {
        throw Error(file_.string() + ": the " + format_.what + " is cut short; use another copy");
    }
    [[noreturn]] void damaged() const {
        throw Error(file_.string() + ": the " + format_.what + " is damaged, its checksum is wrong; use another copy");
    }

private:
    const fs::path& file_;
    const SectionFormat& format_;
    std::ifstream stream_;
    std::uint64_t left_ = 0;
};

}  // namespace

bool is_section_file(const fs::path& file, const SectionFormat& format) {
    std::array<char, kMagic.size() + sizeof(format.kind)> head{}, expected{};
    std::memcpy(expected.data(), kMagic.data(), kMagic.size());
    std::copy(format.kind.begin(), format.kind.end(), expected.begin() + kMagic.size());
    return std::ifstream(file, std::ios::binary).read(head.data(), head.size()) && head == expected;
}

void write_sections(const fs::path& file, const SectionFormat& format, const std::vector<Section>& sections) {
    StateWriter head;
    head.raw(kMagic.data(), kMagic.size());
    head.raw(format.kind.data(), format.kind.size());
    head.put(format.version);
    head.put(static_cast<std::uint32_t>(sections.size()));
    for (const Section& section : sections) {
        std::array<char, kNameLetters> name{};
        std::copy_n(section.name.data(), std::min(section.name.size(), name.size()), name.data());
        head.raw(name.data(), name.size());
        head.put(std::uint64_t{section.bytes().size()});
        head.put(checksum(section.bytes()));
        head.put(std::uint32_t{0});
    }
    const ByteArray table = head.take();
    StateWriter tail;
    tail.put(checksum(table));
    const ByteArray table_checksum = tail.take();
    const auto write_all = [&](std::ostream& out) {
        write_bytes(out, table);
        write_bytes(out, table_checksum);
        for (const Section& section : sections) write_bytes(out, section.bytes());
    };
    write_file_atomically(file, write_all, Survives::PowerFailure);
}

ReadSections read_sections(const fs::path& file, const SectionFormat& format) {
    Input in(file, format);
    ByteArray head = in.read(std::min<std::uint64_t>(in.left(), kStartBytes));
    const auto starts_with = [&](std::size_t at, const auto& expected) {
        const std::size_t n = std::min(expected.size(), head.size() - std::min(head.size(), at));
        return std::memcmp(head.data() + std::min(head.size(), at), expected.data(), n) == 0;
    };
    if (head.empty() || !starts_with(0, kMagic) || !starts_with(kMagic.size(), format.kind)) in.foreign();
    if (head.size() < kStartBytes) in.cut_short();
    StateReader start{std::span(head).subspan(kMagic.size() + format.kind.size()), file.string()};
    const auto version = start.get<std::uint32_t>(), count = start.get<std::uint32_t>();
    if (version != format.version) {
        throw Error(file.string() + ": the " + format.what + " has version " + std::to_string(version) +
                    ", this program reads version " + std::to_string(format.version) + "; make it again");
    }
    if (count > kMostSections) in.damaged();
    const ByteArray entries = in.read(count * kEntryBytes);
    head.insert(head.end(), entries.begin(), entries.end());
    const ByteArray head_checksum = in.read(kChecksumBytes);
    if (StateReader(head_checksum, file.string()).get<std::uint32_t>() != checksum(head)) in.damaged();

    std::map<std::string, ByteArray> sections;
    StateReader table(entries, file.string());
    for (std::uint32_t i = 0; i < count; ++i) {
        std::array<char, kNameLetters + 1> name{};
        table.raw(name.data(), kNameLetters);
        const auto length = table.get<std::uint64_t>();
        const auto expected = table.get<std::uint32_t>();
        (void)table.get<std::uint32_t>();
        ByteArray bytes = in.read(length);
        if (checksum(bytes) != expected) in.damaged();
        sections[name.data()] = std::move(bytes);
    }
    if (in.left() != 0) in.damaged();
    return {file.string(), std::move(sections)};
}

ByteArray ReadSections::take(const std::string& name) {
    auto found = sections_.extract(name);
    if (found.empty()) throw Error(file_ + ": lacks the section '" + name + "'; use another copy");
    return std::move(found.mapped());
}

}  // namespace posefusion
