#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "segmentation/node_grid.hpp"

/// What the frames of the last second say about the points of the current one: was there free space, or a surface?
namespace posefusion {

struct ViewHistoryConfig {
    int views = 10;  ///< frames that are kept
    int every = 3;   ///< one of this many frames is kept
    /// A point lies in front of a surface by more than this margin, metres, ...
    float margin = 0.015f;
    float sigmas = 2;     ///< ... this many standard deviations of the depth noise ...
    float drift = 0.02f;  ///< ... and this share of the way of the camera since the view, also of the angle
    /// Of the motion from a frame to the next: when a row was taken is known to half a frame, as shutters and stamps
    /// go.
    float shutter = 0.5f;
    /// A surface that has moved away from the camera is looked for within this distance behind where it was, metres.
    float receded = 0.25f;
    /// So many views in a row that see a surface show that it has not moved away: it was uncovered.
    int settled = 3;
};

/// The views for and against a point at a node of the current grid.
struct Sightings {
    int free = 0;  ///< views that saw through the point: something has come there since
    int left =
        0;  ///< views that saw a surface closely in front of the point where now there is none: it has moved back
    int there = 0;              ///< views that saw a surface at the point
    int there_since = 0;        ///< ... of these, the newest in a row
    bool was_hidden = false;    ///< something close in front of it is gone, but it has not moved
    bool there_before = false;  ///< ... and before it was gone: something hid it for a while
};

/// A newly uncovered part of the static scene is in front of nothing that an earlier view saw: free space tells what
/// has moved from parallax, whatever its texture (as DynaSLAM's and nvblox's tests do).
class ViewHistory {
public:
    explicit ViewHistory(const ViewHistoryConfig& config) : config_(config) {}

    /// @param T_previous_current  motion of the camera since the frame that was added last
    /// @param nearest  per node, the least depth of its pixels, metres; 0 = unknown
    [[nodiscard]] std::vector<Sightings> look_back(const NodeGrid& grid, const std::vector<float>& nearest,
                                                   const Eigen::Isometry3f& T_previous_current) const;
    void add(const NodeGrid& grid, const std::vector<float>& nearest, const Eigen::Isometry3f& T_previous_current);
    void clear();
    [[nodiscard]] bool empty() const { return views_.empty(); }

    void save(StateWriter& out) const;
    /// @param nodes  of the grid
    void load(StateReader& in, std::size_t nodes);

private:
    struct View {
        Eigen::Isometry3f T_view_last;  ///< from the camera of the frame that was added last
        float blur;                     ///< nodes by which the camera turned during half a frame
        std::vector<float> depth;       ///< per node, median, metres; 0 = unknown
        std::vector<float> clear;       ///< free up to here around the node, metres; 0 = unknown
        std::vector<float> farthest;    ///< the greatest depth around the node, metres; 0 = unknown
    };

    ViewHistoryConfig config_;
    std::vector<View> views_;  ///< oldest first
    int since_kept_ = 0;       ///< frames added since one was kept
};

}  // namespace posefusion
