#include "bake/baker/move_boxes.h"

#include <optional>

namespace relume {
namespace {

constexpr size_t kMostMoveBoxes = 4;

} // namespace

void addBox(const WorldMesh& mesh, std::span<const uint32_t> triangles,
            std::vector<shader::TraceBox>& boxes) {
    if (const std::optional<shader::TraceBox> box = boxAround(mesh, triangles)) boxes.push_back(*box);
}

std::vector<shader::TraceBox> fewBoxes(std::vector<shader::TraceBox> boxes) {
    if (boxes.size() <= kMostMoveBoxes) return boxes;
    shader::TraceBox around = boxes.front();
    for (const shader::TraceBox& box : boxes)
        around = {glm::min(around.lo, box.lo), glm::max(around.hi, box.hi)};
    return {around};
}

} // namespace relume
