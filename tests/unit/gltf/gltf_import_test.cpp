#include "assets/gltf/gltf.h"

#include "assets/base/error.h"
#include "tests/unit/glb_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

using nlohmann::json;
using test::GlbBuilder;
using test::squareScene;

bool warns(const Scene& scene, const std::string& part) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

void expectNearVector(const glm::vec3& a, const glm::vec3& b, float tolerance = 1e-6f) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

glm::vec3 apply(const glm::mat4& m, glm::vec3 p) {
    return glm::vec3(m * glm::vec4(p, 1.0f));
}

TEST(GltfImport, NodesInheritTheirParentsTransforms) {
    GlbBuilder b;
    const int mesh = b.mesh(b.square(), "Square");
    const float h = std::sqrt(0.5f);
    b.node(
        {{"translation", {1, 2, 3}}, {"rotation", {0, 0, h, h}}, {"scale", {2, 2, 2}}, {"children", {1, 2}}});
    b.node({{"name", "Child"}, {"mesh", mesh}, {"translation", {1, 0, 0}}});
    b.node({{"mesh", mesh}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}});
    const Scene scene = loadGltf(b.write("hierarchy.glb"));
    ASSERT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].name, "Child");
    EXPECT_EQ(scene.instances[1].name, "Square");
    EXPECT_EQ(scene.instances[1].mesh, 0);
    // A quarter turn about z after doubling takes (1,0,0) to (0,2,0).
    expectNearVector(apply(scene.instances[0].transform, {0, 0, 0}), {1, 4, 3});
    expectNearVector(apply(scene.instances[0].transform, {0, 1, 0}), {-1, 4, 3});
    expectNearVector(apply(scene.instances[1].transform, {1, 0, 0}), {1, 10, 3});
    EXPECT_LT(glm::determinant(scene.instances[1].transform), 0.0f);
}

TEST(GltfImport, OnlyTheDefaultSceneIsTaken) {
    GlbBuilder b;
    const int mesh = b.mesh(b.square());
    for (const char* name : {"A", "B", "C"})
        b.node({{"mesh", mesh}, {"name", name}});
    b.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {2, 1}}}};
    b.json["scene"] = 1;
    const Scene scene = loadGltf(b.write("scenes.glb"));
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].name, "C");
    EXPECT_EQ(scene.instances[1].name, "B");
}

TEST(GltfImport, AMillionNodesDeepLoads) {
    constexpr int kNodes = 1000000;
    GlbBuilder b = squareScene();
    test::writeBytes("deep.bin", b.bin);
    b.json["buffers"] = {{{"uri", "deep.bin"}, {"byteLength", b.bin.size()}}};
    b.json.erase("nodes");
    std::string text = b.json.dump();
    text.back() = ',';
    text += "\"nodes\":[";
    for (int i = 1; i < kNodes; ++i)
        text += "{\"translation\":[1e-3,0,0],\"children\":[" + std::to_string(i) + "]},";
    const Scene scene = loadGltf(test::writeText("deep.gltf", text + "{\"mesh\":0}]}"));
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_NEAR(scene.instances[0].transform[3].x, 999.999f, 1e-3f);
}

template<typename T>
void expectIndices(const std::string& name) {
    GlbBuilder b;
    json square = b.square();
    square["indices"] = b.accessor<T>({2, 3, 0, 0, 1, 2}, "SCALAR");
    b.node({{"mesh", b.mesh(square)}});
    const Scene scene = loadGltf(b.write(name));
    const Primitive& primitive = scene.meshes[0].primitives[0];
    ASSERT_EQ(primitive.indices.size(), 6u);
    expectNearVector(primitive.positions[primitive.indices[0]], {1, 1, 0});
    expectNearVector(primitive.positions[primitive.indices[4]], {1, 0, 0});
}

