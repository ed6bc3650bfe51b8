#include "bake/surface/patch_carry.h"

#include "assets/base/error.h"
#include "bake/surface/object_members.h"
#include "bake/surface/repaint.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <span>
#include <unordered_map>

namespace relume {
namespace {

using shader::kNoPatch;

constexpr uint64_t kFnvStart = 1469598103934665603u, kFnvPrime = 1099511628211u; // [Fowler, Noll, Vo]

bool emits(const Material& material) {
    return material.emission != glm::vec3(0.0f);
}

// Everything about one side of the comparison, object by object.
class Side {
public:
    explicit Side(const BakedSurfaces& surfaces)
        : surfaces_(surfaces), triangles_(mesh().instance, surfaces.scene.instances.size()),
          patches_(surfaces.patches.instance, surfaces.scene.instances.size()),
          ranks_(surfaces.patches.scene.patches.size(), kNoPatch), materials_(surfaces.scene.materials) {
        materials_.emplace_back(); // glTF's default material
        for (uint32_t i = 0; i < objects(); ++i) {
            uint32_t rank = 0;
            for (const uint32_t patch : patches_.of(i))
                ranks_[patch] = rank++;
        }
    }

    const Scene& scene() const { return surfaces_.scene; }
    const PatchSet& patchSet() const { return surfaces_.patches; }
    const TraceScene& traced() const { return surfaces_.patches.scene; }
    const WorldMesh& mesh() const { return traced().mesh; }
    const Material& materialOf(uint32_t triangle) const { return materials_[mesh().material[triangle]]; }
    uint32_t objects() const { return static_cast<uint32_t>(scene().instances.size()); }
    std::span<const uint32_t> triangles(uint32_t object) const { return triangles_.of(object); }
    std::span<const uint32_t> patches(uint32_t object) const { return patches_.of(object); }
    // Tells which of its object's patches a patch is.
    uint32_t rank(uint32_t patch) const { return patch == kNoPatch ? kNoPatch : ranks_[patch]; }
    // A hidden object leaves triangles and patches behind that are none.
    bool isThere(uint32_t object) const {
        return !scene().instances[object].hidden && !triangles(object).empty();
    }

    uint64_t hash(uint32_t object) const {
        uint64_t value = kFnvStart;
        const auto add = [&](const auto& corner) {
            std::array<uint32_t, sizeof corner / sizeof(uint32_t)> words{};
            std::memcpy(words.data(), &corner, sizeof corner);
            for (const uint32_t word : words)
                value = (value ^ word) * kFnvPrime;
        };
        for (const uint32_t t : triangles(object))
            for (size_t k = size_t{t} * 3; k < size_t{t} * 3 + 3; ++k) {
                add(mesh().positions[k]);
                add(mesh().lightmapUv[k]);
            }
        return value;
    }

private:
    BakedSurfaces surfaces_;
    ObjectMembers triangles_, patches_;
    std::vector<uint32_t> ranks_;
    std::vector<Material> materials_;
};

// Numbers charts, object by object, in the order in which they come.
class ChartNumbers {
public:
    uint32_t of(uint32_t chart) {
        if (chart == kNoChart) return kNoChart;
        return numbers_.try_emplace(chart, static_cast<uint32_t>(numbers_.size())).first->second;
    }

private:
    std::unordered_map<uint32_t, uint32_t> numbers_;
};

template<typename Value>
bool sameCorners(const std::vector<Value>& a, uint32_t s, const std::vector<Value>& b, uint32_t t) {
    return std::equal(a.begin() + std::ptrdiff_t{3} * s, a.begin() + std::ptrdiff_t{3} * s + 3,
                      b.begin() + std::ptrdiff_t{3} * t);
}

class Comparison {
public:
    Comparison(const BakedSurfaces& before, const BakedSurfaces& after) : before_(before), after_(after) {}

    PatchCarry run() {
        PatchCarry carry;
        carry.objects.resize(after_.objects());
        carry.former.assign(after_.patchSet().scene.patches.size(), kNoPatch);
        carry.now.assign(before_.patchSet().scene.patches.size(), kNoPatch);
        std::unordered_multimap<uint64_t, uint32_t> left; // objects that nobody is yet, by their hash
        for (uint32_t i = 0; i < before_.objects(); ++i)
            if (before_.isThere(i)) left.emplace(before_.hash(i), i);
        for (uint32_t i = 0; i < after_.objects(); ++i) {
            if (!after_.isThere(i)) continue;
            const auto [first, last] = left.equal_range(after_.hash(i));
            const auto found =
                std::find_if(first, last, [&](const auto& entry) { return areOne(entry.second, i); });
            if (found == last) {
                carry.changed.push_back(i);
                continue;
            }
            keep(found->second, i, carry);
            left.erase(found);
        }
        for (const auto& [hash, object] : left)
            carry.gone.push_back(object);
        std::sort(carry.gone.begin(), carry.gone.end());
        carry.same = carry.changed.empty() && carry.gone.empty() && isInPlace(carry);
        return carry;
    }

private:
    bool areOne(uint32_t then, uint32_t now) {
        return sameTriangles(then, now) && samePatches(then, now) && shineAlike(then, now);
    }

