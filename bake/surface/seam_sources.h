#pragma once

#include <cstdint>

#include "bake/surface/patch_set.h"

namespace relume {

/// Says of which of its covered neighbours SewSeams makes the texels right beside charts. Where charts lie
/// close, that is no open question: a bilinear filter reads such a texel for the one chart and not for the
/// other, whose light may be a thousand times as much.
class SeamSources {
public:
    /// Keeps the set by reference.
    explicit SeamSources(const PatchSet& set) : set_(set) {}

    /// Chooses among neighbours that are patches (bits of shader::seamOffset, at least one) those that make
    /// the light of a texel. A texel of a patch that lies inside something takes those of its own chart. An
    /// empty one takes those of charts for which filters read it. Where there are none of these, all serve,
    /// as with the RTRad preset.
    uint32_t choose(uint32_t texel, uint32_t among) const;

private:
    uint32_t patchAt(uint32_t texel, uint32_t neighbour) const;
    bool reads(uint32_t patch, uint32_t neighbour) const;

    const PatchSet& set_;
};

} // namespace relume
