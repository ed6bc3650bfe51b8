#include "bake/probes/probe_links.h"

#include "bake/vk/commands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

namespace relume {
namespace shader {
#include "shaders/lib/light/sky_place.glsl"
} // namespace shader

namespace {

using shader::kChunk;
using shader::Lamp;
using shader::Patch;

constexpr uint32_t kWordBits = kTargetsPerWord;
// A batch of targets or links takes so much memory at most, if it has more than one chunk [bytes].
constexpr uint64_t kBatchBytes = 32u << 20;

Patch faceOf(const glm::vec3& point, uint32_t number) {
    constexpr std::array<glm::vec3, kProbeFaces> kAxes = {glm::vec3(1, 0, 0), {-1, 0, 0}, {0, 1, 0},
                                                          {0, -1, 0},         {0, 0, 1},  {0, 0, -1}};
    Patch patch{};
    patch.position = point;
    // Rays start as near to the probe as floats can tell apart.
    constexpr float kNearest = 4.8e-7f; // eight units in the last place of a float
    patch.offset = kNearest * std::max({std::abs(point.x), std::abs(point.y), std::abs(point.z), 1e-3f});
    patch.normal = patch.shading = kAxes[number % kProbeFaces];
    patch.flags = shader::kPatchSends | number << 8;
    return patch;
}

// One ray to an analytic light, and the light that it brings if nothing is in between.
struct LampRay {
    glm::vec3 target{0.0f};
    glm::vec3 direction{0.0f}; // unit
    float lux = 0;             // per unit of the light's colour, on a surface that faces it
};

// Samples a light seen from a probe: as shader::lampSample does, but without the cosine of a receiver.
LampRay sampleLamp(const Lamp& lamp, const glm::vec3& point, uint32_t probe, uint32_t sample, float reach) {
    const glm::vec2 u =
        shader::sobolPoint(shader::replicateIndex(sample), shader::lampSeed(lamp, probe, sample));
    LampRay ray;
    if (lamp.type == shader::kLampRectangle || lamp.type == shader::kLampDisc) {
        float area = glm::length(glm::cross(lamp.edgeU, lamp.edgeV));
        ray.target = shader::rectangleCorner(lamp, u.x, u.y);
        if (lamp.type == shader::kLampDisc) {
            const glm::vec3 c = shader::cosineDirection(u);
            ray.target = lamp.position + lamp.radius * (c.x * lamp.edgeU + c.y * lamp.edgeV);
            area = std::numbers::pi_v<float> * lamp.radius * lamp.radius;
        }
        const glm::vec3 d = ray.target - point;
        const float d2 = std::max(glm::dot(d, d), shader::kNearestLamp2);
        ray.direction = d / std::sqrt(d2);
        ray.lux = area * std::max(-glm::dot(lamp.axis, ray.direction), 0.0f) / d2;
        ray.target += shader::kLampGap * (point - ray.target);
        return ray;
    }
    Patch patch{};
    patch.position = point;
    patch.normal = patch.shading = lamp.type == shader::kLampSun ? -lamp.axis : glm::vec3(0, 1, 0);
    const glm::vec3 away = lamp.position - point;
    if (lamp.type != shader::kLampSun && glm::dot(away, away) > 0.0f)
        patch.normal = patch.shading = glm::normalize(away);
    const shader::LampSample s = shader::lampSample(lamp, patch, point, u, reach);
    ray.target = s.target;
    const glm::vec3 d = s.target - point;
    const float length = glm::length(d);
    if (!(length > 0.0f)) return ray;
    ray.direction = d / length;
    const float cosine = glm::dot(patch.shading, ray.direction);
    if (cosine > 0.0f) ray.lux = std::numbers::pi_v<float> * s.factor / cosine;
    return ray;
}

// The tracer with what it needs: patches of the scene, whole chunks of them, and the probes' faces behind.
class ProbeTracer {
public:
    ProbeTracer(const vk::Device& device, const PatchSet& patches, const ProbeDesc& desc, ProbeLinks& result)
        : device_(device), result_(result), scene_(patches.scene), firstChunk_(patches.chunkCount()),
          commands_(device) {
        const size_t faces = result.points.size() * kProbeFaces;
        const size_t padded = (faces + kChunk - 1) / kChunk * kChunk;
        for (size_t i = 0; i < padded; ++i) {
            const size_t face = std::min(i, faces - 1);
            scene_.patches.push_back(faceOf(result.points[face / kProbeFaces], static_cast<uint32_t>(face)));
            scene_.patchChart.push_back(kNoChart);
        }
        chunks_ = static_cast<uint32_t>(padded / kChunk);
        patches_ = vk::makeBuffer(device, scene_.patches, "probes' patches");
        tracer_ = makeTracer(desc.tracer, device, scene_, patches_);
    }

