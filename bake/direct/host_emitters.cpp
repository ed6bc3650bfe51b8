#include "bake/direct/host_emitters.h"

#include <algorithm>
#include <array>
#include <vector>

namespace relume {
namespace {

using shader::EmitterPolygon;
using shader::kChunk;
using shader::PolygonRest;
using Lane = PatchLanes::Lane;
using Flags = std::array<uint32_t, kChunk>; // mostly 0 or 1

// Points on near polygons are found for so many neighbours at once: two vectors of AVX2.
constexpr uint32_t kBlock = 16;

// Says which of the samples is made, and of what.
struct SampleDesc {
    const EmitterPolygon& polygon;
    uint32_t emitter; // its number
    uint32_t number;  // of the sample, among those of all sample passes
    glm::vec3 off;    // from the polygon to where rays end [m]
};

// What a sample of all patches needs and gives.
struct SampleLanes {
    Flags shines;    // the patch takes part, and light can come from the polygon
    TargetLanes out; // of polygons that are even
    Lane u, v;       // where in the unit square the point is
    Flags uneven;    // the polygon is near: the point is to be found by halving it
};

template<typename T>
using Block = std::array<T, kBlock>;

// What is left of the polygon for the patches of a block whose points are found by halving, by component.
struct RestLanes {
    Block<float> ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz;
    Block<float> u, v, weight, whole;
    Block<uint32_t> uneven; // 1: to be halved further
};

// The patches of a block, by component.
struct BlockLanes {
    Block<float> px, py, pz, sx, sy, sz, nx, ny, nz; // where the sample starts, shading normal, normal
    Block<float> offset;
    Block<float> x, y, z, w; // targets
};

// The loops below have a form that compilers turn into vector code. They are always inlined, to be compiled
// once for each instruction set.

[[gnu::always_inline]] inline void formFactorLanes(const PatchLanes& lanes, const ChunkStarts::Points& at,
                                                   const EmitterPolygon& polygon, Lane& out) {
    const EmitterPolygon e = polygon;
#pragma GCC ivdep
    for (uint32_t i = 0; i < kChunk; ++i)
        out[i] = shader::emitterFormFactor({at.x[i], at.y[i], at.z[i]},
                                           {lanes.sx[i], lanes.sy[i], lanes.sz[i]}, e);
}

[[gnu::always_inline]] inline void unevenLanes(const PatchLanes& lanes, const EmitterPolygon& polygon,
                                               Flags& out) {
    const EmitterPolygon e = polygon;
#pragma GCC ivdep
    for (uint32_t i = 0; i < kChunk; ++i)
        out[i] = shader::unevenness(
            lanes.size[i],
            shader::polygonDistance({lanes.middle.x[i], lanes.middle.y[i], lanes.middle.z[i]}, e));
}

[[gnu::always_inline]] inline void sampleLane(const PatchLanes& lanes, const SampleDesc& desc,
                                              const EmitterPolygon& e, const shader::PolygonPart& part,
                                              uint32_t i, SampleLanes& sample) {
    const glm::vec3 p(lanes.at.x[i], lanes.at.y[i], lanes.at.z[i]);
    const glm::vec3 shading(lanes.sx[i], lanes.sy[i], lanes.sz[i]);
    const glm::vec3 normal(lanes.nx[i], lanes.ny[i], lanes.nz[i]);
    const uint32_t seed = shader::emitterPointSeed(lanes.key[i], desc.number, desc.emitter);
    const glm::vec2 u = shader::sobolPoint(shader::replicateIndex(desc.number), seed);
    const glm::vec3 y = shader::partPoint(part, u), end = y + desc.off;
    const float factor = shader::emitterPointFactor(p, shading, e, y);
    const bool above = glm::dot(y - p, normal) > lanes.offset[i];
    const bool shines = sample.shines[i] != 0;
    sample.out.x[i] = shines ? end.x : 0.0f;
    sample.out.y[i] = shines ? end.y : 0.0f;
    sample.out.z[i] = shines ? end.z : 0.0f;
    sample.out.w[i] = shines ? (above ? factor : -factor) : 0.0f;
    sample.u[i] = u.x, sample.v[i] = u.y;
    sample.uneven[i] = sample.shines[i] & (shader::isEven(p, part) ? 0u : 1u);
}

// Makes the samples as if the polygon were even, with the shape known to compilers.
template<uint32_t kShape>
[[gnu::always_inline]] inline void sampleLanes(const PatchLanes& lanes, const SampleDesc& desc,
                                               SampleLanes& sample) {
    const EmitterPolygon e = desc.polygon;
    shader::PolygonPart part = shader::emitterPart(e);
    part.shape = kShape;
#pragma GCC ivdep
    for (uint32_t i = 0; i < kChunk; ++i)
        sampleLane(lanes, desc, e, part, i, sample);
}

// The rest goes to a place of its own: compilers would make a store that depends on a condition of one that
// keeps what is there, and no vector code.
template<uint32_t kShape, uint32_t kLevel>
[[gnu::always_inline]] inline void halveLane(const BlockLanes& on, const RestLanes& r, float split,
                                             uint32_t i, RestLanes& out) {
    const glm::vec3 p(on.px[i], on.py[i], on.pz[i]), shading(on.sx[i], on.sy[i], on.sz[i]);
    PolygonRest rest;
    rest.part.a = {r.ax[i], r.ay[i], r.az[i]};
    rest.part.b = {r.bx[i], r.by[i], r.bz[i]};
    rest.part.c = {r.cx[i], r.cy[i], r.cz[i]};
    rest.part.d = {r.dx[i], r.dy[i], r.dz[i]};
    rest.part.shape = kShape;
    rest.part.split = split;
    rest.u = {r.u[i], r.v[i]};
    rest.weight = r.weight[i];
    rest.whole = r.whole[i];
    const bool go = r.uneven[i] != 0;
    shader::halve(p, shading, kLevel, rest);
    out.ax[i] = go ? rest.part.a.x : r.ax[i];
    out.ay[i] = go ? rest.part.a.y : r.ay[i];
    out.az[i] = go ? rest.part.a.z : r.az[i];
    out.bx[i] = go ? rest.part.b.x : r.bx[i];
    out.by[i] = go ? rest.part.b.y : r.by[i];
    out.bz[i] = go ? rest.part.b.z : r.bz[i];
    out.cx[i] = go ? rest.part.c.x : r.cx[i];
    out.cy[i] = go ? rest.part.c.y : r.cy[i];
    out.cz[i] = go ? rest.part.c.z : r.cz[i];
    out.dx[i] = go ? rest.part.d.x : r.dx[i];
    out.dy[i] = go ? rest.part.d.y : r.dy[i];
    out.dz[i] = go ? rest.part.d.z : r.dz[i];
    out.u[i] = go ? rest.u.x : r.u[i];
    out.v[i] = go ? rest.u.y : r.v[i];
    out.weight[i] = go ? rest.weight : r.weight[i];
    out.whole[i] = go ? rest.whole : r.whole[i];
}

[[gnu::always_inline]] inline uint32_t isUneven(const BlockLanes& on, const RestLanes& r, uint32_t i) {
    shader::PolygonPart part;
    part.a = {r.ax[i], r.ay[i], r.az[i]};
    part.b = {r.bx[i], r.by[i], r.bz[i]};
    part.c = {r.cx[i], r.cy[i], r.cz[i]};
    part.d = {r.dx[i], r.dy[i], r.dz[i]};
    const uint32_t uneven = shader::isEven({on.px[i], on.py[i], on.pz[i]}, part) ? 0 : 1;
    return uneven & (r.whole[i] > 0.0f ? 1 : 0);
}

// Halves the parts of a block that are uneven once. Of the number of halvings before, only what is left by 2
// counts.
template<uint32_t kShape, uint32_t kLevel>
[[gnu::always_inline]] inline void halveLanes(const BlockLanes& on, const RestLanes& r, float split,
                                              RestLanes& out) {
#pragma GCC ivdep
    for (uint32_t i = 0; i < kBlock; ++i)
        halveLane<kShape, kLevel>(on, r, split, i, out);
#pragma GCC ivdep
    for (uint32_t i = 0; i < kBlock; ++i)
        out.uneven[i] = r.uneven[i] & isUneven(on, out, i);
}

template<uint32_t kShape>
[[gnu::always_inline]] inline void finishLane(const SampleDesc& desc, const EmitterPolygon& e,
                                              const RestLanes& r, uint32_t i, BlockLanes& on) {
    const glm::vec3 p(on.px[i], on.py[i], on.pz[i]), shading(on.sx[i], on.sy[i], on.sz[i]);
    shader::PolygonPart part;
    part.a = {r.ax[i], r.ay[i], r.az[i]};
    part.b = {r.bx[i], r.by[i], r.bz[i]};
    part.c = {r.cx[i], r.cy[i], r.cz[i]};
    part.d = {r.dx[i], r.dy[i], r.dz[i]};
    part.shape = kShape;
    part.split = 1.0f;
    const glm::vec3 y = shader::partPoint(part, {r.u[i], r.v[i]}), end = y + desc.off;
    const float factor = shader::emitterPointFactor(p, shading, e, y) * r.weight[i];
    const bool above = glm::dot(y - p, glm::vec3(on.nx[i], on.ny[i], on.nz[i])) > on.offset[i];
    on.x[i] = end.x, on.y[i] = end.y, on.z[i] = end.z;
    on.w[i] = above ? factor : -factor;
}

// Makes the points of a block where its halvings have ended.
template<uint32_t kShape>
[[gnu::always_inline]] inline void finishLanes(const SampleDesc& desc, const RestLanes& r, BlockLanes& on) {
    const EmitterPolygon e = desc.polygon;
#pragma GCC ivdep
    for (uint32_t i = 0; i < kBlock; ++i)
        finishLane<kShape>(desc, e, r, i, on);
}

// The loops as they are compiled for one instruction set. What is left of a quadrilateral that is halved is a
// triangle.
struct Loops {
    using Sample = void (*)(const PatchLanes&, const SampleDesc&, SampleLanes&);
    using Halve = void (*)(const BlockLanes&, const RestLanes&, float split, RestLanes&);
    using Finish = void (*)(const SampleDesc&, const RestLanes&, BlockLanes&);
    // What depends on the shape.
    struct Shape {
        Sample sample;
        Halve halveFirst;
        std::array<Halve, 2> halve; // after an even number of halvings, and after an odd one
        Finish finish;
    };
    void (*formFactors)(const PatchLanes&, const ChunkStarts::Points&, const EmitterPolygon&, Lane&);
    void (*uneven)(const PatchLanes&, const EmitterPolygon&, Flags&);
    Shape parallelogram, quad, triangle;

