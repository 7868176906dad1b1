#include "hosts/synth/scene.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr float kFar = 100.0f;  ///< metres: farther than any wall
const Vector3f kLampColor(1.03f, 1.0f, 0.93f);
const Vector3f kAmbientColor(0.98f, 1.0f, 1.04f);
constexpr float kShadowStart = 0.006f;  ///< metres off the surface

std::vector<std::vector<Vector3f>> positions(const RoomMesh& mesh) {
    std::vector<Vector3f> out;
    out.reserve(mesh.vertices.size());
    for (const RoomVertex& v : mesh.vertices) out.push_back(v.position);
    return {std::move(out)};
}

/// A point of the lamp panel for one sample: four strata by the lowest bits, jittered by the others.
Vector3f lamp_point(const Lamp& lamp, std::uint64_t sample, std::size_t index) {
    const std::uint64_t h = hash(sample, index);
    const float a = static_cast<float>(sample & 1) + to_uniform(h) - 1,
                b = static_cast<float>((sample >> 1) & 1) + to_uniform(mix(h)) - 1;
    return lamp.center + Vector3f(a * lamp.half.x(), b * lamp.half.y(), 0);
}

/// Ambient light left beside balls (Quilez, sphere occlusion).
float ambient_beside(const Moment& now, const Vector3f& point, const Vector3f& normal) {
    float open = 1;
    for (std::size_t i = 0; i < now.crowd.shade_count(); ++i) {
        const Shade s = now.shade(i);
        const Vector3f to = s.center - point;
        const float squared = to.squaredNorm(), near = s.radius * s.radius;
        if (squared > 60 * near) continue;
        const float share =
            std::min(near / squared, 1.0f) * std::max(normal.dot(to) / std::sqrt(squared) * 0.8f + 0.2f, 0.0f);
        open *= 1 - 0.75f * share;
    }
    return open;
}

}  // namespace

Crowd::Crowd(const RayDevice& device, const std::vector<Body>& bodies, const std::vector<Mover>& movers,
             const std::vector<CrowdPose>& poses)
    : bodies_(bodies),
      movers_(movers),
      positions_(poses.size()),
      normals_(poses.size()),
      shades_(poses.size()),
      pictures_(poses.size()) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        add(i, bodies[i].triangles);
        for (std::size_t k = 0; k < poses.size(); ++k) {
            const BoneTransforms& bones = poses[k].people[i];
            const PosedBody posed = pose_body(bodies[i], bones);
            positions_[k].insert(positions_[k].end(), posed.positions.begin(), posed.positions.end());
            normals_[k].insert(normals_[k].end(), posed.normals.begin(), posed.normals.end());
            const auto shade = [&](int bone, float radius) {
                shades_[k].push_back({bones[static_cast<std::size_t>(bone)].translation(), radius});
            };
            for (const int bone : {ToeL, ToeR}) shade(bone, 0.075f);
            for (const int bone : {FootL, FootR}) shade(bone, 0.085f);
            for (const int bone : {ShinL, ShinR}) shade(bone, 0.11f);
            for (const int bone : {Pelvis, Chest}) shade(bone, 0.17f);
        }
    }
    for (std::size_t i = 0; i < movers.size(); ++i) {
        add(bodies.size() + i, movers[i].mesh.triangles);
        for (std::size_t k = 0; k < poses.size(); ++k) {
            const MoverPose& pose = poses[k].movers[i];
            for (const RoomVertex& v : movers[i].mesh.vertices) {
                positions_[k].push_back(pose.T_world_object * v.position);
                normals_[k].push_back(pose.T_world_object.linear() * v.normal);
            }
            for (const Shade& shade : movers[i].shades)
                shades_[k].push_back({pose.T_world_object * shade.center, shade.radius});
            pictures_[k].push_back(pose.picture);
        }
    }
    rays_ = std::make_unique<RayScene>(device, positions_, triangles_, RayScene::Quality::Fast);
}

void Crowd::add(std::size_t part, const std::vector<Triangle>& triangles) {
    const auto first = static_cast<std::uint32_t>(positions_.front().size());
    first_triangle_.push_back(static_cast<std::uint32_t>(triangles_.size()));
    for (const Triangle& t : triangles) triangles_.push_back({first + t[0], first + t[1], first + t[2]});
    part_.resize(triangles_.size(), static_cast<std::uint8_t>(part));
}

