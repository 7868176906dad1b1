#include "hosts/io/sources/bags/chunk_store.hpp"

#include <zlib.h>

#include <algorithm>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kChunksKept = 3;

}  // namespace

void ChunkStore::add(const Chunk& chunk) {
    check_growth(chunk.packing, chunk.packed_bytes, chunk.bytes, file_.name());
    chunks_.push_back(chunk);
}

ByteBuffer ChunkStore::unpack_chunk(const Chunk& chunk) const {
    const auto bytes = static_cast<std::size_t>(chunk.bytes);
    ByteBuffer packed = file_.read(chunk.offset, static_cast<std::size_t>(chunk.packed_bytes));
    if (chunk.packing != Packing::Plain) packed = unpack(chunk.packing, packed, bytes, file_.name());
    if (chunk.crc != 0 && crc32_z(0, packed.data(), packed.size()) != chunk.crc)
        throw Error(file_.name() + ": is damaged: the checksum of a chunk does not fit");
    return packed;
}

SharedBytes ChunkStore::unpacked(std::uint32_t number) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const auto& kept) { return kept.first == number; });
    if (found != kept_.end()) return found->second;
    auto bytes = std::make_shared<const ByteBuffer>(unpack_chunk(chunks_.at(number)));
    if (kept_.size() == kChunksKept) kept_.pop_front();
    kept_.emplace_back(number, bytes);
    return bytes;
}

ByteBuffer ChunkStore::read(std::uint32_t number, std::uint64_t offset, std::size_t count) const {
    const Chunk& chunk = chunks_.at(number);
    if (offset > chunk.bytes || count > chunk.bytes - offset)
        throw Error(file_.name() + ": is damaged: a message lies outside its chunk");
    if (chunk.packing == Packing::Plain) return file_.read(chunk.offset + offset, count);
    const SharedBytes bytes = unpacked(number);
    const auto begin = bytes->begin() + static_cast<std::ptrdiff_t>(offset);
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

}  // namespace posefusion
