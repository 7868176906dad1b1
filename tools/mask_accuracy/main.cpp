/// Measures the masks of the segmentation against true masks over whole sequences.
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
#include "tools/mask_accuracy/report.hpp"
#include "tools/mask_accuracy/sequence.hpp"

namespace posefusion::mask_accuracy {
namespace {

enum class JointSource { Network, Truth };

struct Options {
    std::vector<std::filesystem::path> sequences;
    SegmentationConfig segmentation;
    PoseConfig pose;
    JointSource source = JointSource::Network;
    int pose_every = 1;              ///< the joint source is asked on every n-th frame
    int max_frames = 0;              ///< 0 = all
    int worst = 3;                   ///< worst frames listed per sequence
    std::filesystem::path overlays;  ///< folder of overlay pictures, empty = none
    int overlay_every = 10;
};

class Joints {
public:
    Joints(const Options& options, const Sequence& sequence) : sequence_(sequence), every_(options.pose_every) {
        if (options.source == JointSource::Network) detector_ = make_joint_detector(options.pose);
        if (!detector_ && sequence.joints.empty())
            throw Error("no joints.json beside the sequence; use --joints network");
    }
    [[nodiscard]] std::optional<People> of(std::size_t frame, const ColorImage& color) const {
        if (frame % static_cast<std::size_t>(every_) != 0) return std::nullopt;
        return detector_ ? detector_->detect(color) : sequence_.joints[frame];
    }

private:
    const Sequence& sequence_;
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
    const Sequence sequence = open_sequence(folder);
    const Joints joints(options, sequence);
    const auto segmenter = make_segmenter(options.segmentation, sequence.camera);
    std::vector<FrameResult> results;
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
        if (options.max_frames > 0 && i >= static_cast<std::size_t>(options.max_frames)) break;
        const Entry& entry = sequence.frames[i];
        const ColorImage color = read_color(entry.color);
        const DepthImage depth = read_depth(entry.depth, sequence.depth_scale);
        const std::optional<People> people = joints.of(i, color);
        const Eigen::Isometry3f T_previous_current =
            i == 0 ? Eigen::Isometry3f::Identity()
                   : sequence.frames[i - 1].T_world_camera.inverse() * entry.T_world_camera;

        const double start = thread_milliseconds();
        const Segmentation result = segmenter->segment(color, depth, people, T_previous_current);
        const double spent = thread_milliseconds() - start;

        const LabelImage truth = entry.mask.empty() ? LabelImage() : read_mask(entry.mask);
        FrameResult frame{entry.stamp,    {},   people ? static_cast<int>(people->size()) : 0, result.people,
                          result.carried, spent};
        if (!truth.empty()) frame.counts = compare(result.labels, truth);
        results.push_back(frame);
        if (!options.overlays.empty() && i % static_cast<std::size_t>(options.overlay_every) == 0) {
            const auto file = options.overlays / (folder.filename().string() + "_" + entry.stamp + ".png");
            write_overlay(file, color, result.labels, truth, people.value_or(People{}));
        }
    }
    return results;
}

void add_options(CLI::App& app, Options& o) {
    const std::map<std::string, SegmentationMode> modes{{"image", SegmentationMode::Image},
                                                        {"paper", SegmentationMode::Paper}};
    const std::map<std::string, JointSource> sources{{"network", JointSource::Network}, {"truth", JointSource::Truth}};
    app.add_option("sequences", o.sequences, "Folders in TUM layout; masks/ and joints.json where there is truth")
        ->required()
        ->check(CLI::ExistingDirectory);
    app.add_option("--mode", o.segmentation.mode, "image or paper")->transform(CLI::CheckedTransformer(modes));
    app.add_option("--joints", o.source, "network or truth (joints.json)")->transform(CLI::CheckedTransformer(sources));
    app.add_option("--model", o.pose.model, "Pose network; default: the one installed at set-up");
    app.add_option("--pose-every", o.pose_every, "Detect joints on every n-th frame only")->check(CLI::PositiveNumber);
    app.add_option("--max-frames", o.max_frames, "Stop after this many frames (0 = all)");
    app.add_option("--worst", o.worst, "How many of the worst frames to list");
    app.add_option("--overlays", o.overlays, "Folder for overlay pictures");
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
        std::vector<FrameResult> all;
        for (const auto& folder : options.sequences) {
            const auto frames = measure(options, folder);
            print_summary(folder.filename().string(), frames, options.worst);
            all.insert(all.end(), frames.begin(), frames.end());
        }
        if (options.sequences.size() > 1) print_summary("all", all, 0);
    } catch (const std::exception& e) {
        std::cerr << "mask_accuracy: " << e.what() << '\n';
        return 1;
    }
    return 0;
}
