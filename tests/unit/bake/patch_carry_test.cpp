// These are patches of levels whose meshes, materials and objects were edited: which of them stay.
#include "bake/layers/layer_carry.h"
#include "bake/surface/known_covers.h"
#include "bake/surface/patch_carry.h"

#include <gtest/gtest.h>

#include <numeric>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;

/// Makes a level of squares, each an object with a chart of `texels` patches in a row of the lightmap.
class Squares {
public:
    explicit Squares(uint32_t size = 16) {
        set.scene.size = size;
        set.scene.texelToPatch.assign(size_t{size} * size, kNoPatch);
        scene.materials.resize(2);
    }

    /// Adds a square at x, in this row of texels.
    Squares& add(float x, uint32_t row, uint32_t material = 0, uint32_t texels = 4) {
        const auto object = static_cast<uint32_t>(scene.instances.size());
        scene.instances.push_back({.name = "Square", .mesh = 0});
        WorldMesh& mesh = set.scene.mesh;
        const uint32_t chart = mesh.chartCount++;
        const auto first = static_cast<uint32_t>(set.scene.patches.size());
        for (uint32_t t = 0; t < 2; ++t) {
            const float side = static_cast<float>(t);
            mesh.positions.insert(mesh.positions.end(), {{x, 0, 0}, {x + 1, side, 0}, {x + side, 1, 0}});
            mesh.normals.insert(mesh.normals.end(), 3, glm::vec3(0, 0, 1));
            mesh.lightmapUv.insert(mesh.lightmapUv.end(), 3, glm::vec2(side, static_cast<float>(row)));
            mesh.emissionUv.insert(mesh.emissionUv.end(), 3, glm::vec2(side));
            mesh.material.push_back(material);
            mesh.instance.push_back(object);
            mesh.chart.push_back(chart);
            shader::HitTriangle& hit = set.scene.hitTriangles.emplace_back();
            hit.chart = chart;
            hit.representative = first + t;
        }
        mesh.opaqueCount = mesh.triangleCount();
        for (uint32_t i = 0; i < texels; ++i) {
            const uint32_t texel = row * set.scene.size + i, patch = first + i;
            set.scene.texelToPatch[texel] = patch;
            shader::Patch& made = set.scene.patches.emplace_back();
            made.position = {x, static_cast<float>(i), 0};
            made.area = 1.0f;
            made.flags = shader::kPatchSends | texel << shader::kTexelShift;
            set.scene.patchChart.push_back(chart);
            set.edges.emplace_back();
            set.covers.emplace_back().cells = shader::kCoverWhole;
            set.coverCells.push_back(shader::kCoverWhole);
            set.instance.push_back(object);
            set.albedo.emplace_back(0.5f);
            set.emissionPattern.emplace_back(1.0f);
        }
        return *this;
    }
    Squares& end() {
        set.count = static_cast<uint32_t>(set.scene.patches.size());
        const size_t padded = (set.count + kChunk - 1) / kChunk * kChunk;
        set.scene.patches.resize(padded);
        set.scene.patchChart.resize(padded, kNoChart);
        set.edges.resize(padded);
        set.covers.resize(padded);
        set.coverCells.resize(padded, 0);
        set.instance.resize(padded, static_cast<uint32_t>(scene.instances.size()));
        set.albedo.resize(padded);
        set.emissionPattern.resize(padded);
        return *this;
    }

    Scene scene;
    PatchSet set;
};

PatchCarry carried(const Squares& before, const Squares& after) {
    return carryPatches({before.scene, before.set}, {after.scene, after.set});
}

using List = std::vector<uint32_t>;

TEST(PatchCarry, TheSameLevelStaysAsAWhole) {
    const Squares level = Squares().add(0, 0).add(2, 1).end();
    const PatchCarry carry = carried(level, level);
    EXPECT_TRUE(carry.same);
    EXPECT_EQ(carry.kept, 8u);
    EXPECT_TRUE(carry.changed.empty() && carry.gone.empty());
    EXPECT_TRUE(sameColours(level.set, level.set));
}

TEST(PatchCarry, CoversOfObjectsThatStayAreKnown) {
    const Squares before = Squares().add(0, 0).add(2, 3).end();
    const Squares after = Squares().add(0, 0).add(2, 3).add(4, 5).end();
    const KnownCovers known = knownCovers({before.scene, before.set}, after.set.scene.mesh, 3);
    EXPECT_EQ(known.objects, (List{0, 1, kNoPatch}));
    for (uint32_t patch = 0; patch < after.set.count; ++patch)
        EXPECT_EQ(known.of(after.set, patch), patch < before.set.count ? patch : kNoPatch);
}

