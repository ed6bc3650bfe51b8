#include "bake/trace/embree_scene.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>
#include <type_traits>

#include "assets/base/error.h"
#include "bake/trace/embree_api.h"
#include "bake/trace/embree_blockers.h"
#include "bake/trace/embree_chunks.h"
#include "bake/trace/embree_packet.h"
#include "bake/trace/embree_rays.h"
#include "bake/trace/embree_shaft.h"

namespace relume {

using shader::kChunk;
using shader::Patch;
using shader::PatchCover;

namespace shader {
namespace {

// Gives the shared alpha test and hit lookup this scene's tables.
struct AlphaTables {
    const uint8_t* texels;
    float alphaTexel(uint offset) { return float(texels[offset]) / 255.0f; }
#include "shaders/lib/rays/alpha.glsl"
};

struct HitTables {
    const TraceScene& scene;
    uint texelPatch(uint texel) { return scene.texelToPatch[texel]; }
    uint chartOfPatch(uint patch) { return scene.sendingChart(patch); }
#include "shaders/lib/rays/hit.glsl"
};

} // namespace
} // namespace shader

namespace {

constexpr uint32_t kPacket = OcclusionPacket::kRays;

struct DeviceRelease {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

uint32_t countBits(const std::array<uint64_t, kChunk>& rows, uint64_t rowMask, uint64_t columnMask) {
    uint32_t count = 0;
    for (; rowMask != 0; rowMask &= rowMask - 1)
        count += uint32_t(std::popcount(rows[size_t(std::countr_zero(rowMask))] & columnMask));
    return count;
}

constexpr uint32_t kNone = ~0u;

// Takes note of an opaque triangle that stops an occlusion ray.
void noteBlocker(const RTCFilterFunctionNArguments* args) {
    for (uint32_t lane = 0; lane < args->N; ++lane)
        if (args->valid[lane] != 0)
            static_cast<EmbreeOccludedQuery::Context*>(args->context)->blocker =
                RTCHitN_primID(args->hit, args->N, lane);
}

// Drops hits in the holes of masked triangles, for both kinds of query.
void keepSolid(const RTCFilterFunctionNArguments* args) {
    const TraceScene& scene = *static_cast<const TraceScene*>(args->geometryUserPtr);
    shader::AlphaTables tables{scene.alphaTexels.data()};
    for (uint32_t lane = 0; lane < args->N; ++lane) {
        if (args->valid[lane] == 0) continue;
        const shader::AlphaTriangle& triangle =
            scene.alphaTriangles[RTCHitN_primID(args->hit, args->N, lane)];
        const float b1 = RTCHitN_u(args->hit, args->N, lane), b2 = RTCHitN_v(args->hit, args->N, lane);
        if (!tables.alphaSolid(triangle, scene.alphaMaterials[triangle.material], b1, b2))
            args->valid[lane] = 0;
    }
}

} // namespace

struct EmbreeScene::Impl {
    Impl(const TraceScene& traceScene, WorkerPool& workers);
    void attach(uint32_t first, uint32_t last, bool masked);
    struct Block {
        const PatchChunk& a;   // receivers
        const PatchChunk& b;   // senders
        bool diagonal = false; // the same chunk: of each pair the one in which a's patch comes first
        bool reversed = false; // RTRad's rays start at b
        std::array<uint64_t, kChunk> turned{}; // bit j of word i: the ray starts at b's patch j
    };
    uint32_t trace(const Block& block, uint32_t* bits) const;
    uint32_t listBlock(const OcclusionArrays& work, uint32_t row, uint32_t column, uint32_t* bits) const;
    void dropOpenPairs(const PatchChunk& a, const PatchChunk& b, std::array<uint64_t, kChunk>& rows) const;
    void build();
    void prepareBlocks();
    void links(const Patch* patches, const ChunkRays& directions, std::span<const uint16_t> order,
               uint32_t* out, bool silent = false) const;
    uint32_t linksAgain(const RetraceArrays& work, uint32_t chunk, uint32_t piece) const;
    uint32_t link(const RTCRayHit8& rays, uint32_t lane) const;
    uint32_t targets(const SegmentArrays& work, uint32_t chunk, uint32_t first, uint32_t* bits) const;

