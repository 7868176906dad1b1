#pragma once
#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

/// Writes MCAP files, good ones and such as no program should write.
namespace posefusion::test {

inline std::string pack_zstd(const std::string& bytes) {
    std::string packed(ZSTD_compressBound(bytes.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), 3));
    return packed;
}

class McapWriter {
public:
    struct Options {
        std::string packing;  ///< of chunks: "", lz4, zstd
        bool chunked = true;  ///< else messages lie in the file, one by one
        bool indexed = true;  ///< chunks are followed by their index
        std::string encoding = "cdr";
        bool checksums = true;
    };
    McapWriter() = default;
    explicit McapWriter(Options options) : options_(std::move(options)) {}

    template <class Number>
    static std::string number(Number value) {
        return {reinterpret_cast<const char*>(&value), sizeof value};
    }
    static std::string text(const std::string& bytes) {
        return number(static_cast<std::uint32_t>(bytes.size())) + bytes;
    }
    static std::string record(std::uint8_t kind, const std::string& content) {
        return std::string(1, static_cast<char>(kind)) + number(static_cast<std::uint64_t>(content.size())) + content;
    }
    static std::string magic() { return {"\x89MCAP0\r\n", 8}; }
    static std::string begin() { return magic() + record(1, text("ros2") + text("posefusion")); }

    /// @param recorded  nanoseconds
    void add(const std::string& topic, const std::string& type, std::uint64_t recorded, const std::string& message) {
        std::uint16_t channel = 0;
        while (channel < channels_.size() && channels_[channel].first != topic) ++channel;
        std::string& out = options_.chunked ? chunk_ : body_;
        if (channel == channels_.size()) {
            channels_.emplace_back(topic, type);
            out += description(channel);
        }
        if (options_.chunked) index_[channel].emplace_back(recorded, chunk_.size());
        out += record(5, number(channel) + number(std::uint32_t{0}) + number(recorded) + number(recorded) + message);
    }

    void end_chunk() {
        if (chunk_.empty()) return;
        const std::string packed = pack(chunk_);
        const auto crc = options_.checksums
                             ? crc32(0, reinterpret_cast<const Bytef*>(chunk_.data()), static_cast<uInt>(chunk_.size()))
                             : 0;
        body_ +=
            record(6, number(std::uint64_t{0}) + number(std::uint64_t{0}) +
                          number(static_cast<std::uint64_t>(chunk_.size())) + number(static_cast<std::uint32_t>(crc)) +
                          text(options_.packing) + number(static_cast<std::uint64_t>(packed.size())) + packed);
        for (const auto& [channel, entries] : index_) {
            if (!options_.indexed) break;
            std::string list;
            for (const auto& [time, offset] : entries) list += number(time) + number(offset);
            body_ += record(7, number(channel) + text(list));
        }
        chunk_.clear();
        index_.clear();
    }

    /// @param closed  with topics repeated at the end, and footer; without, it is as a crash leaves it
    std::string finish(bool closed = true) {
        end_chunk();
        std::string file = begin() + body_;
        if (!closed) return file;
        file += record(15, number(std::uint32_t{0}));
        for (std::uint16_t channel = 0; channel < channels_.size(); ++channel) file += description(channel);
        return file + record(2, std::string(20, '\0')) + magic();
    }

private:
    [[nodiscard]] std::string description(std::uint16_t channel) const {
        const auto& [topic, type] = channels_[channel];
        const auto schema = static_cast<std::uint16_t>(channel + 1);
        return record(3, number(schema) + text(type) + text("ros2msg") + text("its definition")) +
               record(4, number(channel) + number(schema) + text(topic) + text(options_.encoding) + text(""));
    }

    [[nodiscard]] std::string pack(const std::string& bytes) const {
        if (options_.packing == "zstd") return pack_zstd(bytes);
        if (options_.packing != "lz4") return bytes;
        std::string packed(LZ4F_compressFrameBound(bytes.size(), nullptr), '\0');
        packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
        return packed;
    }

    Options options_;
    std::string chunk_, body_;
    std::vector<std::pair<std::string, std::string>> channels_;
    std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> index_;
};

}  // namespace posefusion::test
