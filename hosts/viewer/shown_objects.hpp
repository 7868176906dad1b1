#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/objects/object_map.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/viewer/frame_feed.hpp"

namespace posefusion {

/// A rigid thing that moves, as the window shows it.
struct ShownObject {
    std::uint8_t label = 0;
    std::size_t frames = 0;                           ///< in which it was tracked
    std::uint32_t pixels = 0;                         ///< in the newest frame
    std::optional<Eigen::Isometry3f> T_world_object;  ///< in the newest frame; nullopt: it was not tracked there
    std::vector<Eigen::Vector3f> path;                ///< world; a NaN stands where it was not tracked in between
    std::vector<Surfel> model;                        ///< in the frame of the object
};

/// The objects of a run: their paths, and their models where they are now.
class ShownObjects {
public:
    /// The next frame.
    void add(const FrameNews& news);
    /// Poses of the camera have changed. @param poses  as FrameFeed::News::corrected
    void correct(const Trajectory& poses);
    void set_models(std::vector<ObjectMap> models);
    void clear();

    [[nodiscard]] const std::vector<ShownObject>& all() const { return objects_; }  ///< by label
    /// The models of the objects that were tracked in the newest frame, in the world. A model counts its own frames:
    /// here its last one is the newest frame.
    [[nodiscard]] std::vector<Surfel> surfels() const;

private:
    struct Sighting {
        std::size_t frame = 0;
        Stamp stamp{};
        std::uint8_t label = 0;
        Eigen::Isometry3f T_camera_object = Eigen::Isometry3f::Identity();
    };

    ShownObject& object(std::uint8_t label);
    void extend_path(const Sighting& sighting, const Eigen::Isometry3f& T_world_camera);

    std::vector<ShownObject> objects_;
    std::vector<Sighting> sightings_;                               // in the order of frames
    std::vector<std::pair<std::uint8_t, std::size_t>> last_shown_;  // frame at the end of the path of each label
    std::size_t newest_ = 0;                                        // frame
};

}  // namespace posefusion
