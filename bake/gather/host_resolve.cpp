#include "bake/gather/host_resolve.h"

#include "bake/base/host_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;
using shader::kReplicates;
using shader::Patch;

constexpr uint32_t kMaxReach = 8; // lib/smoothing.glsl, as the following ones
constexpr float kDistanceShare = 0.3f;
constexpr float kLeastSigma = 0.1f; // [texels]
constexpr float kOffPlane = 15.0f;  // more than what lies in the plane counts
constexpr uint32_t kRing = 32;      // places at hand, at most: a power of two above 2 * kMaxReach
constexpr uint32_t kChannels = 3 * kReplicates;
constexpr int32_t kNoChart = -1, kNotSmoothed = -2;

// One texel of each of kLanes lines.
struct Place {
    Floats px, py, pz;    // [m]
    Floats gx, gy, gz;    // geometric normal
    Floats sx, sy, sz;    // shading normal
    Floats falloff;       // of the weight's exponent over squared distance [1/m^2]
    Ints chart, tapChart; // its chart where it is smoothed; where others may take from it
    std::array<uint32_t, kLanes> patch;
    std::array<Floats, kChannels> value;
};

// Makes e to the power of x <= 0: it is 2 to a whole number times 2 to one within a half, of which the
// series' first seven terms are exact to a float's last bits.
[[gnu::always_inline]] inline void exponential(Floats& x) {
    constexpr float kLeast = -86.0f, kLog2e = 1.44269504f;
    const Floats power = (x > kLeast ? x : kLeast + Floats{}) * kLog2e;
    const Ints whole = __builtin_convertvector(power - 0.5f, Ints); // towards zero: to the nearest one
    const Floats f = power - __builtin_convertvector(whole, Floats);
    Floats sum = 1.54035304e-4f + Floats{};
    sum = sum * f + 1.33335581e-3f;
    sum = sum * f + 9.61812911e-3f;
    sum = sum * f + 5.55041087e-2f;
    sum = sum * f + 2.40226507e-1f;
    sum = sum * f + 6.93147181e-1f;
    sum = sum * f + 1.0f;
    constexpr int kBias = 127, kMantissa = 23;
    const Ints bits = (whole + kBias) << kMantissa;
    x = sum * __builtin_bit_cast(Floats, bits);
}

// Smooths lines of texels along themselves. What is read of a place is copied before anything of its line is
// written, and other lines read nothing of it.
class LineSmoother {
public:
    // With `down` lines are columns, else rows. from and to are [kReplicates][patches].
    LineSmoother(const HostResolve& work, const glm::vec4* from, glm::vec4* to, bool down)
        : work_(work), from_(from), to_(to), down_(down), patchCount_(size_t{work.chunkCount} * kChunk),
          mask_(std::bit_ceil(2 * work.reach + 1) - 1) {}

    [[gnu::always_inline]] void run(uint32_t firstLine) const {
        std::array<Place, kRing> ring{};
        for (uint32_t at = 0; at < work_.size + work_.reach; ++at) {
            load(firstLine, at, ring[at & mask_]);
            if (at == 0) {
                for (uint32_t t = 1; t <= work_.reach; ++t) // before the line
                    ring[(0 - t) & mask_].tapChart = kNoChart + Ints{};
            }
            if (at >= work_.reach) smooth(ring, at - work_.reach);
        }
    }

private:
    [[gnu::always_inline]] void load(uint32_t firstLine, uint32_t at, Place& place) const;
    [[gnu::always_inline]] void smooth(const std::array<Place, kRing>& ring, uint32_t at) const;

    const HostResolve& work_;
    const glm::vec4* from_;
    glm::vec4* to_;
    bool down_;
    size_t patchCount_;
    uint32_t mask_; // of places
};