    const Shape& of(const EmitterPolygon& e) const {
        return e.shape == shader::kEmitterParallelogram ? parallelogram
               : e.shape == shader::kEmitterQuad        ? quad
                                                        : triangle;
    }
};

void formFactorsPlain(const PatchLanes& lanes, const ChunkStarts::Points& at, const EmitterPolygon& e,
                      Lane& out) {
    formFactorLanes(lanes, at, e, out);
}
void unevenPlain(const PatchLanes& lanes, const EmitterPolygon& e, Flags& out) {
    unevenLanes(lanes, e, out);
}
template<uint32_t kShape>
void samplePlain(const PatchLanes& lanes, const SampleDesc& desc, SampleLanes& out) {
    sampleLanes<kShape>(lanes, desc, out);
}
template<uint32_t kShape, uint32_t kLevel>
void halvePlain(const BlockLanes& on, const RestLanes& r, float split, RestLanes& out) {
    halveLanes<kShape, kLevel>(on, r, split, out);
}
template<uint32_t kShape>
void finishPlain(const SampleDesc& desc, const RestLanes& r, BlockLanes& on) {
    finishLanes<kShape>(desc, r, on);
}
template<uint32_t kShape, uint32_t kRest>
constexpr Loops::Shape kPlainShape{samplePlain<kShape>,
                                   halvePlain<kShape, 0>,
                                   {halvePlain<kRest, 0>, halvePlain<kRest, 1>},
                                   finishPlain<kRest>};
constexpr Loops kPlain{formFactorsPlain, unevenPlain,
                       kPlainShape<shader::kEmitterParallelogram, shader::kEmitterParallelogram>,
                       kPlainShape<shader::kEmitterQuad, shader::kEmitterTriangle>,
                       kPlainShape<shader::kEmitterTriangle, shader::kEmitterTriangle>};

#if defined(__x86_64__)
#define RELUME_AVX2 __attribute__((target("avx2")))
RELUME_AVX2 void formFactorsAvx2(const PatchLanes& lanes, const ChunkStarts::Points& at,
                                 const EmitterPolygon& e, Lane& out) {
    formFactorLanes(lanes, at, e, out);
}
RELUME_AVX2 void unevenAvx2(const PatchLanes& lanes, const EmitterPolygon& e, Flags& out) {
    unevenLanes(lanes, e, out);
}
template<uint32_t kShape>
RELUME_AVX2 void sampleAvx2(const PatchLanes& lanes, const SampleDesc& desc, SampleLanes& out) {
    sampleLanes<kShape>(lanes, desc, out);
}
template<uint32_t kShape, uint32_t kLevel>
RELUME_AVX2 void halveAvx2(const BlockLanes& on, const RestLanes& r, float split, RestLanes& out) {
    halveLanes<kShape, kLevel>(on, r, split, out);
}
template<uint32_t kShape>
RELUME_AVX2 void finishAvx2(const SampleDesc& desc, const RestLanes& r, BlockLanes& on) {
    finishLanes<kShape>(desc, r, on);
}
template<uint32_t kShape, uint32_t kRest>
constexpr Loops::Shape kAvx2Shape{
    sampleAvx2<kShape>, halveAvx2<kShape, 0>, {halveAvx2<kRest, 0>, halveAvx2<kRest, 1>}, finishAvx2<kRest>};
constexpr Loops kAvx2{formFactorsAvx2, unevenAvx2,
                      kAvx2Shape<shader::kEmitterParallelogram, shader::kEmitterParallelogram>,
                      kAvx2Shape<shader::kEmitterQuad, shader::kEmitterTriangle>,
                      kAvx2Shape<shader::kEmitterTriangle, shader::kEmitterTriangle>};
const Loops& chooseLoops() {
    return __builtin_cpu_supports("avx2") ? kAvx2 : kPlain;
}
#else
const Loops& chooseLoops() {
    return kPlain;
}
#endif

bool anyOf(const uint32_t* flags, uint32_t count) {
    return std::find(flags, flags + count, 1u) != flags + count;
}

// Loads a block, and what halving starts from; wholes are the polygon's form factors from where samples
// start.
void loadBlock(const PatchLanes& lanes, const EmitterPolygon& e, const Lane& wholes, uint32_t first,
               const SampleLanes& sample, BlockLanes& on, RestLanes& r) {
    for (uint32_t i = 0; i < kBlock; ++i) {
        const uint32_t lane = first + i;
        on.px[i] = lanes.at.x[lane], on.py[i] = lanes.at.y[lane], on.pz[i] = lanes.at.z[lane];
        on.sx[i] = lanes.sx[lane], on.sy[i] = lanes.sy[lane], on.sz[i] = lanes.sz[lane];
        on.nx[i] = lanes.nx[lane], on.ny[i] = lanes.ny[lane], on.nz[i] = lanes.nz[lane];
        on.offset[i] = lanes.offset[lane];
        r.u[i] = sample.u[lane], r.v[i] = sample.v[lane];
        r.whole[i] = wholes[lane];
        r.uneven[i] = sample.uneven[lane] & (wholes[lane] > 0.0f ? 1u : 0u);
    }
    r.ax.fill(e.c0.x), r.ay.fill(e.c0.y), r.az.fill(e.c0.z);
    r.bx.fill(e.c1.x), r.by.fill(e.c1.y), r.bz.fill(e.c1.z);
    r.cx.fill(e.c2.x), r.cy.fill(e.c2.y), r.cz.fill(e.c2.z);
    r.dx.fill(e.c3.x), r.dy.fill(e.c3.y), r.dz.fill(e.c3.z);
    r.weight.fill(1.0f);
}

// Does what shader::polygonPoint does, for the patches of a block that are near.
void halveBlock(const PatchLanes& lanes, const SampleDesc& desc, const Loops::Shape& loops,
                const Lane& wholes, uint32_t first, SampleLanes& sample) {
    BlockLanes on;
    std::array<RestLanes, 2> rests;
    loadBlock(lanes, desc.polygon, wholes, first, sample, on, rests[0]);
    const Block<uint32_t> halved = rests[0].uneven;
    uint32_t now = 0;
    for (uint32_t level = 0; level < shader::kMostHalvings && anyOf(rests[now].uneven.data(), kBlock);
         ++level) {
        const Loops::Halve halve = level == 0 ? loops.halveFirst : loops.halve[level % 2];
        halve(on, rests[now], level == 0 ? desc.polygon.split : 1.0f, rests[1 - now]);
        now = 1 - now;
    }
    loops.finish(desc, rests[now], on);
    TargetLanes& out = sample.out;
    for (uint32_t i = 0; i < kBlock; ++i) {
        const uint32_t lane = first + i;
        if (halved[i] == 0) continue;
        out.x[lane] = on.x[i], out.y[lane] = on.y[i], out.z[lane] = on.z[i], out.w[lane] = on.w[i];
    }
}

// What is known of a polygon for the patches of a chunk.
struct Pick {
    Lane whole; // form factor, without shadows
    SampleLanes sample;
    Flags near; // the light is uneven over the patch: it is the mean over where samples start
    std::array<Lane, shader::kReplicates> factors; // sums of form factors from there
    bool shines = false, anyNear = false;          // any patch

