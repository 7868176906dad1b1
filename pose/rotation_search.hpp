#pragma once
#include <optional>
#include <span>

#include "engine/core/byte_stream.hpp"
#include "pose/image_rotation.hpp"
#include "pose/joints.hpp"

namespace posefusion {

/// How clearly people are seen in an image.
struct Sighting {
    float sum = 0;   ///< of p over all joints of all people
    float best = 0;  ///< mean p of the five most certain joints of the person for whom it is largest, [0, 1]
};

[[nodiscard]] Sighting sighting_of(const People& people);

/// In synthetic rooms and TUM's, upright people gave 1.5 to 10 times the sum of the same people upside down; furniture
/// reached a best of 0.43 in any rotation.
struct RotationSearchConfig {
    float sure = 0.5f;        ///< Sighting::best of somebody who is certainly there
    float better = 1.25f;     ///< a rotation is preferred if its sum is this many times that of the present one ...
    int wins = 2;             ///< ... in this many comparisons in succession
    int interval_seen = 64;   ///< images between two comparisons at most, while somebody is certainly there; doubles up
                              ///< to this with each comparison
    int interval_unseen = 8;  ///< the same while nobody is ...
    int first_unseen = 16;    ///< ... after so many images, each of which is compared
};

/// Which way up is the camera? Networks find people who are upright in the image. Now and then an image is looked at
/// in another rotation as well, less and less often while the present one proves right. The outcome depends on the
/// images alone.
class RotationSearch {
public:
    explicit RotationSearch(const RotationSearchConfig& config = {}) : config_(config) {}

    [[nodiscard]] ImageRotation present() const { return present_; }
    /// To be called for each image. @param seen  in present()
    /// @return another rotation to look at the same image in; nullopt: not this time
    [[nodiscard]] std::optional<ImageRotation> other_to_try(const Sighting& seen);
    /// @param seen, seen_there  in present() and in what other_to_try() returned
    /// @return present() has become the other one
    bool compare(const Sighting& seen, const Sighting& seen_there);

    [[nodiscard]] ByteArray state() const;
    /// Throws Error if the bytes are no such state.
    void restore(std::span<const std::byte> state);

private:
    [[nodiscard]] ImageRotation candidate() const;

    RotationSearchConfig config_;
    ImageRotation present_ = ImageRotation::None;
    int candidate_ = 0;  ///< index of the rotation to try next
    int wins_ = 0;       ///< of the candidate, in succession
    int interval_ = 1;   ///< images between two comparisons while somebody is seen
    int images_ = 0;     ///< so far; not counted beyond first_unseen
    int since_ = 0;      ///< images since the last comparison
};

}  // namespace posefusion
