#include "tools/mask_accuracy/movers.hpp"

#include <cstdio>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/motion_judge.hpp"
#include "segmentation/motion_segmenter.hpp"
#include "tools/evaluate_objects/true_masks.hpp"
#include "tools/mask_accuracy/truth.hpp"

namespace posefusion::mask_accuracy {
namespace {

LabelImage people_of(const LabelImage& labels) {
    LabelImage people = labels;
    for (std::uint8_t& label : people)
        if (label > kLastPersonLabel) label = 0;
    return people;
}

void print(const std::string& name, const MaskScores& scores) {
    std::printf("%-24s movers: recall %6.2f %%  precision %6.2f %%  hit %9zu  missed %9zu  wrong %9zu\n", name.c_str(),
                100 * scores.recall(), 100 * scores.precision(), scores.hit, scores.missed, scores.wrong);
}

}  // namespace

void measure_movers(const std::filesystem::path& folder, int max_frames, int every) {
    const Recording recording(folder);
    const TrueMasks masks(recording);
    const Truth truth = read_truth(recording);
    ObjectStates states(read_true_objects(folder), {});
    const auto judge = make_motion_segmenter(recording.intrinsics(), DepthNoise{});
    judge->restart();
    MaskScores all;
    for (std::size_t i = 0; i < recording.size(); ++i) {
        if (max_frames > 0 && i >= static_cast<std::size_t>(max_frames)) break;
        const Frame image = recording.load(i);
        const auto recorded = masks.of(image.stamp);
        if (!recorded) throw Error(folder.string() + ": there is no true mask for the image " + image.stamp_text);
        const LabelImage labels = recording.labels_from_source(*recorded);
        const LabelImage people = people_of(labels);
        judge->begin(image.color, image.depth, people);
        LabelImage found;
        Eigen::Isometry3f T_previous_current = Eigen::Isometry3f::Identity();
        if (i > 0) {
            T_previous_current = truth.T_world_camera[i - 1].inverse() * truth.T_world_camera[i];
            found = judge->find(T_previous_current);
        }
        judge->end(T_previous_current);
        if (found.empty()) found = LabelImage(labels.width(), labels.height());
        MaskScores frame;
        const FrameStates now = states.at(image.stamp, *recorded);
        add_frame(all, with_movers(people, found), labels, now);
        if (every <= 0 || i % static_cast<std::size_t>(every) != 0) continue;
        add_frame(frame, with_movers(people, found), labels, now);
        print("    " + image.stamp_text, frame);
    }
    print(folder.filename().string(), all);
}

}  // namespace posefusion::mask_accuracy
