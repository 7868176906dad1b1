#include "tools/evaluate_objects/mask_scores.hpp"

#include <array>
#include <limits>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kLabels = std::numeric_limits<std::uint8_t>::max() + 1;

double share(std::size_t part, std::size_t rest) {
    return part + rest == 0 ? 1 : static_cast<double>(part) / static_cast<double>(part + rest);
}

bool is_object(int label) { return label >= kFirstObjectLabel; }

}  // namespace

double MaskScores::recall() const { return share(hit, missed); }
double MaskScores::precision() const { return share(right, wrong); }

double MaskScores::iou(int truth, int estimate) const {
    const auto found = shared.find({truth, estimate});
    if (found == shared.end()) return 0;
    const std::size_t all = true_meanwhile.at({truth, estimate}) + estimated.at(estimate) - found->second;
    return static_cast<double>(found->second) / static_cast<double>(all);
}

void add_frame(MaskScores& scores, const LabelImage& estimate, const LabelImage& truth, const FrameStates& states) {
    if (estimate.width() != truth.width() || estimate.height() != truth.height())
        throw Error("the mask of the run and the true one differ in size");
    std::array<ObjectState, kLabels> state{};
    state.fill(ObjectState::Moves);
    for (const auto& [label, does] : states) state[static_cast<std::size_t>(label)] = does;
    std::map<std::pair<int, int>, std::size_t> both;
    std::map<int, std::size_t> true_now, estimated_now;
    for (std::size_t i = 0; i < truth.size(); ++i) ++both[{truth[i], estimate[i]}];
    for (const auto& [labels, pixels] : both) {
        const auto [is, said] = labels;
        if (is_object(is) && state[static_cast<std::size_t>(is)] == ObjectState::Moves) {
            (said > 0 ? scores.hit : scores.missed) += pixels;
            if (is_object(said)) scores.right += pixels;
        }
        if (is == 0 && is_object(said)) scores.wrong += pixels;
        if (is_object(is)) true_now[is] += pixels;
        if (is_object(said)) estimated_now[said] += pixels;
        if (is_object(is) && is_object(said)) scores.shared[labels] += pixels;
    }
    for (const auto& [said, pixels] : estimated_now) {
        scores.estimated[said] += pixels;
        for (const auto& [is, true_pixels] : true_now) scores.true_meanwhile[{is, said}] += true_pixels;
    }
}

}  // namespace posefusion
