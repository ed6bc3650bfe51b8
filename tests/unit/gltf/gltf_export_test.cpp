#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <cmath>
#include <cstring>
#include <filesystem>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace relume {
namespace {

class GltfExport : public testing::Test {
protected:
    std::string file(const std::string& name) const { return folder_.path(name); }
    Scene roundTrip(const Scene& scene) const {
        saveGlb(scene, file("a.glb"));
        return loadGltf(file("a.glb"));
    }

    const TemporaryFolder folder_;
};

Primitive triangle(int material) {
    Primitive p;
    p.positions = {{0, 0, 0}, {1.25f, 0, 0}, {0, 2, 0.1f}};
    p.normals.assign(3, glm::vec3(0, 0, 1));
    p.texCoord0 = {{0, 0}, {3, 0}, {0, 3}};
    p.texCoord1 = {{0.25f, 0.25f}, {0.5f, 0.25f}, {0.25f, 0.5f}};
    p.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0.1f, 0.2f, 0.3f, 0.5f}};
    p.indices = {0, 1, 2};
    p.material = material;
    return p;
}

Scene twoInstances() {
    Scene scene;
    Material plain;
    plain.name = "Plain";
    plain.baseColor = {0.7f, 0.1f, 0.3f, 1.0f};
    plain.metallic = 0.25f;
    plain.roughness = 0.75f;
    plain.doubleSided = true;
    scene.materials.push_back(plain);
    scene.meshes.push_back({"Triangle", {triangle(0), triangle(-1)}});
    scene.instances.push_back({"First", 0, glm::mat4(1.0f)});
    const glm::mat4 moved = glm::rotate(glm::translate(glm::mat4(1.0f), {1, 2, 3}), 0.7f, glm::vec3(0, 1, 0));
    scene.instances.push_back({"Second", 0, glm::scale(moved, {1, -2, 1})});
    return scene;
}

TEST_F(GltfExport, KeepsMeshesInstancesAndAttributes) {
    const Scene scene = twoInstances();
    const Scene back = roundTrip(scene);
    ASSERT_EQ(back.meshes.size(), 1u); // shared, not copied per instance
    ASSERT_EQ(back.instances.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(back.instances[i].name, scene.instances[i].name);
        EXPECT_EQ(back.instances[i].mesh, 0);
        for (int c = 0; c < 4; ++c)
            for (int r = 0; r < 4; ++r)
                EXPECT_FLOAT_EQ(back.instances[i].transform[c][r], scene.instances[i].transform[c][r]);
    }
    ASSERT_EQ(back.meshes[0].primitives.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        const Primitive& a = scene.meshes[0].primitives[i];
        const Primitive& b = back.meshes[0].primitives[i];
        EXPECT_EQ(a.positions, b.positions);
        EXPECT_EQ(a.normals, b.normals);
        EXPECT_EQ(a.texCoord0, b.texCoord0);
        EXPECT_EQ(a.texCoord1, b.texCoord1);
        EXPECT_EQ(a.colors, b.colors);
        EXPECT_EQ(a.indices, b.indices);
        EXPECT_EQ(a.material, b.material);
    }
}

TEST_F(GltfExport, KeepsMaterialsToTheBit) {
    Scene scene = twoInstances();
    Material lamp;
    lamp.name = "Lamp";
    lamp.emission = {17.3f, 8.1f, 1.0f / 3.0f};
    scene.materials.push_back(lamp);
    Material dim;
    dim.name = "Dim";
    dim.emission = {0.3f, 0.2f, 0.9f};
    dim.alphaMode = AlphaMode::Mask;
    dim.alphaCutoff = 0.25f;
    scene.materials.push_back(dim);
    Material glass;
    glass.name = "Glass";
    glass.alphaMode = AlphaMode::Blend;
    glass.baseColor.a = 0.5f;
    scene.materials.push_back(glass);
    const Scene back = roundTrip(scene);
    ASSERT_EQ(back.materials.size(), scene.materials.size());
    for (size_t i = 0; i < scene.materials.size(); ++i) {
        const Material &a = scene.materials[i], &b = back.materials[i];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.baseColor, b.baseColor);
        EXPECT_EQ(a.emission, b.emission);
        EXPECT_EQ(a.metallic, b.metallic);
        EXPECT_EQ(a.roughness, b.roughness);
        EXPECT_EQ(a.alphaMode, b.alphaMode);
        if (a.alphaMode == AlphaMode::Mask) {
            EXPECT_EQ(a.alphaCutoff, b.alphaCutoff);
        }
        EXPECT_EQ(a.doubleSided, b.doubleSided);
    }
}

