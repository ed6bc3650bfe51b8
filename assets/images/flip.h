#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// Holds two pictures as they are displayed, and which of their texels count.
struct FlipInput {
    uint32_t width = 0, height = 0;
    std::vector<glm::vec3> a, b; // linear RGB [0, 1]
    std::vector<bool> covered;   // the others weigh nothing, in no filter
};

/// This is the resolution of a screen of 0.7 m and 3840 pixels seen from 0.7 m [Andersson et al. 2020].
constexpr double kFlipPixelsPerDegree = 67.0;

/// Returns the difference that somebody flipping between two pictures sees, per texel, 0 to 1: LDR-FLIP
/// [Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild: FLIP: A Difference Evaluator for
/// Alternating Images, 2020]. It is 0 for texels that are not covered. With everything covered this is the
/// published metric; filters leave uncovered texels out, so that a chart's edge is as good as its middle.
std::vector<float> flip(const FlipInput& input, double pixelsPerDegree = kFlipPixelsPerDegree);

} // namespace relume