    void links() {
        const uint64_t perChunk = uint64_t{result_.samples} * kChunk;
        const uint32_t most = batch(perChunk * sizeof(uint32_t));
        const vk::Buffer links(device_, {.size = most * perChunk * sizeof(uint32_t),
                                         .memory = vk::Memory::Host,
                                         .name = "probes' links"});
        const size_t faces = result_.points.size() * kProbeFaces;
        result_.links.resize(faces * result_.samples);
        for (uint32_t first = 0; first < chunks_; first += most) {
            const uint32_t count = std::min(most, chunks_ - first);
            VkCommandBuffer cmd = commands_.begin();
            tracer_->closest(cmd, {.firstChunk = firstChunk_ + first,
                                   .chunkCount = count,
                                   .firstSample = 0,
                                   .sampleCount = result_.samples,
                                   .links = &links});
            vk::hostBarrier(cmd);
            commands_.run();
            const auto* from = static_cast<const uint32_t*>(links.mapped());
            for (size_t i = size_t{first} * kChunk; i < std::min(faces, size_t{first + count} * kChunk);
                 ++i) {
                const size_t local = i - size_t{first} * kChunk;
                for (uint32_t k = 0; k < result_.samples; ++k)
                    result_.links[i * result_.samples + k] =
                        from[(local / kChunk * result_.samples + k) * kChunk + local % kChunk];
            }
        }
        result_.rays += faces * result_.samples;
    }

    /// Rays to lights start at the first face of each probe.
    void targets(const LampSet& lamps) {
        const uint32_t words = (result_.targets + kWordBits - 1) / kWordBits;
        const uint64_t perChunk = uint64_t{result_.targets} * kChunk;
        const uint32_t most = batch(perChunk * sizeof(glm::vec4));
        std::vector<glm::vec4> wanted(most * perChunk);
        const vk::Buffer targets(device_, {.size = wanted.size() * sizeof(glm::vec4),
                                           .memory = vk::Memory::Host,
                                           .name = "probes' targets"});
        const vk::Buffer bits(device_, {.size = uint64_t{most} * words * kChunk * sizeof(uint32_t),
                                        .memory = vk::Memory::Host,
                                        .name = "probes' bits"});
        const vk::Buffer rays =
            vk::makeBuffer(device_, std::vector<uint32_t>(shader::kRayCounters), "probes' rays");
        result_.seen.resize(result_.points.size() * result_.targets);
        for (uint32_t first = 0; first < chunks_; first += most) {
            const uint32_t count = std::min(most, chunks_ - first);
            std::fill(wanted.begin(), wanted.end(), glm::vec4(0.0f));
            forProbes(first, count, [&](size_t probe, size_t local) {
                uint32_t target = 0;
                for (const Lamp& lamp : lamps.lamps)
                    for (uint32_t k = 0; k < lamp.samples; ++k, ++target) {
                        const LampRay ray = sampleLamp(lamp, result_.points[probe],
                                                       static_cast<uint32_t>(probe), k, lamps.reach);
                        wanted[(local / kChunk * result_.targets + target) * kChunk + local % kChunk] =
                            glm::vec4(ray.target, ray.lux > 0.0f ? 1.0f : 0.0f);
                    }
            });
            std::memcpy(targets.mapped(), wanted.data(), wanted.size() * sizeof(glm::vec4));
            VkCommandBuffer cmd = commands_.begin();
            tracer_->segments(cmd, {.firstChunk = firstChunk_ + first,
                                    .chunkCount = count,
                                    .targetCount = result_.targets,
                                    .targets = &targets,
                                    .bits = &bits,
                                    .rays = &rays});
            vk::hostBarrier(cmd);
            commands_.run();
            const auto* from = static_cast<const uint32_t*>(bits.mapped());
            forProbes(first, count, [&](size_t probe, size_t local) {
                for (uint32_t t = 0; t < result_.targets; ++t) {
                    const uint32_t word =
                        from[(local / kChunk * words + t / kWordBits) * kChunk + local % kChunk];
                    result_.seen[probe * result_.targets + t] = word >> t % kWordBits & 1u;
                }
            });
        }
        result_.rays += result_.seen.size();
    }

private:
    uint32_t batch(uint64_t bytesPerChunk) const {
        return static_cast<uint32_t>(std::clamp<uint64_t>(kBatchBytes / bytesPerChunk, 1, chunks_));
    }

