// Light probes against closed forms, against the lightmap and against rays of Embree's own.
#include "bake/probes/probe_light.h"
#include "bake/trace/embree_api.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/light_at.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace relume {
namespace {

constexpr double kProbePi = std::numbers::pi;

/// A bake that is done, and its probes.
class ProbedBake {
public:
    ProbedBake(const Scene& scene, const BakeDesc& desc) : scene_(scene), baker_(makeBaker(scene, desc)) {
        while (!baker_->solver().done())
            baker_->solver().step();
        light_ = probeLight(scene, baker_->patches(), lightSources(scene), baker_->solver().light(), 1.0f);
    }
    std::vector<Probe> probes(const std::vector<glm::vec3>& points, TracerKind tracer,
                              uint32_t samples = 4096) {
        const ProbeLinks links =
            traceProbes(testDevice(), baker_->patches(), probeLamps(scene_, baker_->patches().scene.mesh),
                        points, {.samples = samples, .tracer = tracer});
        WorkerPool& pool = testDevice().workers();
        const std::vector<Harmonics> radiance = gatherProbes(pool, links, {&light_, 1}).at(0);
        const std::vector<double> backs = probeBacks(pool, links);
        std::vector<Probe> probes;
        for (size_t i = 0; i < points.size(); ++i)
            probes.push_back({points[i], radiance[i], backs[i]});
        return probes;
    }
    Baker& baker() { return *baker_; }
    const std::vector<glm::vec4>& radiance() const { return light_.radiance; }

private:
    const Scene& scene_;
    std::unique_ptr<Baker> baker_;
    ProbeLight light_;
};

// The harmonics of what so many even directions of Embree's single rays meet.
Harmonics tracedHarmonics(const PatchSet& patches, const std::vector<glm::vec4>& radiance,
                          const glm::vec3& point, uint32_t count) {
    const WorldMesh& mesh = patches.scene.mesh;
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* corners = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), mesh.positions.size()));
    std::copy(mesh.positions.begin(), mesh.positions.end(), corners);
    auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), mesh.triangleCount()));
    for (uint32_t i = 0; i < 3 * mesh.triangleCount(); ++i)
        indices[i] = i;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    Harmonics sum{};
    for (uint32_t i = 0; i < count; ++i) {
        // The directions are a Fibonacci lattice on the sphere [Marques et al. 2013].
        const double z = 1.0 - (2.0 * i + 1.0) / count, angle = i * kProbePi * (3.0 - std::sqrt(5.0));
        const double r = std::sqrt(1.0 - z * z);
        const glm::dvec3 d(r * std::cos(angle), r * std::sin(angle), z);
        RTCRayHit ray{};
        ray.ray.org_x = point.x, ray.ray.org_y = point.y, ray.ray.org_z = point.z;
        ray.ray.dir_x = static_cast<float>(d.x), ray.ray.dir_y = static_cast<float>(d.y);
        ray.ray.dir_z = static_cast<float>(d.z);
        ray.ray.tfar = INFINITY;
        ray.ray.mask = ~0u;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR < 4
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(scene, &context, &ray);
#else
        rtcIntersect1(scene, &ray);
#endif
        if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
        const glm::vec3 normal(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);
        if (glm::dot(glm::dvec3(normal), d) > 0.0) continue;
        const glm::vec2* uv = &mesh.lightmapUv[3 * ray.hit.primID];
        const glm::vec2 at = uv[0] + ray.hit.u * (uv[1] - uv[0]) + ray.hit.v * (uv[2] - uv[0]);
        const glm::uvec2 texel =
            glm::min(glm::uvec2(at * float(patches.scene.size)), glm::uvec2(patches.scene.size - 1));
        const uint32_t patch = patches.scene.texelToPatch[texel.y * patches.scene.size + texel.x];
        if (patch < radiance.size()) addLight(sum, d, 4.0 * kProbePi / count * glm::dvec3(radiance[patch]));
    }
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    return sum;
}

