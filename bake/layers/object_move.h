#pragma once

#include <vector>

#include "bake/base/retrace_types.h"
#include "assets/base/worker_pool.h"
#include "bake/surface/patches.h"

namespace relume {

/// Tells what is to be traced again after objects were moved, hidden or shown again.
struct ObjectMove {
    std::vector<shader::TraceBox> boxes; // where they were and are, grown by what floats round off
    std::vector<glm::uvec2> changed;     // per chunk, a bit for each patch that is another one than before
    std::vector<uint32_t> instances;     // that moved
    bool texels = false;                 // others show what is baked: patches got hidden or inside something

    /// Adds a later move, as if both had been one.
    void add(const ObjectMove& later);
    void change(uint32_t patch) {
        glm::uvec2& bits = changed[patch / shader::kChunk];
        (patch % shader::kChunk < 32 ? bits.x : bits.y) |= 1u << patch % 32;
    }
    bool changes(uint32_t chunk) const { return (changed[chunk].x | changed[chunk].y) != 0; }
    bool has(uint32_t patch) const {
        const glm::uvec2& bits = changed[patch / shader::kChunk];
        return ((patch % shader::kChunk < 32 ? bits.x : bits.y) >> patch % 32 & 1) != 0;
    }
};

/// The place that a light shines from, to tell which segments may meet a box.
struct LightPlace {
    enum class Kind : uint8_t {
        Box,        // within lo..hi [m]
        Directions, // from so far away: lo..hi is added to the receiver's position [m]
        Everywhere
    };
    Kind kind = Kind::Everywhere;
    glm::vec3 lo{0.0f}, hi{0.0f};
};

/// Returns a 1 per chunk where direct light from there may be another one after the move, because of what
/// segments to it meet or because of its patches.
std::vector<uint8_t> chunksReached(WorkerPool& pool, const PatchSet& patches, const LightPlace& light,
                                   const ObjectMove& move);

} // namespace relume