TEST(PatchCarry, NamesAndNumbersSayNothing) {
    const Squares before = Squares().add(0, 0).add(2, 1).end();
    Squares after = Squares().add(2, 1).add(0, 0).end();
    after.scene.instances[0].name = "Another name";
    const PatchCarry carry = carried(before, after);
    EXPECT_EQ(carry.objects[0].former, 1u);
    EXPECT_EQ(carry.objects[1].former, 0u);
    EXPECT_EQ(carry.former[0], 4u);
    EXPECT_EQ(carry.now[0], 4u);
    EXPECT_FALSE(carry.same) << "its patches stand in another order";
    EXPECT_TRUE(carry.changed.empty() && carry.gone.empty());
}

TEST(PatchCarry, WhatCameWentOrMovedIsTold) {
    const Squares before = Squares().add(0, 0).add(2, 1).add(4, 2).end();
    const Squares after = Squares().add(0, 0).add(2.5f, 1).add(6, 3).end();
    const PatchCarry carry = carried(before, after);
    EXPECT_EQ(carry.changed, (List{1, 2}));
    EXPECT_EQ(carry.gone, (List{1, 2}));
    EXPECT_EQ(carry.kept, 4u);
    EXPECT_EQ(carry.former[4], kNoPatch);
    EXPECT_EQ(carry.now[4], kNoPatch);
    EXPECT_FALSE(carry.same);
}

TEST(PatchCarry, AHiddenObjectWasNotThere) {
    Squares before = Squares().add(0, 0).add(2, 1).end();
    before.scene.instances[1].hidden = true;
    const PatchCarry carry = carried(before, Squares().add(0, 0).end());
    EXPECT_TRUE(carry.gone.empty());
    EXPECT_EQ(carry.kept, 4u);
}

// Each of these makes another object of the second square.
TEST(PatchCarry, WhatRaysOrSamplesMeetMustBeTheSame) {
    using Change = void (*)(Squares&);
    const Squares before = Squares().add(0, 0).add(2, 1).end();
    for (const Change change :
         {+[](Squares& s) { s.set.scene.mesh.normals[8].x = 0.5f; },
          +[](Squares& s) { s.set.scene.mesh.chart[3] = kNoChart; },
          +[](Squares& s) { s.set.scene.hitTriangles[3].doubleSided = 1; },
          +[](Squares& s) { s.set.scene.hitTriangles[3].representative = 7; },
          +[](Squares& s) { s.set.scene.patches[6].area = 2.0f; },
          +[](Squares& s) { s.set.scene.patches[6].flags |= shader::kPatchThin; },
          +[](Squares& s) { s.set.scene.texelToPatch[17] = kNoPatch; },
          +[](Squares& s) { s.set.edges[6].du.x = 1.0f; }, +[](Squares& s) { s.set.coverCells[6] = 1; }}) {
        Squares after = before;
        change(after);
        const PatchCarry carry = carried(before, after);
        EXPECT_EQ(carry.changed, List{1});
        EXPECT_EQ(carry.gone, List{1});
    }
    Squares coloured = before;
    coloured.set.albedo[6] = glm::vec4(0.25f);
    EXPECT_TRUE(carried(before, coloured).same) << "colours cost no ray";
    EXPECT_FALSE(sameColours(before.set, coloured.set));
}

TEST(PatchCarry, WhatWasFoundOfAPatchStays) {
    Squares before = Squares().add(0, 0).add(2, 1).end();
    before.set.scene.patches[5].flags &= ~shader::kPatchSends; // it lies inside something
    before.set.covers[6].cells = 3;                            // a wall crosses it
    Squares after = Squares().add(2, 1).end();
    const PatchCarry carry = carried(before, after);
    EXPECT_EQ(carry.kept, 4u);
    carrySearches(carry, before.set, after.set);
    EXPECT_EQ(after.set.scene.patches[1].flags & shader::kPatchSends, 0u);
    EXPECT_NE(after.set.scene.patches[2].flags & shader::kPatchSends, 0u);
    EXPECT_EQ(after.set.covers[2].cells, 3u);
}

TEST(PatchCarry, ALightIsKnownByItsObjectAndMaterial) {
    Squares before = Squares().add(0, 0, 1).add(2, 1, 0).end();
    before.scene.materials[1].emission = glm::vec3(5.0f);
    Squares after = Squares().add(2, 1, 1).add(0, 0, 0).end();
    after.scene.materials[0].emission = glm::vec3(2.0f);
    const PatchCarry carry = carried(before, after);
    EXPECT_EQ(carry.formerLight(1, 0), (std::pair<uint32_t, uint32_t>(0, 1)));
    EXPECT_EQ(carry.formerLight(1, 1), std::nullopt) << "it has no such material";

    // A light with another picture of what shines is another light.
    for (Squares* side : {&before, &after}) {
        side->scene.textures.push_back({.image = 0});
        side->scene.images.push_back({.name = "Glow", .width = 1, .height = 1, .rgba = {255, 0, 0, 255}});
    }
    before.scene.materials[1].emissionTexture.texture = 0;
    after.scene.materials[0].emissionTexture.texture = 0;
    EXPECT_EQ(carried(before, after).kept, 8u);
    after.scene.images[0].rgba[1] = 255;
    EXPECT_EQ(carried(before, after).changed, List{1});
}

