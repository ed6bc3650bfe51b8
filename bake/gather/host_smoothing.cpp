#include "bake/gather/host_smoothing.h"

#include "bake/base/host_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

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

// Smooths lines of texels along themselves: rows of texels, from the sums, or columns, in place. What is read
// of a place is copied before anything of its line is written, and other lines read nothing of it.
class LineSmoother {
public:
    LineSmoother(const HostSmoothing& work, bool down)
        : work_(work), from_(down ? work.rows : work.sums), scales_(down ? nullptr : work.scales),
          wanted_(down ? work.chunks : work.rowChunks), down_(down),
          patchCount_(size_t{work.chunkCount} * kChunk), mask_(std::bit_ceil(2 * work.reach + 1) - 1) {}

    [[gnu::always_inline]] void run(uint32_t firstLine) const {
        const auto [first, end] = wantedPart(firstLine);
        if (first >= end) return;
        const uint32_t reach = work_.reach, start = first - std::min(first, reach);
        std::array<Place, kRing> ring{};
        for (uint32_t t = 1; t <= reach; ++t) // before the line, or further off than anything reaches
            ring[(start - t) & mask_].tapChart = kNoChart + Ints{};
        for (uint32_t at = start; at < end + reach; ++at) {
            load(firstLine, at, ring[at & mask_]);
            if (at >= first + reach) smooth(ring, at - reach);
        }
    }

private:
    uint32_t texelOf(uint32_t line, uint32_t at) const {
        return down_ ? at * work_.size + line : line * work_.size + at;
    }
    bool wants(uint32_t patch) const { return wanted_.empty() || wanted_[patch / kChunk] != 0; }
    // Returns the first place of these lines that is smoothed, and the one behind the last.
    std::pair<uint32_t, uint32_t> wantedPart(uint32_t firstLine) const;
    [[gnu::always_inline]] void load(uint32_t firstLine, uint32_t at, Place& place) const;
    [[gnu::always_inline]] void smooth(const std::array<Place, kRing>& ring, uint32_t at) const;

    const HostSmoothing& work_;
    const glm::vec4* from_;
    const glm::vec2* scales_;
    std::span<const uint8_t> wanted_;
    bool down_;
    size_t patchCount_;
    uint32_t mask_; // of places
};

std::pair<uint32_t, uint32_t> LineSmoother::wantedPart(uint32_t firstLine) const {
    uint32_t first = work_.size, end = 0;
    for (uint32_t line = firstLine, last = std::min(work_.size, firstLine + kLanes); line < last; ++line) {
        for (uint32_t at = 0; at < work_.size; ++at) {
            const uint32_t patch = work_.texelToPatch[texelOf(line, at)];
            if (patch == kNoPatch || !wants(patch)) continue;
            first = std::min(first, at);
            end = std::max(end, at + 1);
        }
    }
    return {first, end};
}

inline void LineSmoother::load(uint32_t firstLine, uint32_t at, Place& place) const {
    place.chart = kNotSmoothed + Ints{};
    place.tapChart = kNoChart + Ints{};
    for (uint32_t lane = 0; lane < kLanes; ++lane) {
        place.patch[lane] = kNoPatch;
        const uint32_t line = firstLine + lane;
        if (line >= work_.size || at >= work_.size) continue;
        const uint32_t texel = texelOf(line, at);
        const uint32_t index = work_.texelToPatch[texel];
        if (index == kNoPatch) continue;
        const Patch& p = work_.patches[index];
        if (shader::patchTexel(p.flags) != texel) continue;
        if (wants(index)) place.patch[lane] = index;
        place.px[lane] = p.position.x, place.py[lane] = p.position.y, place.pz[lane] = p.position.z;
        place.gx[lane] = p.normal.x, place.gy[lane] = p.normal.y, place.gz[lane] = p.normal.z;
        place.sx[lane] = p.shading.x, place.sy[lane] = p.shading.y, place.sz[lane] = p.shading.z;
        const float area = std::max(p.area, 1e-30f);
        const float distance = down_ ? work_.distances[index].y : work_.distances[index].x;
        const float sigma = std::min(work_.sigma, kDistanceShare * distance / std::sqrt(area));
        place.falloff[lane] = -0.5f / (sigma * sigma * area);
        const auto chart = static_cast<int32_t>(work_.patchChart[index]);
        if (sigma > kLeastSigma) place.chart[lane] = chart;
        if ((p.flags & shader::kPatchSends) != 0) place.tapChart[lane] = chart;
        const float scale = scales_ ? scales_[index / kChunk].x : 1.0f;
        for (uint32_t q = 0; q < kReplicates; ++q) {
            const glm::vec4 v = scale * from_[q * patchCount_ + index];
            place.value[q * 3][lane] = v.r, place.value[q * 3 + 1][lane] = v.g,
                            place.value[q * 3 + 2][lane] = v.b;
        }
    }
}

