#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/synth/camera_path.hpp"
#include "hosts/synth/choreography.hpp"
#include "hosts/synth/color_camera.hpp"
#include "hosts/synth/cover.hpp"
#include "hosts/synth/depth_sensor.hpp"
#include "hosts/synth/exposure_course.hpp"
#include "hosts/synth/lane_path.hpp"
#include "hosts/synth/mover_staging.hpp"
#include "hosts/synth/parallel.hpp"
#include "hosts/synth/person_motion.hpp"
#include "hosts/synth/scenario.hpp"
#include "hosts/synth/scene.hpp"
#include "hosts/synth/synth.hpp"

namespace posefusion {
namespace synth {
namespace {

constexpr double kFirstStamp = 1000;      ///< seconds
constexpr float kFocalPerWidth = 0.835f;  ///< of the cameras of the TUM benchmark (fx 535 at 640 pixels)
constexpr float kInsideBody =
    0.16f;  ///< a joint counts as seen if the own surface is at most this far in front of it, metres
/// While a frame is taken, people move evenly for this long at most: they are less than a millimetre from their path.
constexpr double kEvenMotion = 0.015;          ///< seconds
constexpr int kRowSteps = 2;                   ///< to find the row in which a joint is seen
constexpr double kLongestExposure = 1.0 / 30;  ///< seconds

/// Where something must be to be well in view: metres before the camera, share of the image from its border.
constexpr float kNearestMover = 1.1f, kFarthestMover = 4.2f, kMoverMargin = 0.08f;

constexpr double kRevisitDistance = 0.4;  ///< to the place of the first frame, metres
constexpr double kRevisitAngle = 0.35;    ///< to the view of the first frame, rad

void check(bool good, const std::string& what) {
    if (!good) throw Error("synth: " + what);
}

}  // namespace
}  // namespace synth

void check(const SynthConfig& c) {
    using synth::check;
    check(c.frames >= 1, "the number of frames must be at least 1, it is " + std::to_string(c.frames));
    check(
        c.people >= 0 && c.people <= kMaxSynthPeople,
        "the number of people must be 0 to " + std::to_string(kMaxSynthPeople) + ", it is " + std::to_string(c.people));
    check(c.width >= 16 && c.height >= 16 && c.width <= 4096 && c.height <= 4096,
          "the image size must be 16 to 4096 pixels a side, it is " + std::to_string(c.width) + "x" +
              std::to_string(c.height));
    check(c.fps > 0 && c.fps <= 1000,
          "the frame rate must be above 0 and at most 1000 per second, it is " + shortest_text(c.fps));
    check(c.camera_speed >= 0, "the camera speed must not be negative, it is " + shortest_text(c.camera_speed));
    check(!c.still_camera || !has_walk(c.scenario),
          std::string("in the scenario ") + scenario_name(c.scenario) + " the camera walks, it cannot stand still");
    check(c.threads >= 0, "the number of threads must not be negative, it is " + std::to_string(c.threads));
}

namespace synth {
namespace {

Intrinsics intrinsics(const SynthConfig& c) {
    const float focal = kFocalPerWidth * static_cast<float>(c.width);
    return {focal,   focal,   0.5f * static_cast<float>(c.width - 1), 0.5f * static_cast<float>(c.height - 1),
            c.width, c.height};
}

std::vector<Body> make_bodies(const SynthConfig& c) {
    Rng rng(hash(c.seed, 20));
    const bool woman_first = rng.chance(0.5f);
    std::vector<Body> bodies(static_cast<std::size_t>(c.people));
    std::vector<BodyLook> looks;
    for (int i = 0; i < c.people; ++i) looks.emplace_back(rng.seed(), (i % 2 == 0) == woman_first);
    parallel_for(c.people, c.threads,
                 [&](int i) { bodies[static_cast<std::size_t>(i)] = make_body(looks[static_cast<std::size_t>(i)]); });
    return bodies;
}

using Path = std::function<Eigen::Isometry3d(double)>;

Path make_path(const SynthConfig& c, const Room& room, const std::optional<Itinerary>& itinerary) {
    const std::uint64_t seed = hash(c.seed, 11);
    if (itinerary) return [path = LanePath(room, *itinerary, seed, c.camera_speed)](double t) { return path.at(t); };
    return [path = CameraPath(room, seed, c.still_camera ? 0.0 : c.camera_speed)](double t) { return path.at(t); };
}

/// A span of time, seconds.
struct Span {
    double from = 0, to = 0;
    void include(double t) { from = std::min(from, t), to = std::max(to, t); }
    [[nodiscard]] double at(double share) const { return from + share * (to - from); }
    [[nodiscard]] float share(double t) const {
        return to > from ? static_cast<float>(std::clamp((t - from) / (to - from), 0.0, 1.0)) : 0.0f;
    }
};

SynthEvents find_events(const SynthConfig& c, const Path& path, const std::optional<Itinerary>& itinerary) {
    SynthEvents events;
    if (!itinerary) return events;
    for (int i = 0; i < c.frames; ++i)
        if (itinerary->cover(i / c.fps) > 0) events.covered.push_back(i);
    if (!events.covered.empty()) {
        if (events.covered.back() + 1 < c.frames) events.revisit_from = events.covered.back() + 1;
        return events;
    }
    const Eigen::Isometry3d start = path(0);
    bool away = false;
    for (int i = 0; i < c.frames && !events.revisit_from; ++i) {
        const Eigen::Isometry3d moved = start.inverse() * path(i / c.fps);
        const bool far = moved.translation().norm() > kRevisitDistance;
        away = away || moved.translation().norm() > 2 * kRevisitDistance;
        if (away && !far && Eigen::AngleAxisd(moved.linear()).angle() < kRevisitAngle) events.revisit_from = i;
    }
    return events;
}

float angle_between(const Vector2f& a, const Vector2f& b) {
    return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

}  // namespace
}  // namespace synth

using namespace synth;

struct SynthWorld::Impl {
    explicit Impl(const SynthConfig& c)
        : config((check(c), c)),
          sensor(c.sensor, intrinsics(c), kSynthDepthScale, hash(c.seed, 16)),
          scene(hash(c.seed, 10), room_kind(c.scenario), !c.easy, c.threads),
          bodies(make_bodies(c)) {
        if (c.noise) exposure = exposure_of(c);
        const double length = c.frames / c.fps, duration = length + 1;
        if (has_walk(c.scenario)) itinerary = make_itinerary(c.scenario, length, hash(c.seed, 14));
        path = make_path(c, scene.room(), itinerary);
        events = find_events(c, path, itinerary);
        std::vector<Proportions> sizes;
        for (const Body& body : bodies) sizes.push_back(body.proportions);
        stage(sizes, length, duration);
        course.emplace(c.sensor.exposure, metered(), c.fps, hash(c.seed, 17));
    }

