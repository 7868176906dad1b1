#include "hosts/features/sparse_start.hpp"

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

std::vector<StartPose> SparseStart::find(const ColorImage& color, const DepthImage& depth, const LabelImage& labels) {
    Features current = find_features(color, depth, labels, config_);
    std::vector<StartPose> starts;
    const auto look_back = [&](const Features& earlier, std::uint32_t age) {
        const auto motion = motion_between(earlier, current, match_features(earlier, current), camera_, noise_);
        if (motion) starts.push_back(start_of(*motion, age));
        return motion ? motion->inliers : 0u;
    };
    look_back(previous_, 1);
    bool reference_in_view = reference_age_ == 0;  // then it is the previous frame
    if (reference_age_ > 0) {
        const std::uint32_t inliers = look_back(reference_, reference_age_ + 1);
        reference_in_view =
            static_cast<float>(inliers) >= FeatureConfig::kMinReferenceShare * static_cast<float>(reference_.size());
    }
    if (!reference_in_view || reference_.empty()) {
        reference_ = previous_;
        reference_age_ = 0;
    }
    ++reference_age_;
    previous_ = std::move(current);
    if (reference_.empty()) reference_ = previous_, reference_age_ = 0;
    return starts;
}

ByteArray SparseStart::state() const {
    StateWriter out;
    put(out, previous_);
    put(out, reference_);
    out.put(reference_age_);
    return out.take();
}

void SparseStart::restore(std::span<const std::byte> state) {
    StateReader in(state, "the state of the features");
    Features previous = get_features(in), reference = get_features(in);
    const auto age = in.get<std::uint32_t>();
    in.end();
    previous_ = std::move(previous);
    reference_ = std::move(reference);
    reference_age_ = age;
}

}  // namespace posefusion