TEST(GltfImport, AllIndexTypes) {
    expectIndices<uint8_t>("u8.glb");
    expectIndices<uint16_t>("u16.glb");
    expectIndices<uint32_t>("u32.glb");
    GlbBuilder b;
    b.node({{"mesh", b.mesh({{"attributes",
                              {{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")}}}})}});
    EXPECT_EQ(loadGltf(b.write("plain.glb")).meshes[0].primitives[0].indices,
              (std::vector<uint32_t>{0, 1, 2}));
}

float facing(const Primitive& primitive) { // z of the sum of all triangles' normals, twice their area long
    float sum = 0.0f;
    for (size_t i = 0; i < primitive.indices.size(); i += 3) {
        const glm::vec3 a = primitive.positions[primitive.indices[i]];
        sum += glm::cross(primitive.positions[primitive.indices[i + 1]] - a,
                          primitive.positions[primitive.indices[i + 2]] - a)
                   .z;
    }
    return sum;
}

TEST(GltfImport, StripsAndFansKeepTheirWinding) {
    GlbBuilder b;
    const int strip = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3");
    const int fan = b.accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", strip}}}, {"mode", 5}})}});
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", fan}}}, {"mode", 6}})}});
    const Scene scene = loadGltf(b.write("strip.glb"));
    EXPECT_EQ(scene.meshes[0].primitives[0].indices.size(), 9u);
    EXPECT_FLOAT_EQ(facing(scene.meshes[0].primitives[0]), 3.0f);
    EXPECT_EQ(scene.meshes[1].primitives[0].indices.size(), 6u);
    EXPECT_FLOAT_EQ(facing(scene.meshes[1].primitives[0]), 2.0f);
}

TEST(GltfImport, PointsAndLinesAreSkippedWithAWarning) {
    GlbBuilder b = squareScene();
    json line = b.square();
    line["mode"] = 1;
    b.node({{"mesh", b.mesh(line, "Wire")}});
    const Scene scene = loadGltf(b.write("lines.glb"));
    EXPECT_EQ(scene.instances.size(), 1u);
    EXPECT_TRUE(warns(scene, "mesh 'Wire': has points or lines"));
}

TEST(GltfImport, SparseAccessorsOverTheirBaseAndOverZeros) {
    GlbBuilder b;
    json square = b.square();
    const int base = square["attributes"]["POSITION"].get<int>();
    const json sparse = {{"count", 2},
                         {"indices", {{"bufferView", b.view<uint16_t>({1, 3})}, {"componentType", 5123}}},
                         {"values", {{"bufferView", b.view<float>({7, 8, 9, 4, 5, 6})}}}};
    b.json["accessors"][static_cast<size_t>(base)]["sparse"] = sparse;
    b.json["accessors"].push_back(
        {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}, {"sparse", sparse}});
    const int zeros = static_cast<int>(b.json["accessors"].size()) - 1;
    square["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
    json second = square;
    second["attributes"]["POSITION"] = zeros;
    b.node({{"mesh", b.mesh(square)}});
    b.node({{"mesh", b.mesh(second)}});
    const Scene scene = loadGltf(b.write("sparse.glb"));
    expectNearVector(scene.meshes[0].primitives[0].positions[1], {7, 8, 9});
    expectNearVector(scene.meshes[0].primitives[0].positions[2], {1, 1, 0});
    expectNearVector(scene.meshes[0].primitives[0].positions[3], {4, 5, 6});
    expectNearVector(scene.meshes[1].primitives[0].positions[1], {7, 8, 9});
    expectNearVector(scene.meshes[1].primitives[0].positions[2], {0, 0, 0});
}

TEST(GltfImport, SparseIndicesOverTheirBaseAndOverZeros) {
    GlbBuilder b;
    json square = b.square(), zeros = square;
    // The base has the first triangle twice; the sparse part makes the square's other one of the second.
    const int base = b.accessor<uint16_t>({0, 1, 2, 0, 1, 2}, "SCALAR");
    b.json["accessors"][static_cast<size_t>(base)]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", b.view<uint8_t>({4, 5})}, {"componentType", 5121}}},
        {"values", {{"bufferView", b.view<uint16_t>({2, 3})}}}};
    square["indices"] = base;
    b.json["accessors"].push_back(
        {{"componentType", 5125},
         {"count", 6},
         {"type", "SCALAR"},
         {"sparse",
          {{"count", 4},
           {"indices", {{"bufferView", b.view<uint32_t>({1, 2, 4, 5})}, {"componentType", 5125}}},
           {"values", {{"bufferView", b.view<uint32_t>({1, 2, 2, 3})}}}}}});
    zeros["indices"] = b.json["accessors"].size() - 1;
    for (json* primitive : {&square, &zeros}) {
        (*primitive)["attributes"]["NORMAL"] =
            b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
        b.node({{"mesh", b.mesh(*primitive)}});
    }
    const Scene scene = loadGltf(b.write("sparse_indices.glb"));
    ASSERT_EQ(scene.meshes.size(), 2u);
    for (const Mesh& mesh : scene.meshes)
        EXPECT_EQ(mesh.primitives.at(0).indices, (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
}

TEST(GltfImport, MissingNormalsAreFlatAndSplitVertices) {
    GlbBuilder b;
    // These are two triangles with a common edge, folded by a right angle.
    const int positions = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3");
    const int colors = b.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, .5f, .5f, .5f}, "VEC3");
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", positions}, {"COLOR_0", colors}}},
                             {"indices", b.accessor<uint8_t>({0, 1, 2, 0, 2, 3}, "SCALAR")}})}});
    const Scene scene = loadGltf(b.write("flat.glb"));
    const Primitive& primitive = scene.meshes[0].primitives[0];
    ASSERT_EQ(primitive.positions.size(), 6u);
    ASSERT_EQ(primitive.normals.size(), 6u);
    ASSERT_EQ(primitive.colors.size(), 6u);
    for (uint32_t k = 0; k < 3; ++k) {
        expectNearVector(primitive.normals[primitive.indices[k]], {0, 0, 1});
        expectNearVector(primitive.normals[primitive.indices[3 + k]], {1, 0, 0});
    }
    EXPECT_EQ(primitive.colors[primitive.indices[5]], glm::vec4(.5f, .5f, .5f, 1.0f));
}

TEST(GltfImport, NormalsWithoutDirectionAreMended) {
    GlbBuilder b;
    json square = b.square();
    square["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 0, NAN, 0, 0, 0, 3, 4, 0, 0, 1}, "VEC3");
    b.node({{"mesh", b.mesh(square)}});
    const Scene scene = loadGltf(b.write("normals.glb"));
    const Primitive& primitive = scene.meshes[0].primitives[0];
    EXPECT_EQ(primitive.positions.size(), 4u);
    expectNearVector(primitive.normals[0], {0, 0, 1});
    expectNearVector(primitive.normals[1], {0, 0, 1});
    expectNearVector(primitive.normals[2], {0, .6f, .8f});
    EXPECT_TRUE(warns(scene, "normals without a direction"));
}

TEST(GltfImport, TextureCoordinatesOfAllTypes) {
    GlbBuilder b;
    json square = b.square();
    square["attributes"]["TEXCOORD_0"] = b.accessor<uint8_t>({0, 0, 255, 0, 51, 102, 0, 255}, "VEC2", true);
    square["attributes"]["TEXCOORD_1"] =
        b.accessor<uint16_t>({0, 0, 65535, 0, 13107, 26214, 0, 1}, "VEC2", true);
    json plain = b.square();
    plain["attributes"]["TEXCOORD_0"] = b.squareUvs();
    b.node({{"mesh", b.mesh(square)}});
    b.node({{"mesh", b.mesh(plain)}});
    // 8-bit pairs fill the view tightly here; files pad them with a stride.
    b.json["nodes"][0]["mesh"] = 0;
    const Scene scene = loadGltf(b.write("uv.glb"));
    const Primitive& p = scene.meshes[0].primitives[0];
    // Without normals the corners are split: corner 2 of the first triangle is vertex 2.
    EXPECT_EQ(p.texCoord0[1], glm::vec2(1.0f, 0.0f));
    EXPECT_FLOAT_EQ(p.texCoord0[2].x, 0.2f);
    EXPECT_FLOAT_EQ(p.texCoord0[2].y, 0.4f);
    EXPECT_FLOAT_EQ(p.texCoord1[2].x, 0.2f);
    EXPECT_FLOAT_EQ(p.texCoord1[2].y, 0.4f);
    EXPECT_EQ(scene.meshes[1].primitives[0].texCoord0[2], glm::vec2(1.0f, 1.0f));
    EXPECT_TRUE(scene.meshes[1].primitives[0].texCoord1.empty());
}

TEST(GltfImport, QuantizedPositionsWithStride) {
    GlbBuilder b;
    // These are three components of 16 bits padded to 8 bytes.
    const int positions = b.accessor<int16_t>({0, 0, 0, -99, 32767, 0, 0, -99, 0, -32767, 0}, "VEC3", true);
    b.json["accessors"][static_cast<size_t>(positions)]["count"] = 3;
    b.json["bufferViews"][0]["byteStride"] = 8;
    const int integers = b.accessor<uint16_t>({0, 0, 0, 0, 400, 0, 0, 0, 0, 300, 0}, "VEC3");
    b.json["accessors"][static_cast<size_t>(integers)]["count"] = 3;
    b.json["bufferViews"][1]["byteStride"] = 8;
    b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    b.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", positions}}}})}});
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", integers}}}})}});
    const Scene scene = loadGltf(b.write("quantized.glb"));
    expectNearVector(scene.meshes[0].primitives[0].positions[1], {1, 0, 0});
    expectNearVector(scene.meshes[0].primitives[0].positions[2], {0, -1, 0});
    expectNearVector(scene.meshes[1].primitives[0].positions[1], {400, 0, 0});
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfImport, VertexColoursOfAllTypes) {
    GlbBuilder b;
    const auto add = [&](int colors) {
        json square = b.square();
        square["attributes"]["COLOR_0"] = colors;
        b.node({{"mesh", b.mesh(square)}});
    };
    add(b.accessor<float>({1, 0, 0, .5f, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 1}, "VEC4"));
    add(b.accessor<uint8_t>({255, 0, 0, 51, 0, 255, 0, 255, 0, 0, 255, 255, 1, 1, 1, 1}, "VEC4", true));
    add(b.accessor<uint16_t>({65535, 0, 0, 13107, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", true));
    add(b.accessor<float>({.25f, .5f, .75f, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3"));
    const Scene scene = loadGltf(b.write("colors.glb"));
    EXPECT_EQ(scene.meshes[0].primitives[0].colors[0], glm::vec4(1, 0, 0, .5f));
    EXPECT_EQ(scene.meshes[1].primitives[0].colors[0], glm::vec4(1, 0, 0, .2f));
    EXPECT_EQ(scene.meshes[2].primitives[0].colors[0], glm::vec4(1, 0, 0, .2f));
    EXPECT_EQ(scene.meshes[3].primitives[0].colors[0], glm::vec4(.25f, .5f, .75f, 1));
}

void addImage(GlbBuilder& b) {
    b.json["images"].push_back({{"bufferView", b.view(test::kTwoPixels)}, {"mimeType", "image/png"}});
    b.json["textures"].push_back({{"source", 0}, {"sampler", 0}});
    b.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
}

TEST(GltfImport, Materials) {
    GlbBuilder b = squareScene();
    addImage(b);
    b.json["materials"] = {{{"name", "Lamp"},
                            {"emissiveFactor", {1, .5, 0}},
                            {"emissiveTexture", {{"index", 0}, {"texCoord", 1}}},
                            {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 40}}}}},
                            {"alphaMode", "MASK"},
                            {"alphaCutoff", .25},
                            {"doubleSided", true},
                            {"pbrMetallicRoughness",
                             {{"baseColorFactor", {.1, .2, .3, .4}},
                              {"baseColorTexture", {{"index", 0}}},
                              {"metallicFactor", .5},
                              {"roughnessFactor", .75},
                              {"metallicRoughnessTexture", {{"index", 0}}}}}},
                           json::object(),
                           {{"alphaMode", "BLEND"}, {"name", "Milk glass"}}};
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    const Scene scene = loadGltf(b.write("materials.glb"));
    ASSERT_EQ(scene.materials.size(), 3u);
    const Material& lamp = scene.materials[0];
    EXPECT_EQ(scene.meshes[0].primitives[0].material, 0);
    EXPECT_EQ(lamp.baseColor, glm::vec4(.1f, .2f, .3f, .4f));
    EXPECT_EQ(lamp.emission, glm::vec3(40, 20, 0));
    EXPECT_EQ(lamp.emissionTexture.texCoord, 1);
    EXPECT_EQ(lamp.metallic, .5f);
    EXPECT_EQ(lamp.roughness, .75f);
    EXPECT_EQ(lamp.alphaMode, AlphaMode::Mask);
    EXPECT_EQ(lamp.alphaCutoff, .25f);
    EXPECT_TRUE(lamp.doubleSided);
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(lamp.metallicRoughnessTexture.texture, 0);
    EXPECT_EQ(scene.textures[0].wrapS, Wrap::ClampToEdge);
    EXPECT_EQ(scene.textures[0].wrapT, Wrap::MirroredRepeat);
    EXPECT_TRUE(scene.textures[0].nearest);
    const Material& plain = scene.materials[1];
    EXPECT_EQ(plain.baseColor, glm::vec4(1));
    EXPECT_EQ(plain.metallic, 1.0f);
    EXPECT_EQ(plain.emission, glm::vec3(0));
    EXPECT_EQ(plain.baseColorTexture.texture, -1);
    EXPECT_EQ(plain.alphaMode, AlphaMode::Opaque);
    EXPECT_TRUE(warns(scene, "material 'Milk glass': alpha mode BLEND is baked as opaque"));
}

TEST(GltfImport, TextureTransformAndItsTexCoord) {
    GlbBuilder b = squareScene();
    addImage(b);
    // This is the example of the extension's specification: the lower left quarter of the image, turned
    // clockwise.
    const json transform = {
        {"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {.5, .5}}, {"texCoord", 1}};
    b.json["materials"] = {
        {{"pbrMetallicRoughness",
          {{"baseColorTexture",
            {{"index", 0}, {"texCoord", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}}}};
    const Scene scene = loadGltf(b.write("transform.glb"));
    const TextureRef& ref = scene.materials[0].baseColorTexture;
    EXPECT_EQ(ref.texCoord, 1);
    expectNearVector(ref.transform * glm::vec3(0, 0, 1), {0, 1, 1});
    expectNearVector(ref.transform * glm::vec3(1, 0, 1), {0, .5f, 1});
    expectNearVector(ref.transform * glm::vec3(0, 1, 1), {.5f, 1, 1});
}

void expectTwoPixels(const Scene& scene) {
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.images[0].width, 2u);
    EXPECT_EQ(scene.images[0].height, 1u);
    EXPECT_EQ(scene.images[0].rgba, (std::vector<uint8_t>{255, 0, 0, 255, 0, 128, 255, 64}));
}

TEST(GltfImport, EmbeddedImage) {
    GlbBuilder b = squareScene();
    addImage(b);
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    expectTwoPixels(loadGltf(b.write("embedded.glb")));
}

TEST(GltfImport, Base64Image) {
    GlbBuilder b = squareScene();
    b.json["images"] = {{{"uri", "data:image/png;base64,"
                                 "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAEUlEQVR42mP4z8Dwn6Hhvw"
                                 "MAELoDvjp5v74AAAAASUVORK5CYII="}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    expectTwoPixels(loadGltf(b.write("base64.glb")));
}

TEST(GltfImport, ExternalImageAndBufferBesideAGltf) {
    GlbBuilder b = squareScene();
    test::writeBytes("two pixels.png", test::kTwoPixels);
    test::writeBytes("square.bin", b.bin);
    b.json["buffers"] = {{{"uri", "square.bin"}, {"byteLength", b.bin.size()}}};
    b.json["images"] = {{{"uri", "two%20pixels.png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    const Scene scene = loadGltf(test::writeText("external.gltf", b.json.dump(2)));
    expectTwoPixels(scene);
    EXPECT_EQ(scene.meshes[0].primitives[0].texCoord1.size(), 6u);
}

TEST(GltfImport, SixteenBitImagesKeepTheirHighBytes) {
    const std::vector<uint8_t> png = {
        0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
        0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x10, 0x02, 0x00, 0x00, 0x00, 0xc0,
        0xe7, 0x8f, 0x9d, 0x00, 0x00, 0x00, 0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0x68,
        0x10, 0x72, 0x30, 0xf9, 0xff, 0x1f, 0x00, 0x07, 0xfa, 0x03, 0x05, 0x90, 0x39, 0xbc, 0x51,
        0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82}; // one pixel 8012 4034 ffff
    GlbBuilder b = squareScene();
    b.json["images"] = {{{"bufferView", b.view(png)}, {"mimeType", "image/png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
    EXPECT_EQ(loadGltf(b.write("sixteen.glb")).images.at(0).rgba,
              (std::vector<uint8_t>{0x80, 0x40, 0xff, 0xff}));
}

TEST(GltfImport, ImagesThatNothingUsesNeedNotExist) {
    GlbBuilder b = squareScene();
    b.json["images"] = {{{"uri", "nowhere.png"}}};
    b.json["textures"] = {{{"source", 0}}};
    b.json["materials"] = {{{"normalTexture", {{"index", 0}}}}};
    EXPECT_TRUE(loadGltf(b.write("unused.glb")).images.empty());
}

TEST(GltfImport, CamerasAndLights) {
    GlbBuilder b = squareScene();
    b.json["cameras"] = {{{"type", "perspective"},
                          {"perspective", {{"yfov", .7}, {"znear", .1}, {"zfar", 50}, {"aspectRatio", 1.5}}}},
                         {{"type", "orthographic"},
                          {"orthographic", {{"xmag", 4}, {"ymag", 2}, {"znear", .1}, {"zfar", 50}}}}};
    b.json["extensionsUsed"] = {"KHR_lights_punctual"};
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"},
         {"intensity", 100},
         {"color", {1, .5, 0}},
         {"range", 9},
         {"spot", {{"innerConeAngle", .2}, {"outerConeAngle", .6}}}},
        {{"type", "directional"}, {"name", "Sun"}, {"intensity", 1000}},
        {{"type", "point"}}};
    const auto light = [](int i) { return json{{"KHR_lights_punctual", {{"light", i}}}}; };
    b.node({{"camera", 0}, {"name", "Eye"}, {"translation", {1, 2, 3}}, {"children", {2, 3}}});
    b.node({{"camera", 1}, {"extensions", light(0)}, {"name", "Spot"}});
    b.node({{"extensions", light(1)}});
    b.node({{"extensions", light(2)}});
    const Scene scene = loadGltf(b.write("lights.glb"));
    ASSERT_EQ(scene.cameras.size(), 2u);
    EXPECT_EQ(scene.cameras[0].name, "Eye");
    EXPECT_FLOAT_EQ(scene.cameras[0].yfov, .7f);
    EXPECT_FLOAT_EQ(scene.cameras[0].aspect, 1.5f);
    EXPECT_FLOAT_EQ(scene.cameras[0].zfar, 50.0f);
    EXPECT_FALSE(scene.cameras[1].perspective);
    EXPECT_FLOAT_EQ(scene.cameras[1].ymag, 2.0f);
    EXPECT_FLOAT_EQ(scene.cameras[1].aspect, 2.0f);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].type, LightType::Spot);
    EXPECT_EQ(scene.lights[0].name, "Spot");
    EXPECT_EQ(scene.lights[0].color, glm::vec3(1, .5f, 0));
    EXPECT_FLOAT_EQ(scene.lights[0].innerConeAngle, .2f);
    EXPECT_FLOAT_EQ(scene.lights[0].range, 9.0f);
    expectNearVector(glm::vec3(scene.lights[0].transform[3]), {1, 2, 3});
    EXPECT_EQ(scene.lights[1].type, LightType::Directional);
    EXPECT_EQ(scene.lights[1].name, "Sun");
    EXPECT_FLOAT_EQ(scene.lights[1].intensity, 1000.0f);
    EXPECT_EQ(scene.lights[2].type, LightType::Point);
    EXPECT_FLOAT_EQ(scene.lights[2].intensity, 1.0f);
}

TEST(GltfImport, UnsupportedPartsAreNamed) {
    GlbBuilder b = squareScene();
    b.json["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_lights_punctual"};
    b.json["animations"] = {{{"channels", json::array()}, {"samplers", json::array()}}};
    const Scene scene = loadGltf(b.write("unsupported.glb"));
    EXPECT_TRUE(warns(scene, "extension 'KHR_materials_clearcoat'"));
    EXPECT_FALSE(warns(scene, "KHR_lights_punctual"));
    EXPECT_TRUE(warns(scene, "animations: are not played"));
}

TEST(GltfImport, ReferenceScenesLoadWithoutWarnings) {
    const std::string folder = std::string(RELUME_SHARED_DIR) + "/scenes/rtrad/";
    if (!std::filesystem::exists(folder + "Multilayer.glb"))
        GTEST_SKIP() << "no " << folder << " here: the reference scenes are not part of the project";
    const std::pair<const char*, size_t> scenes[] = {{"CornellLucy.glb", 29429},
                                                     {"CornellGeom.glb", 4072},
                                                     {"Multilayer.glb", 60},
                                                     {"Nvidia_Scene.glb", 780},
                                                     {"TextureScene.glb", 9952}};
    for (const auto& [name, triangles] : scenes) {
        const Scene scene = loadGltf(folder + name);
        size_t count = 0;
        for (const Instance& instance : scene.instances)
            for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives)
                count += primitive.indices.size() / 3;
        EXPECT_EQ(count, triangles) << name;
        EXPECT_TRUE(scene.warnings.empty()) << name << ": " << scene.warnings.front();
    }
}

} // namespace
} // namespace relume
