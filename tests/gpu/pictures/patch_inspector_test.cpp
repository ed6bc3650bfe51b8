// What the visualisations show is held against what can be told about simple scenes or asked in another way.
#include "assets/generate/generate.h"
#include "bake/show/patch_inspector.h"
#include "bake/trace/make_tracer.h"
#include "bake/vk/commands.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <set>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;

/// Holds a baker and an inspector of it.
struct Inspected {
    explicit Inspected(const Scene& scene, const BakeDesc& desc = {})
        : baker(makeBaker(scene, desc)),
          inspector({.device = testDevice(),
                     .patches = baker->patches(),
                     .light = baker->light(),
                     .tracer = baker->tracer(),
                     .transport = {.rtrad = desc.rtrad},
                     .links = {.directions = desc.directions, .rotation = desc.rotation}}) {}

    const PatchSet& set() const { return baker->patches(); }
    const shader::Patch& patch(uint32_t i) const { return set().scene.patches[i]; }
    uint32_t at(const TexelRect& rect, uint32_t column, uint32_t row) const {
        return inspector.patchAt(rect.x + column, rect.y + row);
    }

    std::unique_ptr<Baker> baker;
    PatchInspector inspector;
};

PatchValues randomValues(size_t count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0.0f, 2.0f);
    PatchValues values(count);
    for (glm::vec4& v : values)
        v = {uniform(random), uniform(random), uniform(random), 1.0f};
    return values;
}

const std::array<glm::vec3, 3> kUnitBox = {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)};

TEST(PatchInspector, QuantitiesAreThePatches) {
    SceneMaker maker(64);
    const auto walls = maker.box(glm::vec3(0), kUnitBox, maker.material(0.25f), 10);
    Inspected box(maker.scene());
    const PatchValues position = box.inspector.quantity(PatchQuantity::Position),
                      normal = box.inspector.quantity(PatchQuantity::Normal),
                      albedo = box.inspector.quantity(PatchQuantity::Albedo),
                      area = box.inspector.quantity(PatchQuantity::Area);
    const uint32_t patch = box.at(walls[0], 3, 7); // the wall at x = 0, columns along y
    EXPECT_LT(glm::distance(glm::vec3(position[patch]), glm::vec3(0, 0.35f, 0.75f)), 1e-5f);
    EXPECT_LT(glm::distance(glm::vec3(normal[patch]), glm::vec3(1, 0, 0)), 1e-5f);
    EXPECT_NEAR(albedo[patch].g, 0.25f * (1.0f - 0.0f), 1e-3f);
    EXPECT_NEAR(area[patch].r, 0.01f, 1e-5f);
    for (const PatchValues& values : {position, normal, albedo, area})
        EXPECT_EQ(values.size(), box.set().scene.patches.size());
}

TEST(PatchInspector, LightIsTheSolvers) {
    Inspected inspected(generateScene("cornell_small"), {.size = 32, .passes = 2});
    Solver& solver = inspected.baker->solver();
    while (!solver.done())
        solver.step();
    const PatchValues out = inspected.inspector.ligOut();
    double sum = 0;
    for (uint32_t i = 0; i < inspected.set().count; ++i)
        sum += out[i].r + inspected.inspector.ligIn()[i].r;
    EXPECT_GT(sum, 0.0);
    const PatchValues errors = PatchInspector::grey({0.5f, 2.0f});
    EXPECT_EQ(errors[1], glm::vec4(2.0f, 2.0f, 2.0f, 1.0f));
    EXPECT_TRUE(PatchInspector::grey({}).empty());
}

TEST(PatchInspector, MipsAreMeansOfWindowsWithinCharts) {
    SceneMaker maker(64);
    maker.box(glm::vec3(0), kUnitBox, maker.material(0.5f), 10);
    Inspected box(maker.scene());
    const PatchValues values = randomValues(box.set().scene.patches.size());
    EXPECT_EQ(box.inspector.mip(values, 0), values);
    for (uint32_t mip : {1u, 2u, 4u}) {
        const PatchValues means = box.inspector.mip(values, mip);
        std::map<std::array<uint32_t, 3>, std::pair<glm::dvec3, double>> windows;
        const auto key = [&](uint32_t i) {
            const uint32_t texel = shader::patchTexel(box.patch(i).flags);
            return std::array{box.set().scene.patchChart[i], texel % 64 >> mip, texel / 64 >> mip};
        };
        for (uint32_t i = 0; i < box.set().count; ++i) {
            auto& [sum, area] = windows[key(i)];
            sum += double{box.patch(i).area} * glm::dvec3(values[i]);
            area += box.patch(i).area;
        }
        for (uint32_t i = 0; i < box.set().count; ++i) {
            const auto& [sum, area] = windows[key(i)];
            ASSERT_LT(glm::distance(glm::dvec3(means[i]), sum / area), 1e-5) << mip;
        }
    }
}

