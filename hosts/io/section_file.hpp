#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "engine/core/byte_stream.hpp"

/// Our own binary files: named sections, each with its length and checksum. Little-endian:
///   8 bytes  89 'P' 'F' 'U' 'S' 'E' 0d 0a   damaged by a transfer in text mode
///   4        kind, four letters
///   4        version
///   4        number of sections
///   n * 24   name (8 letters, padded with 0), length (8), CRC-32 of the section (4), 0 (4)
///   4        CRC-32 of everything up to here
///   then the sections, one after the other, and nothing else.
namespace posefusion {

struct SectionFormat {
    std::array<char, 4> kind;
    std::uint32_t version;
    std::string what;  ///< for messages: "map file"
};

/// A section to be written: owns its bytes or refers to bytes that must outlive it.
struct Section {
    std::string name;  ///< 1 to 8 letters
    ByteArray own{};
    std::span<const std::byte> elsewhere{};
    [[nodiscard]] std::span<const std::byte> bytes() const { return own.empty() ? elsewhere : own; }
};

/// Written atomically. Throws Error.
void write_sections(const std::filesystem::path& file, const SectionFormat& format,
                    const std::vector<Section>& sections);

/// Whether the file begins like one of that kind, of any version.
[[nodiscard]] bool is_section_file(const std::filesystem::path& file, const SectionFormat& format);

/// The sections of a file. Taking one removes it.
class ReadSections {
public:
    ReadSections(std::string file, std::map<std::string, ByteArray> sections)
        : file_(std::move(file)), sections_(std::move(sections)) {}
    /// Throws Error if there is no such section (any more).
    [[nodiscard]] ByteArray take(const std::string& name);
    [[nodiscard]] const std::string& file() const { return file_; }

private:
    std::string file_;
    std::map<std::string, ByteArray> sections_;
};

/// Allocates no more memory than the size of the file. Throws Error, one line, for a file that is missing, of another
/// kind or version, cut short, too long, or in which a byte has changed.
[[nodiscard]] ReadSections read_sections(const std::filesystem::path& file, const SectionFormat& format);

}  // namespace posefusion