TEST_F(GltfExport, KeepsTexturesAndTheirTransforms) {
    Scene scene = twoInstances();
    Image image{"Checker", 3, 2, {}};
    for (uint8_t i = 0; i < 6; ++i)
        image.rgba.insert(image.rgba.end(), {i, static_cast<uint8_t>(40 * i), 255, 255});
    scene.images.push_back(image);
    image.name = "Holes";
    image.rgba[3] = 17;
    scene.images.push_back(image);
    scene.textures.push_back({0, Wrap::MirroredRepeat, Wrap::ClampToEdge, true});
    scene.textures.push_back({1, Wrap::Repeat, Wrap::Repeat, false});
    const float c = std::cos(0.3f), s = std::sin(0.3f);
    scene.materials[0].baseColorTexture = {
        0, 1, glm::mat3({2 * c, -2 * s, 0}, {3 * s, 3 * c, 0}, {0.5f, 0.25f, 1})};
    scene.materials[0].emission = {1, 2, 3}; // without it the texture would not matter
    scene.materials[0].emissionTexture = {1, 0, glm::mat3(1.0f)};
    scene.materials[0].metallicRoughnessTexture = {1, 0, glm::mat3({4, 0, 0}, {0, -4, 0}, {0, 1, 1})};
    const Scene back = roundTrip(scene);
    ASSERT_EQ(back.images.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(back.images[i].width, 3u);
        EXPECT_EQ(back.images[i].height, 2u);
        EXPECT_EQ(back.images[i].rgba, scene.images[i].rgba);
        EXPECT_EQ(back.textures[i].image, static_cast<int>(i));
        EXPECT_EQ(back.textures[i].wrapS, scene.textures[i].wrapS);
        EXPECT_EQ(back.textures[i].wrapT, scene.textures[i].wrapT);
        EXPECT_EQ(back.textures[i].nearest, scene.textures[i].nearest);
    }
    const auto expectSame = [](const TextureRef& a, const TextureRef& b) {
        EXPECT_EQ(a.texture, b.texture);
        EXPECT_EQ(a.texCoord, b.texCoord);
        for (int col = 0; col < 3; ++col)
            for (int row = 0; row < 3; ++row)
                EXPECT_NEAR(a.transform[col][row], b.transform[col][row], 1e-6f);
    };
    const Material &a = scene.materials[0], &b = back.materials[0];
    expectSame(a.baseColorTexture, b.baseColorTexture);
    expectSame(a.emissionTexture, b.emissionTexture);
    expectSame(a.metallicRoughnessTexture, b.metallicRoughnessTexture);
}

TEST_F(GltfExport, KeepsCamerasAndLights) {
    Scene scene = twoInstances();
    const glm::mat4 view = glm::translate(glm::mat4(1.0f), {1, 2, 3});
    scene.cameras.push_back({"Main", view, true, 0.9f, 1.0f, 1.5f, 0.02f, 50.0f});
    scene.cameras.push_back({"Plan", view, false, 0.8f, 3.0f, 2.0f, 0.1f, 10.0f});
    const Scene back = roundTrip(scene);
    ASSERT_EQ(back.cameras.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        const Camera &a = scene.cameras[i], &b = back.cameras[i];
        EXPECT_EQ(a.name, b.name);
        EXPECT_EQ(a.transform, b.transform);
        EXPECT_EQ(a.perspective, b.perspective);
        if (a.perspective) {
            EXPECT_EQ(a.yfov, b.yfov);
        }
        if (!a.perspective) {
            EXPECT_EQ(a.ymag, b.ymag);
        }
        EXPECT_EQ(a.aspect, b.aspect);
        EXPECT_EQ(a.znear, b.znear);
        EXPECT_EQ(a.zfar, b.zfar);
    }
}

void expectSame(const Light& a, const Light& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.type, b.type);
    EXPECT_EQ(a.transform, b.transform);
    EXPECT_EQ(a.color, b.color);
    EXPECT_EQ(a.intensity, b.intensity);
    EXPECT_EQ(a.range, b.range);
    EXPECT_EQ(a.innerConeAngle, b.innerConeAngle);
    EXPECT_EQ(a.outerConeAngle, b.outerConeAngle);
    EXPECT_EQ(a.radius, b.radius);
    EXPECT_EQ(a.angle, b.angle);
    EXPECT_EQ(a.size, b.size);
}