// There is even light in half of a wall and a steep slope in the other: the tree keeps large leaves here and
// single texels there.
TEST(PatchInspector, LeavesFollowTheLight) {
    SceneMaker maker(64);
    maker.box(glm::vec3(0), kUnitBox, maker.material(0.5f), 16);
    Inspected box(maker.scene());
    PatchValues light(box.set().scene.patches.size(), glm::vec4(1.0f));
    for (uint32_t i = 0; i < box.set().count; ++i)
        if (box.patch(i).position.x > 0.5f) light[i] = glm::vec4(1.0f + 40.0f * box.patch(i).position.x);
    const PatchValues leaves = box.inspector.leaves(light, {.node = 8, .threshold = 0.02f});
    uint32_t largest = 0, single = 0;
    for (uint32_t i = 0; i < box.set().count; ++i) {
        ASSERT_GE(leaves[i].r, 1.0f);
        if (box.patch(i).normal.x > 0.5f) { // the wall at x = 0, all even
            largest += leaves[i].r == 64.0f;
        } else if (box.patch(i).normal.z < -0.5f && box.patch(i).position.x > 0.55f) {
            single += leaves[i].r == 1.0f;
        }
        if (leaves[i].r == 1.0f) {
            EXPECT_EQ(leaves[i].g, 1.0f); // all border
        }
    }
    EXPECT_GT(largest, 60u);
    EXPECT_GT(single, 60u);
    // In an 8x8 leaf, 28 texels lie along its border.
    uint32_t inside = 0;
    for (uint32_t i = 0; i < box.set().count; ++i)
        inside += leaves[i].r == 64.0f && leaves[i].g == 0.0f;
    uint32_t held = 0;
    for (uint32_t i = 0; i < box.set().count; ++i)
        held += leaves[i].r == 64.0f;
    EXPECT_EQ(inside * 64, held * 36);
}

TEST(PatchInspector, RtradsLeavesAreSquares) {
    Inspected inspected(generateScene("cornell_small"), {.size = 64, .rtrad = true});
    const PatchValues light(inspected.set().scene.patches.size(), glm::vec4(0.5f));
    const PatchValues leaves = inspected.inspector.leaves(light, {.node = 8, .threshold = 0.05f});
    std::set<float> sizes;
    for (uint32_t i = 0; i < inspected.set().count; ++i)
        sizes.insert(leaves[i].r);
    for (float size : sizes)
        EXPECT_TRUE(size == 1.0f || size == 4.0f || size == 16.0f) << size; // RTRad stops below the node
    EXPECT_GT(sizes.size(), 1u);
}

// In an empty convex box each patch sees those of all other walls, and what it sees fills its half-space.
TEST(PatchInspector, SeesAllOtherWallsOfABox) {
    SceneMaker maker(64);
    maker.box(glm::vec3(0), kUnitBox, maker.material(0.5f), 10);
    for (TracerKind tracer : tracersOfTestDevice()) {
        Inspected box(maker.scene(), {.tracer = tracer});
        const uint32_t patch = box.inspector.patchAt(4, 4);
        const PatchValues seen = box.inspector.seenFrom(patch);
        float largest = 0;
        for (uint32_t i = 0; i < box.set().count; ++i) {
            const bool other = glm::dot(box.patch(i).normal, box.patch(patch).normal) < 0.9f;
            ASSERT_EQ(seen[i].r, other ? 1.0f : 0.0f) << i;
            ASSERT_EQ(seen[i].b, i == patch ? 1.0f : 0.0f) << i;
            ASSERT_EQ(seen[i].g > 0.0f, other) << i;
            largest = std::max(largest, seen[i].g);
        }
        EXPECT_EQ(largest, 1.0f);
    }
}

// The preset asks for whole blocks, of which there are many super-blocks here.
TEST(PatchInspector, RtradSeesAllOtherWallsOfABox) {
    SceneMaker maker(192);
    maker.box(glm::vec3(0), kUnitBox, maker.material(0.5f), 54);
    Inspected box(maker.scene(), {.size = 192, .rtrad = true});
    ASSERT_GT(box.set().chunkCount(), 17 * shader::kSuper);
    for (uint32_t patch : {3u, box.set().count / 2, box.set().count - 1}) {
        const PatchValues seen = box.inspector.seenFrom(patch);
        uint32_t wrong = 0;
        for (uint32_t i = 0; i < box.set().count; ++i) {
            const bool other = glm::dot(box.patch(i).normal, box.patch(patch).normal) < 0.9f;
            wrong += seen[i].r != (other ? 1.0f : 0.0f);
        }
        EXPECT_EQ(wrong, 0u) << patch;
    }
}

