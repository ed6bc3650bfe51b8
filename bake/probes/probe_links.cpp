#include "bake/probes/probe_links.h"

#include "bake/probes/probe_lamps.h"
#include "bake/vk/commands.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>

namespace relume {
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
    patch.flags = shader::kPatchSends | number << shader::kTexelShift;
    return patch;
}

// So much memory the links of a batch take, unless the fewest probes take more [bytes]: they are traced and
// gathered in a tenth of a second on an ordinary machine.
constexpr uint64_t kLinkBytes = 8u << 20;

uint64_t paddedFaces(uint64_t probes) {
    return (probes * kProbeFaces + kChunk - 1) / kChunk * kChunk;
}

} // namespace

static_assert(kProbeStride * kProbeFaces % shader::kChunk == 0);

/// Holds the tracer with what it needs: patches of the scene, whole chunks of them, and the probes' faces
/// behind.
class ProbeTracer::Impl {
public:
    Impl(const vk::Device& device, const PatchSet& patches, LampSet lamps, std::vector<glm::vec3> points,
         TracerKind kind)
        : device_(device), points_(std::move(points)), scene_(patches.scene),
          sceneChunks_(patches.chunkCount()), commands_(device) {
        const size_t faces = points_.size() * kProbeFaces, padded = paddedFaces(points_.size());
        for (size_t i = 0; i < padded; ++i) {
            const size_t face = std::min(i, faces - 1);
            scene_.patches.push_back(faceOf(points_[face / kProbeFaces], static_cast<uint32_t>(face)));
            scene_.patchChart.push_back(kNoChart);
        }
        patches_ = vk::makeBuffer(device, scene_.patches, "probes' patches");
        tracer_ = makeTracer(kind, device, scene_, patches_);
        setLamps(std::move(lamps));
    }

    void setLamps(LampSet lamps) {
        lamps_ = std::move(lamps);
        targets_ = 0;
        for (const Lamp& lamp : lamps_.lamps)
            targets_ += lamp.samples;
    }

    void move(uint32_t first, const std::vector<glm::vec3>& points) {
        const size_t begin = size_t{sceneChunks_} * kChunk + size_t{first} * kProbeFaces;
        const size_t count = points.size() * kProbeFaces;
        for (size_t i = 0; i < count; ++i)
            scene_.patches[begin + i] =
                faceOf(points[i / kProbeFaces], first * kProbeFaces + static_cast<uint32_t>(i));
        std::copy(points.begin(), points.end(), points_.begin() + first);
        vk::upload(device_, patches_, &scene_.patches[begin], count * sizeof(Patch), begin * sizeof(Patch));
    }

    ProbeLinks trace(uint32_t first, uint32_t count, uint32_t samples) {
        const auto begin = points_.begin() + first;
        ProbeLinks result{.first = first, .points = {begin, begin + count}, .samples = samples};
        result.lamps = lamps_.lamps;
        result.targets = targets_;
        result.links.resize(size_t{count} * kProbeFaces * samples);
        result.seen.resize(size_t{count} * targets_);
        traceLinks(result);
        if (targets_ > 0) traceTargets(result);
        result.rays = result.links.size() + result.seen.size();
        return result;
    }

private:
    /// Some chunks of the faces of the probes that are traced now.
    struct Batch {
        uint32_t first = 0, count = 0; // counted from the first face of these probes
    };

    static uint32_t chunksOf(const ProbeLinks& links) {
        return static_cast<uint32_t>(paddedFaces(links.points.size()) / kChunk);
    }

    static uint32_t batchOf(uint64_t bytesPerChunk, uint32_t chunks) {
        return static_cast<uint32_t>(std::clamp<uint64_t>(kBatchBytes / bytesPerChunk, 1, chunks));
    }

    uint32_t chunkInScene(const ProbeLinks& links, const Batch& batch) const {
        return sceneChunks_ + links.first / kProbeStride * (kProbeStride * kProbeFaces / kChunk) +
               batch.first;
    }

