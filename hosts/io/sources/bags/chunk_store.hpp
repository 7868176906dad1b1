#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "hosts/io/input_file.hpp"
#include "hosts/io/sources/bags/packing.hpp"

/// The chunks of messages in a bag, unpacked when they are needed.
namespace posefusion {

using SharedBytes = std::shared_ptr<const ByteBuffer>;

class ChunkStore {
public:
    struct Chunk {
        std::uint64_t offset = 0;  ///< of its data, in the file
        std::uint64_t packed_bytes = 0, bytes = 0;
        Packing packing = Packing::Plain;
        std::uint32_t crc = 0;  ///< CRC-32 of the unpacked bytes; 0 = not known
    };

    /// @param file  outlives the store
    explicit ChunkStore(const InputFile& file) : file_(file) {}

    /// Throws Error when the chunk cannot be as large as it says.
    void add(const Chunk& chunk);
    [[nodiscard]] std::uint32_t size() const { return static_cast<std::uint32_t>(chunks_.size()); }

    /// The whole chunk; those used last are kept. May be called from several threads. Throws Error: damaged.
    [[nodiscard]] SharedBytes unpacked(std::uint32_t number) const;
    /// A part of it, which is read from the file alone if the chunk is not packed. Throws Error: damaged, outside.
    [[nodiscard]] ByteBuffer read(std::uint32_t number, std::uint64_t offset, std::size_t count) const;

private:
    [[nodiscard]] ByteBuffer unpack_chunk(const Chunk& chunk) const;

    const InputFile& file_;
    std::vector<Chunk> chunks_;
    mutable std::mutex mutex_;
    mutable std::deque<std::pair<std::uint32_t, SharedBytes>> kept_;
};

}  // namespace posefusion
