#pragma once

#include <cstdint>

namespace relume {

/// So many directions of a patch tell whether it lies inside something, and so many are followed first.
constexpr uint32_t kInsideDirections = 32, kFirstDirections = 8;

/// Holds what these directions of a patch meet, a bit for each. A direction that nobody has followed has both
/// bits.
struct MetBits {
    uint32_t backs = ~0u, sky = ~0u;

    /// Takes note of a direction's link, as closest hits tell it.
    void note(uint32_t direction, uint32_t link);
    bool operator==(const MetBits&) const = default;
};

enum class Inside { No, Yes, Unknown };

/// Tells whether a patch lies inside something: at least two in five of its directions meet backs, more meet
/// backs than fronts, and one of the first directions meets a back. They are spread over the whole
/// hemisphere, so that hardly a patch inside something misses all backs, and most of a level is told by them
/// alone. Unknown: that depends on directions that nobody has followed.
Inside insideBy(const MetBits& met);

/// Tells whether a patch that does not lie inside something may lie upon a surface that stands on its own,
/// exactly, as walls do on the middles of texels where all sizes are round: half of its directions begin
/// inside that, at a corner a quarter. At least one of its first directions meets a back then.
bool mayTouch(const MetBits& met);

} // namespace relume
