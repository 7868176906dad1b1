#pragma once
#include <optional>

#include "hosts/export/view.hpp"
#include "hosts/io/masks.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/run/finished_run.hpp"

namespace posefusion {

/// The frames of a finished run whose poses are known, with their images in the full size of the recording.
class ViewSource {
public:
    /// @param undistort  images as an ideal lens would give them, instead of as recorded. Throws Error: the recording
    /// cannot be used, or has none of the frames.
    ViewSource(const FinishedRun& run, bool undistort);

    [[nodiscard]] std::size_t size() const { return frames_.size(); }
    [[nodiscard]] const Eigen::Isometry3d& pose(std::size_t i) const { return frames_[i].T_world_camera; }
    /// Of the views.
    [[nodiscard]] const Camera& camera() const { return camera_; }
    [[nodiscard]] bool masked() const { return masks_.has_value(); }
    [[nodiscard]] const Recording& recording() const { return recording_; }
    /// Frames of the trajectory that the recording does not have, and frames without a mask where others have one:
    /// these are left out.
    [[nodiscard]] std::size_t unknown() const { return unknown_; }
    [[nodiscard]] std::size_t without_mask() const { return without_mask_; }

    /// Throws Error: an image or mask cannot be read.
    [[nodiscard]] View load(std::size_t i) const;

private:
    struct KnownFrame {
        std::size_t index;  ///< in the recording
        Eigen::Isometry3d T_world_camera;
    };
    void find_frames(const FinishedRun& run);
    [[nodiscard]] LabelImage people_in(std::size_t i) const;

    Recording recording_;
    std::optional<MaskFolder> masks_;
    Camera recorded_;  ///< of the images of the recording
    Camera camera_;
    bool undistort_;
    int margin_ = 0;            ///< of masks, pixels
    Image<float> deformation_;  ///< of depth, in the images of the recording; empty = none
    std::vector<KnownFrame> frames_;
    std::size_t unknown_ = 0, without_mask_ = 0;
};

}  // namespace posefusion
