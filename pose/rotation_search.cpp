#include "pose/rotation_search.hpp"

#include <algorithm>
#include <array>
#include <cstdint>

#include "pose/people.hpp"

namespace posefusion {
namespace {

constexpr int kBestJoints = 5;
/// Relative to the present one; a camera mounted upside down is more frequent than one on its side.
constexpr std::array kCandidates{ImageRotation::Half, ImageRotation::Clockwise90, ImageRotation::Half,
                                 ImageRotation::Clockwise270};

}  // namespace

Sighting sighting_of(const People& people) {
    Sighting sighting;
    for (const Person& person : people) {
        for (const JointObservation& joint : person.joints) sighting.sum += joint.p;
        sighting.best = std::max(sighting.best, mean_certainty_of_best_joints(person, kBestJoints));
    }
    return sighting;
}

ImageRotation RotationSearch::candidate() const { return present_ + kCandidates[static_cast<std::size_t>(candidate_)]; }

std::optional<ImageRotation> RotationSearch::other_to_try(const Sighting& seen) {
    ++since_;
    const bool first = images_ < config_.first_unseen;
    if (first) ++images_;
    const int unseen = first ? 1 : config_.interval_unseen;
    if (since_ < (seen.best >= config_.sure ? interval_ : unseen) && wins_ == 0) return std::nullopt;
    since_ = 0;
    return candidate();
}

bool RotationSearch::compare(const Sighting& seen, const Sighting& seen_there) {
    if (seen_there.best < config_.sure || seen_there.sum <= config_.better * seen.sum) {
        wins_ = 0;
        if (seen.best >= config_.sure) interval_ = std::min(2 * interval_, config_.interval_seen);
        candidate_ = (candidate_ + 1) % static_cast<int>(kCandidates.size());
        return false;
    }
    interval_ = 1;
    if (++wins_ < config_.wins) return false;
    present_ = candidate();
    candidate_ = wins_ = 0;
    return true;
}

ByteArray RotationSearch::state() const {
    StateWriter out;
    out.put(static_cast<std::uint8_t>(present_));
    for (const int value : {candidate_, wins_, interval_, images_, since_}) out.put(std::int32_t{value});
    return out.take();
}

void RotationSearch::restore(std::span<const std::byte> state) {
    StateReader in(state, "the state of the pose network");
    RotationSearch read(config_);
    read.present_ = in.get_enum(ImageRotation::Clockwise270);
    for (int* value : {&read.candidate_, &read.wins_, &read.interval_, &read.images_, &read.since_}) {
        *value = in.get<std::int32_t>();
        if (*value < 0 || *value > config_.interval_seen) in.fail();
    }
    if (read.candidate_ >= static_cast<int>(kCandidates.size())) in.fail();
    in.end();
    *this = read;
}

}  // namespace posefusion