// Makes w how much a tap counts for a place, if it is of this chart.
[[gnu::always_inline]] inline void weigh(const Place& c, const Place& tap, const Floats& falloff,
                                         const Ints& chart, Floats& w) {
    const Floats dx = tap.px - c.px, dy = tap.py - c.py, dz = tap.pz - c.pz;
    const Floats height = dx * c.gx + dy * c.gy + dz * c.gz;
    const Floats distance2 = dx * dx + dy * dy + dz * dz + kOffPlane * height * height;
    Floats facing = c.sx * tap.sx + c.sy * tap.sy + c.sz * tap.sz;
    facing = facing > 0.0f ? facing : Floats{};
    facing *= facing;
    facing *= facing;
    facing *= facing;
    w = falloff * distance2;
    exponential(w);
    w *= facing;
    w = tap.tapChart == chart ? w : Floats{};
}

// The weights of the taps are those of a local straight-line fit, and end at what stands between, as in
// lib/smoothing.glsl.
inline void LineSmoother::smooth(const std::array<Place, kRing>& ring, uint32_t at) const {
    const Place& c = ring[at & mask_];
    if (std::all_of(c.patch.begin(), c.patch.end(), [](uint32_t patch) { return patch == kNoPatch; })) return;
    const auto reach = static_cast<int32_t>(work_.reach);
    std::array<Floats, 2 * kMaxReach + 1> weights;
    weights[work_.reach] = 1.0f + Floats{};
    Floats s0 = weights[work_.reach], s1{}, s2{};
    for (const int32_t way : {-1, 1}) {
        Floats falloff = c.falloff;
        Ints chart = c.chart; // kNotSmoothed behind a gap
        for (int32_t t = way; t * way <= reach; t += way) {
            const Place& tap = ring[(at + static_cast<uint32_t>(t)) & mask_];
            chart = tap.tapChart == chart ? chart : kNotSmoothed + Ints{};
            falloff = tap.falloff < falloff ? tap.falloff : falloff;
            Floats& w = weights[static_cast<uint32_t>(t + reach)];
            weigh(c, tap, falloff, chart, w);
            const auto steps = static_cast<float>(t);
            s0 += w;
            s1 += w * steps;
            s2 += w * (steps * steps);
        }
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
            work_.rows[q * patchCount_ + c.patch[lane]] = {sums[q * 3][lane], sums[q * 3 + 1][lane],
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

} // namespace

void smoothOnHost(WorkerPool& pool, const HostSmoothing& work) {
    static const SmoothLines smoothLines = chooseSmoothLines();
    const uint32_t strips = (work.size + kLanes - 1) / kLanes;
    const LineSmoother along(work, false), down(work, true);
    pool.run(strips, [&](uint32_t strip) { smoothLines(along, strip * kLanes); });
    pool.run(strips, [&](uint32_t strip) { smoothLines(down, strip * kLanes); });
}

} // namespace relume