// Expects the irradiance a millimetre above the middle of a floor of 25 x 25 texels to be the middle texel's.
void expectFloorsLight(const Scene& scene, uint32_t size, const TexelRect& floor, const glm::vec3& middle,
                       double tolerance) {
    ProbedBake bake(scene,
                    {.size = size, .passes = 0, .error = 1e-3, .method = Method::Hybrid, .samples = 1024});
    const FloatImage lighting = bake.baker().lightmap({.quantity = Quantity::Lighting, .sew = false});
    const double expected = texel(lighting, floor, 12, 12);
    for (TracerKind tracer : tracersOfTestDevice()) {
        const Probe probe = bake.probes({middle + 0.001f * kY}, tracer).at(0);
        const double above = irradiance(probe.radiance, {0, 1, 0}).r / kProbePi;
        testing::Test::RecordProperty(tracerName(tracer), std::to_string(above / expected - 1.0));
        EXPECT_NEAR(above, expected, tolerance * expected) << tracerName(tracer);
    }
}

} // namespace

TEST(Probes, InAFurnaceAllCoefficientsAreRight) {
    SceneMaker maker(64);
    maker.box({3, 1, -2}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.0f, 5.0f), 20);
    ProbedBake bake(maker.scene(), {.size = maker.size()});
    for (TracerKind tracer : tracersOfTestDevice())
        for (const Probe& probe : bake.probes({{4, 2, -1}, {3.1f, 1.2f, -1.9f}}, tracer)) {
            const double first = 5.0 * std::sqrt(4.0 * kProbePi);
            EXPECT_FALSE(probe.inside());
            for (size_t i = 0; i < probe.radiance.size(); ++i)
                EXPECT_NEAR(probe.radiance[i].g, i == 0 ? first : 0.0, 0.001 * first)
                    << tracerName(tracer) << ", coefficient " << i;
        }
}

// A surface that faces a light of one direction gets, by nine coefficients, 17/16 of its irradiance.
TEST(Probes, AnalyticLightsAreExactUnlessHidden) {
    SceneMaker maker(32);
    maker.quad({-1, 0, -1}, 2.0f * kZ, 2.0f * kX, maker.material(0.0f), {8, 8});
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {0, 3, 0}, 8.0f, "lamp"));
    ProbedBake bake(scene, {.size = maker.size(), .method = Method::Hybrid, .samples = 64});
    for (TracerKind tracer : tracersOfTestDevice()) {
        const std::vector<Probe> probes = bake.probes({{0, 1, 0}, {0, -1, 0}}, tracer);
        EXPECT_NEAR(irradiance(probes.at(0).radiance, {0, 1, 0}).r, 17.0 / 16.0 * 2.0, 1e-4);
        EXPECT_NEAR(irradiance(probes.at(1).radiance, {0, 1, 0}).r, 0.0, 1e-9) << tracerName(tracer);
    }
}

// Even light above a horizon has no even bands but the first, and the cosine no odd ones but the second: nine
// coefficients are exact.
TEST(Probes, OneMillimetreAboveAFloorUnderTheSkyIsTheFloorsTexel) {
    SceneMaker maker(64);
    const int grey = maker.material(0.5f);
    const TexelRect floor = maker.quad({-1, 0, -1}, 2.0f * kZ, 2.0f * kX, grey, {25, 25});
    maker.quad({-1, 0, -1}, 2.0f * kY, 2.0f * kZ, grey, {25, 25});
    Scene scene = maker.scene();
    scene.sky.radiance = glm::vec3(3.0f);
    expectFloorsLight(scene, maker.size(), floor, {0, 0, 0}, 0.02);
}

// A light that covers a part of the hemisphere has bands above 2, which nine coefficients lack: for one
// direction that is 1/16 of its irradiance, for this ceiling a bit more than 2 %.
TEST(Probes, OneMillimetreAboveAFloorUnderALampOnlyHighBandsAreMissing) {
    SceneMaker maker(96);
    const int grey = maker.material(0.5f), lamp = maker.material(0.5f, 5.0f);
    const auto walls =
        maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, {grey, grey, grey, grey, lamp, grey},
                  {glm::uvec2(25), {25, 25}, {25, 25}, {25, 25}, {25, 25}, {25, 25}});
    expectFloorsLight(maker.scene(), maker.size(), walls[1], {1, 0, 1}, 0.03);
}

