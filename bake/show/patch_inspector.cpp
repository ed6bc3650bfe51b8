#include "bake/show/patch_inspector.h"

#include "bake/links/directions.h"
#include "bake/pairs/sender_light.h"
#include "bake/trace/make_tracer.h"
#include "bake/trace/voxel_map.h"
#include "bake/vk/commands.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;

glm::ivec2 texelOf(const PatchSet& set, uint32_t patch) {
    const uint32_t texel = shader::patchTexel(set.scene.patches[patch].flags);
    return {static_cast<int>(texel % set.scene.size), static_cast<int>(texel / set.scene.size)};
}

uint32_t patchOfTexel(const PatchSet& set, glm::ivec2 texel) {
    const auto size = static_cast<int>(set.scene.size);
    if (texel.x < 0 || texel.y < 0 || texel.x >= size || texel.y >= size) return kNoPatch;
    return set.scene.texelToPatch[static_cast<size_t>(texel.y * size + texel.x)];
}

// Returns the length of the diagonal of the scene's bounds [m].
float sceneSize(const PatchSet& set) {
    glm::vec3 lo = set.bounds[0].lo, hi = set.bounds[0].hi;
    for (const shader::ChunkBounds& b : set.bounds) {
        lo = glm::min(lo, b.lo);
        hi = glm::max(hi, b.hi);
    }
    return glm::distance(lo, hi);
}

// Makes counters in the device's own memory: kernels add to them atomically.
vk::Buffer rayCounters(const vk::Device& device) {
    return vk::makeBuffer(device, std::vector<uint32_t>(2 * shader::kRayCounters, 0u), "ray counters");
}

// Marks texels beside which a patch belongs to another leaf.
void markBorders(const PatchSet& set, const std::vector<uint32_t>& leaf, PatchValues& values) {
    constexpr glm::ivec2 kBeside[] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    for (uint32_t i = 0; i < set.count; ++i) {
        if (leaf[i] == kNoPatch) continue;
        for (const glm::ivec2 step : kBeside) {
            const uint32_t other = patchOfTexel(set, texelOf(set, i) + step);
            if (other == kNoPatch || leaf[other] != leaf[i]) values[i].g = 1.0f;
        }
    }
}

// Returns which sender of RTRad's list holds each patch: one of weight w covers a square of w texels from its
// own on.
std::vector<uint32_t> rtradLeaves(const PatchSet& set, const SenderList& list) {
    std::vector<uint32_t> leaf(set.scene.patches.size(), kNoPatch);
    for (uint32_t s = 0; s < list.count; ++s) {
        const glm::ivec2 corner = texelOf(set, list.members[list.senders[s].first]);
        const auto edge = static_cast<int>(std::lround(std::sqrt(list.weights[s])));
        for (int y = 0; y < edge; ++y) {
            for (int x = 0; x < edge; ++x) {
                const uint32_t patch = patchOfTexel(set, corner + glm::ivec2(x, y));
                if (patch != kNoPatch) leaf[patch] = s;
            }
        }
    }
    return leaf;
}

std::vector<uint32_t> leavesOf(const PatchSet& set, const SenderList& list) {
    if (!list.weights.empty()) return rtradLeaves(set, list);
    std::vector<uint32_t> leaf(set.scene.patches.size(), kNoPatch);
    for (uint32_t s = 0; s < list.count; ++s)
        for (uint32_t m = 0; m < list.senders[s].count; ++m)
            leaf[list.members[list.senders[s].first + m]] = s;
    return leaf;
}

} // namespace

PatchValues PatchInspector::quantity(PatchQuantity quantity) const {
    const PatchSet& set = input_.patches;
    if (quantity == PatchQuantity::Albedo) return set.albedo;
    PatchValues values;
    values.reserve(set.scene.patches.size());
    for (const shader::Patch& p : set.scene.patches) {
        const glm::vec3 value = quantity == PatchQuantity::Position ? p.position
                                : quantity == PatchQuantity::Normal ? p.shading
                                                                    : glm::vec3(p.area, 0.0f, 0.0f);
        values.emplace_back(value, 1.0f);
    }
    return values;
}

PatchValues PatchInspector::ligIn() const {
    return vk::readBuffer<glm::vec4>(input_.device, input_.light.ligIn, input_.patches.scene.patches.size());
}

PatchValues PatchInspector::ligOut() const {
    return vk::readBuffer<glm::vec4>(input_.device, input_.light.ligOut, input_.patches.scene.patches.size());
}

PatchValues PatchInspector::grey(const std::vector<float>& values) {
    PatchValues result;
    result.reserve(values.size());
    for (float v : values)
        result.emplace_back(v, v, v, 1.0f);
    return result;
}

