#include "hosts/io/sources/video/stray_source.hpp"

#include <array>
#include <charconv>
#include <cmath>

#include "hosts/io/depth_registration.hpp"
#include "hosts/io/sources/folder_camera.hpp"
#include "hosts/io/sources/time_order.hpp"
#include "hosts/io/sources/video/video_file.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr float kMillimetre = 1000;  ///< depth images count in millimetres
constexpr std::size_t kMostFrames = 10'000'000;

std::optional<StrayFrame> stray_frame(const std::vector<std::string>& fields) {
    constexpr std::size_t kStamp = 0, kNumber = 1, kPosition = 2, kQuaternion = 5, kColumns = 9;
    if (fields.size() < kColumns) return std::nullopt;
    const auto stamp = parse_stamp(fields[kStamp]);
    std::array<double, kColumns - kPosition> pose{};
    for (std::size_t i = 0; i < pose.size(); ++i) {
        const auto value = parse_number(fields[kPosition + i]);
        if (!value || !std::isfinite(*value)) return std::nullopt;
        pose[i] = *value;
    }
    const double* const q = pose.data() + kQuaternion - kPosition;  // x y z w
    const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
    if (!stamp || !(std::abs(rotation.norm() - 1) < 0.1)) return std::nullopt;
    StrayFrame frame{fields[kNumber], {*stamp, Eigen::Isometry3d::Identity()}};
    frame.pose.T_world_camera.linear() = rotation.normalized().toRotationMatrix();
    frame.pose.T_world_camera.translation() = Eigen::Vector3d(pose[0], pose[1], pose[2]);
    return frame;
}

/// That of the image in the video.
std::optional<std::size_t> number_of(const std::string& digits) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc{} || end != digits.data() + digits.size() || number > kMostFrames) return std::nullopt;
    return number;
}

class StraySource final : public FrameSource {
public:
    StraySource(const fs::path& folder, const SourceOptions& options)
        : folder_(folder), video_(open_video(folder / "rgb.mp4")) {
        facts_.location = folder.string();
        facts_.name = folder_name(folder);
        std::vector<StrayFrame> frames = read_stray_odometry(folder / "odometry.csv", facts_.warnings);
        put_in_order(frames, (folder / "odometry.csv").string(), "line", facts_.warnings,
                     [](const StrayFrame& frame) { return frame.pose.stamp; });
        take(frames);
        find_camera(options);
    }

    [[nodiscard]] RawFrame read(std::size_t i) const override {
        const FrameEntry& entry = facts_.frames.at(i);
        const fs::path depth = depth_file(i);
        RawFrame frame{entry.stamp, entry.stamp_text, {}, {}, {}, (folder_ / "rgb.mp4").string(), depth.string()};
        frame.color = video_.color(0, images_[i]);
        frame.depth = read_raw_depth(depth, depth_size_);
        const fs::path confidence = folder_ / "confidence" / depth.filename();
        if (std::error_code error; fs::exists(confidence, error)) {
            const LabelImage certain = read_labels(confidence, depth_size_);
            for (std::size_t p = 0; p < certain.size(); ++p)
                if (certain[p] == 0) frame.depth[p] = 0;
        }
        frame.depth = registration_->apply(frame.depth, facts_.camera.depth_scale);
        return frame;
    }

    [[nodiscard]] std::optional<Trajectory> groundtruth() const override { return poses_; }

private:
    [[nodiscard]] fs::path depth_file(std::size_t i) const { return folder_ / "depth" / (numbers_[i] + ".png"); }

    /// Frames with all that belongs to them.
    void take(const std::vector<StrayFrame>& frames) {
        const std::size_t images = video_.tracks.front().stamps.size();
        for (const StrayFrame& frame : frames) {
            const auto number = number_of(frame.number);
            std::error_code error;
            if (!number || *number >= images || !fs::exists(folder_ / "depth" / (frame.number + ".png"), error))
                continue;
            facts_.frames.push_back(entry_at(frame.pose.stamp));
            images_.push_back(*number);
            numbers_.push_back(frame.number);
            poses_.push_back(frame.pose);
        }
        if (images_.empty())
            throw Error(folder_.string() + ": no line of odometry.csv has an image in rgb.mp4 and one in depth/");
        if (images_.size() < frames.size())
            facts_.warnings.push_back(folder_.string() + ": " + count_text(frames.size() - images_.size(), "line") +
                                      " of odometry.csv without an image in rgb.mp4 or depth/ left out");
    }

