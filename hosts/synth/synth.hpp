#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/synth/sensor_model.hpp"
#include "pose/joints.hpp"

/// Synthetic RGB-D sequences of a furnished room in which people walk, turn, sit and leave. Everything is generated
/// here from the seed: the room, the people, their motion, the hand-held camera and the sensor. World frame: metres, z
/// up, floor at z = 0, a corner of the room at the origin.
namespace posefusion {

namespace synth {
class SensorUnit;
}

enum class SynthScenario : std::uint8_t {
    Room,        ///< a living room, seen by a hand-held camera
    Loop,        ///< the camera walks through a large room, around a block of walls, and returns to its start
    LoopPeople,  ///< the same; people stand and walk in front of the start when the camera returns
    Kidnap,      ///< half the walk; then the lens is covered while the camera is carried to a place seen before
    Movers,      ///< a living room in which things move, too: see SynthObject
};

/// Names on the command line: room, loop, loop-people, kidnap, movers.
[[nodiscard]] const char* scenario_name(SynthScenario scenario);
/// Whether the camera walks through a large room; else it overlooks a living room.
[[nodiscard]] bool has_walk(SynthScenario scenario);
/// Frames that suit a scenario: at 30 a second a walk is one at a hand-held camera's pace, and long enough for its
/// start to become old map (LoopConfig::time_window) before the camera is back.
[[nodiscard]] int usual_frames(SynthScenario scenario);

struct SynthConfig {
    std::filesystem::path out;  ///< folder of the sequence, made if absent (used by synthesize() only)
    SynthScenario scenario = SynthScenario::Room;
    int frames = 120;           ///< number of frames, >= 1; see usual_frames()
    int people = 2;             ///< people in the room, 0..kMaxSynthPeople; 0 = a static scene
    std::uint64_t seed = 1;     ///< decides room, people, motion, camera and noise
    int width = 640;            ///< pixels, >= 16
    int height = 480;           ///< pixels, >= 16
    double fps = 30;            ///< frames per second, > 0
    synth::SensorModel sensor;  ///< what kind of camera it is; see synth::sensor_models()
    /// Off: no noise, dropouts and blur, depth everywhere. What the sensor does to time, exposure, optics and depth as
    /// a whole stays.
    bool noise = true;
    bool still_camera = false;  ///< the camera stays in place, only the tremor remains (not in scenarios with a walk)
    /// Pace of the hand-held motion, 1 = calm (about 0.2 m/s). In scenarios with a walk, `frames` determines its speed,
    /// as it fills the whole sequence (about 13 m in 3/4 of the time); the pace is that of looking around.
    double camera_speed = 1.0;
    bool easy = false;  ///< walks in daylight between textured walls, so that the pose hardly drifts
    int threads = 0;    ///< CPU threads, 0 = all; the pixels do not depend on it
};

inline constexpr int kMaxSynthPeople = 6;
inline constexpr float kSynthDepthScale = 5000;  ///< units of a depth image per metre

enum class JointVisibility : std::uint8_t {
    Hidden = 0,         ///< outside the image or behind something else
    BehindOwnBody = 1,  ///< hidden by the same person's body
    Visible = 2,
};

/// A body joint projected into the image.
struct SynthJoint {
    float u = 0, v = 0;  ///< pixels
    float z = 0;         ///< depth along the optical axis, metres; <= 0 behind the camera
    JointVisibility visibility = JointVisibility::Hidden;
};

/// Ground truth of one person in one frame. `id` is the label in the mask.
struct SynthPerson {
    int id = 0;
    std::array<SynthJoint, kJointCount> joints{};  ///< OpenPose order, see Joint
    int pixels = 0;                                ///< pixels of the mask with this label
    bool sitting = false;
    float facing = 0;  ///< angle between the chest's forward axis and the direction to the camera, rad, 0 = frontal
};

/// Things of the scenario Movers.
enum class SynthObjectKind : std::uint8_t {
    Cart,
    Box,  ///< carried by somebody, or through the air if there are fewer people than it takes
    Door,
    Ball,
    Chair,   ///< pulled by a person
    Screen,  ///< stands still and shows a film: it is part of the static scene
};
/// cart, box, door, ball, chair, screen.
[[nodiscard]] const char* object_name(SynthObjectKind kind);

struct SynthTriangles {
    std::vector<Eigen::Vector3f> vertices;            ///< metres
    std::vector<std::array<std::uint32_t, 3>> faces;  ///< indices of vertices
};

/// A rigid thing.
struct SynthObject {
    SynthObjectKind kind = SynthObjectKind::Cart;
    int label = 0;           ///< in the masks, from 101 on; 0: a screen
    SynthTriangles surface;  ///< in its own frame
};

struct SynthFrame {
    double stamp = 0, depth_stamp = 0;  ///< of colour and depth, seconds
    ColorImage color;                   ///< sRGB
    DepthImage depth;                   ///< metres, registered to colour, 0 = no value
    LabelImage labels;                  ///< true labels of the colour image at the pixel centres: people, objects
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< exact, at `stamp`
    Eigen::Vector3f gain = Eigen::Vector3f::Ones();  ///< of linear light by the exposure, RGB; 1 = fixed
    std::vector<SynthPerson> people;
    std::vector<Eigen::Isometry3d> T_world_object;  ///< of SynthWorld::objects(), at `stamp`
};

/// The events of a scenario, in frames.
struct SynthEvents {
    std::vector<int> covered;         ///< something covers (part of) the lens
    std::optional<int> revisit_from;  ///< from here on the camera is back at a place where it has been before
};

/// One world, from which any frame can be rendered. The same configuration gives the same pixels.
/// Throws Error if a value is out of range, or two do not go together.
void check(const SynthConfig& config);

class SynthWorld {
public:
    /// Throws Error when a value of the configuration is out of its range.
    explicit SynthWorld(const SynthConfig& config);
    ~SynthWorld();
    SynthWorld(SynthWorld&&) noexcept;
    SynthWorld& operator=(SynthWorld&&) noexcept;

