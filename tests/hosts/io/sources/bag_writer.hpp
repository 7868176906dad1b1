#pragma once
#include <bzlib.h>
#include <lz4frame.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

/// Writes ROS 1 bags, good ones and such as no program should write.
namespace posefusion::test {

class BagWriter {
public:
    /// @param compression  none, bz2 or lz4
    explicit BagWriter(std::string compression = "none") : compression_(std::move(compression)) {}

    template <class Number>
    static std::string number(Number value) {
        return {reinterpret_cast<const char*>(&value), sizeof value};
    }
    static std::string block(const std::string& bytes) {
        return number(static_cast<std::uint32_t>(bytes.size())) + bytes;
    }
    static std::string field(const std::string& name, const std::string& value) { return block(name + "=" + value); }
    static std::string record(const std::string& fields, const std::string& data) {
        return block(fields) + block(data);
    }

    static std::string header(std::uint32_t seconds, std::uint32_t nanoseconds,
                              const std::string& frame_id = "camera") {
        return number(std::uint32_t{7}) + number(seconds) + number(nanoseconds) + block(frame_id);
    }
    static std::string image(std::uint32_t seconds, std::uint32_t nanoseconds, int width, int height,
                             const std::string& encoding, const std::string& data, bool big_endian = false,
                             const std::string& frame_id = "camera") {
        return header(seconds, nanoseconds, frame_id) + number(static_cast<std::uint32_t>(height)) +
               number(static_cast<std::uint32_t>(width)) + block(encoding) + (big_endian ? '\1' : '\0') +
               number(static_cast<std::uint32_t>(height == 0 ? 0 : data.size() / static_cast<std::size_t>(height))) +
               block(data);
    }
    static std::string compressed_image(std::uint32_t seconds, std::uint32_t nanoseconds, const std::string& format,
                                        const std::string& data) {
        return header(seconds, nanoseconds) + block(format) + block(data);
    }
    static std::string camera_info(int width, int height, const std::vector<double>& K,
                                   const std::vector<double>& D = {}, const std::string& model = "plumb_bob",
                                   const std::string& frame_id = "camera", double projection = 0) {
        std::string text = header(1, 0, frame_id) + number(static_cast<std::uint32_t>(height)) +
                           number(static_cast<std::uint32_t>(width)) + block(model) +
                           number(static_cast<std::uint32_t>(D.size()));
        for (const double d : D) text += number(d);
        for (const double k : K) text += number(k);
        text += std::string(9 * sizeof(double), '\0');                                     // R
        for (int i = 0; i < 12; ++i) text += number(i == 0 || i == 5 ? projection : 0.0);  // P
        return text + std::string(25, '\0');  // binning and region of interest
    }

    struct Shift {
        std::string parent, child;
        double x;  ///< metres
    };
    /// tf2_msgs/TFMessage
    static std::string transforms(const std::vector<Shift>& shifts) {
        std::string text = number(static_cast<std::uint32_t>(shifts.size()));
        for (const Shift& shift : shifts) {
            text += header(1, 0, shift.parent) + block(shift.child);
            for (const double value : {shift.x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}) text += number(value);
        }
        return text;
    }

    void add(const std::string& topic, const std::string& type, std::uint32_t seconds, std::uint32_t nanoseconds,
             const std::string& message) {
        std::uint32_t connection = 0;
        while (connection < topics_.size() && topics_[connection].first != topic) ++connection;
        if (connection == topics_.size()) {
            topics_.emplace_back(topic, type);
            chunk_ += connection_record(connection);
        }
        index_.push_back({connection, seconds, nanoseconds, static_cast<std::uint32_t>(chunk_.size())});
        chunk_ += record(field("op", "\x02") + field("conn", number(connection)) +
                             field("time", number(seconds) + number(nanoseconds)),
                         message);
    }

    void end_chunk() {
        const std::string packed = pack(chunk_);
        chunks_ += record(field("op", "\x05") + field("compression", compression_) +
                              field("size", number(static_cast<std::uint32_t>(chunk_.size()))),
                          packed);
        for (std::uint32_t c = 0; c < topics_.size(); ++c) {
            std::string entries;
            std::uint32_t count = 0;
            for (const Index& i : index_) {
                if (i.connection != c) continue;
                entries += number(i.seconds) + number(i.nanoseconds) + number(i.offset);
                ++count;
            }
            if (count > 0)
                chunks_ += record(field("op", "\x04") + field("ver", number(std::uint32_t{1})) +
                                      field("conn", number(c)) + field("count", number(count)),
                                  entries);
        }
        chunk_.clear();
        index_.clear();
    }

    /// @param closed  with the connections at the end; without, it is as a crash leaves it
    std::string finish(bool closed = true) {
        if (!chunk_.empty()) end_chunk();
        std::string head = field("op", "\x03") + field("index_pos", number(std::uint64_t{0})) +
                           field("conn_count", number(std::uint32_t{0})) +
                           field("chunk_count", number(std::uint32_t{0}));
        std::string bag = "#ROSBAG V2.0\n" + record(head, std::string(4096 - head.size() - 8, ' ')) + chunks_;
        for (std::uint32_t c = 0; closed && c < topics_.size(); ++c) bag += connection_record(c);
        return bag;
    }

private:
    struct Index {
        std::uint32_t connection, seconds, nanoseconds, offset;
    };

    [[nodiscard]] std::string connection_record(std::uint32_t c) const {
        return record(field("op", "\x07") + field("conn", number(c)) + field("topic", topics_[c].first),
                      field("topic", topics_[c].first) + field("type", topics_[c].second) + field("md5sum", "0") +
                          field("message_definition", "x"));
    }

    [[nodiscard]] std::string pack(const std::string& chunk) const {
        if (compression_ == "bz2") {
            std::string packed(chunk.size() * 2 + 1000, '\0');
            auto size = static_cast<unsigned int>(packed.size());
            BZ2_bzBuffToBuffCompress(packed.data(), &size, const_cast<char*>(chunk.data()),
                                     static_cast<unsigned int>(chunk.size()), 9, 0, 0);
            return packed.substr(0, size);
        }
        if (compression_ == "lz4") {
            std::string packed(LZ4F_compressFrameBound(chunk.size(), nullptr), '\0');
            packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), chunk.data(), chunk.size(), nullptr));
            return packed;
        }
        return chunk;
    }

    std::string compression_, chunk_, chunks_;
    std::vector<std::pair<std::string, std::string>> topics_;
    std::vector<Index> index_;
};

}  // namespace posefusion::test