TEST(Probes, AgreeWithManyRaysOfEmbree) {
    SceneMaker maker(96);
    const int grey = maker.material(0.5f), lamp = maker.material(0.5f, 5.0f), dark = maker.material(0.1f);
    maker.box({0, 0, 0}, {3.0f * kX, 2.0f * kY, 2.0f * kZ}, {grey, grey, dark, grey, lamp, grey},
              {glm::uvec2(20), {20, 20}, {20, 20}, {20, 20}, {20, 20}, {20, 20}});
    ProbedBake bake(
        maker.scene(),
        {.size = maker.size(), .passes = 0, .error = 0.01, .method = Method::Hybrid, .samples = 256});
    std::mt19937 random(7);
    std::uniform_real_distribution<float> share(0.05f, 0.95f);
    std::vector<glm::vec3> points;
    for (int i = 0; i < 20; ++i) {
        const float x = share(random), y = share(random), z = share(random);
        points.push_back({3.0f * x, 2.0f * y, 2.0f * z});
    }
    constexpr uint32_t kRays = 100000, kNormals = 32;
    double worst = 0;
    const std::vector<Probe> probes = bake.probes(points, tracersOfTestDevice().front());
    for (const Probe& probe : probes) {
        const Harmonics reference =
            tracedHarmonics(bake.baker().patches(), bake.radiance(), probe.position, kRays);
        for (uint32_t k = 0; k < kNormals; ++k) {
            const glm::dvec3 n = glm::normalize(glm::dvec3(probeDirection(k, k % kProbeFaces, 1)));
            const double expected = irradiance(reference, n).g;
            worst = std::max(worst, std::abs(irradiance(probe.radiance, n).g / expected - 1.0));
        }
    }
    RecordProperty("worst", std::to_string(worst));
    EXPECT_LT(worst, 0.01);
}

// Half of the sphere around a place just behind a wall of a room is the wall's back.
TEST(Probes, SeeBacksOfWalls) {
    SceneMaker room(32);
    room.box({0, 0, 0}, {kX, kY, kZ}, room.material(0.5f, 1.0f), 4);
    ProbedBake bake(room.scene(), {.size = room.size()});
    for (const TracerKind tracer : tracersOfTestDevice()) {
        const std::vector<Probe> probes = bake.probes({{0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, -0.001f}}, tracer);
        EXPECT_EQ(probes.at(0).backs, 0.0);
        EXPECT_NEAR(probes.at(1).backs, 0.5, 0.01);
    }
}

// Where a batch of probes begins decides nothing, nor does what else is traced with them.
TEST(Probes, AreTheSameInBatches) {
    SceneMaker maker(32);
    maker.box({0, 0, 0}, {kX, kY, kZ}, maker.material(0.5f, 1.0f), 4);
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {0.5f, 0.9f, 0.5f}, 8.0f, "lamp"));
    scene.lights.back().radius = 0.2f;
    const auto baker = makeBaker(scene, {.size = maker.size()});
    std::vector<glm::vec3> points;
    for (uint32_t i = 0; i < 2 * kProbeStride + 5; ++i)
        points.emplace_back(0.01f * static_cast<float>(i + 1), 0.3f, 0.4f);
    const LampSet lamps = probeLamps(scene, baker->patches().scene.mesh);
    for (const TracerKind kind : tracersOfTestDevice()) {
        constexpr uint32_t kSamples = 64;
        ProbeTracer tracer(testDevice(), baker->patches(), lamps, points, kind);
        const ProbeLinks all = tracer.trace(0, static_cast<uint32_t>(points.size()), kSamples);
        const ProbeLinks some = tracer.trace(2 * kProbeStride, 5, kSamples);
        const size_t before = 2 * kProbeStride;
        EXPECT_TRUE(std::equal(some.links.begin(), some.links.end(), all.linksOf(before)))
            << tracerName(kind);
        EXPECT_TRUE(std::equal(some.seen.begin(), some.seen.end(),
                               all.seen.begin() + static_cast<std::ptrdiff_t>(before * all.targets)));
        // Those that have moved see what they would see if they had always stood there.
        ProbeTracer moved(testDevice(), baker->patches(), {}, std::vector<glm::vec3>(points.size()), kind);
        moved.setLamps(lamps);
        moved.move(2 * kProbeStride, {points.begin() + 2 * kProbeStride, points.end()});
        const ProbeLinks there = moved.trace(2 * kProbeStride, 5, kSamples);
        EXPECT_EQ(there.links, some.links) << tracerName(kind);
        EXPECT_EQ(there.seen, some.seen) << tracerName(kind);
        EXPECT_EQ(all.targets, kProbeLampSamples);
        EXPECT_NE(std::count(all.seen.begin(), all.seen.end(), 1), 0);
    }
}

} // namespace relume
