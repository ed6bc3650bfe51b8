#include "bake/surface/object_members.h"

#include <algorithm>

namespace relume {
namespace {

// Rays and boxes together may round off this share of a coordinate, with room.
constexpr float kBoxRounding = 1e-5f;

} // namespace

ObjectMembers::ObjectMembers(const std::vector<uint32_t>& instanceOf, size_t instances)
    : first_(instances + 2, 0), members_(instanceOf.size()) {
    for (const uint32_t instance : instanceOf) // padding is of one more
        ++first_[instance + 1];
    for (size_t i = 1; i < first_.size(); ++i)
        first_[i] += first_[i - 1];
    std::vector<uint32_t> next = first_;
    for (uint32_t i = 0; i < instanceOf.size(); ++i)
        members_[next[instanceOf[i]]++] = i;
}

std::vector<uint32_t> ObjectMembers::of(const std::vector<uint32_t>& instances) const {
    std::vector<uint32_t> all;
    for (const uint32_t instance : instances) {
        const std::span<const uint32_t> own = of(instance);
        all.insert(all.end(), own.begin(), own.end());
    }
    if (instances.size() > 1) std::sort(all.begin(), all.end());
    return all;
}

std::optional<shader::TraceBox> boxAround(const WorldMesh& mesh, std::span<const uint32_t> triangles) {
    if (triangles.empty()) return std::nullopt;
    shader::TraceBox box{glm::vec3(1e30f), glm::vec3(-1e30f)};
    for (const uint32_t t : triangles)
        for (size_t corner = size_t{t} * 3; corner < size_t{t} * 3 + 3; ++corner)
            box = {glm::min(box.lo, mesh.positions[corner]), glm::max(box.hi, mesh.positions[corner])};
    const glm::vec3 reach = glm::max(glm::abs(box.lo), glm::abs(box.hi));
    const float grown = kBoxRounding * std::max({reach.x, reach.y, reach.z});
    return shader::TraceBox{box.lo - grown, box.hi + grown};
}

} // namespace relume
