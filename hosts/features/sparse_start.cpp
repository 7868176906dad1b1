#include "hosts/features/sparse_start.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hosts/features/rigid_motion.hpp"

namespace posefusion {
namespace {

StartPose start_of(const RigidMotion& motion, std::uint32_t age) {
    return {age, motion.T_earlier_current, motion.covariance, motion.inliers};
}

void put(StateWriter& out, const Features& features) {
    out.list(features, [&](const Feature& feature) {
        for (const float value : {feature.pixel.x(), feature.pixel.y(), feature.sigma, feature.depth}) out.put(value);
        out.raw(feature.descriptor.data(), feature.descriptor.size());
    });
}

Features get_features(StateReader& in) {
    return in.list<Feature>(sizeof(Feature), [&] {
        Feature feature;
        for (float* value : {&feature.pixel.x(), &feature.pixel.y(), &feature.sigma, &feature.depth}) {
            *value = in.get<float>();
            if (!std::isfinite(*value)) in.fail();
        }
        in.raw(feature.descriptor.data(), feature.descriptor.size());
        return feature;
    });
}

}  // namespace

std::optional<StartPose> SparseStart::look_back(const View& earlier, const Features& current) const {
    const auto matches = match_features(earlier.features, current);
    const auto motion = motion_between(earlier.features, current, matches, camera_, noise_);
    return motion ? std::optional(start_of(*motion, frame_ - earlier.frame)) : std::nullopt;
}

std::vector<StartPose> SparseStart::find(const ColorImage& color, const DepthImage& depth, const LabelImage& labels) {
    Features current = find_features(color, depth, labels, config_);
    std::vector<StartPose> starts;
    const auto recognise = [&](const View& earlier) {
        const auto start = look_back(earlier, current);
        if (start) starts.push_back(*start);
        return start ? start->inliers : 0u;
    };
    recognise(previous_);
    bool reference_in_view = reference_.frame == previous_.frame;
    if (!reference_in_view)
        reference_in_view = static_cast<float>(recognise(reference_)) >=
                            FeatureConfig::kMinReferenceShare * static_cast<float>(reference_.features.size());
    const bool broken = starts.empty() && !current.empty();
    if (!reference_in_view || reference_.features.empty()) replace_reference();
    if (broken && !places_.empty()) {
        adrift_ = true;
        search_until_ = frame_ + FeatureConfig::kSearchFrames;
    }
    if (adrift_ || frame_ < search_until_) look_for_places(current, starts);
    previous_ = {std::move(current), frame_};
    if (reference_.features.empty()) reference_ = previous_;
    ++frame_;
    return starts;
}

/// By the previous frame.
void SparseStart::replace_reference() {
    if (!reference_.features.empty()) places_.push_back(std::move(reference_));
    if (places_.size() > FeatureConfig::kMaxPlaces) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < places_.size(); i += 2) places_[kept++] = std::move(places_[i]);
        places_.resize(kept);
    }
    reference_ = previous_;
}

/// Compares some of the places with the current frame, in turn.
void SparseStart::look_for_places(const Features& current, std::vector<StartPose>& starts) {
    std::optional<StartPose> best;
    for (std::size_t i = 0; i < std::min(FeatureConfig::kPlacesPerFrame, places_.size()); ++i) {
        next_place_ = (next_place_ + 1) % static_cast<std::uint32_t>(places_.size());
        const auto start = look_back(places_[next_place_], current);
        if (start && (!best || start->inliers > best->inliers)) best = start;
    }
    if (!best) return;
    starts.push_back(*best);
    adrift_ = false;
}

ByteArray SparseStart::state() const {
    StateWriter out;
    const auto put_view = [&](const View& view) {
        put(out, view.features);
        out.put(view.frame);
    };
    out.put(frame_);
    put_view(previous_);
    put_view(reference_);
    out.list(places_, put_view);
    out.put(next_place_);
    out.put(static_cast<std::uint8_t>(adrift_));
    out.put(search_until_);
    return out.take();
}

void SparseStart::restore(std::span<const std::byte> state) {
    StateReader in(state, "the state of the features");
    SparseStart restored(camera_, noise_, config_);
    restored.frame_ = in.get<std::uint32_t>();
    const auto get_view = [&] {
        View view;
        view.features = get_features(in);
        view.frame = in.get<std::uint32_t>();
        if (view.frame > restored.frame_) in.fail();
        return view;
    };
    restored.previous_ = get_view();
    restored.reference_ = get_view();
    constexpr std::size_t kLeastBytes = 12;  // of a view without features
    restored.places_ = in.list<View>(kLeastBytes, get_view);
    restored.next_place_ = in.get<std::uint32_t>();
    restored.adrift_ = in.get<std::uint8_t>() != 0;
    restored.search_until_ = in.get<std::uint32_t>();
    in.end();
    *this = std::move(restored);
}

}  // namespace posefusion