    /// Decides what everybody and everything does.
    void stage(const std::vector<Proportions>& sizes, double length, double duration);
    [[nodiscard]] bool in_view(const Vector3f& point, double t) const;
    [[nodiscard]] double time(int frame) const { return frame / config.fps; }
    [[nodiscard]] CrowdPose crowd_at(double t) const {
        CrowdPose all;
        for (std::size_t i = 0; i < bodies.size(); ++i)
            all.people.push_back(solve_pose(bodies[i].proportions, motions[i].at(t)));
        for (const Mover& mover : movers) all.movers.push_back(mover.at(t));
        return all;
    }
    /// The time of exposure of a frame, seconds.
    [[nodiscard]] double exposure_time(int frame) const {
        if (!exposure) return 0;
        return std::min(exposure->seconds * static_cast<double>(course->gain(frame)), kLongestExposure);
    }
    /// When a sample of the colour of a row is taken, seconds after the stamp.
    [[nodiscard]] double sample_time(int frame, int row, int sample) const {
        return sensor.color_time(row) + ((sample + 0.5) / kColorSamples - 0.5) * exposure_time(frame);
    }
    /// While the pixels of a frame are taken, seconds after its stamp. People stand still where that is one instant.
    [[nodiscard]] Span span_of(int frame) const {
        Span span;
        if (config.sensor.instantaneous()) return span;
        for (const int row : {0, config.height - 1}) {
            span.include(sample_time(frame, row, 0));
            span.include(sample_time(frame, row, kColorSamples - 1));
            span.include(sensor.depth_time(row, time(frame)));
        }
        return span;
    }
    [[nodiscard]] std::vector<CrowdPose> crowd_during(const Span& span, int frame) const {
        const int intervals = static_cast<int>(std::ceil((span.to - span.from) / kEvenMotion));
        std::vector<CrowdPose> all;
        for (int k = 0; k <= intervals; ++k)
            all.push_back(crowd_at(time(frame) + span.at(intervals > 0 ? k / static_cast<double>(intervals) : 0)));
        return all;
    }
    /// @param row_time  seconds after the frame's stamp
    template <class RowTime>
    [[nodiscard]] RollingView view(int frame, const Span& span, const RowTime& row_time) const {
        RollingView rows;
        for (int v = 0; v < config.height; ++v) {
            const double t = row_time(v);
            if (v > 0 && t == row_time(v - 1))
                rows.push_back(rows.back());
            else
                rows.push_back({path(time(frame) + t).cast<float>(), span.share(t)});
        }
        return rows;
    }
    [[nodiscard]] std::vector<float> metered() const {
        if (config.sensor.exposure.follow == 0) return {};
        std::vector<float> brightness(static_cast<std::size_t>(config.frames));
        parallel_for(config.frames, config.threads, [&](int frame) {
            const Crowd crowd(scene.device(), bodies, movers, {crowd_at(time(frame))});
            brightness[static_cast<std::size_t>(frame)] =
                metered_brightness(scene, crowd, sensor, path(time(frame)).cast<float>());
        });
        return brightness;
    }
    [[nodiscard]] Cover cover(int frame) const {
        return {itinerary ? itinerary->cover(time(frame)) : 0.0, hash(config.seed, 15)};
    }
    [[nodiscard]] SynthPerson observe(std::size_t index, int frame, const Crowd& crowd, const Span& span,
                                      const ExactView& exact, const RollingView& view) const;

