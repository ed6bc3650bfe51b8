#include "bake/trace/chunk_starts.h"

#include <algorithm>
#include <bit>

namespace relume {

using shader::kChunk;

namespace {

struct StartLanes {
    const float *px, *py, *pz, *ux, *uy, *uz, *vx, *vy, *vz;
    const uint32_t* seed;
};

// Makes points anywhere in whole texels, in a form that compilers turn into vector code. It is always
// inlined, to be compiled once for each instruction set.
[[gnu::always_inline]] inline void makeStarts(uint32_t index, const StartLanes& in, float* __restrict x,
                                              float* __restrict y, float* __restrict z,
                                              float* __restrict first) {
#pragma GCC ivdep
    for (uint32_t i = 0; i < kChunk; ++i) {
        const glm::vec2 u = shader::sobolPoint(index, in.seed[i]);
        first[i] = u.x;
        x[i] = in.px[i] + u.x * in.ux[i] + u.y * in.vx[i];
        y[i] = in.py[i] + u.x * in.uy[i] + u.y * in.vy[i];
        z[i] = in.pz[i] + u.x * in.uz[i] + u.y * in.vz[i];
    }
}

using MakeStarts = void (*)(uint32_t, const StartLanes&, float*, float*, float*, float*);

void makeStartsPlain(uint32_t index, const StartLanes& in, float* x, float* y, float* z, float* first) {
    makeStarts(index, in, x, y, z, first);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void makeStartsAvx2(uint32_t index, const StartLanes& in, float* x, float* y,
                                                    float* z, float* first) {
    makeStarts(index, in, x, y, z, first);
}
MakeStarts chooseMakeStarts() {
    return __builtin_cpu_supports("avx2") ? makeStartsAvx2 : makeStartsPlain;
}
#else
MakeStarts chooseMakeStarts() {
    return makeStartsPlain;
}
#endif

} // namespace

void ChunkStarts::setPatches(const shader::Patch* patches, const shader::PatchCover* covers) {
    move_ = covers != nullptr;
    parts_ = 0;
    Lanes& l = lanes_;
    for (uint32_t i = 0; i < kChunk; ++i) {
        const shader::Patch& p = patches[i];
        glm::vec3 corner = p.position, du(0.0f), dv(0.0f);
        if (covers && covers[i].cells != 0) {
            corner += shader::coverWay(covers[i], glm::vec2(0.0f));
            du = covers[i].du, dv = covers[i].dv;
            setCover(i, covers[i]);
        }
        l.px[i] = corner.x, l.py[i] = corner.y, l.pz[i] = corner.z;
        l.ux[i] = du.x, l.uy[i] = du.y, l.uz[i] = du.z;
        l.vx[i] = dv.x, l.vy[i] = dv.y, l.vz[i] = dv.z;
        if (!covers) continue;
        for (uint32_t r = 0; r < shader::kReplicates; ++r)
            l.seed[r][i] = shader::startSeed(shader::replicateSeed(shader::seedKey(p), r));
    }
}

void ChunkStarts::setCover(uint32_t lane, const shader::PatchCover& cover) {
    if ((cover.cells & shader::kCoverWhole) != 0) return;
    parts_ |= uint64_t{1} << lane;
    uint8_t count = 0;
    for (uint32_t rest = cover.cells & shader::kCoverCells; rest != 0; rest &= rest - 1)
        cells_[lane][count++] = static_cast<uint8_t>(std::countr_zero(rest));
    cellCount_[lane] = count;
}

void ChunkStarts::make(uint32_t number, Points& out) const {
    const Lanes& l = lanes_;
    if (!move_) {
        out.x = l.px, out.y = l.py, out.z = l.pz;
        return;
    }
    static const MakeStarts makeWhole = chooseMakeStarts();
    alignas(64) Lane first;
    makeWhole(shader::replicateIndex(number),
              {l.px.data(), l.py.data(), l.pz.data(), l.ux.data(), l.uy.data(), l.uz.data(), l.vx.data(),
               l.vy.data(), l.vz.data(), l.seed[number % shader::kReplicates].data()},
              out.x.data(), out.y.data(), out.z.data(), first.data());
    for (uint64_t rest = parts_; rest != 0; rest &= rest - 1) {
        const auto i = static_cast<size_t>(std::countr_zero(rest));
        const uint32_t count = cellCount_[i];
        const auto which = std::min(static_cast<uint32_t>(first[i] * static_cast<float>(count)), count - 1);
        const glm::vec2 u = shader::cellPlace(cells_[i][which]);
        out.x[i] = l.px[i] + u.x * l.ux[i] + u.y * l.vx[i];
        out.y[i] = l.py[i] + u.x * l.uy[i] + u.y * l.vy[i];
        out.z[i] = l.pz[i] + u.x * l.uz[i] + u.y * l.vz[i];
    }
}

} // namespace relume