    void traceLinks(ProbeLinks& result) {
        const uint32_t samples = result.samples;
        const uint64_t perChunk = uint64_t{samples} * kChunk;
        const uint32_t chunks = chunksOf(result), most = batchOf(perChunk * sizeof(uint32_t), chunks);
        const vk::Buffer links(device_, {.size = most * perChunk * sizeof(uint32_t),
                                         .memory = vk::Memory::Host,
                                         .name = "probes' links"});
        const size_t faces = result.points.size() * kProbeFaces;
        for (Batch batch{0, most}; batch.first < chunks; batch.first += most) {
            batch.count = std::min(most, chunks - batch.first);
            VkCommandBuffer cmd = commands_.begin();
            tracer_->closest(cmd, {.firstChunk = chunkInScene(result, batch),
                                   .chunkCount = batch.count,
                                   .firstSample = 0,
                                   .sampleCount = samples,
                                   .rotation = Rotation::Alone, // faces are no texels
                                   .links = &links});
            vk::hostBarrier(cmd);
            commands_.run();
            const auto* from = static_cast<const uint32_t*>(links.mapped());
            const size_t begin = size_t{batch.first} * kChunk;
            for (size_t i = begin; i < std::min(faces, begin + size_t{batch.count} * kChunk); ++i) {
                const size_t local = i - begin;
                for (uint32_t k = 0; k < samples; ++k)
                    result.links[i * samples + k] =
                        from[(local / kChunk * samples + k) * kChunk + local % kChunk];
            }
        }
    }

    // Rays to lights start at the first face of each probe.
    void traceTargets(ProbeLinks& result) {
        const uint32_t words = (targets_ + kWordBits - 1) / kWordBits;
        const uint64_t perChunk = uint64_t{targets_} * kChunk;
        const uint32_t chunks = chunksOf(result), most = batchOf(perChunk * sizeof(glm::vec4), chunks);
        std::vector<glm::vec4> wanted(most * perChunk);
        const vk::Buffer targets(device_, {.size = wanted.size() * sizeof(glm::vec4),
                                           .memory = vk::Memory::Host,
                                           .name = "probes' targets"});
        const vk::Buffer bits(device_, {.size = uint64_t{most} * words * kChunk * sizeof(uint32_t),
                                        .memory = vk::Memory::Host,
                                        .name = "probes' bits"});
        const vk::Buffer rays =
            vk::makeBuffer(device_, std::vector<uint32_t>(shader::kRayCounters), "probes' rays");
        for (Batch batch{0, most}; batch.first < chunks; batch.first += most) {
            batch.count = std::min(most, chunks - batch.first);
            fillTargets(result, batch, wanted);
            std::memcpy(targets.mapped(), wanted.data(), wanted.size() * sizeof(glm::vec4));
            VkCommandBuffer cmd = commands_.begin();
            tracer_->segments(cmd, {.firstChunk = chunkInScene(result, batch),
                                    .chunkCount = batch.count,
                                    .targetCount = targets_,
                                    .targets = &targets,
                                    .bits = &bits,
                                    .rays = &rays});
            vk::hostBarrier(cmd);
            commands_.run();
            const auto* from = static_cast<const uint32_t*>(bits.mapped());
            forProbes(result, batch, [&](size_t probe, size_t local) {
                for (uint32_t t = 0; t < targets_; ++t) {
                    const uint32_t word =
                        from[(local / kChunk * words + t / kWordBits) * kChunk + local % kChunk];
                    result.seen[probe * targets_ + t] = word >> t % kWordBits & 1u;
                }
            });
        }
    }

    void fillTargets(const ProbeLinks& result, const Batch& batch, std::vector<glm::vec4>& wanted) const {
        std::fill(wanted.begin(), wanted.end(), glm::vec4(0.0f));
        forProbes(result, batch, [&](size_t probe, size_t local) {
            const uint32_t number = result.first + static_cast<uint32_t>(probe);
            uint32_t target = 0;
            for (const Lamp& lamp : lamps_.lamps)
                for (uint32_t k = 0; k < lamp.samples; ++k, ++target) {
                    const ProbeLampRay ray =
                        sampleProbeLamp(lamp, result.points[probe], number, k, lamps_.reach);
                    wanted[(local / kChunk * targets_ + target) * kChunk + local % kChunk] =
                        glm::vec4(ray.target, ray.lux > 0.0f ? 1.0f : 0.0f);
                }
        });
    }