TEST_F(GltfExport, KeepsLightsToTheBit) {
    Scene scene = twoInstances();
    Light light;
    light.transform = glm::rotate(glm::translate(glm::mat4(1.0f), {1, 2, 3}), 0.7f, glm::vec3(0.6f, 0, 0.8f));
    light.color = {1, 0.3f, 0.1f};
    light.intensity = 80.1f;
    for (const char* name : {"Bulb", "Beam", "Sun", "Panel", "Disc", ""}) {
        light.name = name;
        light.type = static_cast<LightType>(scene.lights.size() % 5);
        scene.lights.push_back(light);
    }
    scene.lights[0].radius = 0.03f;
    scene.lights[0].range = 12.1f;
    scene.lights[1].innerConeAngle = 0.2f;
    scene.lights[1].outerConeAngle = 1.57079637f; // half of pi, rounded up to a float
    scene.lights[2].angle = 3.14159274f;
    scene.lights[3].size = {1.2f, 0.3f};
    scene.lights[4].radius = 0.15f;
    scene.lights[4].intensity = 0.0f;
    const Scene back = roundTrip(scene);
    ASSERT_EQ(back.lights.size(), scene.lights.size());
    for (size_t i = 0; i < back.lights.size(); ++i) {
        SCOPED_TRACE(scene.lights[i].name);
        expectSame(scene.lights[i], back.lights[i]);
        EXPECT_EQ(back.lights[i].node, static_cast<int>(2 + i)); // behind the instances
    }
    EXPECT_TRUE(back.warnings.empty()) << back.warnings.front();
    EXPECT_EQ(back.sky.radiance, glm::vec3(0.0f));
}

TEST_F(GltfExport, KeepsAConstantSkyToTheBit) {
    Scene scene = twoInstances();
    scene.sky.radiance = {117.1f, 1.0f / 3.0f, 250.7f};
    scene.sky.rotation = 0.3f;
    const Scene back = roundTrip(scene);
    EXPECT_EQ(back.sky.radiance, scene.sky.radiance);
    EXPECT_EQ(back.sky.rotation, scene.sky.rotation);
    EXPECT_EQ(back.sky.file, "");
    EXPECT_EQ(folder_.files().size(), 1u);
}

TEST_F(GltfExport, WritesASkyPictureWithoutAFileBesideTheScene) {
    Scene scene = twoInstances();
    scene.sky.radiance = glm::vec3(2.0f);
    scene.sky.width = 4;
    scene.sky.height = 2;
    for (int i = 0; i < 8; ++i)
        scene.sky.pixels.emplace_back(0.1f * float(i), float(i), 1e4f);
    const Scene back = roundTrip(scene);
    EXPECT_EQ(folder_.files(), (std::vector<std::string>{"a.glb", "a_sky.exr"}));
    EXPECT_EQ(back.sky.file, file("a_sky.exr"));
    EXPECT_EQ(back.sky.radiance, scene.sky.radiance);
    EXPECT_EQ(back.sky.width, 4u);
    EXPECT_EQ(back.sky.pixels, scene.sky.pixels);
    EXPECT_TRUE(back.warnings.empty());
}

TEST_F(GltfExport, ASkyPictureWhosePathJsonCannotHoldIsToldBeforehand) {
    const std::string folder = file("caf\xe9");
    std::filesystem::create_directories(folder);
    Scene scene = twoInstances();
    scene.sky.radiance = glm::vec3(1.0f);
    scene.sky.width = scene.sky.height = 1;
    scene.sky.pixels = {{1, 2, 3}};
    saveGlb(scene, folder + "/a.glb");
    const Scene saved = loadGltf(folder + "/a.glb");
    checkGlb(saved, folder + "/b.glb"); // in the same folder its name is enough
    saveGlb(saved, folder + "/b.glb");
    EXPECT_EQ(loadGltf(folder + "/b.glb").sky.pixels, scene.sky.pixels);
    EXPECT_THROW(checkGlb(saved, file("c.glb")), Error);
    EXPECT_THROW(saveGlb(saved, file("c.glb")), Error);
    EXPECT_FALSE(std::filesystem::exists(file("c.glb")));
}