    SynthConfig config;
    SensorUnit sensor;
    Scene scene;
    std::vector<Body> bodies;
    std::vector<PersonMotion> motions;
    std::vector<Mover> movers;
    std::vector<SynthObject> objects;    ///< the movers, as others see them
    std::optional<Itinerary> itinerary;  ///< of scenarios with a walk
    Path path;
    std::optional<Exposure> exposure;  ///< none without noise
    std::optional<ExposureCourse> course;
    SynthEvents events;
};

bool SynthWorld::Impl::in_view(const Vector3f& point, double t) const {
    const Vector3f p = path(t).cast<float>().inverse() * point;
    if (p.z() < kNearestMover || p.z() > kFarthestMover) return false;
    const Vector2f at = sensor.project(p);
    const auto inside = [](float x, int size) {
        const auto length = static_cast<float>(size);
        return x > kMoverMargin * length && x < (1 - kMoverMargin) * length;
    };
    return inside(at.x(), config.width) && inside(at.y(), config.height);
}

void SynthWorld::Impl::stage(const std::vector<Proportions>& sizes, double length, double duration) {
    const Room& room = scene.room();
    const FloorPlan floor(room);
    const InView seen = [&](const Vector3f& point, double t) { return in_view(point, t); };
    std::optional<MoverCast> cast;
    std::optional<ChairPull> pull;
    std::vector<MotionPlan> made, avoid;
    if (config.scenario == SynthScenario::Movers) cast.emplace(hash(config.seed, 18), config.people);
    if (cast && cast->chair) pull = plan_chair_pull(floor, room, sizes.front(), seen, length, hash(config.seed, 19));
    if (pull) made.push_back(pull->person), avoid.push_back(chair_place(*pull, sizes.front()));
    std::vector<MotionPlan> plans = choreograph(room, floor, make_acts(config.scenario, room, length), sizes, duration,
                                                hash(config.seed, 12), made, avoid);
    for (std::size_t i = 0; i < bodies.size(); ++i)
        motions.emplace_back(sizes[i], plans[i], duration, hash(config.seed, 13, i));
    if (!cast) return;
    std::optional<std::size_t> carrier;
    if (cast->box) carrier = find_carrier(room, motions, pull ? 1 : 0, length);  // who pulls has no hand free
    if (carrier) {
        plans[*carrier].carry();
        motions[*carrier] = PersonMotion(sizes[*carrier], plans[*carrier], duration, hash(config.seed, 13, *carrier));
    }
    movers = stage_movers(*cast, room, floor, plans, motions, pull, carrier, seen, length, hash(config.seed, 21));
    for (const Mover& mover : movers) {
        SynthObject object{mover.kind, mover.label, {{}, mover.mesh.triangles}};
        for (const RoomVertex& v : mover.mesh.vertices) object.surface.vertices.push_back(v.position);
        objects.push_back(std::move(object));
    }
}

SynthPerson SynthWorld::Impl::observe(std::size_t index, int frame, const Crowd& crowd, const Span& span,
                                      const ExactView& exact, const RollingView& view) const {
    const Proportions& body = bodies[index].proportions;
    const auto bones_at = [&](double t) { return solve_pose(body, motions[index].at(time(frame) + t)); };
    SynthPerson person;
    person.id = static_cast<int>(index) + 1;
    person.pixels =
        static_cast<int>(std::count(exact.labels.begin(), exact.labels.end(), static_cast<std::uint8_t>(person.id)));
    person.sitting = motions[index].sitting(time(frame));
    const BoneTransforms bones = bones_at(0);
    const Isometry3f T_world_camera = path(time(frame)).cast<float>();
    const Vector2f ahead = bones[Chest].linear().col(0).head<2>();
    person.facing = angle_between(ahead, T_world_camera.translation().head<2>() - bones[Chest].translation().head<2>());
    for (std::size_t j = 0; j < kJointCount; ++j) {
        SynthJoint& joint = person.joints[j];
        // A joint is seen in some row, and is where it is while that row is read.
        RowView row{T_world_camera, span.share(0)};
        Vector3f in_world = body_joints(body, bones)[j];
        Vector3f p = T_world_camera.inverse() * in_world;
        for (int step = 0; step < kRowSteps && p.z() > 0 && !config.sensor.instantaneous(); ++step) {
            const int v = std::clamp(static_cast<int>(std::lround(sensor.project(p).y())), 0, config.height - 1);
            row = view[static_cast<std::size_t>(v)];
            in_world = body_joints(body, bones_at(sensor.color_time(v)))[j];
            p = row.T_world_camera.inverse() * in_world;
        }
        joint.z = p.z();
        if (p.z() <= 0) continue;
        const Vector2f at = sensor.project(p);
        joint.u = at.x(), joint.v = at.y();
        const int u = static_cast<int>(std::lround(joint.u)), v = static_cast<int>(std::lround(joint.v));
        if (!exact.labels.contains(u, v) || exact.labels(u, v) != person.id) continue;
        const Vector3f origin = row.T_world_camera.translation();
        const SceneHit seen = scene.trace(Moment(crowd, row.moment), origin, in_world - origin);
        if (seen.part != static_cast<int>(index)) continue;
        const float in_front = (1 - seen.hit.t) * (in_world - origin).norm();
        joint.visibility = in_front < kInsideBody ? JointVisibility::Visible : JointVisibility::BehindOwnBody;
    }
    return person;
}

SynthWorld::SynthWorld(const SynthConfig& config) : impl_(std::make_unique<Impl>(config)) {}
SynthWorld::~SynthWorld() = default;
SynthWorld::SynthWorld(SynthWorld&&) noexcept = default;
SynthWorld& SynthWorld::operator=(SynthWorld&&) noexcept = default;

const SynthConfig& SynthWorld::config() const { return impl_->config; }
const Intrinsics& SynthWorld::camera() const { return impl_->sensor.camera().intrinsics; }
const SensorUnit& SynthWorld::sensor() const { return impl_->sensor; }
double SynthWorld::stamp(int frame) const { return kFirstStamp + impl_->time(frame); }
Eigen::Isometry3d SynthWorld::camera_pose(int frame) const { return impl_->path(impl_->time(frame)); }

const SynthEvents& SynthWorld::events() const { return impl_->events; }

SynthTriangles SynthWorld::room() const {
    const RoomMesh& mesh = impl_->scene.room().mesh;
    SynthTriangles triangles;
    for (const RoomVertex& vertex : mesh.vertices) triangles.vertices.push_back(vertex.position);
    triangles.faces = mesh.triangles;
    return triangles;
}

const std::vector<SynthObject>& SynthWorld::objects() const { return impl_->objects; }

Eigen::Isometry3d SynthWorld::object_pose(std::size_t index, int frame) const {
    return impl_->movers.at(index).at(impl_->time(frame)).T_world_object.cast<double>();
}

std::vector<Eigen::Vector2d> SynthWorld::people_on_floor(int frame) const {
    std::vector<Eigen::Vector2d> all;
    for (const PersonMotion& motion : impl_->motions)
        all.emplace_back(motion.at(impl_->time(frame)).pelvis.head<2>().cast<double>());
    return all;
}

double SynthWorld::clearance(const Eigen::Vector3d& point) const {
    return impl_->scene.room().clearance(point.cast<float>());
}

SynthFrame SynthWorld::render(int frame) const {
    const Impl& world = *impl_;
    const int threads = world.config.threads;
    const std::uint64_t seed = hash(world.config.seed, 30, static_cast<std::uint64_t>(frame));
    const Span span = world.span_of(frame);
    const Crowd crowd(world.scene.device(), world.bodies, world.movers, world.crowd_during(span, frame));
    const auto view_at = [&](const auto& row_time) { return world.view(frame, span, row_time); };
    SynthFrame out;
    out.stamp = stamp(frame);
    out.depth_stamp = out.stamp + world.sensor.stamped_delay(world.time(frame));
    out.T_world_camera = camera_pose(frame);
    out.gain = world.course->channels(frame);
    for (std::size_t i = 0; i < world.movers.size(); ++i) out.T_world_object.push_back(object_pose(i, frame));

    std::vector<RollingView> samples;
    for (int s = 0; s < kColorSamples; ++s)
        samples.push_back(view_at([&](int row) { return world.sample_time(frame, row, s); }));
    out.color = photograph(world.scene, crowd, world.sensor, samples, out.gain, world.exposure, hash(seed, 1), threads);

    const RollingView color_view = view_at([&](int row) { return world.sensor.color_time(row); });
    ExactView seen = look_exactly(world.scene, crowd, world.sensor, color_view, threads);
    RollingView depth_view = color_view;
    if (!world.config.sensor.instantaneous()) {
        depth_view = view_at([&](int row) { return world.sensor.depth_time(row, world.time(frame)); });
        seen.depth = look_exactly(world.scene, crowd, world.sensor, depth_view, threads).depth;
    }
    if (world.config.noise)
        out.depth =
            measure_depth(world.sensor, seen, out.color, world.scene, crowd, depth_view, hash(seed, 2), threads);
    if (const Cover cover = world.cover(frame); !cover.empty()) {
        cover.hide(seen);
        cover.darken(out.color);
        if (world.config.noise) cover.disturb(out.depth, world.config.sensor.depth, hash(seed, 3));
    }
    for (std::size_t i = 0; i < world.bodies.size(); ++i)
        out.people.push_back(world.observe(i, frame, crowd, span, seen, color_view));
    if (!world.config.noise) {
        out.depth = std::move(seen.depth);
        distort_depth(world.sensor, out.depth);
    }
    out.labels = std::move(seen.labels);
    return out;
}

}  // namespace posefusion
