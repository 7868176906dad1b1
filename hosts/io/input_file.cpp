#include "hosts/io/input_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cerrno>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {

static_assert(std::endian::native == std::endian::little, "numbers are taken as they are in the file");

InputFile::InputFile(const std::filesystem::path& file, std::string name)
    : name_(name.empty() ? file.string() : std::move(name)) {
    std::error_code error;
    const auto status = std::filesystem::status(file, error);
    if (!std::filesystem::exists(status)) throw Error(name_ + ": no such file");
    if (!std::filesystem::is_regular_file(status)) throw Error(name_ + ": is not a file");
    size_ = std::filesystem::file_size(file, error);
    if (error) throw Error(name_ + ": cannot be read: " + error.message());
    descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor_ < 0) throw Error(name_ + ": cannot be read: " + std::strerror(errno));
}

InputFile::~InputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

ByteBuffer InputFile::read(std::uint64_t offset, std::size_t count) const {
    if (offset > size_ || count > size_ - offset) throw Error(name_ + ": ends early; is the copy complete?");
    ByteBuffer bytes(count);
    for (std::size_t done = 0; done < count;) {
        const ssize_t got = ::pread(descriptor_, bytes.data() + done, count - done, static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw Error(name_ + ": cannot be read: " + std::strerror(errno));
        if (got == 0) throw Error(name_ + ": ends early; has it been cut while it was read?");
        done += static_cast<std::size_t>(got);
    }
    return bytes;
}

ByteView ByteReader::take(std::size_t count) {
    if (count > bytes_.size()) throw Error(name_ + ": is damaged: it ends within a record");
    const auto part = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return part;
}

std::string printable(ByteView bytes) { return printable(std::string(bytes.begin(), bytes.end())); }

std::string printable(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
    return text;
}

}  // namespace posefusion
