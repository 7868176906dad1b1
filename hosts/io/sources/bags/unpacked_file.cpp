#include "hosts/io/sources/bags/unpacked_file.hpp"

#include <unistd.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "engine/core/error.hpp"
#include "hosts/io/input_file.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// A new file of its own name, open for writing.
class TemporaryFile {
public:
    TemporaryFile() : path_((fs::temp_directory_path() / "posefusion-XXXXXX").string()) {
        descriptor_ = ::mkstemp(path_.data());
        if (descriptor_ < 0) fail();
    }
    ~TemporaryFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
        if (!kept_ && descriptor_ >= 0) ::unlink(path_.c_str());
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    void append(ByteView bytes) {
        while (!bytes.empty()) {
            const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) fail();
            bytes = bytes.subspan(static_cast<std::size_t>(written));
        }
    }
    [[nodiscard]] fs::path keep() {
        kept_ = true;
        return path_;
    }

private:
    [[noreturn]] void fail() const {
        throw Error(path_ + ": a packed bag cannot be unpacked to there: " + std::strerror(errno) +
                    "; set TMPDIR to a folder with more room, or unpack it with `unzstd`");
    }

    std::string path_;
    int descriptor_ = -1;
    bool kept_ = false;
};

void unpack(const InputFile& packed, TemporaryFile& to) {
    const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(), &ZSTD_freeDStream);
    ByteBuffer out(ZSTD_DStreamOutSize());
    std::size_t hint = 1;  // 0 at the end of a frame
    for (std::uint64_t at = 0; at < packed.size();) {
        const ByteBuffer piece = packed.read(at, std::min<std::uint64_t>(ZSTD_DStreamInSize(), packed.size() - at));
        at += piece.size();
        ZSTD_inBuffer from{piece.data(), piece.size(), 0};
        for (bool more = true; more;) {
            ZSTD_outBuffer written{out.data(), out.size(), 0};
            hint = ZSTD_decompressStream(stream.get(), &written, &from);
            if (ZSTD_isError(hint) != 0U)
                throw Error(packed.name() + ": cannot be unpacked: " + ZSTD_getErrorName(hint));
            to.append(ByteView(out).first(written.pos));
            more = from.pos < from.size || written.pos == written.size;
        }
    }
    if (hint != 0) throw Error(packed.name() + ": ends early; is the copy complete?");
}

}  // namespace

UnpackedFile::UnpackedFile(const fs::path& packed) {
    const InputFile from(packed);
    TemporaryFile to;
    unpack(from, to);
    path_ = to.keep();
}

UnpackedFile::~UnpackedFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
}

}  // namespace posefusion
