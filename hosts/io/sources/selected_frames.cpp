#include "hosts/io/sources/selected_frames.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "engine/core/number_text.hpp"

namespace posefusion {
namespace {

class SelectedFrames final : public FrameSource {
public:
    SelectedFrames(std::unique_ptr<FrameSource> source, const FrameSelection& selection)
        : source_(std::move(source)), selection_(selection) {
        facts_ = source_->facts();
        if (facts_.live) return;
        const std::vector<FrameEntry> all = std::exchange(facts_.frames, {});
        for (std::size_t i = first_of(all); i < all.size(); i += std::min(selection.every, all.size() - i)) {
            facts_.frames.push_back(all[i]);
            facts_.places.push_back(i);
        }
    }

    RawFrame read(std::size_t i) const override { return facts_.live ? next() : source_->read(facts_.places.at(i)); }
    std::optional<Trajectory> groundtruth() const override { return source_->groundtruth(); }

private:
    [[nodiscard]] std::size_t first_of(const std::vector<FrameEntry>& all) const {
        const FrameStart& start = selection_.start;
        std::size_t first = start.frame;
        if (start.after > Stamp{} && !all.empty()) {
            first = static_cast<std::size_t>(std::count_if(all.begin(), all.end(), [&](const FrameEntry& frame) {
                return frame.stamp - all.front().stamp < start.after;
            }));
        }
        if (first >= all.size()) {
            const Stamp length = all.empty() ? Stamp{} : all.back().stamp - all.front().stamp;
            throw Error(facts_.location + ": --start " + text_of(start) + " leaves nothing of its " +
                        counted(all.size(), "frame") + " (" + fixed_text(to_seconds(length), 1) +
                        " s); give an earlier one");
        }
        return first;
    }

    /// Of a camera: the next frame that is selected.
    [[nodiscard]] RawFrame next() const {
        const std::lock_guard lock(mutex_);
        for (;;) {
            RawFrame frame = source_->read(0);
            if (arrived_++ == 0) begin_ = frame.stamp;
            const bool started = arrived_ > selection_.start.frame && frame.stamp - begin_ >= selection_.start.after;
            if (started && since_start_++ % selection_.every == 0) return frame;
        }
    }

    std::unique_ptr<FrameSource> source_;
    FrameSelection selection_;
    mutable std::mutex mutex_;  ///< guards what follows
    mutable std::size_t arrived_ = 0, since_start_ = 0;
    mutable Stamp begin_{};
};

}  // namespace

std::unique_ptr<FrameSource> select_frames(std::unique_ptr<FrameSource> source, const FrameSelection& selection) {
    if (selection == FrameSelection{}) return source;
    return std::make_unique<SelectedFrames>(std::move(source), selection);
}

}  // namespace posefusion
