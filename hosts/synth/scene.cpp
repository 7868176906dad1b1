#include "hosts/synth/scene.hpp"

#include <cmath>

#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr float kFar = 100.0f;  ///< metres: farther than any wall
const Vector3f kLampColor(1.03f, 1.0f, 0.93f);
const Vector3f kAmbientColor(0.98f, 1.0f, 1.04f);
constexpr float kShadowStart = 0.006f;  ///< metres off the surface

std::vector<Vector3f> positions(const RoomMesh& mesh) {
    std::vector<Vector3f> out;
    out.reserve(mesh.vertices.size());
    for (const RoomVertex& v : mesh.vertices) out.push_back(v.position);
    return out;
}

/// A point of the lamp panel for one sample: four strata by the lowest bits, jittered by the others.
Vector3f lamp_point(const Lamp& lamp, std::uint64_t sample, std::size_t index) {
    const std::uint64_t h = hash(sample, index);
    const float a = static_cast<float>(sample & 1) + to_uniform(h) - 1,
                b = static_cast<float>((sample >> 1) & 1) + to_uniform(mix(h)) - 1;
    return lamp.center + Vector3f(a * lamp.half.x(), b * lamp.half.y(), 0);
}

/// Ambient light left beside balls (Quilez, sphere occlusion).
float ambient_beside(const std::vector<Crowd::Shade>& shades, const Vector3f& point, const Vector3f& normal) {
    float open = 1;
    for (const Crowd::Shade& s : shades) {
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

Crowd::Crowd(const RayDevice& device, const std::vector<Body>& bodies, const std::vector<BoneTransforms>& poses)
    : bodies_(bodies) {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const PosedBody posed = pose_body(bodies[i], poses[i]);
        const auto first = static_cast<std::uint32_t>(positions_.size());
        first_vertex_.push_back(first);
        first_triangle_.push_back(static_cast<std::uint32_t>(triangles_.size()));
        positions_.insert(positions_.end(), posed.positions.begin(), posed.positions.end());
        normals_.insert(normals_.end(), posed.normals.begin(), posed.normals.end());
        for (const Triangle& t : bodies[i].triangles) triangles_.push_back({first + t[0], first + t[1], first + t[2]});
        person_.resize(triangles_.size(), static_cast<std::uint8_t>(i));
        for (const int bone : {ToeL, ToeR})
            shades_.push_back({poses[i][static_cast<std::size_t>(bone)].translation(), 0.075f});
        for (const int bone : {FootL, FootR})
            shades_.push_back({poses[i][static_cast<std::size_t>(bone)].translation(), 0.085f});
        for (const int bone : {ShinL, ShinR})
            shades_.push_back({poses[i][static_cast<std::size_t>(bone)].translation(), 0.11f});
        for (const int bone : {Pelvis, Chest})
            shades_.push_back({poses[i][static_cast<std::size_t>(bone)].translation(), 0.17f});
    }
    rays_ = std::make_unique<RayScene>(device, positions_, triangles_, RayScene::Quality::Fast);
}

Scene::Scene(std::uint64_t seed, RoomKind kind, bool fresh_paint, int threads)
    : room_(hash(seed, 1), kind, fresh_paint),
      textures_(paint_textures(hash(seed, 2), threads)),
      rays_(device_, positions(room_.mesh), room_.mesh.triangles, RayScene::Quality::Best),
      light_(bake_light(room_, rays_, hash(seed, 3), threads)) {}

SceneHit Scene::trace(const Crowd& crowd, const Vector3f& origin, const Vector3f& direction) const {
    SceneHit found;
    found.hit.t = kFar;
    found.any = rays_.intersect(origin, direction, 0.0f, found.hit);
    if (crowd.rays().intersect(origin, direction, 0.0f, found.hit)) {
        found.any = true;
        found.person = crowd.person_of(found.hit.triangle);
    }
    return found;
}

bool Scene::occluded(const Crowd& crowd, const Vector3f& origin, const Vector3f& direction, float t_min,
                     float t_max) const {
    return crowd.rays().occluded(origin, direction, t_min, t_max) || rays_.occluded(origin, direction, t_min, t_max);
}

Vector3f Scene::face_normal(const Crowd& crowd, const SceneHit& found, const Vector3f& direction) const {
    Vector3f a, b, c;
    if (found.person >= 0) {
        const Triangle& t = crowd.triangles_[found.hit.triangle];
        a = crowd.positions_[t[0]], b = crowd.positions_[t[1]], c = crowd.positions_[t[2]];
    } else {
        const Triangle& t = room_.mesh.triangles[found.hit.triangle];
        a = room_.mesh.vertices[t[0]].position, b = room_.mesh.vertices[t[1]].position,
        c = room_.mesh.vertices[t[2]].position;
    }
    const Vector3f normal = (b - a).cross(c - a).normalized();
    return normal.dot(direction) > 0 ? Vector3f(-normal) : normal;
}

Vector3f Scene::radiance(const Crowd& crowd, const SceneHit& found, const Vector3f& origin, const Vector3f& direction,
                         float footprint, std::uint64_t sample) const {
    if (!found.any) return Vector3f::Zero();
    const Vector3f point = origin + found.hit.t * direction;
    if (found.person >= 0) return body_radiance(crowd, found, point, sample);
    return room_radiance(crowd, found.hit, point, direction, footprint, sample);
}

Vector3f Scene::room_radiance(const Crowd& crowd, const Hit& hit, const Vector3f& point, const Vector3f& direction,
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
    if (!crowd.empty()) ambient *= ambient_beside(crowd.shades_, point, normal);
    Vector3f light = ambient * kAmbientColor;
    for (std::size_t l = 0; l < room_.lamps.size(); ++l) {
        const float lamp = wa * la.lamps[l] + wb * lb.lamps[l] + wc * lc.lamps[l];
        if (lamp < 0.01f) continue;
        if (!crowd.empty() && crowd.rays().occluded(point + kShadowStart * normal,
                                                    lamp_point(room_.lamps[l], sample, l) - point, 0.0f, 1.0f))
            continue;
        light += lamp * kLampColor;
    }
    return color.cwiseProduct(light);
}

Vector3f Scene::body_radiance(const Crowd& crowd, const SceneHit& found, const Vector3f& point,
                              std::uint64_t sample) const {
    const auto person = static_cast<std::size_t>(found.person);
    const Body& body = crowd.bodies_[person];
    const std::uint32_t triangle = found.hit.triangle - crowd.first_triangle_[person];
    const Triangle& local = body.triangles[triangle];
    const Triangle& world = crowd.triangles_[found.hit.triangle];
    const float wa = 1 - found.hit.u - found.hit.v, wb = found.hit.u, wc = found.hit.v;
    const BodyVertex &a = body.vertices[local[0]], &b = body.vertices[local[1]], &c = body.vertices[local[2]];
    const Vector3f normal =
        (wa * crowd.normals_[world[0]] + wb * crowd.normals_[world[1]] + wc * crowd.normals_[world[2]]).normalized();
    const Vector3f albedo = body_albedo(body.look, body.proportions.head_height, body.layers[triangle],
                                        wa * a.rest + wb * b.rest + wc * c.rest);
    const float openness = wa * a.openness + wb * b.openness + wc * c.openness;
    Vector3f light = ambient_light(normal) * openness * kAmbientColor;
    for (std::size_t l = 0; l < room_.lamps.size(); ++l) {
        const float lamp = lamp_irradiance(room_.lamps[l], point, normal) * (0.35f + 0.55f * openness);
        if (lamp < 0.01f) continue;
        const Vector3f from = point + kShadowStart * normal;
        if (!occluded(crowd, from, lamp_point(room_.lamps[l], sample, l) - from, 0.0f, 0.99f))
            light += lamp * kLampColor;
    }
    return albedo.cwiseProduct(light);
}

}  // namespace posefusion::synth