    [[nodiscard]] const SynthConfig& config() const;
    [[nodiscard]] const Intrinsics& camera() const;  ///< as it is, without its lens: sensor()
    [[nodiscard]] const synth::SensorUnit& sensor() const;
    [[nodiscard]] double stamp(int frame) const;                   ///< seconds
    [[nodiscard]] Eigen::Isometry3d camera_pose(int frame) const;  ///< T_world_camera
    [[nodiscard]] const SynthEvents& events() const;
    [[nodiscard]] SynthTriangles room() const;  ///< what never moves, but for a screen's panel; world
    [[nodiscard]] const std::vector<SynthObject>& objects() const;  ///< none but in the scenario Movers
    [[nodiscard]] Eigen::Isometry3d object_pose(std::size_t index, int frame) const;  ///< T_world_object
    /// Floor positions (x, y) of everybody at a frame, in the order of their labels; metres.
    [[nodiscard]] std::vector<Eigen::Vector2d> people_on_floor(int frame) const;
    /// Distance from a point of the world to the nearest piece of furniture or wall, metres; 0 inside one.
    [[nodiscard]] double clearance(const Eigen::Vector3d& point) const;

    [[nodiscard]] SynthFrame render(int frame) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// Called after every frame; return false to stop early (what is written until then is a valid sequence).
using SynthProgress = std::function<bool(int frames_done, int frames_total)>;

/// Renders the sequence and writes it to `config.out` in the layout of the TUM RGB-D benchmark: rgb/<stamp>.jpg,
/// depth/<stamp>.png (16 bit, 5000 per metre), masks/<stamp>.png, rgb.txt, depth.txt, masks.txt, associations.txt,
/// groundtruth.txt, joints.json, camera.yaml, info.json, surface.ply (the room), events.json (SynthEvents and
/// their stamps). Objects add objects/<label>/groundtruth.txt (T_world_object, TUM format) and
/// objects/<label>/mesh.ply, of a screen objects/screen. A sensor other than clean adds camera_true.yaml, and what it
/// truly does to info.json. The recording is readable however this ends: the lists grow with the images.
/// @return the number of frames made. Throws Error: the folder holds a recording already, or something cannot be
/// written (any further: the frames before are kept).
int synthesize(const SynthConfig& config, const SynthProgress& progress = {});

}  // namespace posefusion
