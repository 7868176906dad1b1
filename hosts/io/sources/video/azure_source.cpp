#include "hosts/io/sources/video/azure_source.hpp"

#include <algorithm>

#include "hosts/io/association.hpp"
#include "hosts/io/depth_registration.hpp"
#include "hosts/io/sources/time_order.hpp"
#include "hosts/io/sources/video/azure_calibration.hpp"
#include "hosts/io/sources/video/video_file.hpp"

namespace posefusion {
namespace {

constexpr const char* kCalibration = "calibration.json";

class AzureSource final : public FrameSource {
public:
    AzureSource(const std::filesystem::path& file, const SourceOptions& options)
        : video_(open_video(file)), name_(file.string()), color_(track("COLOR")), depth_(track("DEPTH")) {
        facts_.location = name_;
        facts_.name = file.stem().string();
        pair();
        find_camera(options);
    }

    [[nodiscard]] RawFrame read(std::size_t i) const override {
        const FrameEntry& entry = facts_.frames.at(i);
        const std::string where = name_ + ", " + entry.stamp_text + ", ";
        RawFrame frame{entry.stamp, entry.stamp_text, entry.depth_delay, {}, {}, where + "COLOR", where + "DEPTH"};
        frame.color = video_.color(color_, pairs_[i].first);
        frame.depth = video_.grey16(depth_, pairs_[i].second);
        if (registration_) frame.depth = registration_->apply(frame.depth, facts_.camera.depth_scale);
        return frame;
    }

private:
    [[nodiscard]] std::size_t track(const std::string& name) const {
        const auto& tracks = video_.tracks;
        const auto found =
            std::find_if(tracks.begin(), tracks.end(), [&](const VideoTrack& track) { return track.name == name; });
        if (found == tracks.end())
            throw Error(name_ +
                        ": is no recording of an Azure Kinect with colour and depth: there is no image of a "
                        "track " +
                        name);
        return static_cast<std::size_t>(found - tracks.begin());
    }

    void pair() {
        const auto &color = video_.tracks[color_].stamps, &depth = video_.tracks[depth_].stamps;
        pairs_ = associate(color, depth);
        for (const auto& [c, d] : pairs_) facts_.frames.push_back(entry_at(color[c], depth[d]));
        if (pairs_.empty()) throw Error(name_ + ": no image of COLOR has one of DEPTH within 20 ms");
        if (pairs_.size() < color.size())
            facts_.warnings.push_back(name_ + ": " + count_text(color.size() - pairs_.size(), "colour image") +
                                      " without a depth image within 20 ms left out");
    }

    void find_camera(const SourceOptions& options) {
        const ImageSize color = video_.tracks[color_].size, depth = video_.tracks[depth_].size;
        CameraDescription description;
        if (options.camera_file.empty()) {
            const auto calibration = video_.attachments.find(kCalibration);
            if (calibration == video_.attachments.end())
                throw Error(name_ + ": lacks " + kCalibration + "; give the camera with --camera");
            description = parse_azure_calibration(calibration->second, color, depth, name_);
        } else {
            description = read_camera_description(options.camera_file);
            Intrinsics& K = description.camera.intrinsics;
            if (K.width == 0) K.width = color.width, K.height = color.height;
            if (!(ImageSize{K.width, K.height} == color))
                throw Error(options.camera_file.string() + ": is of images of " + size_text({K.width, K.height}) +
                            ", those of " + name_ + " are " + size_text(color));
            if (!description.says_depth_scale) description.camera.depth_scale = 1000;  // millimetres
        }
        facts_.camera = description.camera;
        registration_ = registration_for(description, depth, name_, facts_.warnings);
    }

    VideoFile video_;
    std::string name_;
    std::size_t color_, depth_;  // tracks
    std::vector<std::pair<std::size_t, std::size_t>> pairs_;
    std::optional<DepthRegistration> registration_;
};

}  // namespace

std::unique_ptr<FrameSource> open_azure(const std::filesystem::path& file, const SourceOptions& options) {
    return std::make_unique<AzureSource>(file, options);
}

}  // namespace posefusion
