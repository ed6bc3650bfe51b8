#pragma once

#include <array>
#include <cstdint>

#include "bake/base/shader_types.h"
#include "bake/trace/embree_api.h"
#include "bake/trace/embree_blockers.h"

namespace relume {

/// Rays of one block on their way through Embree: filled lane by lane, traced when full.
class OcclusionPacket {
public:
    // This is what AVX holds: 16 are taken apart by Embree without AVX-512 and cost more.
    static constexpr uint32_t kRays = 8;

    /// Takes where the bits of what is seen are: those of rays that something stops are cleared.
    OcclusionPacket(RTCScene scene, Blockers& blockers, std::array<uint64_t, shader::kChunk>& visible)
        : scene_(scene), blockers_(blockers), visible_(visible) {
        for (uint32_t lane = 0; lane < kRays; ++lane) {
            valid_[lane] = -1;
            rays_.time[lane] = 0;
            rays_.mask[lane] = ~0u;
            rays_.id[lane] = lane;
            rays_.flags[lane] = 0;
        }
    }

    /// Adds the ray of bit j of word i.
    void add(uint32_t i, uint32_t j, const shader::Segment& segment) {
        const uint32_t lane = count_++;
        rays_.org_x[lane] = segment.origin.x, rays_.org_y[lane] = segment.origin.y,
        rays_.org_z[lane] = segment.origin.z;
        rays_.dir_x[lane] = segment.direction.x, rays_.dir_y[lane] = segment.direction.y;
        rays_.dir_z[lane] = segment.direction.z;
        rays_.tnear[lane] = segment.tMin, rays_.tfar[lane] = segment.tMax;
        pair_[lane] = uint16_t(i << 6 | j);
        if (count_ == kRays) trace();
    }

    /// Traces what has been added since.
    void trace() {
        if (count_ == 0) return;
        for (uint32_t lane = count_; lane < kRays; ++lane)
            valid_[lane] = 0;
        query_.context.blocker = kNoBlocker;
        embreeOccluded(valid_.data(), scene_, query_, rays_);
        if (query_.context.blocker != kNoBlocker) blockers_.add(query_.context.blocker);
        for (uint32_t lane = 0; lane < count_; ++lane) {
            if (rays_.tfar[lane] < 0) visible_[pair_[lane] >> 6] &= ~(uint64_t(1) << (pair_[lane] & 63));
        }
        count_ = 0;
    }

private:
    static constexpr uint32_t kNoBlocker = ~0u;

    alignas(64) RTCRay8 rays_;
    alignas(64) std::array<int, kRays> valid_;
    std::array<uint16_t, kRays> pair_;
    RTCScene scene_;
    EmbreeOccludedQuery query_;
    Blockers& blockers_;
    std::array<uint64_t, shader::kChunk>& visible_;
    uint32_t count_ = 0;
};

} // namespace relume
