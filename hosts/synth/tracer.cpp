#include "hosts/synth/tracer.hpp"

#include <embree3/rtcore.h>

#include <cstring>

#include "engine/core/error.hpp"

namespace posefusion::synth {

struct RayDevice::Impl {
    RTCDevice device = rtcNewDevice("threads=1");
    ~Impl() {
        if (device) rtcReleaseDevice(device);
    }
};

RayDevice::RayDevice() : impl_(std::make_unique<Impl>()) {
    if (!impl_->device)
        throw Error(
            "cannot start Embree (the ray-casting library of synth): check that libembree3-3 is completely installed");
}
RayDevice::~RayDevice() = default;
RayDevice::RayDevice(RayDevice&&) noexcept = default;
RayDevice& RayDevice::operator=(RayDevice&&) noexcept = default;

struct RayScene::Impl {
    RTCScene scene = nullptr;
    bool empty = true;
    ~Impl() {
        if (scene) rtcReleaseScene(scene);
    }
};

RayScene::RayScene(const RayDevice& device, std::span<const std::vector<Vector3f>> vertices,
                   const std::vector<Triangle>& triangles, Quality quality)
    : impl_(std::make_unique<Impl>()) {
    if (triangles.empty()) return;
    RTCDevice embree = device.impl_->device;
    impl_->scene = rtcNewScene(embree);
    const RTCBuildQuality build = quality == Quality::Best ? RTC_BUILD_QUALITY_HIGH : RTC_BUILD_QUALITY_LOW;
    rtcSetSceneBuildQuality(impl_->scene, build);
    rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(embree, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, build);
    static_assert(sizeof(Vector3f) == 3 * sizeof(float));
    bool fits = true;
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(vertices.size()));
    for (unsigned step = 0; step < vertices.size(); ++step) {
        const std::vector<Vector3f>& at_step = vertices[step];
        void* positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3,
                                                  3 * sizeof(float), at_step.size());
        fits = fits && positions;
        if (positions)
            std::memcpy(positions, static_cast<const void*>(at_step.data()), at_step.size() * sizeof(Vector3f));
    }
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle),
                                            triangles.size());
    if (!fits || !indices) {
        rtcReleaseGeometry(geometry);
        throw Error("not enough memory for the triangles of the synthetic scene: use fewer people");
    }
    std::memcpy(indices, triangles.data(), triangles.size() * sizeof(Triangle));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(impl_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(impl_->scene);
    impl_->empty = false;
}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

namespace {

void set_ray(RTCRay& ray, const Vector3f& origin, const Vector3f& direction, float t_min, float t_max, float time) {
    ray.org_x = origin.x(), ray.org_y = origin.y(), ray.org_z = origin.z();
    ray.dir_x = direction.x(), ray.dir_y = direction.y(), ray.dir_z = direction.z();
    ray.tnear = t_min, ray.tfar = t_max;
    ray.time = time, ray.mask = ~0u, ray.id = 0, ray.flags = 0;
}

}  // namespace

bool RayScene::intersect(const Vector3f& origin, const Vector3f& direction, float t_min, Hit& hit, float time) const {
    if (impl_->empty) return false;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    RTCRayHit query;
    set_ray(query.ray, origin, direction, t_min, hit.t, time);
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(impl_->scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
    hit = {query.ray.tfar, query.hit.primID, query.hit.u, query.hit.v};
    return true;
}

bool RayScene::occluded(const Vector3f& origin, const Vector3f& direction, float t_min, float t_max, float time) const {
    if (impl_->empty) return false;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay ray;
    set_ray(ray, origin, direction, t_min, t_max, time);
    rtcOccluded1(impl_->scene, &context, &ray);
    return ray.tfar < 0;
}

}  // namespace posefusion::synth
