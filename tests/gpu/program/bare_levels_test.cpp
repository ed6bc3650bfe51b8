// Whatever ships is opened as a level from elsewhere: without lightmap UVs and without light. It is
// unwrapped, lit by a preview and told so, and its picture is not black.
#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "assets/images/image_file.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace relume {
namespace {

namespace fs = std::filesystem;

/// Returns the scenes that ship, and the files of the tests that can be read.
std::vector<std::string> levelFiles() {
    std::vector<std::string> files;
    for (const char* folder : {"/assets/scenes", "/tests/data"})
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(std::string(RELUME_SOURCE_DIR) + folder))
            if (const std::string ending = entry.path().extension(); ending == ".glb" || ending == ".gltf")
                files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

void strip(Scene& scene) {
    for (Mesh& mesh : scene.meshes)
        for (Primitive& primitive : mesh.primitives) {
            primitive.texCoord0.clear(); // which may be a valid atlas, too
            primitive.texCoord1.clear();
        }
    for (Material& material : scene.materials) {
        material.emission = glm::vec3(0.0f);
        material.baseColorTexture = material.emissionTexture = material.metallicRoughnessTexture = {};
    }
    scene.lights.clear();
    scene.sky = {};
    scene.cameras.clear();
}

class BareLevels : public testing::TestWithParam<std::string> {};

TEST_P(BareLevels, AreUnwrappedAndLit) {
    const TemporaryFolder folder;
    const std::string level = folder.path("level.glb"), picture = folder.path("level.png");
    Scene scene = loadGltf(GetParam());
    strip(scene);
    saveGlb(scene, level);
    const ProcessResult run = runRelume(
        {"shot", level, "-o", picture, "--size", "160x90", "--lightmap-size", "512", "--error", "0.3"});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_TRUE(contains(run.err, "lightmap UVs were made")) << run.err;
    EXPECT_TRUE(contains(run.err, "nothing in it shines: a preview")) << run.err;
    const FloatImage image = readImage(picture);
    double sum = 0;
    for (size_t c = 0; c < 3; ++c)
        for (const float value : image.planes[c])
            sum += value;
    EXPECT_GT(sum / (3.0 * static_cast<double>(image.planes[0].size())), 0.02) << "it is black";
}

std::string nameOfFile(const std::string& path) {
    std::string name = fs::path(path).stem();
    std::replace_if(
        name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; },
        '_');
    return name;
}

INSTANTIATE_TEST_SUITE_P(All, BareLevels, testing::ValuesIn(levelFiles()),
                         [](const auto& file) { return nameOfFile(file.param); });

} // namespace
} // namespace relume
