#include "assets/gltf/gltf.h"
#include "assets/gltf/gltf_batches.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>
#include <unistd.h>

namespace relume {
namespace {

glm::mat4 placeOf(int i) {
    glm::mat4 m = glm::translate(glm::mat4(1.0f), glm::vec3(1.5f * float(i), 0.25f, -0.5f * float(i)));
    m = glm::rotate(m, 0.7f * float(i), glm::normalize(glm::vec3(0.3f, 1.0f, 0.1f * float(i))));
    return glm::scale(m, glm::vec3(1.0f + 0.1f * float(i), 1.0f, i == 2 ? -0.5f : 0.5f));
}

/// Holds so many instances of a triangle that asks for a batch.
Scene trianglesInARow(int count) {
    Scene scene;
    Primitive primitive;
    primitive.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    primitive.normals.assign(3, {0, 0, 1});
    primitive.indices = {0, 1, 2};
    scene.meshes.push_back({.name = "Leaf", .primitives = {primitive}, .batched = true});
    for (int i = 0; i < count; ++i)
        scene.instances.push_back({.name = "Leaf " + std::to_string(i), .mesh = 0, .transform = placeOf(i)});
    return scene;
}

TEST(GltfBatches, AreMadeFromEightInstancesOn) {
    EXPECT_TRUE(gltf::batchesOf(trianglesInARow(7)).batches.empty());
    ASSERT_EQ(gltf::batchesOf(trianglesInARow(8)).batches.size(), 1u);
    Scene unasked = trianglesInARow(8);
    unasked.meshes[0].batched = false;
    EXPECT_TRUE(gltf::batchesOf(unasked).batches.empty());
}

TEST(GltfBatches, LeaveOutWhatIsHiddenOrSheared) {
    Scene scene = trianglesInARow(10);
    scene.instances[3].hidden = true;
    scene.instances[5].transform[1].x += 0.3f;
    const gltf::Batches batches = gltf::batchesOf(scene);
    ASSERT_EQ(batches.batches.size(), 1u);
    EXPECT_EQ(batches.batches[0].translations.size(), 8u);
    for (size_t i = 0; i < 10; ++i)
        EXPECT_EQ(batches.isBatched[i], i != 3 && i != 5) << i;
}

// Mirrored, turned and scaled instances come back where they were.
TEST(GltfBatches, ComeBackFromTheFile) {
    const Scene scene = trianglesInARow(12);
    const auto path =
        std::filesystem::temp_directory_path() / ("relume_batch" + std::to_string(getpid()) + ".glb");
    saveGlb(scene, path.string());
    const Scene back = loadGltf(path.string());
    std::filesystem::remove(path);
    EXPECT_TRUE(back.warnings.empty()) << back.warnings.front();
    ASSERT_EQ(back.instances.size(), scene.instances.size());
    for (size_t i = 0; i < scene.instances.size(); ++i)
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r)
                EXPECT_NEAR(back.instances[i].transform[c][r], scene.instances[i].transform[c][r], 2e-6f)
                    << i;
}

} // namespace
} // namespace relume
