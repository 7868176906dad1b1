#include <unistd.h>
#include <zlib.h>

#include <limits>

#include "hosts/io/input_file.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/recorders/recorder.hpp"
#include "hosts/io/sources/klg_source.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// Written to a temporary file beside the goal, which is renamed at the end: no half log under the final name.
/// Everything needed at the end is written at the beginning, while there is room on the disk.
class KlgRecorder final : public Recorder {
public:
    KlgRecorder(const fs::path& file, const Camera& camera, const RecordOptions& options)
        : file_(file), temporary_(file.string() + ".tmp-" + std::to_string(::getpid())), options_(options) {
        for (const fs::path& mine : {file, klg_camera_file(file), klg_groundtruth_file(file)})
            if (fs::exists(mine)) throw Error(mine.string() + ": is there already; choose another name for the log");
        if (file.has_parent_path()) prepare_output_folder(file.parent_path());
        const fs::path camera_file = klg_camera_file(file_);
        ours_ = camera_file;
        write_camera_file(camera_file, camera);
        out_.emplace(temporary_, bytes_of(std::int32_t{0}), file_);  // the number of frames is known at the end
    }
    ~KlgRecorder() override {
        std::error_code ignored;
        if (fs::remove(temporary_, ignored) && !ours_.empty()) fs::remove(ours_, ignored);  // it was not finished
    }

    void add(const RawFrame& frame) override {
        if (count_ == std::numeric_limits<std::int32_t>::max()) throw Error(file_.string() + ": the log is full");
        const ByteBuffer depth = pack_depth(frame.depth);
        const std::string color = pack_color(frame.color);
        const auto microseconds = std::chrono::round<std::chrono::microseconds>(frame.stamp).count();
        std::string bytes = bytes_of(std::int64_t{microseconds}) + bytes_of(static_cast<std::int32_t>(depth.size())) +
                            bytes_of(static_cast<std::int32_t>(color.size()));
        bytes.append(depth.begin(), depth.end());
        bytes += color;
        out_->append(bytes);
        ++count_;
    }

    void finish(const std::optional<Trajectory>& groundtruth) override {
        out_->overwrite(0, bytes_of(count_));
        std::error_code error;
        fs::rename(temporary_, file_, error);
        if (error) throw Error(file_.string() + ": cannot be replaced: " + error.message());
        if (groundtruth) write_trajectory(klg_groundtruth_file(file_), *groundtruth);
    }

private:
    template <class Number>
    static std::string bytes_of(Number value) {
        return {reinterpret_cast<const char*>(&value), sizeof value};
    }

    [[nodiscard]] ByteBuffer pack_depth(const RawDepth& depth) const {
        const auto* raw = reinterpret_cast<const std::uint8_t*>(depth.data());
        const std::size_t raw_bytes = depth.size() * sizeof(std::uint16_t);
        ByteBuffer packed(raw, raw + raw_bytes);
        if (!options_.compress) return packed;
        auto bytes = ::compressBound(static_cast<uLong>(raw_bytes));
        packed.resize(bytes);
        const int result = ::compress2(packed.data(), &bytes, raw, static_cast<uLong>(raw_bytes), Z_BEST_SPEED);
        if (result != Z_OK) throw Error(file_.string() + ": depth cannot be compressed");
        // Compressed data of exactly the raw size would be read as raw.
        if (bytes == raw_bytes) return {raw, raw + raw_bytes};
        packed.resize(bytes);
        return packed;
    }

    [[nodiscard]] std::string pack_color(const ColorImage& color) const {
        const std::size_t raw_bytes = color.size() * sizeof(Rgb8);
        static_assert(sizeof(Rgb8) == 3);
        if (options_.jpeg_quality > 0) {
            std::string jpeg = encode_jpeg(color, options_.jpeg_quality);
            if (jpeg.size() != raw_bytes) return jpeg;
        }
        return {reinterpret_cast<const char*>(color.data()), raw_bytes};
    }

    fs::path file_, temporary_;
    fs::path ours_;  // a camera file that was not there before; empty: it was
    RecordOptions options_;
    std::optional<GrowingFile> out_;
    std::int32_t count_ = 0;
};

}  // namespace

std::unique_ptr<Recorder> make_klg_recorder(const fs::path& file, const Camera& camera, const RecordOptions& options) {
    return std::make_unique<KlgRecorder>(file, camera, options);
}

}  // namespace posefusion
