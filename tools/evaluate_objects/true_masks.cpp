#include "tools/evaluate_objects/true_masks.hpp"

#include <filesystem>
#include <set>

#include "engine/core/error.hpp"
#include "hosts/evaluate/pose_matching.hpp"
#include "hosts/io/association.hpp"

namespace posefusion {

TrueMasks::TrueMasks(const Recording& recording) {
    const std::filesystem::path folder = recording.location();
    if (std::filesystem::is_directory(folder / "masks")) labels_.emplace(folder / "masks", recording);
    if (std::filesystem::is_directory(folder / "movers")) movers_.emplace(folder / "movers", recording);
    if (!labels_ && !movers_) throw Error(folder.string() + ": has no true masks; use a recording of posefusion synth");
}

std::optional<LabelImage> TrueMasks::of(Stamp stamp) const {
    std::optional<LabelImage> labels = labels_ ? labels_->load_as_recorded(stamp) : std::nullopt;
    const std::optional<LabelImage> movers = movers_ ? movers_->load_as_recorded(stamp) : std::nullopt;
    if (!movers) return labels;
    if (!labels) labels.emplace(movers->width(), movers->height());
    for (std::size_t i = 0; i < labels->size(); ++i)
        if ((*movers)[i] > 0) (*labels)[i] = kFirstObjectLabel;
    return labels;
}

ObjectStates::ObjectStates(const std::vector<TrueObject>& objects, const MotionConfig& motion)
    : settled_(motion.settled) {
    for (const TrueObject& object : objects)
        all_.push_back({object.label, stamps_of(object.poses), states_of(object, motion)});
}

FrameStates ObjectStates::at(Stamp stamp, const LabelImage& truth) {
    FrameStates states;
    for (const OfObject& object : all_)
        if (const auto i = nearest_stamp(object.stamps, stamp)) states[object.label] = object.states[*i];
    std::set<int> in_view;
    for (const std::uint8_t label : truth)
        if (label >= kFirstObjectLabel) in_view.insert(label);
    for (const int label : in_view)
        if (++frames_in_view_[label] <= settled_ && !states.contains(label)) states[label] = ObjectState::Begins;
    return states;
}

}  // namespace posefusion