Moment::Moment(const Crowd& people, float at) : crowd(people), time(at) {
    const std::size_t intervals = crowd.positions_.size() - 1;
    if (intervals == 0) return;
    const float place = at * static_cast<float>(intervals);
    before_ = std::min(static_cast<std::size_t>(place), intervals - 1);
    share_ = place - static_cast<float>(before_);
}

Vector3f Moment::position(std::uint32_t vertex) const {
    const Vector3f& before = crowd.positions_[before_][vertex];
    if (share_ == 0) return before;
    return before + share_ * (crowd.positions_[before_ + 1][vertex] - before);
}

Vector3f Moment::normal(std::uint32_t vertex) const {
    const Vector3f& before = crowd.normals_[before_][vertex];
    if (share_ == 0) return before;
    return before + share_ * (crowd.normals_[before_ + 1][vertex] - before);
}

Shade Moment::shade(std::size_t index) const {
    const Shade& before = crowd.shades_[before_][index];
    if (share_ == 0) return before;
    return {before.center + share_ * (crowd.shades_[before_ + 1][index].center - before.center), before.radius};
}

/// A film shows one picture at a time.
Vector2f Moment::picture(std::size_t mover) const { return crowd.pictures_[before_][mover]; }

Scene::Scene(std::uint64_t seed, RoomKind kind, bool fresh_paint, int threads)
    : room_(hash(seed, 1), kind, fresh_paint),
      textures_(paint_textures(hash(seed, 2), threads)),
      rays_(device_, positions(room_.mesh), room_.mesh.triangles, RayScene::Quality::Best),
      light_(bake_light(room_, rays_, hash(seed, 3), threads)) {}

SceneHit Scene::trace(const Moment& now, const Vector3f& origin, const Vector3f& direction) const {
    SceneHit found;
    found.hit.t = kFar;
    found.any = rays_.intersect(origin, direction, 0.0f, found.hit);
    if (now.crowd.rays().intersect(origin, direction, 0.0f, found.hit, now.time)) {
        found.any = true;
        found.part = now.crowd.part_of(found.hit.triangle);
    }
    return found;
}

bool Scene::occluded(const Moment& now, const Vector3f& origin, const Vector3f& direction, float t_min,
                     float t_max) const {
    return now.crowd.rays().occluded(origin, direction, t_min, t_max, now.time) ||
           rays_.occluded(origin, direction, t_min, t_max);
}

Vector3f Scene::face_normal(const Moment& now, const SceneHit& found, const Vector3f& direction) const {
    Vector3f a, b, c;
    if (found.part >= 0) {
        const Triangle& t = now.crowd.triangles_[found.hit.triangle];
        a = now.position(t[0]), b = now.position(t[1]), c = now.position(t[2]);
    } else {
        const Triangle& t = room_.mesh.triangles[found.hit.triangle];
        a = room_.mesh.vertices[t[0]].position, b = room_.mesh.vertices[t[1]].position,
        c = room_.mesh.vertices[t[2]].position;
    }
    const Vector3f normal = (b - a).cross(c - a).normalized();
    return normal.dot(direction) > 0 ? Vector3f(-normal) : normal;
}

Vector3f Scene::radiance(const Moment& now, const SceneHit& found, const Vector3f& origin, const Vector3f& direction,
                         float footprint, std::uint64_t sample) const {
    if (!found.any) return Vector3f::Zero();
    const Vector3f point = origin + found.hit.t * direction;
    if (found.part >= now.crowd.people()) return mover_radiance(now, found, point, direction, footprint, sample);
    if (found.part >= 0) return body_radiance(now, found, point, sample);
    return room_radiance(now, found.hit, point, direction, footprint, sample);
}