    void find_camera(const SourceOptions& options) {
        const ImageSize color = video_.tracks.front().size;
        const auto size = first_readable(depth_files(), [](const fs::path& file) { return image_file_size(file); });
        if (!size) throw Error(depth_file(0).string() + ": cannot be read, nor can those that follow");
        depth_size_ = *size;
        CameraDescription description;
        if (options.camera_file.empty()) {
            description.camera = {.intrinsics = read_stray_camera(folder_ / "camera_matrix.csv", color),
                                  .depth_scale = kMillimetre};
        } else {
            description.camera = read_camera_file(options.camera_file, kMillimetre);
            const Intrinsics& K = description.camera.intrinsics;
            if (!(ImageSize{K.width, K.height} == color))
                throw Error(options.camera_file.string() + ": is of images of " + size_text({K.width, K.height}) +
                            ", those of " + (folder_ / "rgb.mp4").string() + " are " + size_text(color));
        }
        facts_.camera = description.camera;
        registration_.emplace(DepthCamera{resized(facts_.camera.intrinsics, depth_size_.width, depth_size_.height),
                                          facts_.camera.distortion, Eigen::Isometry3f::Identity()},
                              facts_.camera);
    }

    [[nodiscard]] std::vector<fs::path> depth_files() const {
        std::vector<fs::path> files;
        for (std::size_t i = 0; i < numbers_.size(); ++i) files.push_back(depth_file(i));
        return files;
    }

    fs::path folder_;
    VideoFile video_;
    std::vector<std::size_t> images_;   // of the frames, in the video
    std::vector<std::string> numbers_;  // likewise, in the names of files
    Trajectory poses_;
    ImageSize depth_size_{};
    std::optional<DepthRegistration> registration_;
};

}  // namespace

std::vector<StrayFrame> read_stray_odometry(const fs::path& file, std::vector<std::string>& warnings) {
    std::vector<StrayFrame> frames;
    std::size_t bad = 0, first_bad = 0;
    for (const TextLine& line : read_text_table(file)) {
        if (auto frame = stray_frame(line.fields))
            frames.push_back(std::move(*frame));
        else if (line.number > 1 && bad++ == 0)  // the first names the columns
            first_bad = line.number;
    }
    if (frames.empty())
        throw Error(file.string() + ": no line like `timestamp, frame, x, y, z, qx, qy, qz, qw`, a frame each");
    if (bad > 0)
        warnings.push_back(file.string() + ": " + count_text(bad, "line") + " left out, the first is line " +
                           std::to_string(first_bad));
    return frames;
}

Intrinsics read_stray_camera(const fs::path& file, ImageSize image) {
    std::vector<double> matrix;
    for (const TextLine& line : read_text_table(file))
        for (const std::string& field : line.fields) matrix.push_back(parse_number(field).value_or(NAN));
    constexpr std::size_t kFx = 0, kCx = 2, kFy = 4, kCy = 5, kElements = 9;
    Intrinsics K;
    if (matrix.size() == kElements)
        K = {static_cast<float>(matrix[kFx]),
             static_cast<float>(matrix[kFy]),
             static_cast<float>(matrix[kCx]),
             static_cast<float>(matrix[kCy]),
             image.width,
             image.height};
    if (matrix.size() != kElements || !K.valid() || !std::isfinite(K.cx) || !std::isfinite(K.cy))
        throw Error(file.string() + ": is not a camera matrix of three rows; give the camera with --camera");
    return K;
}

bool is_stray_folder(const fs::path& folder) {
    std::error_code error;
    return fs::exists(folder / "rgb.mp4", error) && fs::exists(folder / "odometry.csv", error);
}

std::unique_ptr<FrameSource> open_stray_folder(const fs::path& folder, const SourceOptions& options) {
    return std::make_unique<StraySource>(folder, options);
}

}  // namespace posefusion
