#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

/// Binary files of other programs, with random access. Sizes stated in a file are not trusted.
namespace posefusion {

using ByteBuffer = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// Text for a one-line message: control characters become question marks.
[[nodiscard]] std::string printable(ByteView bytes);
[[nodiscard]] std::string printable(std::string text);

/// A regular file; read() may be called from several threads.
class InputFile {
public:
    /// @param name  for messages; empty = that of the file
    /// Throws Error: missing, a folder, not readable.
    explicit InputFile(const std::filesystem::path& file, std::string name = {});
    ~InputFile();
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] const std::string& name() const { return name_; }
    /// `count` bytes from `offset` on, all of them inside the file. Throws Error when they are not.
    [[nodiscard]] ByteBuffer read(std::uint64_t offset, std::size_t count) const;

private:
    std::string name_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

/// Little-endian numbers one after the other; take() beyond the end throws Error.
class ByteReader {
public:
    /// @param name  what is read, for the message of an Error
    ByteReader(ByteView bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

    template <class Number>
    [[nodiscard]] Number take() {
        static_assert(std::is_arithmetic_v<Number>);
        Number value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    [[nodiscard]] ByteView take(std::size_t count);
    /// A length of 32 bit, then this many bytes.
    [[nodiscard]] ByteView take_block() { return take(take<std::uint32_t>()); }
    [[nodiscard]] std::string take_text() { return printable(take_block()); }  ///< likewise
    [[nodiscard]] std::size_t left() const { return bytes_.size(); }
    [[nodiscard]] bool at_end() const { return bytes_.empty(); }

private:
    ByteView bytes_;
    std::string name_;
};

}  // namespace posefusion
