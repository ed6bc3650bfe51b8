#include "bake/baker/link_ends.h"

#include <algorithm>
#include <vector>

namespace relume {
namespace {

// A link ends within kHitReach of its hit, and so do those that would end there now.
constexpr int kReach = 2 * shader::kHitReach;

// Adds the patches of the chart around a texel.
void addAround(const TraceScene& scene, uint32_t texel, uint32_t chart, ObjectMove& move) {
    const auto size = static_cast<int>(scene.size);
    const int column = static_cast<int>(texel) % size, row = static_cast<int>(texel) / size;
    for (int y = std::max(0, row - kReach); y <= std::min(size - 1, row + kReach); ++y) {
        for (int x = std::max(0, column - kReach); x <= std::min(size - 1, column + kReach); ++x) {
            const uint32_t p =
                scene.texelToPatch[static_cast<size_t>(y) * scene.size + static_cast<size_t>(x)];
            if (p != shader::kNoPatch && scene.patchChart[p] == chart) move.addEnd(p);
        }
    }
}

} // namespace

void addLinkEnds(const TraceScene& scene, std::span<const uint32_t> patches, ObjectMove& move) {
    std::vector<uint8_t> charts; // 1: a patch of it sends
    for (const uint32_t i : patches) {
        const uint32_t chart = scene.patchChart[i];
        if (chart == kNoChart) continue; // no hit ends there
        if (scene.sendingChart(i) == kNoChart) {
            move.addEnd(i);
            continue;
        }
        if (charts.size() <= chart) charts.resize(size_t{chart} + 1, 0);
        charts[chart] = 1;
        addAround(scene, shader::patchTexel(scene.patches[i].flags), chart, move);
    }
    // Far from all patches that send, links have ended at a triangle's representative.
    if (charts.empty()) return;
    for (const shader::HitTriangle& triangle : scene.hitTriangles)
        if (triangle.representative != shader::kNoPatch && triangle.chart < charts.size() &&
            charts[triangle.chart] != 0)
            move.addEnd(triangle.representative);
}

} // namespace relume