TEST(LayerCarry, LinksLeadToWhereTheirPatchesAre) {
    PatchCarry carry;
    carry.former.assign(kChunk, kNoPatch);
    carry.now.assign(2 * kChunk, kNoPatch);
    carry.former[0] = 70;
    carry.now[70] = 0;
    carry.former[1] = 3;
    carry.now[3] = 1;
    constexpr uint32_t kSamples = 8;
    std::vector<uint32_t> from(2 * kSamples * kChunk);
    std::iota(from.begin(), from.end(), 0u); // most lead nowhere
    from[kSamples * kChunk + 6] = 3;
    from[kSamples * kChunk + kChunk + 6] = shader::kLinkBack;
    from[2 * kChunk + 3] = 70;
    for (uint32_t& link : from)
        if (link >= 2 * kChunk && link < shader::kLinkFirstSpecial) link = 9;
    std::vector<uint32_t> to(kSamples * kChunk);
    carryLinks(carry, 0, kSamples, from, to.data());
    EXPECT_EQ(to[0], 1u);
    EXPECT_EQ(to[kChunk], shader::kLinkBack);
    EXPECT_EQ(to[2 * kChunk], shader::kLinkDark) << "its patch is there no more";
    EXPECT_EQ(to[2 * kChunk + 1], 0u);
    EXPECT_EQ(to[5], shader::kLinkDark) << "it has none yet";
}

TEST(LayerCarry, ChunksAreKnownWhereAllThatCameAlongIs) {
    PatchCarry carry;
    carry.former.assign(3 * kChunk, kNoPatch);
    carry.former[0] = 5;
    carry.former[1] = kChunk + 5;
    carry.former[kChunk] = 6;
    const std::vector<uint8_t> known{1, 0};
    EXPECT_EQ(carryKnown(carry, known), (std::vector<uint8_t>{0, 1, 0}));
}

TEST(LayerCarry, MovesAndValuesFollowTheirPatches) {
    PatchCarry carry;
    carry.former.assign(kChunk, kNoPatch);
    carry.former[2] = 40;
    carry.former[3] = 41;
    ObjectMove move;
    move.boxes = {{glm::vec3(0.0f), glm::vec3(1.0f)}};
    move.changed = {glm::uvec2(0)};
    move.change(41);
    const ObjectMove now = carryMove(carry, move);
    EXPECT_FALSE(now.has(2));
    EXPECT_TRUE(now.has(3));
    EXPECT_TRUE(now.has(4)) << "it was not there";
    EXPECT_EQ(now.boxes.size(), 1u);
    std::vector<glm::vec4> values(kChunk, glm::vec4(7.0f));
    values[40] = glm::vec4(3.0f);
    EXPECT_EQ(carryValues(carry, values)[2], glm::vec4(3.0f));
    EXPECT_EQ(carryValues(carry, values)[4], glm::vec4(0.0f));
}

TEST(LayerCarry, ACacheKeyIsTranslated) {
    PatchCarry patches;
    patches.objects.resize(1);
    patches.objects[0] = {.former = 4, .materials = {{2, 1}}};
    FormerLayers former;
    const ObjectMove move;
    LayerCarry carry{.former = former, .patches = patches, .move = move, .sameSky = false};
    LightCacheKey light;
    light.kind = LightKey::Kind::Emitter;
    light.material = 2;
    light.surfaces = 3;
    light.objects = 9;
    const auto then = formerCacheKey(light, carry);
    ASSERT_TRUE(then);
    EXPECT_EQ(then->instance, 4u);
    EXPECT_EQ(then->material, 1u);
    EXPECT_EQ(then->surfaces + then->objects, 0u);
    LightCacheKey sky;
    sky.file = "sky.hdr";
    EXPECT_FALSE(formerCacheKey(sky, carry)) << "it has another picture";
    carry.sameSky = true;
    EXPECT_TRUE(formerCacheKey(sky, carry));
    LightCacheKey group;
    group.kind = LightKey::Kind::Group;
    group.members = {light, sky};
    ASSERT_TRUE(formerCacheKey(group, carry));
    EXPECT_EQ(formerCacheKey(group, carry)->members[0].instance, 4u);
}

} // namespace
} // namespace relume
