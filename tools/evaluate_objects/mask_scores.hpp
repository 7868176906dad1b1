#pragma once
#include <cstddef>
#include <map>
#include <utility>

#include "engine/core/image.hpp"
#include "tools/evaluate_objects/object_truth.hpp"

/// What a run has left out as moving, compared with what moves.
namespace posefusion {

/// Pixels of all frames.
struct MaskScores {
    std::size_t hit = 0;     ///< of things that move: left out, as a mover or with a person
    std::size_t missed = 0;  ///< of things that move: kept
    std::size_t right = 0;   ///< said to be a mover: one that moves
    std::size_t wrong = 0;   ///< said to be a mover: static
    /// By the labels of a true object and an estimated one: pixels that they share, and pixels of the true object while
    /// the other one is in the image.
    std::map<std::pair<int, int>, std::size_t> shared, true_meanwhile;
    std::map<int, std::size_t> estimated;  ///< pixels by label

    [[nodiscard]] double recall() const;
    [[nodiscard]] double precision() const;
    /// Intersection over union of a true object and an estimated one, while that is in the image.
    [[nodiscard]] double iou(int truth, int estimate) const;
};

/// What the true objects do in a frame, by label.
using FrameStates = std::map<int, ObjectState>;

/// Adds a frame. People, and what stands or has just begun to move, may be left out or not: neither counts in recall
/// or precision.
/// @param estimate, truth  labels: 0 static, people, from kFirstObjectLabel on objects; of the same size
/// @param states           of labels that are not in it objects always move
void add_frame(MaskScores& scores, const LabelImage& estimate, const LabelImage& truth, const FrameStates& states);

}  // namespace posefusion
