#pragma once
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "hosts/config/run_config.hpp"
#include "hosts/io/recording.hpp"
#include "pose/joints.hpp"
#include "segmentation/segmenter.hpp"

namespace posefusion {

/// Who is in the picture, and how long it took to find out.
struct FoundPeople {
    std::optional<People> joints;  ///< eq. (1); nullopt: the network did not look at this frame
    Segmentation segmentation;
    std::optional<double> joints_ms;        ///< time of the network; nullopt: it did not run
    std::optional<double> segmentation_ms;  ///< time of the segmentation; nullopt: it did not run
};

/// Steps 1 and 2 of the paper: colour and depth in, static depth out. Called once per frame, in order, by one thread.
class PeopleFinder {
public:
    virtual ~PeopleFinder() = default;
    /// @param T_previous_current  asked for the camera motion since the previous call where it is needed; may block
    [[nodiscard]] virtual FoundPeople find(const Frame& frame,
                                           const std::function<Eigen::Isometry3f()>& T_previous_current) = 0;
    [[nodiscard]] virtual std::string description() const = 0;  ///< for reports

    /// What is remembered between calls; restore() into a finder of the same configuration goes on with the same
    /// results. Nothing by default.
    [[nodiscard]] virtual ByteArray state() const { return {}; }
    /// Throws Error if the bytes are no such state.
    virtual void restore(std::span<const std::byte> state) { StateReader(state, "the state of the people").end(); }
};

/// What is labelled is people; the rest is static. @param labels  of the same size; 0 static, 1..n person
[[nodiscard]] Segmentation cut_out(const DepthImage& depth, LabelImage labels);

/// The joint detector and the min-cut; or the network config.mask_network; or, with config.no_people, nobody. A network
/// of another kind is plugged in as a PersonMasker (pose/person_masker.hpp). Throws Error if the model cannot be used,
/// or for config.masks, which belong to a recording.
[[nodiscard]] std::unique_ptr<PeopleFinder> make_people_finder(const RunConfig& config, const Intrinsics& camera);
/// The same, or the masks of config.masks. Throws Error if the model or the masks cannot be used.
[[nodiscard]] std::unique_ptr<PeopleFinder> make_people_finder(const RunConfig& config, const Recording& recording);

}  // namespace posefusion