    // Calls f(probe, its first face's place in the batch) for probes whose first face is in these chunks.
    template<typename F>
    static void forProbes(const ProbeLinks& links, const Batch& batch, const F& f) {
        const size_t begin = size_t{batch.first} * kChunk, end = begin + size_t{batch.count} * kChunk;
        for (size_t probe = (begin + kProbeFaces - 1) / kProbeFaces;
             probe < links.points.size() && probe * kProbeFaces < end; ++probe)
            f(probe, probe * kProbeFaces - begin);
    }

    const vk::Device& device_;
    uint32_t targets_ = 0;
    std::vector<glm::vec3> points_;
    LampSet lamps_;
    TraceScene scene_;
    uint32_t sceneChunks_;
    vk::Commands commands_;
    vk::Buffer patches_;
    std::unique_ptr<Tracer> tracer_;
};

ProbeTracer::ProbeTracer(const vk::Device& device, const PatchSet& patches, LampSet lamps,
                         std::vector<glm::vec3> points, TracerKind kind) {
    ASSERT(!points.empty());
    const vk::MemoryOwner owner("probes");
    impl_ = std::make_unique<Impl>(device, patches, std::move(lamps), std::move(points), kind);
}

ProbeTracer::~ProbeTracer() = default;

ProbeLinks ProbeTracer::trace(uint32_t first, uint32_t count, uint32_t samples) {
    ASSERT(first % kProbeStride == 0);
    const vk::MemoryOwner owner("probes");
    return impl_->trace(first, count, samples);
}

void ProbeTracer::move(uint32_t first, const std::vector<glm::vec3>& points) {
    impl_->move(first, points);
}

void ProbeTracer::setLamps(LampSet lamps) {
    impl_->setLamps(std::move(lamps));
}

glm::vec3 probeDirection(uint32_t probe, uint32_t face, uint32_t sample) {
    const Patch patch = faceOf(glm::vec3(0.0f), probe * kProbeFaces + face);
    return shader::patchDirection(patch, shader::keyAlone(shader::seedKey(patch)), sample);
}

double probeSolidAngle(const glm::vec3& d, uint32_t samples) {
    const double sum = double{std::abs(d.x)} + std::abs(d.y) + std::abs(d.z);
    return std::numbers::pi / (samples * sum);
}

LampSet probeLamps(const Scene& scene, const WorldMesh& mesh) {
    return buildLamps(scene, mesh, {.samples = kProbeLampSamples, .sky = false, .unit = true});
}

uint32_t probeBatch(uint32_t samples) {
    const uint64_t perStride = uint64_t{kProbeStride} * kProbeFaces * samples * sizeof(uint32_t);
    return static_cast<uint32_t>(std::max<uint64_t>(kLinkBytes / perStride, 1)) * kProbeStride;
}

ProbeLinks traceProbes(const vk::Device& device, const PatchSet& patches, const LampSet& lamps,
                       std::vector<glm::vec3> points, const ProbeDesc& desc) {
    if (points.empty()) return {.samples = desc.samples};
    const auto count = static_cast<uint32_t>(points.size());
    return ProbeTracer(device, patches, lamps, std::move(points), desc.tracer).trace(0, count, desc.samples);
}

uint64_t probeTracerBytes(const ProbeExtent& extent, uint64_t patches) {
    if (extent.count == 0) return 0;
    const uint64_t chunks =
        paddedFaces(std::min<uint64_t>(extent.count, probeBatch(extent.samples))) / kChunk;
    const auto batch = [&](uint64_t perChunk) {
        return std::clamp<uint64_t>(kBatchBytes / perChunk, 1, chunks) * perChunk;
    };
    // Tracers have a table of patches' charts beside them, which for the scene's own is counted with its
    // tables.
    const uint64_t faces = paddedFaces(extent.count);
    const uint64_t own = (patches + faces) * sizeof(Patch) + faces * sizeof(uint32_t);
    const uint64_t links = batch(uint64_t{extent.samples} * kChunk * sizeof(uint32_t));
    if (extent.targets == 0) return own + links;
    // Links are gone when rays go to lights. A target has a bit of a word for each patch.
    const uint64_t targets = batch(uint64_t{extent.targets} * kChunk * sizeof(glm::vec4));
    const uint64_t words = (extent.targets + kWordBits - 1) / kWordBits;
    const uint64_t bits = targets * words * sizeof(uint32_t) / (extent.targets * sizeof(glm::vec4));
    return own + std::max(links, targets + bits + shader::kRayCounters * sizeof(uint32_t));
}

} // namespace relume
