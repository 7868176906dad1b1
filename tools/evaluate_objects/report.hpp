#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate_objects/object_scores.hpp"

namespace posefusion {

struct ObjectResult {
    std::string kind;
    int label = 0;               ///< true one
    std::optional<int> matched;  ///< label of the estimated object
    double iou = 0;
    ObjectScores scores;
};

struct ObjectEvaluation {
    MaskScores masks;
    std::size_t frames = 0;             ///< with both masks
    bool has_objects = false;           ///< the run has models of objects
    std::size_t spurious = 0;           ///< estimated objects that match no true one
    std::vector<ObjectResult> objects;  ///< true ones, if the run has models of objects
};

/// @param recording  with masks/ and, for objects, info.json; a folder `movers` with masks of what moves, people left
///                   out, is read, too: all that is labelled in it moves
/// @param run        output folder of `posefusion run --save-masks`
/// Throws Error.
[[nodiscard]] ObjectEvaluation evaluate_objects(const std::filesystem::path& recording,
                                                const std::filesystem::path& run, const MotionConfig& motion = {});

[[nodiscard]] std::string object_evaluation_table(const ObjectEvaluation& evaluation);
[[nodiscard]] std::string object_evaluation_json(const ObjectEvaluation& evaluation);

}  // namespace posefusion