    // Calls f(probe, its first face's place in the batch) for probes whose first face is in these chunks.
    template<typename F>
    void forProbes(uint32_t first, uint32_t count, const F& f) const {
        const size_t begin = size_t{first} * kChunk, end = begin + size_t{count} * kChunk;
        for (size_t probe = (begin + kProbeFaces - 1) / kProbeFaces;
             probe < result_.points.size() && probe * kProbeFaces < end; ++probe)
            f(probe, probe * kProbeFaces - begin);
    }

    const vk::Device& device_;
    ProbeLinks& result_;
    TraceScene scene_;
    uint32_t firstChunk_, chunks_ = 0;
    vk::Commands commands_;
    vk::Buffer patches_;
    std::unique_ptr<Tracer> tracer_;
};

glm::vec3 skyRadiance(const Sky& sky, const glm::vec3& direction) {
    if (sky.pixels.empty()) return sky.radiance;
    const glm::vec2 place = shader::skyPlace(direction, sky.rotation);
    const uint32_t row =
        std::min(static_cast<uint32_t>(place.y * static_cast<float>(sky.height)), sky.height - 1);
    const uint32_t column =
        std::min(static_cast<uint32_t>(place.x * static_cast<float>(sky.width)), sky.width - 1);
    return sky.radiance * sky.pixels[size_t{row} * sky.width + column];
}

} // namespace

glm::vec3 probeDirection(uint32_t probe, uint32_t face, uint32_t sample) {
    const Patch patch = faceOf(glm::vec3(0.0f), probe * kProbeFaces + face);
    return shader::patchDirection(patch, shader::seedKey(patch), sample);
}

double probeSolidAngle(const glm::vec3& d, uint32_t samples) {
    const double sum = double{std::abs(d.x)} + std::abs(d.y) + std::abs(d.z);
    return std::numbers::pi / (samples * sum);
}

ProbeLinks traceProbes(const vk::Device& device, const PatchSet& patches, const LampSet& lamps,
                       std::vector<glm::vec3> points, const ProbeDesc& desc) {
    ProbeLinks result;
    result.points = std::move(points);
    result.samples = desc.samples;
    for (const Lamp& lamp : lamps.lamps)
        result.targets += lamp.samples;
    if (result.points.empty()) return result;
    ProbeTracer tracer(device, patches, desc, result);
    tracer.links();
    if (result.targets > 0) tracer.targets(lamps);
    return result;
}

std::vector<Probe> gatherProbes(const ProbeLinks& links, const ProbeLight& light) {
    std::vector<Probe> probes(links.points.size());
    for (uint32_t p = 0; p < probes.size(); ++p) {
        Probe& probe = probes[p];
        probe.position = links.points[p];
        const uint32_t* link = links.links.data() + size_t{p} * kProbeFaces * links.samples;
        for (uint32_t face = 0; face < kProbeFaces; ++face)
            for (uint32_t k = 0; k < links.samples; ++k, ++link) {
                const glm::vec3 d = probeDirection(p, face, k);
                const double solidAngle = probeSolidAngle(d, links.samples);
                if (*link < shader::kLinkFirstSpecial)
                    addLight(probe.radiance, d, solidAngle * glm::dvec3(light.radiance[*link]));
                else if (*link == shader::kLinkBack)
                    probe.backs += solidAngle / (4.0 * std::numbers::pi);
                else if (shader::linkIsSky(*link) && light.sky)
                    addLight(probe.radiance, d, solidAngle * glm::dvec3(skyRadiance(*light.sky, d)));
            }
        uint32_t target = 0;
        for (const Lamp& lamp : light.lamps)
            for (uint32_t k = 0; k < lamp.samples; ++k, ++target) {
                if (!links.seen[size_t{p} * links.targets + target]) continue;
                const LampRay ray = sampleLamp(lamp, probe.position, p, k, 1.0f);
                addLight(probe.radiance, ray.direction,
                         double{ray.lux} / lamp.samples * glm::dvec3(lamp.color));
            }
    }
    return probes;
}

std::vector<glm::vec4> patchRadiance(const PatchSet& patches, const std::vector<glm::vec4>& lighting,
                                     float reflectivity) {
    std::vector<glm::vec4> radiance(patches.emission);
    for (size_t i = 0; i < radiance.size(); ++i)
        radiance[i] += reflectivity * patches.albedo[i] * lighting[i];
    return radiance;
}

} // namespace relume
