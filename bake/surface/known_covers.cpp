#include "bake/surface/known_covers.h"

#include "bake/surface/object_members.h"

#include <algorithm>
#include <span>
#include <unordered_map>

namespace relume {
namespace {

using shader::kNoPatch;

// Tells whether triangle t of b lies where triangle s of a lies, in the world and in the lightmap.
bool sameTriangle(const WorldMesh& a, uint32_t s, const WorldMesh& b, uint32_t t) {
    const auto same = [&](const auto& x, const auto& y) {
        return std::equal(x.begin() + std::ptrdiff_t{3} * s, x.begin() + std::ptrdiff_t{3} * s + 3,
                          y.begin() + std::ptrdiff_t{3} * t);
    };
    return same(a.positions, b.positions) && same(a.normals, b.normals) && same(a.lightmapUv, b.lightmapUv) &&
           (s < a.opaqueCount) == (t < b.opaqueCount);
}

// There are triangles of b.
bool sameObject(const WorldMesh& a, std::span<const uint32_t> x, const WorldMesh& b,
                std::span<const uint32_t> y) {
    if (x.size() != y.size() || !sameTriangle(a, x[0], b, y[0])) return false;
    std::unordered_map<uint32_t, uint32_t> to, from; // charts
    for (size_t i = 0; i < x.size(); ++i) {
        const uint32_t then = a.chart[x[i]], now = b.chart[y[i]];
        if ((then == kNoChart) != (now == kNoChart) || to.try_emplace(then, now).first->second != now ||
            from.try_emplace(now, then).first->second != then || !sameTriangle(a, x[i], b, y[i]))
            return false;
    }
    return true;
}

} // namespace

uint32_t KnownCovers::of(const PatchSet& set, uint32_t patch) const {
    const uint32_t instance = set.instance[patch];
    if (instance >= objects.size() || objects[instance] == kNoPatch) return kNoPatch;
    const shader::Patch& now = set.scene.patches[patch];
    const uint32_t then = former.scene.texelToPatch[shader::patchTexel(now.flags)];
    if (then == kNoPatch || former.instance[then] != objects[instance]) return kNoPatch;
    const shader::Patch& was = former.scene.patches[then];
    return was.position == now.position && was.normal == now.normal && was.area == now.area ? then : kNoPatch;
}

KnownCovers knownCovers(const BakedSurfaces& before, const WorldMesh& mesh, size_t instances) {
    KnownCovers known{before.patches, std::vector<uint32_t>(instances, kNoPatch)};
    const WorldMesh& was = before.patches.scene.mesh;
    if (before.patches.covers.empty()) return known;
    const ObjectMembers then(was.instance, before.scene.instances.size()), now(mesh.instance, instances);
    // Objects that stay are in the order that they were in, but for those between that came or went.
    uint32_t next = 0;
    const auto former = static_cast<uint32_t>(before.scene.instances.size());
    for (uint32_t i = 0; i < instances; ++i) {
        if (now.of(i).empty()) continue;
        uint32_t found = next;
        while (found < former && !sameObject(was, then.of(found), mesh, now.of(i)))
            ++found;
        if (found == former) continue;
        known.objects[i] = found;
        next = found + 1;
    }
    return known;
}

} // namespace relume
