#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "pose/joints.hpp"

namespace posefusion::mask_accuracy {

/// Pixels of one frame, estimate against truth; labels above 0 all mean person.
struct Counts {
    long hit = 0;     ///< person in both
    long missed = 0;  ///< person in the truth only
    long lost = 0;    ///< person in the estimate only: static pixels lost
    long clear = 0;   ///< static in both
    [[nodiscard]] double recall() const { return hit + missed > 0 ? double(hit) / double(hit + missed) : 1.0; }
    [[nodiscard]] double static_lost() const { return lost + clear > 0 ? double(lost) / double(lost + clear) : 0.0; }
    [[nodiscard]] double iou() const {
        return hit + missed + lost > 0 ? double(hit) / double(hit + missed + lost) : 1.0;
    }
    Counts& operator+=(const Counts& other);
};

[[nodiscard]] Counts compare(const LabelImage& estimate, const LabelImage& truth);

struct FrameResult {
    std::string stamp;
    Counts counts;
    int detected = 0, people = 0, carried = 0;
    double milliseconds = 0;  ///< of one core for the segmentation alone
};

/// Prints one table line and the worst frames of a recording.
void print_summary(const std::string& name, const std::vector<FrameResult>& frames, int worst);

/// Picture to look at: hit pixels green, missed red, lost blue (without truth: one tint per person); joints as dots.
void write_overlay(const std::filesystem::path& file, const ColorImage& color, const LabelImage& estimate,
                   const LabelImage& truth, const People& people);

}  // namespace posefusion::mask_accuracy
