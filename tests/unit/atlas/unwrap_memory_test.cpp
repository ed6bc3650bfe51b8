// This tests what stays in its place when a scene is unwrapped again.
#include "assets/atlas/unwrap.h"

#include "assets/atlas/lightmap_atlas.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace relume {
namespace {

/// Makes cubes and a sphere, each with a name and a size of its own.
Scene someObjects() {
    Scene scene;
    scene.path = "objects.glb";
    const int cube = test::addMesh(scene, test::cube(), "Cube"),
              sphere = test::addMesh(scene, test::sphere(12), "Ball");
    for (int i = 0; i < 6; ++i) {
        const glm::mat4 place = glm::translate(glm::mat4(1), glm::vec3(4 * i, 0, 0));
        test::addInstance(scene, i == 3 ? sphere : cube,
                          glm::scale(place, glm::vec3(1.0f + 0.1f * float(i))));
        scene.instances.back().name = "Object " + std::to_string(i);
    }
    return scene;
}

/// Returns the UVs of the object of this name, corner by corner.
std::vector<glm::vec2> uvsOf(const Scene& scene, const std::string& name) {
    std::vector<glm::vec2> uvs;
    for (const Instance& instance : scene.instances)
        if (instance.name == name)
            for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives)
                for (uint32_t index : primitive.indices)
                    uvs.push_back(primitive.texCoord1[index]);
    EXPECT_FALSE(uvs.empty()) << name;
    return uvs;
}

// Half of what would fit: there is room for more.
constexpr UnwrapDesc kRoomy = {.density = 12, .size = 256};

TEST(UnwrapMemory, TheSameFileAgainGivesTheSameBytes) {
    UnwrapMemory memory;
    Scene first = someObjects(), again = someObjects(), fresh = someObjects();
    EXPECT_EQ(unwrap(first, {.size = 256}, &memory).stayed, 0u);
    const UnwrapResult result = unwrap(again, {.size = 256}, &memory);
    unwrap(fresh, {.size = 256});
    EXPECT_EQ(result.stayed, 6u);
    for (const Instance& instance : first.instances) {
        EXPECT_EQ(uvsOf(first, instance.name), uvsOf(again, instance.name));
        EXPECT_EQ(uvsOf(first, instance.name), uvsOf(fresh, instance.name));
    }
}

TEST(UnwrapMemory, WhatMovedAndTurnedStaysAndWhatIsNewFindsAPlace) {
    UnwrapMemory memory;
    Scene first = someObjects(), next = someObjects();
    const UnwrapResult before = unwrap(first, kRoomy, &memory);
    next.instances[1].transform =
        glm::rotate(glm::translate(glm::mat4(1), glm::vec3(0, 9, 0)), 0.7f, glm::vec3(3, 1, 2)) *
        glm::scale(glm::mat4(1), glm::vec3(1.1f));
    next.instances[2].transform = glm::scale(glm::mat4(1), glm::vec3(2.5f)); // larger
    std::swap(next.instances[0], next.instances[5]);
    test::addInstance(next, 0, glm::scale(glm::mat4(1), glm::vec3(0.8f)));
    next.instances.back().name = "New";
    const UnwrapResult after = unwrap(next, kRoomy, &memory);
    EXPECT_EQ(after.stayed, 5u);
    EXPECT_EQ(after.objects, 7u);
    EXPECT_EQ(after.density, before.density);
    for (const std::string name : {"Object 0", "Object 1", "Object 3", "Object 4", "Object 5"})
        EXPECT_EQ(uvsOf(first, name), uvsOf(next, name)) << name;
    EXPECT_NE(uvsOf(first, "Object 2"), uvsOf(next, "Object 2"));
    const LightmapAtlas atlas = buildAtlas(next, 256);
    EXPECT_FALSE(atlas.repacked);
    EXPECT_EQ(measureAtlas(next, atlas, 256).overlap, 0.0);
}

