#include <array>

#include "hosts/io/output_file.hpp"
#include "hosts/io/recorders/recorder.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr const char* kListTitle = "# timestamp filename\n";

fs::path prepared(const fs::path& folder, const Camera& camera) {
    expect_no_recording(folder);
    for (const char* part : {"rgb", "depth"}) prepare_output_folder(folder / part);
    write_camera_file(folder / "camera.yaml", camera);
    return folder;
}

/// Camera and lists are there from the beginning and name every frame whose images are complete: however the recording
/// ends, it can be read.
class TumRecorder final : public Recorder {
public:
    TumRecorder(const fs::path& folder, const Camera& camera)
        : folder_(prepared(folder, camera)),
          lock_(folder),
          color_(folder / "rgb.txt", kListTitle),
          depth_(folder / "depth.txt", kListTitle),
          pairs_(folder / "associations.txt") {}
    ~TumRecorder() override {
        if (frames_ > 0) return;
        std::error_code ignored;  // empty: the folder may be used again
        for (const char* file : {"rgb.txt", "depth.txt", "associations.txt", "camera.yaml"})
            fs::remove(folder_ / file, ignored);
    }

    void add(const RawFrame& frame) override {
        const std::string stamp = seconds_text(frame.stamp), image = stamp + ".png";
        const std::array before{color_.bytes(), depth_.bytes(), pairs_.bytes()};
        try {
            write_png(folder_ / "rgb" / image, frame.color);
            write_raw_depth(folder_ / "depth" / image, frame.depth);
            const std::string color = stamp + " rgb/" + image, depth = stamp + " depth/" + image;
            color_.append(color + "\n");
            depth_.append(depth + "\n");
            pairs_.append(color + " " + depth + "\n");
        } catch (...) {
            color_.shorten(before[0]);
            depth_.shorten(before[1]);
            pairs_.shorten(before[2]);
            std::error_code ignored;
            for (const char* part : {"rgb", "depth"}) fs::remove(folder_ / part / image, ignored);
            throw;
        }
        ++frames_;
    }

    void finish(const std::optional<Trajectory>& groundtruth) override {
        if (groundtruth) write_trajectory(folder_ / "groundtruth.txt", *groundtruth);
    }

private:
    fs::path folder_;
    FolderLock lock_;
    GrowingFile color_, depth_, pairs_;
    std::size_t frames_ = 0;
};

}  // namespace

std::unique_ptr<Recorder> make_tum_recorder(const fs::path& folder, const Camera& camera) {
    return std::make_unique<TumRecorder>(folder, camera);
}

}  // namespace posefusion
