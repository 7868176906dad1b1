#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "engine/preprocess/preprocessing.hpp"

namespace posefusion {

/// Measures on the device how two frames disagree about the times at which their rows were taken: each frame, one late
/// so that its motion is known from both sides, is compared with an earlier one, the reference. Frames rather than the
/// model, because the model was made from the newest frames, taken with nearly the same motion, and shares their error.
class TimingProbe {
public:
    TimingProbe(vulkan::Context& context, const Intrinsics& camera, bool rolling);

    /// After a frame. @param tracked  it has a pose  @param params, record, live  of the frame, on the device
    /// @return TIMING_COLUMNS sums of track_reduce with TIMING for the frame before it (SensorTiming::add()); empty:
    /// that frame could not be compared
    [[nodiscard]] std::span<const float> after_frame(bool tracked, const vulkan::Buffer& params,
                                                     const vulkan::Buffer& record, const ImagePyramid& live);

private:
    /// Half resolution: rows of a few pixels' height are what the shutter bends.
    static constexpr int kLevel = 1;
    /// Frames from one reference to the next: a frame is compared with one that is this many to twice as many older. By
    /// then a hand-held camera moves differently, but still sees the same.
    static constexpr std::uint32_t kReferenceEvery = 8;

    /// What is kept of a frame.
    struct View {
        vulkan::Buffer geometry, photometric, record;
        View(vulkan::Context& context, const Intrinsics& camera, const std::string& name);
    };
    void enqueue_copy(vulkan::Sequence& sequence, const View& from, const View& to) const;
    void record_commands(const vulkan::Buffer& params, const vulkan::Buffer& record, const ImagePyramid& live);

    vulkan::Context& context_;
    Intrinsics camera_;
    View previous_, next_reference_, reference_;
    vulkan::Buffer pair_, rows_, row_counts_, sums_, host_sums_;
    vulkan::Kernel begin_, reduce_, sum_;
    std::unique_ptr<vulkan::Sequence> compare_, change_reference_, keep_;
    std::uint32_t tracked_ = 0;  ///< frames in a row
};

}  // namespace posefusion
