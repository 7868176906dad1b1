#include "hosts/io/sources/bags/packing.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <memory>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr std::array<std::uint8_t, 4> kZstdMagic{0x28, 0xB5, 0x2F, 0xFD};

/// The most by which data grows when it is unpacked: lz4 cannot do more, the others only with nothing but zeros.
std::uint64_t most_growth(Packing packing) {
    switch (packing) {
        case Packing::Plain:
            return 1;
        case Packing::Lz4:
            return 256;
        case Packing::Bz2:
        case Packing::Zstd:
            return 32768;
    }
    return 0;
}

/// @return bytes written; SIZE_MAX if the data is damaged
std::size_t unpack_lz4(ByteView packed, ByteBuffer& to) {
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) return SIZE_MAX;
    const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context,
                                                                                     &LZ4F_freeDecompressionContext);
    std::size_t written = 0, taken = 0;
    while (taken < packed.size()) {
        std::size_t room = to.size() - written, rest = packed.size() - taken;
        const std::size_t hint =
            LZ4F_decompress(context, to.data() + written, &room, packed.data() + taken, &rest, nullptr);
        if (LZ4F_isError(hint) != 0U || (room == 0 && rest == 0)) return SIZE_MAX;
        written += room;
        taken += rest;
        if (hint == 0) break;
    }
    return written;
}

std::size_t unpack_bz2(ByteView packed, ByteBuffer& to) {
    auto written = static_cast<unsigned int>(to.size());
    auto* from = reinterpret_cast<char*>(const_cast<std::uint8_t*>(packed.data()));  // it is only read
    const int result = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(to.data()), &written, from,
                                                  static_cast<unsigned int>(packed.size()), 0, 0);
    return result == BZ_OK ? written : SIZE_MAX;
}

std::size_t unpack_zstd_chunk(ByteView packed, ByteBuffer& to) {
    const std::size_t written = ZSTD_decompress(to.data(), to.size(), packed.data(), packed.size());
    return ZSTD_isError(written) != 0U ? SIZE_MAX : written;
}

std::size_t unpack_into(Packing packing, ByteView packed, ByteBuffer& to) {
    switch (packing) {
        case Packing::Plain:
            std::copy_n(packed.begin(), std::min(packed.size(), to.size()), to.begin());
            return packed.size();
        case Packing::Bz2:
            return unpack_bz2(packed, to);
        case Packing::Lz4:
            return unpack_lz4(packed, to);
        case Packing::Zstd:
            return unpack_zstd_chunk(packed, to);
    }
    return SIZE_MAX;
}

}  // namespace

void check_growth(Packing packing, std::uint64_t packed_bytes, std::uint64_t bytes, const std::string& name) {
    if (bytes > kMaxChunkBytes || packed_bytes > kMaxChunkBytes)
        throw Error(name + ": a chunk has more than " + std::to_string(kMaxChunkBytes >> 20) + " MiB");
    if (bytes > most_growth(packing) * packed_bytes)
        throw Error(name + ": is damaged: a packed chunk claims to be enormous");
}

ByteBuffer unpack(Packing packing, ByteView packed, std::size_t bytes, const std::string& name) {
    ByteBuffer unpacked(bytes);
    if (unpack_into(packing, packed, unpacked) != bytes)
        throw Error(name + ": is damaged: a packed chunk cannot be unpacked");
    return unpacked;
}

bool is_zstd(ByteView bytes) {
    return bytes.size() >= kZstdMagic.size() && std::equal(kZstdMagic.begin(), kZstdMagic.end(), bytes.begin());
}

ByteBuffer unpack_zstd(ByteView packed, std::size_t at_most, const std::string& name) {
    const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(), &ZSTD_freeDStream);
    ByteBuffer bytes;
    ZSTD_inBuffer from{packed.data(), packed.size(), 0};
    for (std::size_t hint = 1; hint != 0 && bytes.size() < at_most;) {
        const std::size_t begin = bytes.size();
        bytes.resize(std::min(at_most, begin + ZSTD_DStreamOutSize()));
        ZSTD_outBuffer to{bytes.data(), bytes.size(), begin};
        const std::size_t before = from.pos;
        hint = ZSTD_decompressStream(stream.get(), &to, &from);
        const bool stuck = from.pos == before && to.pos == begin;
        bytes.resize(to.pos);
        if (ZSTD_isError(hint) != 0U || (stuck && hint != 0))
            throw Error(name + ": is damaged: a packed message cannot be unpacked");
    }
    return bytes;
}

}  // namespace posefusion