inline void LineSmoother::load(uint32_t firstLine, uint32_t at, Place& place) const {
    place.chart = kNotSmoothed + Ints{};
    place.tapChart = kNoChart + Ints{};
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        place.patch[lane] = kNoPatch;
        const uint32_t line = firstLine + lane;
        if (line >= work_.size || at >= work_.size) continue;
        const uint32_t texel = down_ ? at * work_.size + line : line * work_.size + at;
        const uint32_t index = work_.texelToPatch[texel];
        if (index == kNoPatch) continue;
        const Patch& p = work_.patches[index];
        if (shader::patchTexel(p.flags) != texel) continue;
        place.patch[lane] = index;
        place.px[lane] = p.position.x, place.py[lane] = p.position.y, place.pz[lane] = p.position.z;
        place.gx[lane] = p.normal.x, place.gy[lane] = p.normal.y, place.gz[lane] = p.normal.z;
        place.sx[lane] = p.shading.x, place.sy[lane] = p.shading.y, place.sz[lane] = p.shading.z;
        const float area = std::max(p.area, 1e-30f);
        const float sigma = std::min(work_.sigma, kDistanceShare * work_.distances[index] / std::sqrt(area));
        place.falloff[lane] = -0.5f / (sigma * sigma * area);
        const auto chart = static_cast<int32_t>(work_.patchChart[index]);
        if (sigma > kLeastSigma) place.chart[lane] = chart;
        if ((p.flags & shader::kPatchSends) != 0) place.tapChart[lane] = chart;
        for (uint32_t q = 0; q < kReplicates; ++q) {
            const glm::vec4& v = from_[q * patchCount_ + index];
            place.value[q * 3][lane] = v.r, place.value[q * 3 + 1][lane] = v.g,
                            place.value[q * 3 + 2][lane] = v.b;
        }
    }
}

// The weights of the taps are those of a local straight-line fit, as in lib/smoothing.glsl.
inline void LineSmoother::smooth(const std::array<Place, kRing>& ring, uint32_t at) const {
    const Place& c = ring[at & mask_];
    if (std::all_of(c.patch.begin(), c.patch.end(), [](uint32_t patch) { return patch == kNoPatch; })) return;
    const auto reach = static_cast<int32_t>(work_.reach);
    std::array<Floats, 2 * kMaxReach + 1> weights;
    Floats s0{}, s1{}, s2{};
    for (int32_t t = -reach; t <= reach; ++t) {
        const Place& tap = ring[(at + static_cast<uint32_t>(t)) & mask_];
        Floats w = 1.0f + Floats{};
        if (t != 0) {
            const Floats dx = tap.px - c.px, dy = tap.py - c.py, dz = tap.pz - c.pz;
            const Floats height = dx * c.gx + dy * c.gy + dz * c.gz;
            const Floats distance2 = dx * dx + dy * dy + dz * dz + kOffPlane * height * height;
            Floats facing = c.sx * tap.sx + c.sy * tap.sy + c.sz * tap.sz;
            facing = facing > 0.0f ? facing : Floats{};
            facing *= facing;
            facing *= facing;
            w = c.falloff * distance2;
            exponential(w);
            w *= facing;
            w = tap.tapChart == c.chart ? w : Floats{};
        }
        const auto way = static_cast<float>(t);
        weights[static_cast<uint32_t>(t + reach)] = w;
        s0 += w;
        s1 += w * way;
        s2 += w * (way * way);
    }
    const Floats det = s0 * s2 - s1 * s1;
    const Ints line = det > 1e-3f * s0 * s0;
    const Floats level = line ? s2 / det : 1.0f / s0, slope = line ? -s1 / det : Floats{};
    std::array<Floats, kChannels> sums{};
    for (int32_t t = -reach; t <= reach; ++t) {
        const Place& tap = ring[(at + static_cast<uint32_t>(t)) & mask_];
        const Floats w = weights[static_cast<uint32_t>(t + reach)] * (level + slope * static_cast<float>(t));
        for (uint32_t k = 0; k < kChannels; ++k)
            sums[k] += w * tap.value[k];
    }
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        if (c.patch[lane] == kNoPatch) continue;
        for (uint32_t q = 0; q < kReplicates; ++q)
            to_[q * patchCount_ + c.patch[lane]] = {sums[q * 3][lane], sums[q * 3 + 1][lane],
                                                    sums[q * 3 + 2][lane], 0.0f};
    }
}

using SmoothLines = void (*)(const LineSmoother&, uint32_t);

