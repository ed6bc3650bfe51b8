// Scenes are loaded beside the main thread, again and again.
#include "app/live/scene_loader.h"

#include "assets/gltf/gltf.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

/// Saves six cubes without lightmap UVs; one of them is so much larger than the others.
void saveCubes(const std::string& path, float larger) {
    Scene scene;
    const int cube = test::addMesh(scene, test::cube(), "Cube");
    for (int i = 0; i < 6; ++i) {
        const glm::mat4 place = glm::translate(glm::mat4(1), glm::vec3(4 * i, 0, 0));
        test::addInstance(scene, cube, glm::scale(place, glm::vec3(i == 2 ? larger : 1.0f)));
        scene.instances.back().name = "Cube " + std::to_string(i);
    }
    saveGlb(scene, path);
}

TEST(SceneLoader, ChartsStayInASavedFileAndAreLaidOutAnewWhereItIsOpened) {
    const TemporaryFolder folder;
    const PrepareDesc desc{.path = folder.path("cubes.glb"), .size = 128};
    SceneLoader loader;
    const auto madeUvs = [&](bool opened) {
        loader.start(desc, opened);
        return loader.finish()->prepared.madeUvs;
    };
    const std::string stay = "1 of 6 objects with";
    saveCubes(desc.path, 1.0f);
    EXPECT_FALSE(contains(madeUvs(true), stay));
    saveCubes(desc.path, 1.3f);
    const std::string saved = madeUvs(false);
    EXPECT_TRUE(contains(saved, stay)) << saved;
    const std::string opened = madeUvs(true);
    EXPECT_FALSE(contains(opened, stay)) << opened;
}

} // namespace
} // namespace relume
