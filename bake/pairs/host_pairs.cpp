#include "bake/pairs/host_pairs.h"

#include "bake/base/host_lanes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <numbers>
#include <vector>

namespace relume {
namespace {

using shader::kBlockWords;
using shader::kChunk;
using shader::kSuper;
using shader::kSuperPatches;

using Rows = std::array<uint64_t, kChunk>; // per receiver of a chunk, a bit per sender of another one

// A chunk of senders by component.
struct SenderLanes {
    using Lane = std::array<float, kChunk>;
    Lane px, py, pz; // [m]
    Lane nx, ny, nz;
    Lane area;                          // [m^2]
    Lane r, g, b;                       // radiance of all patches that the sender stands for [cd/m^2]
    std::array<uint32_t, kChunk> index; // of its patch and edges
};

// The light that one receiver gets, before lanes are added up.
struct Received {
    Floats r, g, b;
};

// Adds light by the disc form factor (farFactor of shaders/pairs/gather.comp) from senders whose bit is set
// and that are not within `close` patch sizes. It is inlined, to be compiled for each instruction set.
[[gnu::always_inline]] inline void addFar(const shader::Patch* receivers, const Rows& rows,
                                          const SenderLanes& s, float close, Received* sums) {
    constexpr Ints kBits = {1, 2, 4, 8, 16, 32, 64, 128};
    const float nearest = close * close;
    for (uint32_t i = 0; i < kChunk; ++i) {
        const glm::vec3 p = receivers[i].position, n = receivers[i].shading;
        Received sum = sums[i];
        uint64_t mask = rows[i];
        for (uint32_t j = 0; mask != 0; j += kLanes, mask >>= kLanes) {
            const auto byte = static_cast<int32_t>(mask & 0xff);
            if (byte == 0) continue;
            Floats x, y, z, nx, ny, nz, area, r, g, b;
            load(x, &s.px[j]), load(y, &s.py[j]), load(z, &s.pz[j]);
            load(nx, &s.nx[j]), load(ny, &s.ny[j]), load(nz, &s.nz[j]);
            load(area, &s.area[j]), load(r, &s.r[j]), load(g, &s.g[j]), load(b, &s.b[j]);
            const Floats dx = x - p.x, dy = y - p.y, dz = z - p.z;
            const Floats r2 = dx * dx + dy * dy + dz * dz;
            const Floats up = dx * n.x + dy * n.y + dz * n.z;
            const Floats down = dx * nx + dy * ny + dz * nz;
            const Floats cosines = (up > 0.0f ? up : Floats{}) * -down;
            const Floats f = cosines * area / (r2 * (std::numbers::pi_v<float> * r2 + area));
            const Ints counts = ((kBits & byte) != 0) & (r2 > nearest * area);
            const Floats factor = counts ? f : Floats{};
            sum.r += factor * r, sum.g += factor * g, sum.b += factor * b;
        }
        sums[i] = sum;
    }
}

using AddFar = void (*)(const shader::Patch*, const Rows&, const SenderLanes&, float, Received*);

void addFarPlain(const shader::Patch* receivers, const Rows& rows, const SenderLanes& s, float close,
                 Received* sums) {
    addFar(receivers, rows, s, close, sums);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void addFarAvx2(const shader::Patch* receivers, const Rows& rows,
                                                const SenderLanes& s, float close, Received* sums) {
    addFar(receivers, rows, s, close, sums);
}
AddFar chooseAddFar() {
    return __builtin_cpu_supports("avx2") ? addFarAvx2 : addFarPlain;
}
#else
AddFar chooseAddFar() {
    return addFarPlain;
}
#endif

// Turns columns into rows.
void transpose(Rows& rows) {
    uint64_t mask = 0x00000000ffffffffull;
    for (uint32_t step = 32; step > 0; step /= 2, mask ^= mask << step) {
        for (uint32_t i = 0; i < kChunk; i = (i + step + 1) & ~step) {
            const uint64_t swapped = (rows[i] >> step ^ rows[i + step]) & mask;
            rows[i] ^= swapped << step;
            rows[i + step] ^= swapped;
        }
    }
}

// Gathers one side of one super-block: what the patches of a super-row get from those of another.
class SideGather {
public:
    SideGather(const HostPairs& work, size_t super, uint32_t side)
        : work_(work), bits_(work.bits[super]), partial_(work.partial + (super * 2 + side) * kSuperPatches) {
        const shader::SuperBlock& block = work.supers[super];
        receivers_ = side == 0 ? block.row : block.column;
        senders_ = side == 0 ? block.column : block.row;
    }

    void run() {
        const uint32_t columns = std::min(kSuper, work_.columnCount - senders_ * kSuper);
        const uint32_t rows = std::min(kSuper, work_.rowCount - receivers_ * kSuper);
        std::vector<SenderLanes> lanes(columns);
        for (uint32_t r = 0; r < rows; ++r) {
            if (r == 0 || work_.senders) load(lanes, receivers_ * kSuper + r);
            gatherRow(r, lanes);
        }
    }

private:
    bool sends(uint32_t c) const { return work_.sends[senders_ * kSuper + c] != 0; }
    void load(std::vector<SenderLanes>& lanes, uint32_t receivers) const;
    void gatherRow(uint32_t r, const std::vector<SenderLanes>& lanes) const;
    Rows seen(uint32_t r, uint32_t c) const;
    Rows traced(uint32_t row, uint32_t column) const;
    bool close(uint32_t receivers, uint32_t senders) const;
    void addClose(const shader::Patch* receivers, const Rows& rows, const SenderLanes& lanes,
                  std::array<glm::vec3, kChunk>& sums) const;

    const HostPairs& work_;
    const uint32_t* bits_;
    glm::vec4* partial_;
    uint32_t receivers_, senders_; // super-rows
};

// Loads the senders that a chunk of receivers has before it.
void SideGather::load(std::vector<SenderLanes>& lanes, uint32_t receivers) const {
    const uint32_t key = shader::patchTexel(work_.patches[size_t{receivers} * kChunk].flags);
    for (uint32_t c = 0; c < lanes.size(); ++c) {
        if (!sends(c)) continue;
        SenderLanes& s = lanes[c];
        for (uint32_t j = 0; j < kChunk; ++j) {
            uint32_t index = (senders_ * kSuper + c) * kChunk + j;
            float count = 1.0f;
            if (work_.senders) {
                const shader::Sender& sender = work_.senders[index];
                count = static_cast<float>(sender.count);
                // Padding has no bit set, so any patch will do.
                index = sender.count > 0 ? work_.members[sender.first + shader::drawMember(sender, key)] : 0;
            }
            const shader::Patch& patch = work_.senderPatches[index];
            const glm::vec4 radiance = count * work_.radiance[index];
            s.px[j] = patch.position.x, s.py[j] = patch.position.y;
            s.pz[j] = patch.position.z;
            s.nx[j] = patch.normal.x, s.ny[j] = patch.normal.y;
            s.nz[j] = patch.normal.z;
            s.area[j] = patch.area;
            s.r[j] = radiance.r, s.g[j] = radiance.g, s.b[j] = radiance.b;
            s.index[j] = index;
        }
    }
}

// Returns bits as they were traced.
Rows SideGather::traced(uint32_t row, uint32_t column) const {
    const uint32_t* words = bits_ + size_t{row * kSuper + column} * kBlockWords;
    Rows rows;
    for (uint32_t i = 0; i < kChunk; ++i)
        rows[i] = words[i * 2] | uint64_t{words[i * 2 + 1]} << 32;
    return rows;
}

// Returns what chunk r of the receivers sees of chunk c of the senders.
Rows SideGather::seen(uint32_t r, uint32_t c) const {
    const uint32_t receiver = receivers_ * kSuper + r, sender = senders_ * kSuper + c;
    if (!work_.symmetric || receiver < sender) return traced(r, c);
    Rows rows = traced(c, r);
    transpose(rows);
    if (receiver != sender) return rows;
    const Rows upper = traced(r, c);
    for (uint32_t i = 0; i < kChunk; ++i)
        rows[i] |= upper[i];
    return rows;
}

bool SideGather::close(uint32_t receivers, uint32_t senders) const {
    const shader::ChunkBounds &p = work_.bounds[receivers], &q = work_.senderBounds[senders];
    const glm::vec3 gap = glm::max(glm::max(q.lo - p.hi, p.lo - q.hi), glm::vec3(0.0f));
    return glm::dot(gap, gap) <= shader::kClosePair * shader::kClosePair * q.size * q.size;
}

// Adds light by the exact form factor from the pairs that addFar leaves out.
void SideGather::addClose(const shader::Patch* receivers, const Rows& rows, const SenderLanes& lanes,
                          std::array<glm::vec3, kChunk>& sums) const {
    for (uint32_t i = 0; i < kChunk; ++i) {
        const shader::Patch& p = receivers[i];
        for (uint64_t mask = rows[i]; mask != 0; mask &= mask - 1) {
            const auto j = static_cast<uint32_t>(std::countr_zero(mask));
            const shader::Patch& s = work_.senderPatches[lanes.index[j]];
            const glm::vec3 d = s.position - p.position;
            if (glm::dot(d, d) > shader::kClosePair * shader::kClosePair * s.area) continue;
            const shader::PatchEdges& e = work_.senderEdges[lanes.index[j]];
            const float f =
                shader::parallelogramFormFactor(p.position, p.shading, s.position, e.du, e.dv, s.normal);
            sums[i] += f * glm::vec3(lanes.r[j], lanes.g[j], lanes.b[j]);
        }
    }
}

float sumOf(const Floats& lanes) {
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) + ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

void SideGather::gatherRow(uint32_t r, const std::vector<SenderLanes>& lanes) const {
    static const AddFar addFarBest = chooseAddFar();
    const uint32_t chunk = receivers_ * kSuper + r;
    const shader::Patch* receivers = work_.patches + size_t{chunk} * kChunk;
    std::array<Received, kChunk> far{};
    std::array<glm::vec3, kChunk> near{};
    for (uint32_t c = 0; c < lanes.size(); ++c) {
        if (!sends(c)) continue;
        const Rows rows = seen(r, c);
        const bool isClose = close(chunk, senders_ * kSuper + c);
        addFarBest(receivers, rows, lanes[c], isClose ? shader::kClosePair : 0.0f, far.data());
        if (isClose) addClose(receivers, rows, lanes[c], near);
    }
    for (uint32_t i = 0; i < kChunk; ++i) {
        const glm::vec3 sum(sumOf(far[i].r), sumOf(far[i].g), sumOf(far[i].b));
        partial_[size_t{r} * kChunk + i] = glm::vec4(sum + near[i], 0.0f);
    }
}

} // namespace

void gatherPairs(WorkerPool& pool, const HostPairs& work) {
    const uint32_t sides = work.symmetric ? 2 : 1;
    pool.run(static_cast<uint32_t>(work.supers.size()) * sides, [&](uint32_t k) {
        const shader::SuperBlock& super = work.supers[k / sides];
        const uint32_t side = k % sides;
        if (side == 1 && super.row == super.column) return; // its one side has both
        SideGather(work, k / sides, side).run();
    });
}

} // namespace relume
