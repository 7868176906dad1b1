#pragma once
#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hosts/config/run_config.hpp"
#include "hosts/io/recording.hpp"
#include "pose/joints.hpp"
#include "segmentation/segmenter.hpp"

namespace posefusion {

/// The people in an image, and the time that finding them took.
struct FoundPeople {
    std::optional<People> joints;  ///< eq. (1); nullopt: the network did not run on this frame
    Segmentation segmentation;
    /// Of person 1..n of the segmentation, over a whole run (hosts/run/people_tracks.hpp); empty: not known.
    std::vector<int> ids;
    std::optional<double> joints_ms;        ///< nullopt: the network did not run
    std::optional<double> segmentation_ms;  ///< nullopt: there was no search for people
};

/// Steps 1 and 2 of the paper: finding people. Each is called once per frame, in order, by one thread.
class PeopleFinder {
public:
    virtual ~PeopleFinder() = default;
    /// Step 1: the joints of people; nullopt where it does not run on this frame, or needs no joints.
    [[nodiscard]] virtual std::optional<People> find_joints(const Frame&) { return std::nullopt; }
    /// Step 2: their pixels; no labels where it does not search for people at all.
    /// @param joints              the result of find_joints() for this frame
    /// @param T_previous_current  motion of the camera since the previous frame, predicted
    [[nodiscard]] virtual Segmentation segment(const Frame& frame, const std::optional<People>& joints,
                                               const Eigen::Isometry3f& T_previous_current) = 0;
    [[nodiscard]] virtual std::string description() const = 0;  ///< for reports

    /// The memory between calls; after restore(), a finder of the same configuration continues with the same results.
    /// Empty by default.
    [[nodiscard]] virtual ByteArray state() const { return {}; }
    /// Throws Error if the bytes are not such a state.
    virtual void restore(std::span<const std::byte> state) { StateReader(state, "the state of the people").end(); }
};

/// The joint detector and the min-cut; or the network config.mask_network; or, with config.no_people, none. A network
/// of another kind is plugged in as a PersonMasker (pose/person_masker.hpp). Throws Error if the model cannot be used,
/// or for config.masks, which belong to a recording.
[[nodiscard]] std::unique_ptr<PeopleFinder> make_people_finder(const RunConfig& config, const Intrinsics& camera);
/// The same, or the masks of config.masks. Throws Error if the model or the masks cannot be used.
[[nodiscard]] std::unique_ptr<PeopleFinder> make_people_finder(const RunConfig& config, const Recording& recording);

}  // namespace posefusion
