#include "assets/survey/level_rays.h"

#include "assets/base/error.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cstring>
#include <type_traits>

#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

struct DeviceEnd {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneEnd {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

void intersect(RTCScene scene, RTCRayHit& ray) {
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(scene, &ray, nullptr);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray);
#endif
}

// Returns the point of a triangle that is nearest to p [Ericson, Real-Time Collision Detection, 5.1.5].
glm::vec3 nearestPoint(const glm::vec3& p, const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 ab = b - a, ac = c - a, ap = p - a;
    const float d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return a;
    const glm::vec3 bp = p - b;
    const float d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return b;
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
    const glm::vec3 cp = p - c;
    const float d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return c;
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
    const float sum = va + vb + vc;
    return sum > 0 ? a + (vb * ab + vc * ac) / sum : a; // a triangle without area is its corner here
}

struct Nearest {
    const glm::vec3* positions; // 3 per triangle
};

bool takeNearer(RTCPointQueryFunctionArguments* query) {
    const auto& nearest = *static_cast<const Nearest*>(query->userPtr);
    const glm::vec3* corners = nearest.positions + size_t{query->primID} * 3;
    const glm::vec3 point(query->query->x, query->query->y, query->query->z);
    const float distance = glm::distance(point, nearestPoint(point, corners[0], corners[1], corners[2]));
    if (distance >= query->query->radius) return false;
    query->query->radius = distance;
    return true;
}

} // namespace

struct LevelRays::Impl {
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceEnd> device;
    std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneEnd> scene;
    const glm::vec3* positions = nullptr; // Embree's own
};

LevelRays::LevelRays(const WorldMesh& mesh) : impl_(std::make_unique<Impl>()) {
    impl_->device.reset(rtcNewDevice(nullptr));
    if (!impl_->device) throw Error("embree: no device to look at the level with: free some memory");
    impl_->scene.reset(rtcNewScene(impl_->device.get()));
    RTCScene scene = impl_->scene.get();
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW); // there are few rays
    const size_t count = mesh.triangleCount();
    if (count > 0) {
        RTCGeometry geometry = rtcNewGeometry(impl_->device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
        void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                 sizeof(glm::vec3), count * 3);
        void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                3 * sizeof(uint32_t), count);
        if (vertices && indices) {
            std::memcpy(vertices, mesh.positions.data(), count * 3 * sizeof(glm::vec3));
            for (uint32_t i = 0; i < count * 3; ++i)
                static_cast<uint32_t*>(indices)[i] = i;
            impl_->positions = static_cast<const glm::vec3*>(vertices);
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene, geometry);
        }
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    if (rtcGetDeviceError(impl_->device.get()) != RTC_ERROR_NONE)
        throw Error(fmt::format("embree: no memory to look at a level of {} triangles: free some", count));
}

LevelRays::~LevelRays() = default;
LevelRays::LevelRays(LevelRays&&) noexcept = default;

LevelHit LevelRays::trace(const glm::vec3& origin, const glm::vec3& direction) const {
    RTCRayHit ray{};
    ray.ray.org_x = origin.x, ray.ray.org_y = origin.y, ray.ray.org_z = origin.z;
    ray.ray.dir_x = direction.x, ray.ray.dir_y = direction.y, ray.ray.dir_z = direction.z;
    ray.ray.tfar = std::numeric_limits<float>::infinity();
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect(impl_->scene.get(), ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    const glm::vec3* corners = impl_->positions + size_t{ray.hit.primID} * 3;
    const glm::vec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    return {ray.ray.tfar, glm::dot(normal, direction) < 0.0f, glm::normalize(normal)};
}

float LevelRays::clearance(const glm::vec3& point) const {
    RTCPointQuery query{};
    query.x = point.x, query.y = point.y, query.z = point.z;
    query.radius = std::numeric_limits<float>::infinity();
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    Nearest nearest{impl_->positions};
    rtcPointQuery(impl_->scene.get(), &query, &context, takeNearer, &nearest);
    return query.radius;
}

} // namespace relume
