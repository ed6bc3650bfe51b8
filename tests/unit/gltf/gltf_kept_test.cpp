// Maps of a material that no bake reads, and that files that are written have all the same.
#include "assets/gltf/gltf.h"
#include "tests/unit/edited_file.h"
#include "tests/unit/webp_pictures.h"

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace relume {
namespace {

using nlohmann::json;
using test::GlbBuilder;
using test::squareScene;

json embedded(GlbBuilder& b, const std::vector<uint8_t>& bytes) {
    return {{"bufferView", b.view(bytes)}, {"mimeType", "image/png"}};
}

/// Makes a square whose roughness and occlusion are one texture and whose normal map is another.
GlbBuilder mapped() {
    GlbBuilder b = squareScene();
    b.json["materials"] = json::array(
        {{{"name", "Brick"},
          {"pbrMetallicRoughness", {{"metallicRoughnessTexture", {{"index", 0}}}}},
          {"occlusionTexture", {{"index", 0}, {"strength", 0.25}}},
          {"normalTexture",
           {{"index", 1},
            {"scale", 0.5},
            {"texCoord", 1},
            {"extensions", {{"KHR_texture_transform", {{"scale", {2, 4}}, {"offset", {0.5, 0}}}}}}}}}});
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    b.json["images"] = {embedded(b, test::kTwoPixels), embedded(b, test::kTwoPixels)};
    b.json["images"][1]["name"] = "Bumps";
    b.json["textures"] = {{{"source", 0}}, {{"source", 1}, {"sampler", 0}}};
    b.json["samplers"] = {{{"wrapS", 33071}, {"magFilter", 9728}}};
    return b;
}

class GltfKept : public test::EditedFile {
protected:
    std::string written(const Scene& scene) const {
        saveGlb(scene, folder_.path("out.glb"));
        return folder_.path("out.glb");
    }
    /// Returns the bytes of a picture in a file.
    static std::vector<uint8_t> pictureIn(const std::string& path, const json& image) {
        const json view = test::jsonOf(path)["bufferViews"][image["bufferView"].get<size_t>()];
        const std::string chunk = test::chunksOf(path).substr(8 + view.value("byteOffset", size_t{0}),
                                                              view["byteLength"].get<size_t>());
        return {chunk.begin(), chunk.end()};
    }
};

TEST_F(GltfKept, MapsAreWrittenAsTheyWereRead) {
    const Scene scene = loadGltf(write(mapped()));
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
    ASSERT_EQ(scene.images.size(), 1u) << "what no bake reads is not decoded";
    const std::string path = written(scene);
    const json out = test::jsonOf(path);
    ASSERT_EQ(out["images"].size(), 2u) << "occlusion lies in the texture of roughness";
    const json& material = out["materials"][0];
    EXPECT_EQ(material["occlusionTexture"], json({{"index", 0}, {"strength", 0.25}}));
    EXPECT_EQ(material["pbrMetallicRoughness"]["metallicRoughnessTexture"]["index"], 0);
    const json& normal = material["normalTexture"];
    EXPECT_EQ(normal["index"], 1);
    EXPECT_EQ(normal["scale"], 0.5);
    EXPECT_EQ(normal["texCoord"], 1);
    EXPECT_EQ(normal["extensions"]["KHR_texture_transform"]["scale"], json({2.0, 4.0}));
    EXPECT_EQ(out["extensionsUsed"], json({"KHR_texture_transform"}));
    const json& texture = out["textures"][1];
    EXPECT_EQ(out["samplers"][texture["sampler"].get<size_t>()]["wrapS"], 33071);
    EXPECT_EQ(out["images"][1]["name"], "Bumps");
    EXPECT_EQ(pictureIn(path, out["images"][1]), test::kTwoPixels) << "byte for byte";
    // Another round changes nothing of them.
    const json again = test::jsonOf(written(loadGltf(path)));
    for (const char* part : {"materials", "textures", "samplers", "images"})
        EXPECT_EQ(again[part].size(), out[part].size()) << part;
    EXPECT_EQ(again["materials"], out["materials"]);
}

TEST_F(GltfKept, APictureBesideTheSceneIsReadWhenAFileIsWritten) {
    GlbBuilder b = mapped();
    b.json["images"][1] = {{"uri", "bumps%20map.png"}};
    const std::string picture(test::kTwoPixels.begin(), test::kTwoPixels.end());
    write(picture, "bumps map.png");
    const Scene scene = loadGltf(write(b));
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
    const std::string path = written(scene);
    EXPECT_EQ(pictureIn(path, test::jsonOf(path)["images"][1]), test::kTwoPixels);
    std::filesystem::remove(folder_.path("bumps map.png"));
    EXPECT_NE(messageOf([&] { saveGlb(scene, path); }).find("bumps map.png"), std::string::npos);
}

TEST_F(GltfKept, WebpIsWrittenAsPng) {
    GlbBuilder b = mapped();
    b.json["images"][1] = embedded(b, test::kTwoPixelsWebp);
    b.json["textures"][1] = {{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}};
    const std::string path = written(loadGltf(write(b)));
    const json out = test::jsonOf(path);
    EXPECT_EQ(out["images"][1]["mimeType"], "image/png");
    const std::vector<uint8_t> bytes = pictureIn(path, out["images"][1]);
    const std::string head(bytes.begin() + 1, bytes.begin() + 4);
    EXPECT_EQ(head, "PNG");
}

TEST_F(GltfKept, WhatIsNoPictureIsToldAndLeftOut) {
    for (const json& image : {json{{"uri", "gone.png"}}, json{{"uri", "data:image/png;base64,AAAA"}}}) {
        GlbBuilder b = mapped();
        b.json["images"][1] = image;
        const Scene scene = loadGltf(write(b));
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_NE(scene.warnings[0].find("texture 1: has no PNG, JPEG or WebP image"), std::string::npos);
        const json out = test::jsonOf(written(scene));
        EXPECT_FALSE(out["materials"][0].contains("normalTexture"));
        EXPECT_TRUE(out["materials"][0].contains("occlusionTexture"));
    }
}

} // namespace
} // namespace relume