void smoothLinesPlain(const LineSmoother& smoother, uint32_t firstLine) {
    smoother.run(firstLine);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void smoothLinesAvx2(const LineSmoother& smoother, uint32_t firstLine) {
    smoother.run(firstLine);
}
SmoothLines chooseSmoothLines() {
    return __builtin_cpu_supports("avx2") ? smoothLinesAvx2 : smoothLinesPlain;
}
#else
SmoothLines chooseSmoothLines() {
    return smoothLinesPlain;
}
#endif

using Replicates = std::array<Float4, kReplicates>; // R, G, B and 0

[[gnu::always_inline]] inline void mean(Float4& out, const Replicates& v) {
    out = 0.25f * (v[0] + v[1] + v[2] + v[3]);
}

float sumOfSquares(const Float4& v) {
    const Float4 squares = v * v;
    return squares[0] + squares[1] + squares[2];
}

// Returns what spread() of lib/replicates.glsl does.
float spread(const Replicates& v) {
    Float4 middle, sum{};
    mean(middle, v);
    for (const Float4& one : v)
        sum += (one - middle) * (one - middle);
    return (sum[0] + sum[1] + sum[2]) / static_cast<float>(kReplicates * (kReplicates - 1));
}

void resolveChunk(const HostResolve& work, uint32_t chunk, shader::ResolveSums& indirectSums,
                  glm::vec4& resultSums) {
    const size_t count = size_t{work.chunkCount} * kChunk;
    for (size_t index = size_t{chunk} * kChunk, end = index + kChunk; index < end; ++index) {
        const Patch& p = work.patches[index];
        const bool smooths = work.reach > 0 && work.texelToPatch[shader::patchTexel(p.flags)] == index;
        const glm::vec4* from = smooths ? work.rows : work.sums;
        Replicates raw{}, smoothed{}, moved{};
        for (size_t q = 0; q < kReplicates && work.scale > 0.0f; ++q) {
            load(raw[q], work.sums[q * count + index]);
            load(smoothed[q], from[q * count + index]);
            raw[q] *= work.scale, smoothed[q] *= work.scale;
            moved[q] = smoothed[q] - raw[q];
        }
        Float4 indirect, move;
        mean(indirect, smoothed);
        mean(move, moved);
        indirect = indirect > 0.0f ? indirect : Float4{}; // weights of both signs may end a little below
        const float variance = spread(smoothed);
        const glm::vec4& direct = work.direct[index];
        const glm::vec3 light = glm::vec3(direct) + glm::vec3(indirect[0], indirect[1], indirect[2]);
        work.result[index] = glm::vec4(light, std::sqrt((direct.w + variance) / 3.0f));
        if (!shader::patchIsShown(p.flags)) continue;
        indirectSums.light += indirect[0] + indirect[1] + indirect[2];
        indirectSums.indirect += variance;
        indirectSums.raw += smooths ? spread(raw) : variance;
        indirectSums.bias += smooths ? sumOfSquares(move) - spread(moved) : 0.0f;
        indirectSums.count += 1.0f;
        resultSums += glm::vec4(light.r + light.g + light.b, direct.w, 1.0f, 0.0f);
    }
}

} // namespace

HostResolveSums resolveLayer(WorkerPool& pool, const HostResolve& work) {
    static const SmoothLines smoothLines = chooseSmoothLines();
    if (work.reach > 0) {
        const uint32_t strips = (work.size + kLanes - 1) / kLanes;
        const LineSmoother along(work, work.sums, work.rows, false), down(work, work.rows, work.rows, true);
        pool.run(strips, [&](uint32_t strip) { smoothLines(along, strip * kLanes); });
        pool.run(strips, [&](uint32_t strip) { smoothLines(down, strip * kLanes); });
    }
    HostResolveSums sums{std::vector<shader::ResolveSums>(work.chunkCount),
                         std::vector<glm::vec4>(work.chunkCount, glm::vec4(0.0f))};
    pool.run(work.chunkCount,
             [&](uint32_t chunk) { resolveChunk(work, chunk, sums.indirect[chunk], sums.result[chunk]); });
    return sums;
}

} // namespace relume