    const TraceScene& scene;
    WorkerPool& pool;
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, DeviceRelease> device;
    std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneRelease> embree;
    std::vector<PatchChunk> chunks;
    Bvh bvh; // for shafts
};

EmbreeScene::Impl::Impl(const TraceScene& traceScene, WorkerPool& workers)
    : scene(traceScene), pool(workers) {
    const std::string config = "threads=" + std::to_string(pool.size());
    device.reset(rtcNewDevice(config.c_str()));
    if (!device)
        throw Error("embree: no device (error " + std::to_string(rtcGetDeviceError(nullptr)) +
                    "): pass --tracer bvh");
    build();
}

// Makes what only blocks need, when they are asked for, from patches as they are marked by then.
void EmbreeScene::Impl::prepareBlocks() {
    chunks = buildChunks(scene.patches, scene.rtrad);
    std::vector<uint32_t> all(scene.mesh.triangleCount());
    std::iota(all.begin(), all.end(), 0u);
    bvh = buildBvh(
        scene.mesh,
        {.triangles = all, .margin = bvhMargin(bvhReach(scene.mesh)), .pool = &pool, .reinsert = false});
}

void EmbreeScene::Impl::build() {
    embree.reset(rtcNewScene(device.get()));
    rtcSetSceneFlags(embree.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(embree.get(), RTC_BUILD_QUALITY_HIGH);
    attach(0, scene.mesh.opaqueCount, false);
    attach(scene.mesh.opaqueCount, scene.mesh.triangleCount(), true);
    rtcCommitScene(embree.get());
    const RTCError error = rtcGetDeviceError(device.get());
    if (error != RTC_ERROR_NONE)
        throw Error("embree: no acceleration structure for " + std::to_string(scene.mesh.triangleCount()) +
                    " triangles (error " + std::to_string(error) +
                    "): free some memory or pass --tracer bvh");
}

// Geometry 0 holds the opaque triangles, geometry 1 the masked ones.
void EmbreeScene::Impl::attach(uint32_t first, uint32_t last, bool masked) {
    if (first == last) return;
    const uint32_t count = last - first;
    RTCGeometry geometry = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    // The buffers are Embree's own: it reads 16 bytes at a 12-byte stride, past the end of ours.
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(glm::vec3), size_t(count) * 3);
    void* indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                            3 * sizeof(uint32_t), count);
    if (!vertices || !indices) {
        rtcReleaseGeometry(geometry);
        throw Error("embree: no memory for " + std::to_string(count) +
                    " triangles: free some or pass --tracer bvh");
    }
    std::memcpy(vertices, &scene.mesh.positions[size_t(first) * 3], size_t(count) * 3 * sizeof(glm::vec3));
    for (uint32_t i = 0; i < count * 3; ++i)
        static_cast<uint32_t*>(indices)[i] = i;
    if (masked) {
        rtcSetGeometryUserData(geometry, const_cast<TraceScene*>(&scene));
        rtcSetGeometryIntersectFilterFunction(geometry, keepSolid);
        rtcSetGeometryOccludedFilterFunction(geometry, keepSolid);
    } else {
        rtcSetGeometryOccludedFilterFunction(geometry, noteBlocker);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(embree.get(), geometry, masked ? 1 : 0);
    rtcReleaseGeometry(geometry);
}

// Clears pairs in open shafts, which see each other, from `rows`; the pairs that are left need rays. First
// the whole block is tried, then the pairs of quarters.
void EmbreeScene::Impl::dropOpenPairs(const PatchChunk& a, const PatchChunk& b,
                                      std::array<uint64_t, kChunk>& rows) const {
    constexpr uint32_t kWorthwhile = 32; // rays that cost as much as one look at a shaft
    if (countBits(rows, ~uint64_t(0), ~uint64_t(0)) < kWorthwhile) return;
    if (Shaft(a, a.ends, b, b.ends).isOpen(bvh)) return rows.fill(0);
    for (size_t qa = 0; qa < 4; ++qa) {
        for (size_t qb = 0; qb < 4; ++qb) {
            if (countBits(rows, kQuarter[qa], kQuarter[qb]) < kWorthwhile) continue;
            if (!Shaft(a, a.quarterEnds[qa], b, b.quarterEnds[qb]).isOpen(bvh)) continue;
            for (uint64_t rest = kQuarter[qa]; rest != 0; rest &= rest - 1)
                rows[size_t(std::countr_zero(rest))] &= ~kQuarter[qb];
        }
    }
}

// Traces the rays of a block and returns the number of facing pairs.
uint32_t EmbreeScene::Impl::trace(const Block& block, uint32_t* bits) const {
    const PatchChunk &a = block.a, &b = block.b;
    std::array<uint64_t, kChunk> visible{};
    if (chunksMayFace(a, b)) facingRows(a, b, visible);
    if (block.diagonal)
        for (uint32_t i = 0; i < kChunk; ++i)
            visible[i] &= ~(uint64_t(2) << i) + 1;
    const uint32_t pairs = countBits(visible, ~uint64_t(0), ~uint64_t(0));
    std::array<uint64_t, kChunk> asked = visible;
    dropOpenPairs(a, b, asked);
    Blockers blockers(scene.mesh.positions.data());
    OcclusionPacket packet(embree.get(), blockers, visible);
    for (uint32_t i = 0; i < kChunk; ++i) {
        const glm::vec3 origin(a.ex[i], a.ey[i], a.ez[i]);
        // RTRad's rays end well before the patches, where a triangle may stand.
        const uint64_t hidden = scene.rtrad ? 0 : blockers.stopped(origin, b, asked[i]);
        visible[i] &= ~hidden;
        for (uint64_t rest = asked[i] & ~hidden; rest != 0; rest &= rest - 1) {
            const uint32_t j = uint32_t(std::countr_zero(rest));
            const glm::vec3 end(b.ex[j], b.ey[j], b.ez[j]);
            const bool turned = scene.rtrad ? block.reversed : (block.turned[i] >> j & 1) != 0;
            shader::Segment segment = turned ? shader::Segment{end, origin - end, 0.0f, 1.0f}
                                             : shader::Segment{origin, end - origin, 0.0f, 1.0f};
            if (scene.rtrad) {
                const float distance = glm::length(segment.direction);
                segment = {segment.origin, segment.direction / distance, 0.001f, distance - 0.002f};
                if (segment.tMax <= segment.tMin) continue;
            }
            packet.add(i, j, segment);
        }
    }
    packet.trace();
    std::memcpy(bits, visible.data(), sizeof(visible));
    return pairs;
}

// Traces a chunk of patches against a chunk of a sender list.
uint32_t EmbreeScene::Impl::listBlock(const OcclusionArrays& work, uint32_t row, uint32_t column,
                                      uint32_t* bits) const {
    std::array<Patch, kChunk> patches{};
    const uint32_t rowKey = shader::patchTexel(scene.patches[size_t{row} * kChunk].flags);
    std::array<uint32_t, kChunk> index;
    for (uint32_t j = 0; j < kChunk; ++j) {
        const shader::Sender& sender = work.senders[size_t{column} * kChunk + j];
        index[j] =
            sender.count == 0 ? kNone : work.members[sender.first + shader::drawMember(sender, rowKey)];
        if (index[j] != kNone) patches[j] = scene.patches[index[j]];
    }
    const PatchChunk senders = buildChunk(patches.data(), scene.rtrad);
    Block block{.a = chunks[row], .b = senders};
    // A ray starts at the patch of the lower index, whichever end asks.
    for (uint32_t j = 0; j < kChunk; ++j)
        for (uint32_t i = 0; i < kChunk; ++i)
            block.turned[i] |= uint64_t{index[j] < row * kChunk + i} << j;
    return trace(block, bits);
}

void EmbreeScene::occlusion(const OcclusionArrays& work) {
    if (impl_->chunks.empty()) impl_->prepareBlocks();
    const Impl& impl = *impl_;
    const bool list = !work.senders.empty();
    const uint32_t rows = impl.scene.chunkCount();
    const uint32_t columns = list ? uint32_t(work.senders.size() / kChunk) : rows;
    impl_->pool.run(work.unitCount, [&](uint32_t k) {
        const uint32_t unit = work.firstUnit + k, local = unit % shader::kSuperBlocks;
        const SuperBlock& super = work.supers[unit / shader::kSuperBlocks];
        const uint32_t row = super.row * shader::kSuper + local / shader::kSuper;
        const uint32_t column = super.column * shader::kSuper + local % shader::kSuper;
        if (row >= rows || column >= columns || (!list && row > column)) return;
        if (work.sends[column] == 0 && (list || work.sends[row] == 0)) return;
        if (shader::unitKnown(super, local)) return;
        uint32_t* bits = work.bits[unit / shader::kSuperBlocks] + size_t{local} * shader::kBlockWords +
                         (work.reversed ? shader::kSuperWords : 0);
        const uint32_t rays = list ? impl.listBlock(work, row, column, bits)
                                   : impl.trace({.a = impl.chunks[row],
                                                 .b = impl.chunks[column],
                                                 .diagonal = row == column,
                                                 .reversed = work.reversed},
                                                bits);
        const uint32_t slot = super.counters + unit % shader::kRayCounters;
        if (work.rays && rays > 0) std::atomic_ref(work.rays[slot]) += rays;
    });
}

// Turns a lane's hit into the link that the gather reads.
uint32_t EmbreeScene::Impl::link(const RTCRayHit8& rays, uint32_t lane) const {
    const RTCHit8& hit = rays.hit;
    if (hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) return shader::kLinkSky;
    const uint32_t triangle = hit.primID[lane] + (hit.geomID[lane] == 0 ? 0 : scene.mesh.opaqueCount);
    const shader::HitTriangle& target = scene.hitTriangles[triangle];
    const glm::vec3 direction(rays.ray.dir_x[lane], rays.ray.dir_y[lane], rays.ray.dir_z[lane]);
    if (glm::dot(direction, target.normal) > 0)
        return target.doubleSided ? shader::kLinkDark : shader::kLinkBack;
    if (target.representative == shader::kNoPatch) return shader::kLinkDark;
    shader::HitTables tables{scene};
    return tables.patchAtHit(target, hit.u[lane], hit.v[lane], scene.size);
}

// Finds the links of the rays of these numbers.
void EmbreeScene::Impl::links(const Patch* patches, const ChunkRays& directions,
                              std::span<const uint16_t> order, uint32_t* out, bool silent) const {
    EmbreeIntersectQuery query;
    alignas(64) RTCRayHit8 rays;
    alignas(64) std::array<int, kPacket> valid;
    for (size_t first = 0; first < order.size(); first += kPacket) {
        const auto count = uint32_t(std::min<size_t>(kPacket, order.size() - first));
        for (uint32_t lane = 0; lane < kPacket; ++lane) {
            const uint32_t number = order[first + std::min(lane, count - 1)];
            const Patch& patch = patches[number % kChunk];
            valid[lane] = lane < count && shader::asksAgain(patch, silent) ? -1 : 0;
            const glm::vec3 origin = directions.origin(number);
            rays.ray.org_x[lane] = origin.x, rays.ray.org_y[lane] = origin.y, rays.ray.org_z[lane] = origin.z;
            rays.ray.dir_x[lane] = directions.x[number], rays.ray.dir_y[lane] = directions.y[number];
            rays.ray.dir_z[lane] = directions.z[number];
            rays.ray.tnear[lane] = 0, rays.ray.tfar[lane] = std::numeric_limits<float>::infinity();
            rays.ray.time[lane] = 0;
            rays.ray.mask[lane] = ~0u;
            rays.ray.id[lane] = lane;
            rays.ray.flags[lane] = 0;
            rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
            rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        }
        embreeIntersect(valid.data(), embree.get(), query, rays);
        for (uint32_t lane = 0; lane < count; ++lane) {
            uint32_t& found = out[order[first + lane]];
            found = valid[lane] ? link(rays, lane) : shader::kLinkDark;
            if (found == shader::kLinkSky && directions.mirror[order[first + lane]] < 0.0f)
                found = shader::kLinkSkyBelow;
        }
    }
}

// Traces those links again that a move may have changed, and returns how many rays there were.
uint32_t EmbreeScene::Impl::linksAgain(const RetraceArrays& work, uint32_t chunk, uint32_t piece) const {
    const ClosestArrays& c = work.closest;
    const Patch* patches = &scene.patches[size_t(c.firstChunk + chunk) * kChunk];
    const glm::uvec2 words = work.changed[c.firstChunk + chunk];
    const uint64_t changed = words.x | uint64_t(words.y) << 32;
    uint64_t above = 0, sends = 0;
    for (uint32_t i = 0; i < kChunk; ++i) {
        sends |= uint64_t(shader::asksAgain(patches[i], work.silent)) << i;
        for (const shader::TraceBox& box : work.boxes)
            above |= uint64_t(shader::boxAbove(patches[i].position, patches[i].normal, box)) << i;
    }
    above &= sends & ~changed;
    const uint32_t first = piece * ChunkRays::kSamplesMax;
    const uint32_t samples = std::min(ChunkRays::kSamplesMax, c.sampleCount - first);
    uint32_t* const links = c.links + (size_t(chunk) * c.sampleCount + first) * kChunk;
    const auto endsElsewhere = [&](uint32_t link) {
        return work.ends && link < shader::kLinkFirstSpecial &&
               shader::hasPatch(work.ends[link / kChunk], link % kChunk);
    };
    if ((above | changed) == 0 &&
        (!work.ends || std::none_of(links, links + size_t{samples} * kChunk, endsElsewhere)))
        return 0;
    ChunkRays rays;
    const PatchCover* covers = c.covers ? c.covers + size_t(c.firstChunk + chunk) * kChunk : nullptr;
    rays.setPatches(patches, covers, static_cast<uint32_t>(c.rotation), scene.size);
    rays.setSamples(c.firstSample + first, samples);
    const auto again = [&](uint32_t number) {
        const uint32_t i = number % kChunk;
        if ((changed >> i & 1) != 0 || endsElsewhere(links[number])) return true;
        if ((above >> i & 1) == 0) return false;
        const glm::vec3 origin = rays.origin(number);
        const glm::vec3 direction(rays.x[number], rays.y[number], rays.z[number]);
        return std::any_of(work.boxes.begin(), work.boxes.end(), [&](const shader::TraceBox& box) {
            return shader::rayMeetsBox(origin, direction, box);
        });
    };
    ChunkRays::Rays<uint16_t> order;
    uint32_t count = 0, traced = 0;
    for (uint32_t n = 0; n < rays.count(); ++n) {
        const uint16_t number = rays.order()[n];
        if (!again(number)) continue;
        order[count++] = number;
        traced += uint32_t(sends >> number % kChunk & 1);
    }
    this->links(patches, rays, {order.data(), count}, links, work.silent);
    return traced;
}

void EmbreeScene::retrace(const RetraceArrays& work) {
    const Impl& impl = *impl_;
    constexpr uint32_t kPiece = ChunkRays::kSamplesMax;
    const uint32_t pieces = (work.closest.sampleCount + kPiece - 1) / kPiece;
    impl_->pool.run(work.closest.chunkCount * pieces, [&](uint32_t k) {
        const uint32_t rays = impl.linksAgain(work, k / pieces, k % pieces);
        const uint32_t slot = (work.closest.firstChunk + k / pieces) % shader::kRayCounters;
        if (work.rays && rays > 0) std::atomic_ref(work.rays[slot]) += rays;
    });
}

void EmbreeScene::update() {
    impl_->build();
    impl_->chunks.clear(); // blocks are seldom asked for then
}

void EmbreeScene::closest(const ClosestArrays& work) {
    const Impl& impl = *impl_;
    constexpr uint32_t kPiece = ChunkRays::kSamplesMax;
    const uint32_t pieces = (work.sampleCount + kPiece - 1) / kPiece;
    const Patch* receivers = work.receivers ? work.receivers : impl.scene.patches.data();
    impl_->pool.run(work.chunkCount * pieces, [&](uint32_t k) {
        const uint32_t chunk = k / pieces, first = k % pieces * kPiece;
        const size_t firstPatch = size_t(work.firstChunk + chunk) * kChunk;
        const Patch* patches = receivers + firstPatch;
        const PatchCover* covers = work.covers && !work.receivers ? work.covers + firstPatch : nullptr;
        ChunkRays rays;
        if (work.disc) rays.setDisc(work.disc, work.discCount);
        rays.setPatches(patches, covers, static_cast<uint32_t>(work.rotation), impl.scene.size);
        rays.setSamples(work.firstSample + first, std::min(kPiece, work.sampleCount - first));
        impl.links(patches, rays, {rays.order().data(), rays.count()},
                   work.links + (size_t(chunk) * work.sampleCount + first) * kChunk);
    });
}

// Writes a word of bits for each of a chunk's patches, for targets from `first` on, and returns the number of
// rays. Rays of neighbouring patches to the same target fill a packet.
uint32_t EmbreeScene::Impl::targets(const SegmentArrays& work, uint32_t chunk, uint32_t first,
                                    uint32_t* bits) const {
    const size_t firstPatch = size_t{work.chunkOf(chunk)} * kChunk;
    const Patch* patches = &scene.patches[firstPatch];
    const glm::vec4* ends = work.targets + (size_t(chunk) * work.targetCount + first) * kChunk;
    const uint32_t count = std::min(kTargetsPerWord, work.targetCount - first);
    ChunkStarts starts;
    ChunkStarts::Points points;
    starts.setPatches(patches, work.covers ? work.covers + firstPatch : nullptr);
    starts.make(0, points);
    std::array<uint64_t, kChunk> free{}; // per target, a bit for each patch
    Blockers blockers(scene.mesh.positions.data());
    OcclusionPacket packet(embree.get(), blockers, free);
    uint32_t rays = 0;
    for (uint32_t s = 0; s < count; ++s) {
        const glm::vec4* to = ends + size_t{s} * kChunk;
        if (std::none_of(to, to + kChunk, [](const glm::vec4& end) { return end.w > 0.0f; })) continue;
        if (starts.move())
            starts.make(shader::startNumber(first + s, work.samplePass, work.turn, work.run), points);
        for (uint32_t i = 0; i < kChunk; ++i) {
            if (!(to[i].w > 0.0f)) continue;
            const glm::vec3 origin =
                glm::vec3(points.x[i], points.y[i], points.z[i]) + patches[i].offset * patches[i].normal;
            free[s] |= uint64_t{1} << i;
            packet.add(s, i, {origin, glm::vec3(to[i]) - origin, 0.0f, 1.0f});
            ++rays;
        }
    }
    packet.trace();
    for (uint32_t i = 0; i < kChunk; ++i) {
        bits[i] = 0;
        for (uint32_t s = 0; s < count; ++s)
            bits[i] |= uint32_t(free[s] >> i & 1) << s;
    }
    return rays;
}

void EmbreeScene::segments(const SegmentArrays& work) {
    const Impl& impl = *impl_;
    const uint32_t words = (work.targetCount + kTargetsPerWord - 1) / kTargetsPerWord;
    impl_->pool.run(work.chunkCount * words, [&](uint32_t k) {
        const uint32_t chunk = k / words, first = k % words * kTargetsPerWord;
        const uint32_t rays = impl.targets(work, chunk, first, work.bits + size_t(k) * kChunk);
        const uint32_t slot = (work.firstChunk + chunk) % shader::kRayCounters;
        if (work.rays && rays > 0) std::atomic_ref(work.rays[slot]) += rays;
    });
}

EmbreeScene::EmbreeScene(const TraceScene& scene, WorkerPool& pool)
    : impl_(std::make_unique<Impl>(scene, pool)) {}
EmbreeScene::~EmbreeScene() = default;

} // namespace relume
