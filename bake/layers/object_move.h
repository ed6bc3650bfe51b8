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
    std::vector<glm::uvec2> ends;        // likewise: links that end there may end elsewhere now; empty: none
    std::vector<uint32_t> instances;     // that moved
    bool texels = false;                 // others show what is baked: patches got hidden or inside something

    /// Adds a later move, as if both had been one.
    void add(const ObjectMove& later);
    void change(uint32_t patch) { set(changed, patch); }
    /// Has links that end at a patch traced again.
    void addEnd(uint32_t patch) {
        ends.resize(changed.size(), glm::uvec2(0));
        set(ends, patch);
    }
    bool changes(uint32_t chunk) const { return (changed[chunk].x | changed[chunk].y) != 0; }
    bool has(uint32_t patch) const {
        return shader::hasPatch(changed[patch / shader::kChunk], patch % shader::kChunk);
    }
    /// Tells whether links that end at a patch are to be traced again.
    bool hasEnd(uint32_t patch) const {
        return !ends.empty() && shader::hasPatch(ends[patch / shader::kChunk], patch % shader::kChunk);
    }

private:
    static void set(std::vector<glm::uvec2>& all, uint32_t patch) {
        glm::uvec2& bits = all[patch / shader::kChunk];
        (patch % shader::kChunk < 32 ? bits.x : bits.y) |= 1u << patch % 32;
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