PatchValues PatchInspector::mip(const PatchValues& values, uint32_t mip) {
    ASSERT(mip <= kMaxMip && values.size() == input_.patches.scene.patches.size());
    if (mip == 0) return values;
    Windows& windows = windows_[mip];
    if (windows.runs.empty()) {
        SenderList list = windowSenders(input_.patches, 1u << mip);
        windows = {std::move(list.senders), std::move(list.members)};
    }
    PatchValues result = values;
    for (const shader::Sender& window : windows.runs) {
        glm::dvec4 sum(0.0);
        double area = 0.0;
        for (uint32_t m = window.first; m < window.first + window.count; ++m) {
            const double own = input_.patches.scene.patches[windows.members[m]].area;
            sum += own * glm::dvec4(values[windows.members[m]]);
            area += own;
        }
        if (!(area > 0.0)) continue;
        for (uint32_t m = window.first; m < window.first + window.count; ++m)
            result[windows.members[m]] = glm::vec4(sum / area);
    }
    return result;
}

const std::vector<uint32_t>& PatchInspector::parts() {
    if (parts_.empty()) parts_ = mergeableParts(input_.patches);
    return parts_;
}

PatchValues PatchInspector::leaves(const PatchValues& light, const QuadTreeDesc& desc) {
    const PatchSet& set = input_.patches;
    QuadTreeDesc own = desc;
    own.rtrad = input_.transport.rtrad;
    const SenderList list = quadTreeSenders(set, parts(), patchRadiance(set, light, input_.transport), own);
    const std::vector<uint32_t> leaf = leavesOf(set, list);
    std::vector<uint32_t> held(list.count, 0);
    for (uint32_t l : leaf)
        if (l != kNoPatch) ++held[l];
    PatchValues values(leaf.size(), glm::vec4(0.0f));
    for (size_t i = 0; i < leaf.size(); ++i) {
        if (leaf[i] == kNoPatch) continue;
        const auto id = static_cast<float>(shader::hash32(leaf[i]) >> 24) / 256.0f;
        values[i] = {static_cast<float>(held[leaf[i]]), 0.0f, id, 1.0f};
    }
    markBorders(set, leaf, values);
    return values;
}

uint32_t PatchInspector::patchAt(uint32_t x, uint32_t y) const {
    constexpr int kReach = 4; // texels: the rings that are filled around charts
    const glm::ivec2 texel(x, y);
    uint32_t best = patchOfTexel(input_.patches, texel);
    if (best != kNoPatch) return best;
    int bestDistance = std::numeric_limits<int>::max();
    for (int dy = -kReach; dy <= kReach; ++dy) {
        for (int dx = -kReach; dx <= kReach; ++dx) {
            const uint32_t patch = patchOfTexel(input_.patches, texel + glm::ivec2(dx, dy));
            if (patch == kNoPatch || dx * dx + dy * dy >= bestDistance) continue;
            bestDistance = dx * dx + dy * dy;
            best = patch;
        }
    }
    return best;
}

// Returns what `from` gets of `to` if it sees it, as the gather has it.
float PatchInspector::formFactor(uint32_t from, uint32_t to) const {
    const shader::Patch &r = input_.patches.scene.patches[from], &s = input_.patches.scene.patches[to];
    const glm::vec3 d = s.position - r.position;
    if (glm::dot(d, d) > shader::kClosePair * shader::kClosePair * s.area)
        return shader::discFormFactor(r.position, r.shading, s.position, s.normal, s.area);
    const shader::PatchEdges& e = input_.patches.edges[to];
    return shader::parallelogramFormFactor(r.position, r.shading, s.position, e.du, e.dv, s.normal);
}

PatchValues PatchInspector::seenFrom(uint32_t patch) {
    ASSERT(patch < input_.patches.count);
    const std::vector<uint32_t> seen =
        input_.patches.scene.rtrad ? seeingBitsRtrad(patch) : seeingBits(patch);
    PatchValues values(input_.patches.scene.patches.size(), glm::vec4(0.0f));
    float largest = 0.0f;
    for (uint32_t i = 0; i < input_.patches.count; ++i) {
        if (seen[i] == 0) continue;
        const float factor = formFactor(patch, i);
        if (!(factor > 0.0f)) continue;
        values[i] = {1.0f, factor, 0.0f, 1.0f};
        largest = std::max(largest, factor);
    }
    for (glm::vec4& v : values)
        v.g = largest > 0.0f ? v.g / largest : 0.0f;
    values[patch].b = 1.0f;
    return values;
}

