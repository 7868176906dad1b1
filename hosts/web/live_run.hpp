#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "hosts/pipeline/frame_scheduler.hpp"
#include "hosts/run/people_tracks.hpp"

namespace posefusion {

/// What a page is told of a run that goes on, apart from the map. Neither who fills it in nor who reads it waits for
/// the other.
class LiveRun {
public:
    struct Frame {
        Stamp stamp{};
        bool tracked = false;      ///< its pose was found
        bool in_map = false;       ///< it belongs to the piece of map that is shown
        bool is_keyframe = false;  ///< of the map
        std::uint32_t number = 0;  ///< as the map counts, see Surfel::created
        Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
        std::vector<PersonInView> people;
    };
    struct Picture {
        std::size_t frame = 0;  ///< position in State::frames
        std::shared_ptr<const ColorImage> image;
    };
    struct State {
        std::vector<Frame> frames;      ///< since the start of the run, or since it was resumed
        std::vector<Picture> pictures;  ///< of some keyframes, small; ascending frames
    };

    /// A frame is done. Called by the run's thread, in the order of the frames.
    /// @param slam  which has just processed it
    void add(const ScheduledFrame& frame, const Slam& slam);
    /// The poses are others, as a loop was closed or the map is another piece. Called by the run's thread.
    void correct(const Slam& slam);

    [[nodiscard]] State state() const;

private:
    void keep_picture(const ColorImage& image);

    mutable std::mutex mutex_;
    State state_;
    std::uint32_t next_number_ = 0;
    std::size_t keyframes_ = 0;      ///< that the engine had after the last frame
    std::size_t pictures_seen_ = 0;  ///< keyframes offered for a picture
    std::size_t one_of_ = 1;         ///< so many of them, one is kept
};

}  // namespace posefusion