Vector3f Scene::room_radiance(const Moment& now, const Hit& hit, const Vector3f& point, const Vector3f& direction,
                              float footprint, std::uint64_t sample) const {
    const Triangle& t = room_.mesh.triangles[hit.triangle];
    const RoomVertex &a = room_.mesh.vertices[t[0]], &b = room_.mesh.vertices[t[1]], &c = room_.mesh.vertices[t[2]];
    const BakedLight &la = light_[t[0]], &lb = light_[t[1]], &lc = light_[t[2]];
    const float wa = 1 - hit.u - hit.v, wb = hit.u, wc = hit.v;
    const Vector3f normal = wa * a.normal + wb * b.normal + wc * c.normal;
    const float slant = std::max(std::abs(normal.dot(direction)) / direction.norm(), 0.3f);
    const Texture& texture = textures_[room_.mesh.material[hit.triangle]];
    const Vector3f color =
        a.tint.cwiseProduct(texture.sample(wa * a.uv + wb * b.uv + wc * c.uv, footprint * hit.t / slant));
    if (texture.emits()) return color;
    float ambient = wa * la.ambient + wb * lb.ambient + wc * lc.ambient;
    if (!now.crowd.empty()) ambient *= ambient_beside(now, point, normal);
    Vector3f light = ambient * kAmbientColor;
    for (std::size_t l = 0; l < room_.lamps.size(); ++l) {
        const float lamp = wa * la.lamps[l] + wb * lb.lamps[l] + wc * lc.lamps[l];
        if (lamp < 0.01f) continue;
        if (!now.crowd.empty() &&
            now.crowd.rays().occluded(point + kShadowStart * normal, lamp_point(room_.lamps[l], sample, l) - point,
                                      0.0f, 1.0f, now.time))
            continue;
        light += lamp * kLampColor;
    }
    return color.cwiseProduct(light);
}

Vector3f Scene::body_radiance(const Moment& now, const SceneHit& found, const Vector3f& point,
                              std::uint64_t sample) const {
    const auto person = static_cast<std::size_t>(found.part);
    const Crowd& crowd = now.crowd;
    const Body& body = crowd.bodies_[person];
    const std::uint32_t triangle = found.hit.triangle - crowd.first_triangle_[person];
    const Triangle& local = body.triangles[triangle];
    const Triangle& world = crowd.triangles_[found.hit.triangle];
    const float wa = 1 - found.hit.u - found.hit.v, wb = found.hit.u, wc = found.hit.v;
    const BodyVertex &a = body.vertices[local[0]], &b = body.vertices[local[1]], &c = body.vertices[local[2]];
    const Vector3f normal =
        (wa * now.normal(world[0]) + wb * now.normal(world[1]) + wc * now.normal(world[2])).normalized();
    const Vector3f albedo = body_albedo(body.look, body.proportions.head_height, body.layers[triangle],
                                        wa * a.rest + wb * b.rest + wc * c.rest);
    const float openness = wa * a.openness + wb * b.openness + wc * c.openness;
    return albedo.cwiseProduct(light_at(now, point, normal, openness, sample));
}

Vector3f Scene::mover_radiance(const Moment& now, const SceneHit& found, const Vector3f& point,
                               const Vector3f& direction, float footprint, std::uint64_t sample) const {
    constexpr float kOpenness = 0.9f;
    const Crowd& crowd = now.crowd;
    const auto index = static_cast<std::size_t>(found.part - crowd.people());
    const RoomMesh& mesh = crowd.movers_[index].mesh;
    const std::uint32_t triangle = found.hit.triangle - crowd.first_triangle_[static_cast<std::size_t>(found.part)];
    const Triangle& local = mesh.triangles[triangle];
    const Triangle& world = crowd.triangles_[found.hit.triangle];
    const float wa = 1 - found.hit.u - found.hit.v, wb = found.hit.u, wc = found.hit.v;
    const RoomVertex &a = mesh.vertices[local[0]], &b = mesh.vertices[local[1]], &c = mesh.vertices[local[2]];
    const Vector3f normal =
        (wa * now.normal(world[0]) + wb * now.normal(world[1]) + wc * now.normal(world[2])).normalized();
    const float slant = std::max(std::abs(normal.dot(direction)) / direction.norm(), 0.3f);
    const Texture& texture = textures_[mesh.material[triangle]];
    const Vector2f uv = wa * a.uv + wb * b.uv + wc * c.uv + now.picture(index);
    const Vector3f color = a.tint.cwiseProduct(texture.sample(uv, footprint * found.hit.t / slant));
    return texture.emits() ? color : Vector3f(color.cwiseProduct(light_at(now, point, normal, kOpenness, sample)));
}

Vector3f Scene::light_at(const Moment& now, const Vector3f& point, const Vector3f& normal, float openness,
                         std::uint64_t sample) const {
    Vector3f light = ambient_light(normal) * openness * kAmbientColor;
    for (std::size_t l = 0; l < room_.lamps.size(); ++l) {
        const float lamp = lamp_irradiance(room_.lamps[l], point, normal) * (0.35f + 0.55f * openness);
        if (lamp < 0.01f) continue;
        const Vector3f from = point + kShadowStart * normal;
        if (!occluded(now, from, lamp_point(room_.lamps[l], sample, l) - from, 0.0f, 0.99f)) light += lamp * kLampColor;
    }
    return light;
}

}  // namespace posefusion::synth