    glm::vec3 light(const EmitterPolygon& e, size_t lane) const { return e.radiance * whole[lane]; }
};

// Makes form factors the mean over the texels, by the points of their spread, where the light is not even.
void spreadWhole(const PatchLanes& lanes, const Loops& loops, const EmitterPolygon& e, const Flags& uneven,
                 Lane& whole) {
    const auto isUneven = [](uint32_t u) { return u != shader::kLightEven; };
    if (std::none_of(uneven.begin(), uneven.end(), isUneven)) return;
    Lane sum{};
    for (const ChunkStarts::Points& at : lanes.spread) {
        Lane factors;
        loops.formFactors(lanes, at, e, factors);
        for (uint32_t i = 0; i < kChunk; ++i)
            sum[i] += factors[i];
    }
    for (uint32_t i = 0; i < kChunk; ++i)
        if (isUneven(uneven[i])) whole[i] = sum[i] / static_cast<float>(shader::kSpreadPoints);
}

// Begins the pick of a polygon.
void begin(const HostPoints& on, const PatchLanes& lanes, const Loops& loops, const EmitterPolygon& e,
           Pick& pick) {
    loops.formFactors(lanes, lanes.middle, e, pick.whole);
    Flags uneven{};
    if (on.covers) {
        loops.uneven(lanes, e, uneven);
        spreadWhole(lanes, loops, e, uneven, pick.whole);
    }
    for (uint32_t i = 0; i < kChunk; ++i) {
        if (lanes.sends[i] == 0) pick.whole[i] = 0.0f;
        const bool may = uneven[i] == shader::kLightUneven && lanes.sends[i] != 0 &&
                         shader::mayShineOn(lanes.spreadAt(i), {lanes.sx[i], lanes.sy[i], lanes.sz[i]}, e);
        const bool shines = (pick.whole[i] > 0.0f || may) && e.radiance != glm::vec3(0.0f);
        pick.sample.shines[i] = shines ? 1 : 0;
        pick.shines = pick.shines || shines;
    }
    if (!on.covers || !pick.shines) return;
    for (Lane& factors : pick.factors)
        factors.fill(0.0f);
    for (uint32_t i = 0; i < kChunk; ++i) {
        pick.near[i] = uneven[i] == shader::kLightUneven ? pick.sample.shines[i] : 0;
        pick.anyNear = pick.anyNear || pick.near[i] != 0;
    }
}

// Leaves out the patches that do not take this one of the sample passes.
void leaveOut(const PatchLanes& lanes, uint32_t samplePass, Pick& pick) {
    for (uint32_t i = 0; lanes.unalike && i < kChunk; ++i)
        if (samplePass >= lanes.taken[i]) pick.sample.shines[i] = 0;
}

// Makes one point for each patch of the chunk.
void samplePoint(const PatchLanes& lanes, const Loops& loops, const SampleDesc& desc, Pick& pick) {
    const Loops::Shape& shape = loops.of(desc.polygon);
    SampleLanes& sample = pick.sample;
    shape.sample(lanes, desc, sample);
    const bool anyUneven = anyOf(sample.uneven.data(), kChunk);
    if (!pick.anyNear && !anyUneven) return;
    Lane factors;
    loops.formFactors(lanes, lanes.at, desc.polygon, factors);
    for (uint32_t i = 0; pick.anyNear && i < kChunk; ++i)
        pick.factors[desc.number % shader::kReplicates][i] += sample.shines[i] != 0 ? factors[i] : 0.0f;
    for (uint32_t first = 0; anyUneven && first < kChunk; first += kBlock)
        if (anyOf(sample.uneven.data() + first, kBlock))
            halveBlock(lanes, desc, shape, factors, first, sample);
}

void sampleChunk(const HostEmitters& work, uint32_t chunk, const Loops& loops) {
    const HostPoints& on = work.points;
    const size_t first = on.firstPatch(chunk), count = work.polygons.size();
    glm::vec4* picked = work.picks + chunk * count * kChunk;
    PatchLanes lanes;
    const bool any = lanes.load(on, first);
    std::vector<Pick> picks(count);
    bool shines = false;
    for (size_t k = 0; any && k < count; ++k) {
        begin(on, lanes, loops, work.polygons[k], picks[k]);
        shines = shines || picks[k].shines;
    }
    if (!shines) {
        std::fill_n(on.targetsOf(chunk, 0), size_t{on.targetCount} * kChunk, glm::vec4(0.0f));
        std::fill_n(picked, count * kChunk, glm::vec4(0.0f));
        return;
    }
    ChunkStarts starts;
    starts.setPatches(on.patches + first, on.covers ? on.covers + first : nullptr);
    for (uint32_t s = 0; s < work.allPoints(); ++s) {
        // The start has the same number: the points of one polygon are a turn, and take turns among
        // replicates.
        const uint32_t number = on.samplePass * work.allPoints() + s;
        starts.make(number, lanes.at);
        for (uint32_t k = 0; k < count; ++k) {
            glm::vec4* targets = on.targetsOf(chunk, k * work.allPoints() + s);
            if (s % work.pointCount == 0) leaveOut(lanes, s / work.pointCount, picks[k]);
            if (picks[k].shines) {
                const EmitterPolygon& e = work.polygons[k];
                samplePoint(lanes, loops, {e, k, number, e.offset * shader::emitterNormal(e)}, picks[k]);
                picks[k].sample.out.store(targets);
            } else {
                std::fill_n(targets, kChunk, glm::vec4(0.0f));
            }
        }
    }
    for (size_t k = 0; k < count; ++k) {
        Pick& pick = picks[k];
        for (uint32_t i = 0; i < kChunk; ++i) {
            const bool near = pick.anyNear && pick.near[i] != 0;
            if (near) {
                glm::vec4& wholes = work.near[(chunk * count + k) * kChunk + i];
                for (uint32_t q = 0; q < shader::kReplicates; ++q)
                    wholes[static_cast<int>(q)] = pick.factors[q][i] *
                                                  static_cast<float>(shader::kReplicates) /
                                                  static_cast<float>(work.pointCount * lanes.taken[i]);
                pick.whole[i] = 0.25f * (wholes[0] + wholes[1] + wholes[2] + wholes[3]);
                // A near light is seen as unevenly over a texel as in a penumbra.
                on.noteLights(first + i, HostGathered::bitOf(k), HostGathered::bitOf(k));
            }
            // The sign marks what is near, as in shaders/direct/emitter_samples.comp.
            picked[k * kChunk + i] =
                glm::vec4(pick.light(work.polygons[k], i), near ? -pick.whole[i] : pick.whole[i]);
        }
    }
}

} // namespace

void sampleEmitters(WorkerPool& pool, const HostEmitters& work) {
    static const Loops& loops = chooseLoops();
    pool.run(work.points.chunkCount, [&](uint32_t chunk) { sampleChunk(work, chunk, loops); });
}

} // namespace relume
