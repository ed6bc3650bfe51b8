// What tracers' alpha tests read is kept once for each image, and never beyond what offsets can tell.
#include "assets/base/error.h"
#include "bake/surface/alpha_tables.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

// Makes images of 4 x 3 and 2 x 2 texels, whose alpha counts up, and four masked materials: two of the first
// image, one of the second, one of none.
Scene maskedMaterials() {
    Scene scene;
    scene.path = "leaves.glb";
    for (const glm::uvec2 size : {glm::uvec2(4, 3), glm::uvec2(2, 2)}) {
        Image image{"leaf", size.x, size.y, {}};
        for (uint32_t i = 0; i < size.x * size.y; ++i)
            image.rgba.insert(image.rgba.end(), {9, 9, 9, static_cast<uint8_t>(image.rgba.size())});
        scene.images.push_back(image);
    }
    scene.textures = {{.image = 0}, {.image = 0, .wrapS = Wrap::ClampToEdge}, {.image = 1}};
    for (const int texture : {0, 1, 2, -1}) {
        Material material;
        material.alphaMode = AlphaMode::Mask;
        material.alphaCutoff = 0.1f * static_cast<float>(texture + 2);
        material.baseColorTexture.texture = texture;
        scene.materials.push_back(material);
    }
    return scene;
}

TraceScene tracedTriangles(uint32_t count) {
    TraceScene traced;
    for (uint32_t t = 0; t < count; ++t)
        traced.mesh.material.push_back(t);
    traced.mesh.baseUv.resize(size_t{count} * 3);
    traced.mesh.colors.resize(size_t{count} * 3, glm::vec4(1.0f));
    return traced;
}

} // namespace

TEST(AlphaTables, AnImageIsThereOnceHoweverManyMaterialsHaveIt) {
    const Scene scene = maskedMaterials();
    TraceScene traced = tracedTriangles(4);
    addAlphaTables(scene, traced);
    ASSERT_EQ(traced.alphaMaterials.size(), 4u);
    EXPECT_EQ(traced.alphaTexels.size(), 12u + 4u);
    EXPECT_EQ(traced.alphaMaterials[0].texels, 0u);
    EXPECT_EQ(traced.alphaMaterials[1].texels, 0u);
    EXPECT_EQ(traced.alphaMaterials[2].texels, 12u);
    EXPECT_EQ(traced.alphaMaterials[3].texels, 0xffffffffu);
    EXPECT_EQ(traced.alphaMaterials[0].wrapS, static_cast<uint32_t>(Wrap::Repeat));
    EXPECT_EQ(traced.alphaMaterials[1].wrapS, static_cast<uint32_t>(Wrap::ClampToEdge));
    EXPECT_NE(traced.alphaMaterials[0].cutoff, traced.alphaMaterials[1].cutoff);
    for (size_t i = 0; i < 12; ++i)
        EXPECT_EQ(traced.alphaTexels[i], scene.images[0].rgba[4 * i + 3]);
    for (size_t i = 0; i < 4; ++i)
        EXPECT_EQ(traced.alphaTexels[12 + i], scene.images[1].rgba[4 * i + 3]);
}

TEST(AlphaTables, MoreThanOffsetsCanTellIsAnError) {
    static_assert(kMostAlphaBytes < uint64_t{1} << 32);
    const Scene scene = maskedMaterials();
    TraceScene fits = tracedTriangles(4);
    addAlphaTables(scene, fits, 16);
    EXPECT_EQ(fits.alphaTexels.size(), 16u);
    for (const uint64_t most : {uint64_t{15}, uint64_t{3}}) {
        TraceScene traced = tracedTriangles(4);
        try {
            addAlphaTables(scene, traced, most);
            FAIL() << "16 bytes do not fit into " << most;
        } catch (const Error& error) {
            const std::string message = error.what();
            EXPECT_EQ(message.find("leaves.glb: image 'leaf'"), 0u) << message;
            EXPECT_NE(message.find("make them smaller"), std::string::npos) << message;
            EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        }
    }
}

} // namespace relume
