/// Measures the masks of the segmentation against true masks over whole recordings.
/// Camera motion comes from groundtruth.txt, joints from the network or from joints.json.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "pose/detector.hpp"
#include "segmentation/segmenter.hpp"
#include "tools/mask_accuracy/movers.hpp"
#include "tools/mask_accuracy/report.hpp"
#include "tools/mask_accuracy/truth.hpp"

namespace posefusion::mask_accuracy {
namespace {

enum class JointSource { Network, Truth };

struct Options {
    std::vector<std::filesystem::path> recordings;
    SegmentationConfig segmentation;
    PoseConfig pose;
    JointSource source = JointSource::Network;
    int pose_every = 1;              ///< the joint source is asked on every n-th frame
    int max_frames = 0;              ///< 0 = all
    int worst = 3;                   ///< worst frames listed per recording
    std::filesystem::path overlays;  ///< folder of overlay pictures, empty = none
    int overlay_every = 10;
    bool movers = false;  ///< instead: what moves and is no person
    int print_every = 0;  ///< 0 = the whole recording only
};

class Joints {
public:
    Joints(const Options& options, const Truth& truth) : truth_(truth), every_(options.pose_every) {
        if (options.source == JointSource::Network) detector_ = make_joint_detector(options.pose);
        if (!detector_ && truth.joints.empty())
            throw Error("no joints.json beside the recording; use --joints network");
    }
    [[nodiscard]] std::optional<People> of(std::size_t frame, const ColorImage& color) const {
        if (frame % static_cast<std::size_t>(every_) != 0) return std::nullopt;
        return detector_ ? detector_->detect(color) : truth_.joints[frame];
    }

private:
    const Truth& truth_;
    std::unique_ptr<JointDetector> detector_;
    int every_;
};

/// Time this thread has worked, so that neighbours on the machine do not count.
double thread_milliseconds() {
    timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

std::vector<FrameResult> measure(const Options& options, const std::filesystem::path& folder) {
    const Recording recording(folder);
    const Truth truth = read_truth(recording);
    const Joints joints(options, truth);
    const auto segmenter = make_segmenter(options.segmentation, recording.intrinsics(), DepthNoise{});
    std::vector<FrameResult> results;
    for (std::size_t i = 0; i < recording.size(); ++i) {
        if (options.max_frames > 0 && i >= static_cast<std::size_t>(options.max_frames)) break;
        const Frame image = recording.load(i);
        const std::optional<People> people = joints.of(i, image.color);
        const Eigen::Isometry3f T_previous_current =
            i == 0 ? Eigen::Isometry3f::Identity() : truth.T_world_camera[i - 1].inverse() * truth.T_world_camera[i];

        const double start = thread_milliseconds();
        const Segmentation result = segmenter->segment(image.color, image.depth, people, T_previous_current);
        const double spent = thread_milliseconds() - start;

        const LabelImage mask = true_mask(truth, recording, image);
        FrameResult frame{image.stamp_text, {},   people ? static_cast<int>(people->size()) : 0, result.people,
                          result.carried,   spent};
        if (!mask.empty()) frame.counts = compare(result.labels, mask);
        results.push_back(frame);
        if (!options.overlays.empty() && i % static_cast<std::size_t>(options.overlay_every) == 0) {
            const auto file = options.overlays / (folder.filename().string() + "_" + image.stamp_text + ".png");
            write_overlay(file, image.color, result.labels, mask, people.value_or(People{}));
        }
    }
    return results;
}

void add_options(CLI::App& app, Options& o) {
    const std::map<std::string, SegmentationMode> modes{{"image", SegmentationMode::Image},
                                                        {"paper", SegmentationMode::Paper}};
    const std::map<std::string, JointSource> sources{{"network", JointSource::Network}, {"truth", JointSource::Truth}};
    app.add_option("recordings", o.recordings, "Folders in TUM layout; masks/ and joints.json where there is truth")
        ->required()
        ->check(CLI::ExistingDirectory);
    app.add_option("--mode", o.segmentation.mode, "image or paper")->transform(CLI::CheckedTransformer(modes));
    app.add_option("--sigma", o.segmentation.sigma, "Eq. (2), metres")->capture_default_str();
    app.add_option("--radius", o.segmentation.radius, "Eq. (3), metres")->capture_default_str();
    app.add_option("--reach", o.segmentation.reach, "Of things that move with people, metres")->capture_default_str();
    app.add_option("--joints", o.source, "network or truth (joints.json)")->transform(CLI::CheckedTransformer(sources));
    app.add_option("--model", o.pose.model, "Pose network; default: the one installed at set-up");
    app.add_option("--pose-every", o.pose_every, "Detect joints on every n-th frame only")->check(CLI::PositiveNumber);
    app.add_option("--max-frames", o.max_frames, "Stop after this many frames (0 = all)");
    app.add_option("--worst", o.worst, "How many of the worst frames to list");
    app.add_option("--overlays", o.overlays, "Folder for overlay pictures");
    app.add_flag("--movers", o.movers,
                 "Instead of people, what moves: with the true motion of the camera and the true people");
    app.add_option("--print-every", o.print_every, "With --movers, a line on every n-th frame");
    app.add_option("--overlay-every", o.overlay_every, "Overlay on every n-th frame")->check(CLI::PositiveNumber);
}

}  // namespace
}  // namespace posefusion::mask_accuracy

int main(int argc, char** argv) {
    using namespace posefusion::mask_accuracy;
    CLI::App app("Masks of the segmentation against true masks");
    Options options;
    add_options(app, options);
    CLI11_PARSE(app, argc, argv);
    try {
        if (!options.overlays.empty()) std::filesystem::create_directories(options.overlays);
        for (const auto& folder : options.recordings)
            if (options.movers) measure_movers(folder, options.max_frames, options.print_every);
        if (options.movers) return 0;
        std::vector<FrameResult> all;
        for (const auto& folder : options.recordings) {
            const auto frames = measure(options, folder);
            print_summary(folder.filename().string(), frames, options.worst);
            all.insert(all.end(), frames.begin(), frames.end());
        }
        if (options.recordings.size() > 1) print_summary("all", all, 0);
    } catch (const std::exception& e) {
        std::cerr << "mask_accuracy: " << e.what() << '\n';
        return 1;
    }
    return 0;
}