// Returns per patch 1 when nothing is between it and the one that is asked about.
std::vector<uint32_t> PatchInspector::seeingBits(uint32_t patch) {
    const PatchSet& set = input_.patches;
    // A batch has 65,536 rays on a GPU, 4,096 on the CPU: a few milliseconds.
    const uint32_t atOnce = std::min(input_.device.info().software() ? 64u : 1024u, set.chunkCount());
    const uint64_t count = uint64_t{atOnce} * kChunk;
    const auto hostBuffer = [&](uint64_t size, const char* name) {
        return vk::Buffer(input_.device, {.size = size, .memory = vk::Memory::Host, .name = name});
    };
    const vk::Buffer targets = hostBuffer(count * sizeof(glm::vec4), "segment ends");
    const vk::Buffer bits = hostBuffer(count * sizeof(uint32_t), "seeing patches");
    const vk::Buffer rays = rayCounters(input_.device);
    const shader::Patch& to = set.scene.patches[patch];
    const glm::vec3 end = to.position + to.offset * to.normal;
    std::vector<uint32_t> seen(set.scene.patches.size());
    vk::Commands commands(input_.device);
    for (uint32_t first = 0; first < set.chunkCount(); first += atOnce) {
        const uint32_t chunks = std::min(atOnce, set.chunkCount() - first), patches = chunks * kChunk;
        for (uint32_t i = 0; i < patches; ++i) {
            const bool faces = shader::pairFaces(set.scene.patches[first * kChunk + i], to);
            targets.as<glm::vec4>()[i] = glm::vec4(end, faces ? 1.0f : 0.0f);
        }
        VkCommandBuffer cmd = commands.begin();
        input_.tracer.segments(cmd, {.firstChunk = first,
                                     .chunkCount = chunks,
                                     .targetCount = 1,
                                     .targets = &targets,
                                     .bits = &bits,
                                     .rays = &rays});
        vk::hostBarrier(cmd);
        commands.run();
        for (uint32_t i = 0; i < patches; ++i)
            seen[first * kChunk + i] = bits.as<uint32_t>()[i] & 1u;
    }
    return seen;
}

// Does the same in the preset, whose ray intervals are known to occlusion() alone: all of the patch's chunk
// are asked, block by block, those of some super-blocks at a time.
std::vector<uint32_t> PatchInspector::seeingBitsRtrad(uint32_t patch) {
    using shader::kSuper;
    constexpr uint32_t kAtOnce = 16; // super-blocks, 2 MiB of bits; 256 blocks of them are asked
    const PatchSet& set = input_.patches;
    const auto hostBuffer = [&](uint64_t size, const char* name) {
        return vk::Buffer(input_.device, {.size = size, .memory = vk::Memory::Host, .name = name});
    };
    const vk::Buffer bits = hostBuffer(kAtOnce * superBytes(false), "seen patches");
    const vk::Buffer sends = hostBuffer(set.chunkCount() * sizeof(uint32_t), "chunk sends");
    const vk::Buffer table = hostBuffer(kAtOnce * sizeof(SuperBlock), "super-blocks");
    const vk::Buffer rays = rayCounters(input_.device);
    std::fill_n(sends.as<uint32_t>(), set.chunkCount(), 1u);
    const uint32_t own = patch / kChunk, supers = (set.chunkCount() + kSuper - 1) / kSuper;
    std::vector<uint32_t*> words;
    for (uint32_t s = 0; s < kAtOnce; ++s)
        words.push_back(bits.as<uint32_t>() + s * superBytes(false) / sizeof(uint32_t));
    const auto unitOf = [&](uint32_t chunk) {
        return std::min(own, chunk) % kSuper * kSuper + std::max(own, chunk) % kSuper;
    };
    std::vector<uint32_t> seen(set.scene.patches.size());
    vk::Commands commands(input_.device);
    for (uint32_t first = 0; first < supers; first += kAtOnce) {
        const uint32_t count = std::min(kAtOnce, supers - first);
        for (uint32_t s = 0; s < count; ++s) {
            const auto [row, column] = std::minmax({own / kSuper, first + s});
            table.as<SuperBlock>()[s] = {row, column, bits.address() + s * superBytes(false), {}, {}, 0};
        }
        const uint32_t firstChunk = first * kSuper,
                       endChunk = std::min((first + count) * kSuper, set.chunkCount());
        VkCommandBuffer cmd = commands.begin();
        for (uint32_t chunk = firstChunk; chunk < endChunk; ++chunk) {
            input_.tracer.occlusion(
                cmd, {.supers = {table.as<SuperBlock>(), count},
                      .superBuffer = &table,
                      .bits = words,
                      .firstUnit = (chunk / kSuper - first) * shader::kSuperBlocks + unitOf(chunk),
                      .unitCount = 1,
                      .sends = &sends,
                      .rays = &rays});
        }
        vk::hostBarrier(cmd);
        commands.run();
        for (uint32_t index = firstChunk * kChunk; index < endChunk * kChunk; ++index) {
            const uint32_t chunk = index / kChunk;
            const uint32_t* block = words[chunk / kSuper - first] + unitOf(chunk) * shader::kBlockWords;
            const uint32_t r = std::min(patch, index) % kChunk, c = std::max(patch, index) % kChunk;
            seen[index] = index == patch ? 0 : block[r * 2 + c / 32] >> c % 32 & 1u;
        }
    }
    return seen;
}

