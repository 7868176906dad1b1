#pragma once
#include <map>
#include <optional>
#include <vector>

#include "hosts/io/masks.hpp"
#include "hosts/io/recording.hpp"
#include "tools/evaluate_objects/mask_scores.hpp"

namespace posefusion {

/// The true masks of a recording: people, and from kFirstObjectLabel on what moves and is no person. In a folder
/// `movers` all that is labelled moves, as one thing.
class TrueMasks {
public:
    /// Throws Error: the recording, which must outlive this object, has neither masks/ nor movers/.
    explicit TrueMasks(const Recording& recording);
    /// In the geometry of the recording's own images.
    [[nodiscard]] std::optional<LabelImage> of(Stamp stamp) const;

private:
    std::optional<MaskFolder> labels_, movers_;
};

/// What objects do in the frames of a recording, asked for one after the other. Of an object without known poses: it
/// begins to move when it comes into view.
class ObjectStates {
public:
    ObjectStates(const std::vector<TrueObject>& objects, const MotionConfig& motion);
    /// @param truth  true mask of the frame
    [[nodiscard]] FrameStates at(Stamp stamp, const LabelImage& truth);

private:
    struct OfObject {
        int label;
        std::vector<Stamp> stamps;
        std::vector<ObjectState> states;
    };
    std::vector<OfObject> all_;
    int settled_;
    std::map<int, int> frames_in_view_;  ///< by label
};

}  // namespace posefusion
