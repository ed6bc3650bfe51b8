#include "assets/gltf/gltf.h"

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/unwrap.h"
#include "assets/atlas/world_mesh.h"
#include "assets/base/error.h"
#include "tests/unit/rich_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

namespace relume {
namespace {

using nlohmann::json;
using test::GlbBuilder;
using test::richScene;
using test::squareScene;
using test::useImage;

/// Expects that loading fails with one line that names the file and holds `part`.
void expectError(const std::string& path, const std::string& part) {
    try {
        loadGltf(path);
        ADD_FAILURE() << path << " was loaded";
    } catch (const Error& error) {
        const std::string message = error.what();
        EXPECT_NE(message.find(part), std::string::npos) << message;
        EXPECT_EQ(message.rfind(path, 0), 0u) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

/// Expects that of the square's scene with one thing spoiled.
void expectSpoiled(const std::string& name, const std::string& part,
                   const std::function<void(GlbBuilder&)>& spoil) {
    GlbBuilder builder = squareScene();
    spoil(builder);
    SCOPED_TRACE(name);
    expectError(builder.write(name + ".glb"), part);
}

TEST(GltfBadInput, MissingFileAndFolder) {
    expectError(test::tempPath("none.glb"), "cannot be opened");
    std::filesystem::create_directories(test::tempPath("folder.glb"));
    expectError(test::tempPath("folder.glb"), "is a folder");
}

TEST(GltfBadInput, EveryTruncationIsAnError) {
    const std::vector<uint8_t> whole = squareScene().bytes();
    for (size_t size = 0; size + 4 <= whole.size(); size += size < 64 ? 1 : 37) { // fewer bytes are padding
        const std::string path =
            test::writeBytes("cut.glb", {whole.begin(), whole.begin() + static_cast<long>(size)});
        EXPECT_THROW(loadGltf(path), Error) << size;
    }
    expectError(test::writeBytes("half.glb", {whole.begin(), whole.begin() + 100}), "is truncated");
}

TEST(GltfBadInput, WrongMagicVersionOrText) {
    std::vector<uint8_t> bytes = squareScene().bytes();
    bytes[0] = 'x';
    expectError(test::writeBytes("magic.glb", bytes), "wrong magic");
    bytes[0] = 'g';
    bytes[4] = 1;
    expectError(test::writeBytes("version.glb", bytes), "GLB version 1");
    expectError(test::writeText("list.gltf", "[1, 2]"), "glTF 2.0");
    expectError(test::writeText("comma.gltf", "{\"asset\": {\"version\": \"2.0\"},,}"), "no valid JSON");
    expectError(test::writeText("bare.gltf", "{}"), "asset.version");
    expectError(test::writeText("old.gltf", "{\"asset\": {\"version\": \"1.0\"}}"), "is glTF '1.0'");
    expectError(test::writeText("utf8.gltf", "{\"asset\": {\"version\": \"2.0\", \"x\": \"\xff\"}}"),
                "no valid JSON");
}

TEST(GltfBadInput, DeeplyNestedJsonDoesNotExhaustTheStack) {
    std::string text = "{\"asset\":{\"version\":\"2.0\"},\"extras\":";
    text += std::string(1000000, '[') + std::string(1000000, ']') + "}";
    expectError(test::writeText("nested.gltf", text), "nested more than");
}

TEST(GltfBadInput, EmptyScenes) {
    expectError(test::writeText("empty.gltf", "{\"asset\": {\"version\": \"2.0\"}}"),
                "no mesh with triangles");
    expectSpoiled("no_nodes", "no mesh with triangles",
                  [](GlbBuilder& b) { b.json["nodes"] = json::array(); });
    expectSpoiled("no_primitives", "no mesh with triangles",
                  [](GlbBuilder& b) { b.json["meshes"][0]["primitives"] = json::array(); });
    expectSpoiled("no_positions", "no mesh with triangles",
                  [](GlbBuilder& b) { b.json["meshes"][0]["primitives"][0]["attributes"] = json::object(); });
}

TEST(GltfBadInput, ViewsAndAccessorsPastTheEnd) {
    expectSpoiled("view", "bufferViews[0] ends at byte",
                  [](GlbBuilder& b) { b.json["bufferViews"][0]["byteLength"] = 1000000; });
    expectSpoiled("view_offset", "bufferViews[0] ends at byte",
                  [](GlbBuilder& b) { b.json["bufferViews"][0]["byteOffset"] = 1000000; });
    expectSpoiled("view_huge", "bufferViews[0].byteOffset",
                  [](GlbBuilder& b) { b.json["bufferViews"][0]["byteOffset"] = 18446744073709551600ull; });
    expectSpoiled("accessor", "accessors[0] reads up to byte",
                  [](GlbBuilder& b) { b.json["accessors"][0]["count"] = 5; });
    expectSpoiled("stride", "accessors[0] reads up to byte",
                  [](GlbBuilder& b) { b.json["bufferViews"][0]["byteStride"] = 16; });
    expectSpoiled("zeros", "far too large", [](GlbBuilder& b) {
        b.json["accessors"][0].erase("bufferView");
        b.json["accessors"][0]["count"] = 2147483647;
    });
    expectSpoiled("buffer", "binary chunk", [](GlbBuilder& b) {
        b.json["buffers"] = {{{"byteLength", 1000000}}};
    });
    expectSpoiled("buffer_file", "cannot be read", [](GlbBuilder& b) {
        b.json["buffers"] = {{{"byteLength", 1000}, {"uri", "nowhere.bin"}}};
    });
}

TEST(GltfBadInput, IndicesOutOfRange) {
    expectSpoiled("vertex", "mesh 'Mesh' has index 77, but 4 vertices", [](GlbBuilder& b) {
        b.json["meshes"][0]["primitives"][0]["indices"] = b.accessor<uint16_t>({0, 1, 77}, "SCALAR");
    });
    expectSpoiled("signed", "no unsigned integers", [](GlbBuilder& b) {
        b.json["meshes"][0]["primitives"][0]["indices"] = b.accessor<int16_t>({0, 1, 2}, "SCALAR");
    });
    expectSpoiled("sparse", "sparse accessor's index", [](GlbBuilder& b) {
        b.json["accessors"][0]["sparse"] = {
            {"count", 1},
            {"indices", {{"bufferView", b.view<uint16_t>({4, 0})}, {"componentType", 5123}}},
            {"values", {{"bufferView", b.view<float>({7, 8, 9})}}}};
    });
    expectSpoiled("sparse_index", "indices: a sparse accessor's index", [](GlbBuilder& b) {
        b.json["accessors"][b.json["meshes"][0]["primitives"][0]["indices"].get<size_t>()]["sparse"] = {
            {"count", 1},
            {"indices", {{"bufferView", b.view<uint16_t>({6, 0})}, {"componentType", 5123}}},
            {"values", {{"bufferView", b.view<uint16_t>({0, 0})}}}};
    });
    expectSpoiled("no_indices", "indices has no data", [](GlbBuilder& b) {
        b.json["accessors"][b.json["meshes"][0]["primitives"][0]["indices"].get<size_t>()].erase(
            "bufferView");
    });
    expectSpoiled("mesh", "nodes[0].mesh is 9, but there are 1 meshes",
                  [](GlbBuilder& b) { b.json["nodes"][0]["mesh"] = 9; });
    expectSpoiled("attribute", "POSITION is 99",
                  [](GlbBuilder& b) { b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 99; });
    expectSpoiled("material", ".material is 3",
                  [](GlbBuilder& b) { b.json["meshes"][0]["primitives"][0]["material"] = 3; });
    expectSpoiled("scene", "scene is 1", [](GlbBuilder& b) { b.json["scene"] = 1; });
    expectSpoiled("child", "children names node",
                  [](GlbBuilder& b) { b.json["nodes"][0]["children"] = {-1}; });
    expectSpoiled("light", "names light 2", [](GlbBuilder& b) {
        b.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 2;
    });
    expectSpoiled("image", "images[0].bufferView", [](GlbBuilder& b) {
        b.json["images"] = {{{"bufferView", 99}}};
    });
    expectSpoiled("counts", "4 positions but 3 of TEXCOORD_0", [](GlbBuilder& b) {
        b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
            b.accessor<float>({0, 0, 1, 0, 1, 1}, "VEC2");
    });
    expectSpoiled("components", "wrong number of components", [](GlbBuilder& b) {
        b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
            b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
    });
}

TEST(GltfBadInput, WrongJsonTypes) {
    expectSpoiled("meshes", "meshes is no array", [](GlbBuilder& b) { b.json["meshes"] = 7; });
    expectSpoiled("mesh", "meshes[0] is not an object", [](GlbBuilder& b) { b.json["meshes"][0] = "x"; });
    expectSpoiled("matrix", "not an array of 16 numbers", [](GlbBuilder& b) {
        b.json["nodes"][0]["matrix"] = {1, 2, 3};
    });
    expectSpoiled("index", "nodes[0].mesh is '0.5'", [](GlbBuilder& b) { b.json["nodes"][0]["mesh"] = 0.5; });
    expectSpoiled("type", "accessors[0].type",
                  [](GlbBuilder& b) { b.json["accessors"][0]["type"] = "VEC9"; });
    expectSpoiled("component", "componentType",
                  [](GlbBuilder& b) { b.json["accessors"][0]["componentType"] = 5130; });
}

TEST(GltfBadInput, NodeHierarchyThatIsNoTree) {
    expectSpoiled("diamond", "two parents", [](GlbBuilder& b) {
        b.node({{"children", {0}}});
        b.node({{"children", {0}}});
    });
    expectSpoiled("self", "must be a tree", [](GlbBuilder& b) {
        b.json["nodes"][0]["children"] = {0};
        b.json["scenes"] = {{{"nodes", {0}}}};
    });
    expectSpoiled("cycle", "must be a tree", [](GlbBuilder& b) {
        b.node({{"children", {0}}});
        b.json["nodes"][0]["children"] = {1};
        b.json["scenes"] = {{{"nodes", {0}}}};
    });
    // Without a scene nothing leads into the cycle.
    expectSpoiled("island", "no mesh with triangles", [](GlbBuilder& b) {
        b.node({{"children", {0}}});
        b.json["nodes"][0]["children"] = {1};
    });
}

TEST(GltfBadInput, RequiredExtensions) {
    const json use = {{"ACME_secret", json::object()}};
    const json::json_pointer users[] = {"/accessors/0"_json_pointer, "/bufferViews/0"_json_pointer,
                                        "/meshes/0"_json_pointer, "/meshes/0/primitives/0"_json_pointer};
    for (const json::json_pointer& user : users)
        expectSpoiled("unknown", "requires the extension 'ACME_secret' for its meshes", [&](GlbBuilder& b) {
            b.json["extensionsRequired"] = {"ACME_secret"};
            b.json[user]["extensions"] = use;
        });
    expectSpoiled("meshopt", "without mesh compression", [](GlbBuilder& b) {
        b.json["extensionsRequired"] = {"KHR_meshopt_compression"};
        b.json["bufferViews"][0]["extensions"]["KHR_meshopt_compression"] = json::object();
    });
}

/// Expects that the square's scene is read without the texture, and warns in one line that holds `part`.
void expectWithoutTexture(const std::string& name, const std::string& part,
                          const std::function<void(GlbBuilder&)>& spoil) {
    GlbBuilder builder = squareScene();
    spoil(builder);
    SCOPED_TRACE(name);
    const Scene scene = loadGltf(builder.write(name + ".glb"));
    EXPECT_TRUE(scene.images.empty());
    EXPECT_TRUE(scene.textures.empty());
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find(part), std::string::npos) << scene.warnings[0];
    EXPECT_EQ(scene.warnings[0].find('\n'), std::string::npos) << scene.warnings[0];
}

TEST(GltfBadInput, MissingOrBrokenImages) {
    expectWithoutTexture("missing", "image file 'nowhere.png': is missing", [](GlbBuilder& b) {
        useImage(b, {{"uri", "nowhere.png"}});
    });
    expectWithoutTexture("codes", "image 0 'Wood': cannot be decoded", [](GlbBuilder& b) {
        // It ends early and lacks even its first chunk's checksum.
        std::vector<uint8_t> png = test::kTwoPixels;
        png.resize(30);
        useImage(b, {{"bufferView", b.view(png)}, {"mimeType", "image/png"}, {"name", "Wood"}});
    });
    // stb would write 4080 codes into a table of 256, once before the pixels and once behind some.
    for (const bool behind : {false, true})
        expectWithoutTexture("codes", "image 0 'Wood': cannot be decoded", [behind](GlbBuilder& b) {
            std::vector<uint8_t> jpeg = {0xff, 0xff, 0xd8}; // filled up, as it may be
            if (behind) jpeg.insert(jpeg.end(), {0xff, 0xda, 0, 8, 1, 1, 0, 0, 63, 0, 1, 2, 3});
            jpeg.insert(jpeg.end(), {0xff, 0xc4, 0x10, 0x03, 0});
            jpeg.insert(jpeg.end(), 16, 255);
            jpeg.resize(5000);
            useImage(b, {{"bufferView", b.view(jpeg)}, {"mimeType", "image/jpeg"}, {"name", "Wood"}});
        });
    // stb reads these as well, and multiplies this width until it overflows.
    for (const std::string other : {"P5 99999999999999999999 1 255 .", "P5 1 1 255 .", "GIF89a", "BM"})
        expectWithoutTexture("other", "image 0 'Wood': cannot be decoded", [&](GlbBuilder& b) {
            const std::vector<uint8_t> bytes(other.begin(), other.end());
            useImage(b, {{"bufferView", b.view(bytes)}, {"mimeType", "image/png"}, {"name", "Wood"}});
        });
    expectWithoutTexture("no_image", "texture 0: has no PNG, JPEG or WebP image", [](GlbBuilder& b) {
        useImage(b, {{"uri", "nowhere.png"}});
        b.json["textures"] = json::array({json::object()});
    });
}

TEST(GltfBadInput, TrianglesWithNanAreDroppedWithAWarning) {
    GlbBuilder b = squareScene();
    const float nan = NAN, inf = INFINITY;
    b.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
        b.accessor<float>({0, 0, 0, 1, nan, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
    const Scene scene = loadGltf(b.write("nan.glb"));
    EXPECT_EQ(scene.meshes[0].primitives[0].indices.size(), 3u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("mesh 'Mesh': has positions that are not finite"), std::string::npos);
    for (const glm::vec3& p : scene.meshes[0].primitives[0].positions)
        EXPECT_TRUE(std::isfinite(p.x + p.y + p.z));

    expectSpoiled("all_nan", "no mesh with triangles", [&](GlbBuilder& bad) {
        bad.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] =
            bad.accessor<float>({inf, 0, 0, 1, nan, 0, 1, inf, 0, nan, 1, 0}, "VEC3");
    });
}

struct Outcomes {
    int loaded = 0, refused = 0;
    void add(const std::string& path) {
        try {
            Scene scene = loadGltf(path);
            unwrap(scene, {});
            flatten(scene, buildAtlas(scene, 64));
            ++loaded;
        } catch (const Error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
            ++refused;
        }
    }
};

/// Damage may leave a scene or give an Error, but nothing else; what loads must also flatten or fail cleanly.
TEST(GltfBadInput, FlippedBitsNeverCrash) {
    const std::vector<uint8_t> whole = richScene().bytes();
    std::mt19937 random(1);
    Outcomes outcomes;
    for (int round = 0; round < 300; ++round) {
        std::vector<uint8_t> bytes = whole;
        for (uint32_t flips = 1 + random() % 4; flips > 0; --flips)
            bytes[random() % bytes.size()] ^= 1 << random() % 8;
        outcomes.add(test::writeBytes("bits.glb", bytes));
    }
    EXPECT_GT(outcomes.loaded, 10);
    EXPECT_GT(outcomes.refused, 10);
}

TEST(GltfBadInput, OddJsonValuesNeverCrash) {
    const json odd[] = {-1,
                        0,
                        1,
                        3,
                        0.5,
                        255,
                        4294967295ull,
                        18446744073709551615ull,
                        1e300,
                        -1e300,
                        nullptr,
                        true,
                        "",
                        "x",
                        json::array(),
                        json::object(),
                        {1, 2},
                        {{"index", 0}}};
    const GlbBuilder rich = richScene();
    const json flat = rich.json.flatten();
    std::vector<std::string> places;
    for (const auto& [place, value] : flat.items())
        places.push_back(place);
    std::mt19937 random(2);
    Outcomes outcomes;
    for (int round = 0; round < 300; ++round) {
        GlbBuilder b = rich;
        std::string place = places[random() % places.size()];
        // Half the time it is the object or array around the value.
        if (random() % 2 == 0 && place.rfind('/') != 0) place.resize(place.rfind('/'));
        b.json[json::json_pointer(place)] = odd[random() % std::size(odd)];
        SCOPED_TRACE(place + " = " + b.json[json::json_pointer(place)].dump());
        outcomes.add(b.write("values.glb"));
    }
    EXPECT_GT(outcomes.loaded, 10);
    EXPECT_GT(outcomes.refused, 10);
}

} // namespace
} // namespace relume