std::vector<PatchInspector::Link> PatchInspector::links(uint32_t patch, uint32_t count) {
    ASSERT(patch < input_.patches.count && count >= 8 && count % 8 == 0);
    const PatchSet& set = input_.patches;
    std::vector<glm::vec2> points; // of the disc, where directions are not Sobol's
    if (input_.links.directions == DirectionSet::Lec)
        for (const glm::dvec2 p : evenRings(largestEmptyCircleDisc(count / shader::kReplicates)))
            points.emplace_back(p);
    const vk::Buffer disc = vk::makeBuffer(input_.device, points, "directions");
    const vk::Buffer ids(
        input_.device,
        {.size = uint64_t{count} * kChunk * sizeof(uint32_t), .memory = vk::Memory::Host, .name = "links"});
    const auto discCount = static_cast<uint32_t>(points.size());
    vk::Commands commands(input_.device);
    VkCommandBuffer cmd = commands.begin();
    input_.tracer.closest(cmd, {.firstChunk = patch / kChunk,
                                .chunkCount = 1,
                                .firstSample = 0,
                                .sampleCount = count,
                                .rotation = input_.links.rotation,
                                .disc = discCount > 0 ? &disc : nullptr,
                                .discCount = discCount,
                                .links = &ids});
    vk::hostBarrier(cmd);
    commands.run();
    const shader::Patch& p = set.scene.patches[patch];
    const uint32_t key = shader::rotationKey(p, set.scene.patches[patch / kChunk * kChunk],
                                             static_cast<uint32_t>(input_.links.rotation), set.scene.size);
    const float size = sceneSize(set);
    std::vector<Link> result;
    for (uint32_t k = 0; k < count; ++k) {
        const uint32_t id = ids.as<uint32_t>()[size_t{k} * kChunk + patch % kChunk];
        if (id < shader::kLinkFirstSpecial) {
            result.push_back({id, set.scene.patches[id].position});
            continue;
        }
        const uint32_t seed = discCount > 0 ? shader::discSeed(key, k, discCount) : 0u;
        const glm::vec3 direction =
            discCount > 0
                ? shader::aroundPatch(p, shader::discDirection(points[shader::discPoint(k, discCount, seed)],
                                                               discCount, seed))
                : shader::patchDirection(p, key, k);
        // Nobody has kept how far away a hit was that is no patch: a short stroke says only where to.
        constexpr float kStroke = 0.05f; // of the scene
        result.push_back({id, p.position + direction * size * (id == shader::kLinkSky ? 1.0f : kStroke)});
    }
    return result;
}

PatchInspector::Voxels PatchInspector::voxels(uint32_t resolution) const {
    const std::string problem = tracerProblem(TracerKind::Voxel, input_.device.info());
    if (!problem.empty()) throw Error(input_.device.info().name + ": no voxel map: " + problem);
    const VoxelMap map(input_.device, input_.patches.scene, {.resolution = resolution},
                       input_.light.patches.address());
    const std::vector<uint32_t> words = map.readBits(input_.device);
    const shader::VoxelGrid& grid = map.grid();
    Voxels voxels;
    for (int axis = 0; axis < 3; ++axis) // flat scenes of the preset have no scale across
        voxels.edge[axis] = grid.scale[axis] > 0.0f ? 1.0f / grid.scale[axis] : 0.0f;
    voxels.centres.reserve(map.setVoxels());
    for (size_t w = 0; w < words.size(); ++w) {
        for (uint32_t rest = words[w]; rest != 0; rest &= rest - 1) {
            const size_t index = w * 32 + static_cast<size_t>(std::countr_zero(rest));
            const glm::vec3 voxel(index % resolution, index / resolution % resolution,
                                  index / resolution / resolution);
            voxels.centres.push_back(grid.origin + (voxel + 0.5f) * voxels.edge);
        }
    }
    return voxels;
}

} // namespace relume
