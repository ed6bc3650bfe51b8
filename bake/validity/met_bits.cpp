#include "bake/validity/met_bits.h"

#include "bake/base/shader_types.h"

#include <bit>

namespace relume {
namespace {

constexpr uint32_t kFirst = (1u << kFirstDirections) - 1u;

// Half of what a texel just below a floor looks at is the floor's back, the other half nothing at all. More
// backs or more sky never make a patch that lies inside one that does not.
bool meetsEnough(uint32_t backs, uint32_t sky) {
    constexpr double kLeastBacks = 0.4 * kInsideDirections;
    return backs >= kLeastBacks && 2 * backs + sky > kInsideDirections;
}

} // namespace

void MetBits::note(uint32_t direction, uint32_t link) {
    const uint32_t bit = 1u << direction;
    backs = link == shader::kLinkBack ? backs | bit : backs & ~bit;
    sky = shader::linkIsSky(link) ? sky | bit : sky & ~bit;
}

Inside insideBy(const MetBits& met) {
    const uint32_t unknown = met.backs & met.sky, backs = met.backs & ~unknown, sky = met.sky & ~unknown;
    if ((backs & kFirst) == 0) return (unknown & kFirst) == 0 ? Inside::No : Inside::Unknown;
    const auto count = [](uint32_t bits) { return static_cast<uint32_t>(std::popcount(bits)); };
    if (!meetsEnough(count(backs | unknown), count(sky))) return Inside::No;
    return meetsEnough(count(backs), count(sky)) ? Inside::Yes : Inside::Unknown;
}

bool mayTouch(const MetBits& met) {
    const uint32_t unknown = met.backs & met.sky;
    return (unknown & kFirst) == 0 && (met.backs & kFirst) != 0 && insideBy(met) == Inside::No;
}

} // namespace relume
