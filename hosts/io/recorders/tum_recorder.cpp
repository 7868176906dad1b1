#include "hosts/io/output_file.hpp"
#include "hosts/io/recorders/recorder.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

class TumRecorder final : public Recorder {
public:
    TumRecorder(const fs::path& folder, const Camera& camera) : folder_(folder), camera_(camera) {
        if (fs::exists(folder / "rgb.txt") || fs::exists(folder / "associations.txt"))
            throw Error(folder.string() + ": holds a recording already; choose another folder");
        for (const char* part : {"rgb", "depth"}) prepare_output_folder(folder / part);
    }

    void add(const RawFrame& frame) override {
        const std::string stamp = seconds_text(frame.stamp);
        write_png(folder_ / "rgb" / (stamp + ".png"), frame.color);
        write_raw_depth(folder_ / "depth" / (stamp + ".png"), frame.depth);
        stamps_.push_back(stamp);
    }

    void finish(const std::optional<Trajectory>& groundtruth) override {
        std::string pairs, color = "# timestamp filename\n", depth = color;
        for (const std::string& stamp : stamps_) {
            const std::string rgb_line = stamp + " rgb/" + stamp + ".png",
                              depth_line = stamp + " depth/" + stamp + ".png";
            color += rgb_line + "\n";
            depth += depth_line + "\n";
            pairs += rgb_line + " " + depth_line + "\n";
        }
        write_camera_file(folder_ / "camera.yaml", camera_);
        if (groundtruth) write_trajectory(folder_ / "groundtruth.txt", *groundtruth);
        write_file_atomically(folder_ / "rgb.txt", color);
        write_file_atomically(folder_ / "depth.txt", depth);
        write_file_atomically(folder_ / "associations.txt", pairs);
    }

private:
    fs::path folder_;
    Camera camera_;
    std::vector<std::string> stamps_;
};

}  // namespace

std::unique_ptr<Recorder> make_tum_recorder(const fs::path& folder, const Camera& camera) {
    return std::make_unique<TumRecorder>(folder, camera);
}

}  // namespace posefusion