    bool sameTriangles(uint32_t then, uint32_t now) const {
        const std::span<const uint32_t> a = before_.triangles(then), b = after_.triangles(now);
        const WorldMesh &was = before_.mesh(), &is = after_.mesh();
        ChartNumbers chartsThen, chartsNow;
        return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](uint32_t s, uint32_t t) {
            const shader::HitTriangle& x = before_.traced().hitTriangles[s];
            const shader::HitTriangle& y = after_.traced().hitTriangles[t];
            return sameCorners(was.positions, s, is.positions, t) &&
                   sameCorners(was.normals, s, is.normals, t) &&
                   sameCorners(was.lightmapUv, s, is.lightmapUv, t) &&
                   chartsThen.of(was.chart[s]) == chartsNow.of(is.chart[t]) && x.normal == y.normal &&
                   x.doubleSided == y.doubleSided &&
                   before_.rank(x.representative) == after_.rank(y.representative) && sameHoles(s, t);
        });
    }

    // Tells whether rays pass both triangles in the same places.
    bool sameHoles(uint32_t s, uint32_t t) const {
        const TraceScene &was = before_.traced(), &is = after_.traced();
        const bool masked = s >= was.mesh.opaqueCount;
        if (masked != (t >= is.mesh.opaqueCount)) return false;
        if (!masked) return true;
        const shader::AlphaTriangle& x = was.alphaTriangles[s - was.mesh.opaqueCount];
        const shader::AlphaTriangle& y = is.alphaTriangles[t - is.mesh.opaqueCount];
        return x.uv0 == y.uv0 && x.uv1 == y.uv1 && x.uv2 == y.uv2 && x.a0 == y.a0 && x.a1 == y.a1 &&
               x.a2 == y.a2 && sameMask(x.material, y.material);
    }
    bool sameMask(uint32_t x, uint32_t y) const {
        const auto [found, isNew] = masks_.try_emplace({x, y}, false);
        if (isNew) found->second = compareMasks(x, y);
        return found->second;
    }
    bool compareMasks(uint32_t x, uint32_t y) const {
        const TraceScene &was = before_.traced(), &is = after_.traced();
        const shader::AlphaMaterial &a = was.alphaMaterials[x], &b = is.alphaMaterials[y];
        constexpr uint32_t kPlain = 0xffffffffu;
        if (a.factor != b.factor || a.cutoff != b.cutoff || (a.texels == kPlain) != (b.texels == kPlain))
            return false;
        if (a.texels == kPlain) return true;
        const auto from = was.alphaTexels.begin() + a.texels;
        return a.width == b.width && a.height == b.height && a.wrapS == b.wrapS && a.wrapT == b.wrapT &&
               std::equal(from, from + std::ptrdiff_t{a.width} * a.height, is.alphaTexels.begin() + b.texels);
    }

