#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include "hosts/io/input_file.hpp"

/// How messages are packed in bags. Sizes that a bag claims are not trusted.
namespace posefusion {

enum class Packing { Plain, Bz2, Lz4, Zstd };

/// Largest chunk or message, unpacked. The recorders' own chunks have less than a MiB, or one message if that is
/// larger.
inline constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{1} << 28;

/// Throws Error that starts with `name` if a chunk is too large or claims to grow by more than its packing can.
void check_growth(Packing packing, std::uint64_t packed_bytes, std::uint64_t bytes, const std::string& name);

/// Exactly `bytes` bytes. Throws Error that starts with `name` if the data is damaged.
[[nodiscard]] ByteBuffer unpack(Packing packing, ByteView packed, std::size_t bytes, const std::string& name);

/// Whether it starts as zstd's frames do (RFC 8878); no message of ROS 2 starts so.
[[nodiscard]] bool is_zstd(ByteView bytes);

/// The first bytes of packed data among which its first block is, whatever the data.
inline constexpr std::size_t kZstdPrefixBytes = std::size_t{1} << 18;

/// At most `at_most` bytes. `packed` may end early if they come before. Throws Error that starts with `name`: damaged.
[[nodiscard]] ByteBuffer unpack_zstd(ByteView packed, std::size_t at_most, const std::string& name);

}  // namespace posefusion