TEST_F(GltfExport, RefersToTheSkyPictureFromWhereItIsSaved) {
    Scene scene = twoInstances();
    scene.sky.radiance = glm::vec3(1.0f);
    scene.sky.width = 2;
    scene.sky.height = 1;
    scene.sky.pixels = {{1, 2, 3}, {4, 5, 6}};
    const Scene first = roundTrip(scene);
    std::filesystem::create_directories(file("deep/er"));
    saveGlb(first, file("deep/er/b.glb"));
    EXPECT_EQ(std::filesystem::directory_iterator(file("deep/er"))->path().filename(), "b.glb"); // alone
    const Scene second = loadGltf(file("deep/er/b.glb"));
    EXPECT_TRUE(std::filesystem::equivalent(second.sky.file, file("a_sky.exr")));
    EXPECT_EQ(second.sky.pixels, scene.sky.pixels);
    // A folder that is moved with all that is in it still works.
    std::filesystem::create_directories(file("elsewhere"));
    for (const char* name : {"a_sky.exr", "deep"})
        std::filesystem::rename(file(name), file("elsewhere/" + std::string(name)));
    EXPECT_EQ(loadGltf(file("elsewhere/deep/er/b.glb")).sky.pixels, scene.sky.pixels);
    // The picture is gone from its place; the pixels are not.
    saveGlb(second, file("c.glb"));
    EXPECT_EQ(loadGltf(file("c.glb")).sky.pixels, scene.sky.pixels);
    EXPECT_TRUE(std::filesystem::exists(file("c_sky.exr")));
}

TEST_F(GltfExport, WidensIndicesOfALargeMesh) {
    Scene scene;
    Primitive p;
    for (uint32_t i = 0; i < 70002; ++i) {
        p.positions.emplace_back(i % 3 == 1, i % 3 == 2, static_cast<float>(i / 3));
        p.normals.emplace_back(0, 0, 1);
        p.indices.push_back(i);
    }
    scene.meshes.push_back({"Big", {p}});
    scene.instances.push_back({"Big", 0, glm::mat4(1.0f)});
    EXPECT_EQ(roundTrip(scene).meshes[0].primitives[0].indices, p.indices);
}

TEST_F(GltfExport, IsAWellFormedContainer) {
    saveGlb(twoInstances(), file("b.glb"));
    const std::string bytes = bytesOf(file("b.glb"));
    uint32_t header[5];
    ASSERT_GE(bytes.size(), sizeof(header));
    std::memcpy(header, bytes.data(), sizeof(header));
    EXPECT_EQ(header[0], 0x46546C67u);
    EXPECT_EQ(header[1], 2u);
    EXPECT_EQ(header[2], bytes.size());
    EXPECT_EQ(header[3] % 4, 0u);
    const auto parsed = nlohmann::json::parse(bytes.substr(20, header[3]));
    const size_t binSize = parsed["buffers"][0]["byteLength"];
    EXPECT_EQ(bytes.size(), 20 + header[3] + 8 + binSize);
    for (const auto& accessor : parsed["accessors"]) {
        const auto& view = parsed["bufferViews"][accessor["bufferView"].get<int>()];
        const std::string type = accessor["type"];
        const size_t components = type == "SCALAR" ? 1 : static_cast<size_t>(type.back() - '0');
        const size_t size = components * (accessor["componentType"] == 5123 ? 2 : 4);
        const size_t offset = accessor["byteOffset"];
        EXPECT_LE(offset + size * accessor["count"].get<size_t>(), view["byteLength"].get<size_t>());
        if (view.contains("byteStride")) {
            EXPECT_EQ(view["byteStride"], size);
        }
        EXPECT_LE(view["byteOffset"].get<size_t>() + view["byteLength"].get<size_t>(), binSize);
    }
}

TEST_F(GltfExport, WritesTheSameBytesTwiceAndLeavesNoTemporaryFile) {
    saveGlb(twoInstances(), file("a.glb"));
    saveGlb(twoInstances(), file("b.glb"));
    saveGlb(twoInstances(), file("b.glb")); // replaces
    EXPECT_EQ(bytesOf(file("a.glb")), bytesOf(file("b.glb")));
    EXPECT_EQ(folder_.files().size(), 2u);
}

TEST_F(GltfExport, NamesTheFileItCannotWrite) {
    const std::string path = file("missing_folder/a.glb");
    try {
        saveGlb(twoInstances(), path);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
    }
    std::filesystem::create_directory(file("folder"));
    EXPECT_THROW(saveGlb(twoInstances(), file("folder")), Error);
    EXPECT_EQ(folder_.files().size(), 1u);
}

TEST_F(GltfExport, RefusesAShearedTextureTransform) {
    Scene scene = twoInstances();
    scene.images.push_back({"Dot", 1, 1, {1, 2, 3, 255}});
    scene.textures.push_back({0, Wrap::Repeat, Wrap::Repeat, false});
    scene.materials[0].baseColorTexture = {0, 0, glm::mat3({1, 0, 0}, {0.5f, 1, 0}, {0, 0, 1})};
    EXPECT_THROW(saveGlb(scene, file("a.glb")), Error);
}

} // namespace
} // namespace relume