// A screen across the middle of a room hides what is behind it.
TEST(PatchInspector, DoesNotSeeThroughAScreen) {
    SceneMaker maker(96);
    const int grey = maker.material(0.5f);
    const auto walls =
        maker.box(glm::vec3(0), {glm::vec3(2, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}, grey, 12);
    maker.blocker(glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1), grey);
    for (bool rtrad : {false, true}) {
        Inspected room(maker.scene(), {.size = 96, .rtrad = rtrad});
        const uint32_t patch = room.at(walls[0], 5, 5); // in the middle of the wall at x = 0
        const PatchValues seen = room.inspector.seenFrom(patch);
        uint32_t before = 0, behind = 0, wrong = 0;
        for (uint32_t i = 0; i < room.set().count; ++i) {
            const bool faces = glm::dot(room.patch(i).normal, glm::vec3(1, 0, 0)) < 0.9f;
            const bool hidden = room.patch(i).position.x > 1.0f;
            before += seen[i].r != 0.0f && !hidden;
            behind += seen[i].r != 0.0f && hidden;
            wrong += (seen[i].r != 0.0f) != (faces && !hidden);
        }
        EXPECT_GT(before, 4u * 60) << rtrad;
        EXPECT_EQ(behind, 0u) << rtrad;
        EXPECT_EQ(wrong, 0u) << rtrad;
    }
}

TEST(PatchInspector, LinksEndWhereTheDirectionsHit) {
    SceneMaker maker(64);
    maker.box(glm::vec3(0), kUnitBox, maker.material(0.5f), 10);
    for (DirectionSet directions : {DirectionSet::Sobol, DirectionSet::Lec}) {
        Inspected box(maker.scene(), {.directions = directions, .rotation = Rotation::Interleaved});
        const uint32_t patch = box.inspector.patchAt(17, 6);
        const auto links = box.inspector.links(patch, 64);
        ASSERT_EQ(links.size(), 64u);
        double cosines = 0;
        for (const PatchInspector::Link& link : links) {
            ASSERT_LT(link.target, box.set().count);
            EXPECT_EQ(link.end, box.patch(link.target).position);
            const glm::vec3 d = glm::normalize(link.end - box.patch(patch).position);
            cosines += glm::dot(d, box.patch(patch).normal);
        }
        EXPECT_NEAR(cosines / 64, 2.0 / 3.0, 0.03); // of directions by the cosine
    }
}

// Above a floor there is sky or the back of a roof, and lines go where the directions do.
TEST(PatchInspector, LinksWithoutPatchKeepTheirDirection) {
    SceneMaker maker(32);
    const int grey = maker.material(0.5f);
    const auto floor = maker.quad(glm::vec3(0), glm::vec3(0, 0, 1), glm::vec3(1, 0, 0), grey, {12, 12});
    maker.quad(glm::vec3(-9, 1, 1.2f), glm::vec3(0, 0, 9), glm::vec3(18, 0, 0), grey,
               {4, 4}); // seen from below
    Inspected scene(maker.scene(), {.size = 32});
    const auto links = scene.inspector.links(scene.at(floor, 6, 6), 64);
    uint32_t sky = 0, back = 0;
    for (const PatchInspector::Link& link : links) {
        EXPECT_GE(link.target, shader::kLinkFirstSpecial);
        EXPECT_GT(link.end.y, 0.0f);
        sky += link.target == shader::kLinkSky;
        back += link.target == shader::kLinkBack;
        const glm::vec3 d = link.end - scene.patch(scene.at(floor, 6, 6)).position;
        const glm::vec3 onRoof = scene.patch(scene.at(floor, 6, 6)).position + d / d.y;
        if (std::abs(onRoof.z - 1.2f) > 0.01f && std::abs(onRoof.x) < 8.9f && onRoof.z < 10.1f) {
            EXPECT_EQ(link.target == shader::kLinkBack, onRoof.z > 1.2f);
        }
    }
    EXPECT_GT(sky, 10u);
    EXPECT_GT(back, 10u);
}

TEST(PatchInspector, FindsPatchesBesideCharts) {
    SceneMaker maker(64);
    const auto floor =
        maker.quad(glm::vec3(0), glm::vec3(0, 0, 1), glm::vec3(1, 0, 0), maker.material(0.5f), {12, 12});
    Inspected scene(maker.scene());
    const uint32_t corner = scene.at(floor, 11, 11);
    EXPECT_EQ(shader::patchTexel(scene.patch(corner).flags), (floor.y + 11) * 64 + floor.x + 11);
    EXPECT_EQ(scene.at(floor, 13, 13), corner);
    EXPECT_EQ(scene.at(floor, 14, 11), corner);
    EXPECT_EQ(scene.at(floor, 30, 30), kNoPatch);
    EXPECT_EQ(scene.inspector.patchAt(1000, 3), kNoPatch);
}

TEST(PatchInspector, VoxelsLieOnTheWalls) {
    if (!testDevice().info().fragmentStores) GTEST_SKIP() << "no voxel maps on this device";
    SceneMaker maker(64);
    maker.box(glm::vec3(0), kUnitBox, maker.material(0.5f), 10);
    Inspected box(maker.scene());
    const PatchInspector::Voxels voxels = box.inspector.voxels(32);
    EXPECT_NEAR(voxels.edge.x, 1.0f / 31.0f, 1e-6f);
    EXPECT_EQ(voxels.centres.size(), 32u * 32 * 32 - 30u * 30 * 30);
    for (const glm::vec3& c : voxels.centres) {
        const glm::vec3 inside = glm::min(glm::abs(c), glm::abs(1.0f - c));
        ASSERT_LT(std::min({inside.x, inside.y, inside.z}), 1e-5f);
    }
}

} // namespace
} // namespace relume