    // Compares what was found of the surface alone: a patch may lie inside something else now.
    bool samePatches(uint32_t then, uint32_t now) const {
        const std::span<const uint32_t> a = before_.patches(then), b = after_.patches(now);
        const PatchSet &was = before_.patchSet(), &is = after_.patchSet();
        if (was.covers.empty() != is.covers.empty()) return false;
        ChartNumbers chartsThen, chartsNow;
        return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](uint32_t i, uint32_t k) {
            const shader::Patch &x = was.scene.patches[i], &y = is.scene.patches[k];
            const uint32_t texel = shader::patchTexel(x.flags);
            return x.position == y.position && x.offset == y.offset && x.normal == y.normal &&
                   x.area == y.area && x.shading == y.shading &&
                   (x.flags | shader::kPatchSends) == (y.flags | shader::kPatchSends) &&
                   was.edges[i].du == is.edges[k].du && was.edges[i].dv == is.edges[k].dv &&
                   chartsThen.of(was.scene.patchChart[i]) == chartsNow.of(is.scene.patchChart[k]) &&
                   (was.scene.texelToPatch[texel] == i) == (is.scene.texelToPatch[texel] == k) &&
                   sameCover(i, k);
        });
    }
    bool sameCover(uint32_t i, uint32_t k) const {
        const PatchSet &was = before_.patchSet(), &is = after_.patchSet();
        if (was.covers.empty()) return true;
        const shader::PatchCover &x = was.covers[i], &y = is.covers[k];
        return was.coverCells[i] == is.coverCells[k] && x.du == y.du && x.dv == y.dv && x.place == y.place;
    }

    // Tells whether all that both shine with is the same, but for how strong it is.
    bool shineAlike(uint32_t then, uint32_t now) const {
        const std::span<const uint32_t> a = before_.triangles(then), b = after_.triangles(now);
        const WorldMesh &was = before_.mesh(), &is = after_.mesh();
        std::map<uint32_t, uint32_t> to, from; // materials
        for (size_t i = 0; i < a.size(); ++i) {
            const Material &x = before_.materialOf(a[i]), &y = after_.materialOf(b[i]);
            if (!emits(x) || !emits(y)) continue;
            const uint32_t one = was.material[a[i]], other = is.material[b[i]];
            if (to.try_emplace(one, other).first->second != other ||
                from.try_emplace(other, one).first->second != one ||
                !sameGlow(x.emissionTexture.texture, y.emissionTexture.texture))
                return false;
            if (x.emissionTexture.texture >= 0 && !sameCorners(was.emissionUv, a[i], is.emissionUv, b[i]))
                return false;
        }
        return true;
    }
    bool sameGlow(int x, int y) const {
        const auto [found, isNew] = glows_.try_emplace({x, y}, false);
        if (isNew) found->second = sameTexture(before_.scene(), x, after_.scene(), y);
        return found->second;
    }

    void keep(uint32_t then, uint32_t now, PatchCarry& carry) const {
        PatchCarry::Object& object = carry.objects[now];
        object.former = then;
        const std::span<const uint32_t> triangles = after_.triangles(now);
        for (size_t i = 0; i < triangles.size(); ++i) {
            const std::pair both(after_.mesh().material[triangles[i]],
                                 before_.mesh().material[before_.triangles(then)[i]]);
            if (std::find(object.materials.begin(), object.materials.end(), both) == object.materials.end())
                object.materials.push_back(both);
        }
        const std::span<const uint32_t> patches = after_.patches(now);
        for (size_t i = 0; i < patches.size(); ++i) {
            carry.former[patches[i]] = before_.patches(then)[i];
            carry.now[before_.patches(then)[i]] = patches[i];
        }
        carry.kept += static_cast<uint32_t>(patches.size());
    }

    bool isInPlace(const PatchCarry& carry) const {
        if (before_.patchSet().count != after_.patchSet().count) return false;
        for (uint32_t i = 0; i < after_.patchSet().count; ++i)
            if (carry.former[i] != i) return false;
        return true;
    }

    const Side before_, after_;
    mutable std::map<std::pair<uint32_t, uint32_t>, bool> masks_; // that were compared
    mutable std::map<std::pair<int, int>, bool> glows_;           // emission textures that were
};

} // namespace

std::optional<std::pair<uint32_t, uint32_t>> PatchCarry::formerLight(uint32_t instance,
                                                                     uint32_t material) const {
    const Object& object = objects[instance];
    if (object.former == kNoPatch) return std::nullopt;
    std::optional<uint32_t> then;
    for (const auto& [is, was] : object.materials) {
        if (is != material) continue;
        if (then) return std::nullopt;
        then = was;
    }
    if (!then) return std::nullopt;
    const auto parts = std::count_if(object.materials.begin(), object.materials.end(),
                                     [&](const auto& both) { return both.second == *then; });
    if (parts != 1) return std::nullopt; // only part of it
    return std::pair(object.former, *then);
}

PatchCarry carryPatches(const BakedSurfaces& before, const BakedSurfaces& after) {
    ASSERT(before.patches.scene.size == after.patches.scene.size);
    return Comparison(before, after).run();
}

void carrySearches(const PatchCarry& carry, const PatchSet& before, PatchSet& after) {
    for (uint32_t i = 0; i < after.count; ++i) {
        const uint32_t then = carry.former[i];
        if (then == kNoPatch) continue;
        shader::Patch& patch = after.scene.patches[i];
        patch.flags =
            (patch.flags & ~shader::kPatchSends) | (before.scene.patches[then].flags & shader::kPatchSends);
        if (!after.covers.empty()) after.covers[i].cells = before.covers[then].cells;
    }
}

bool sameColours(const PatchSet& before, const PatchSet& after) {
    return before.albedo == after.albedo && before.emissionPattern == after.emissionPattern;
}

} // namespace relume