TEST(UnwrapMemory, AChangedMeshLosesItsPlaceAndNoOther) {
    UnwrapMemory memory;
    Scene first = someObjects(), next = someObjects();
    unwrap(first, kRoomy, &memory);
    next.meshes[1].primitives[0].positions[40] *= 1.01f;
    const UnwrapResult result = unwrap(next, kRoomy, &memory);
    EXPECT_EQ(result.stayed, 5u);
    EXPECT_EQ(uvsOf(first, "Object 5"), uvsOf(next, "Object 5"));
    // A renamed one is found by its order.
    Scene renamed = someObjects();
    renamed.meshes[1].primitives[0].positions[40] *= 1.01f;
    renamed.instances[4].name = "Renamed";
    EXPECT_EQ(unwrap(renamed, kRoomy, &memory).stayed, 6u);
    EXPECT_EQ(uvsOf(next, "Object 4"), uvsOf(renamed, "Renamed"));
}

TEST(UnwrapMemory, WhatGrewIsCoarserBeforeAllMoves) {
    UnwrapMemory memory;
    Scene first = someObjects(), next = someObjects(), again = someObjects();
    const UnwrapResult before = unwrap(first, {.size = 256}, &memory);
    for (Scene* scene : {&next, &again})
        scene->instances[2].transform = glm::scale(scene->instances[2].transform, glm::vec3(1.3f));
    const UnwrapResult after = unwrap(next, {.size = 256}, &memory);
    EXPECT_EQ(after.stayed, 5u);
    EXPECT_EQ(after.density, before.density);
    EXPECT_EQ(before.coarser, 0u);
    EXPECT_EQ(after.coarser, 1u);
    EXPECT_LT(after.leastShare, 1.0);
    EXPECT_EQ(uvsOf(first, "Object 5"), uvsOf(next, "Object 5"));
    const AtlasStatistics former = measureAtlas(first, buildAtlas(first, 256), 256),
                          statistics = measureAtlas(next, buildAtlas(next, 256), 256);
    EXPECT_EQ(statistics.overlap, 0.0);
    EXPECT_GT(statistics.texelDensityMin, 0.65 * former.texelDensityMin);
    EXPECT_LT(statistics.texelDensityMin, 0.9 * former.texelDensityMin);
    EXPECT_EQ(unwrap(again, {.size = 256}, &memory).stayed, 6u) << "it stays coarser, and where it is";
    EXPECT_EQ(uvsOf(next, "Object 2"), uvsOf(again, "Object 2"));
}

TEST(UnwrapMemory, AllMovesWhereItNoLongerFits) {
    UnwrapMemory memory;
    Scene first = someObjects(), next = someObjects();
    const UnwrapResult before = unwrap(first, {.size = 256}, &memory);
    for (int i = 0; i < 4; ++i)
        test::addInstance(next, 0, glm::scale(glm::mat4(1), glm::vec3(2)));
    const UnwrapResult after = unwrap(next, {.size = 256}, &memory);
    EXPECT_EQ(after.stayed, 0u);
    EXPECT_LT(after.density, before.density);
    EXPECT_EQ(measureAtlas(next, buildAtlas(next, 256), 256).overlap, 0.0);
    Scene fresh = next;
    // Another size begins anew, and so does another density.
    Scene other = someObjects(), sparse = someObjects();
    EXPECT_EQ(unwrap(other, {.size = 128}, &memory).stayed, 0u);
    EXPECT_EQ(unwrap(sparse, {.density = 2, .size = 128}, &memory).stayed, 0u);
}

TEST(UnwrapMemory, AnotherFileDoesNotInheritASparseAtlas) {
    UnwrapMemory memory;
    Scene first = someObjects(), next = someObjects();
    const double before = unwrap(first, {.size = 256}, &memory).density;
    next.instances.resize(1);
    const UnwrapResult result = unwrap(next, {.size = 256}, &memory);
    EXPECT_EQ(result.stayed, 0u);
    EXPECT_GT(result.density, 1.5 * before);
}

} // namespace
} // namespace relume
