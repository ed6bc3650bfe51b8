// Materials of glTF files beyond the core: their extensions, pictures in other forms, pictures that are
// missing.
#include "assets/gltf/gltf.h"

#include "assets/base/error.h"
#include "assets/gltf/edit/gltf_edit.h"
#include "tests/unit/edited_file.h"
#include "tests/unit/webp_pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace relume {
namespace {

using nlohmann::json;
using test::GlbBuilder;
using test::squareScene;

const std::vector<uint8_t> kPixels = {255, 0, 0, 255, 0, 128, 255, 64};

bool warnsOf(const Scene& scene, const std::string& part) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

/// Makes the square's scene with one material.
GlbBuilder painted(const json& material) {
    GlbBuilder b = squareScene();
    b.json["materials"] = json::array({material});
    b.json["meshes"][0]["primitives"][0]["material"] = 0;
    return b;
}

json picture(GlbBuilder& b, const std::vector<uint8_t>& bytes, const char* type) {
    return {{"bufferView", b.view(bytes)}, {"mimeType", type}};
}

json baseTexture() {
    return {
        {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {.5, 1, 1, 1}}}}};
}

json extended(const char* name, const json& value, json material = json::object()) {
    material["extensions"][name] = value;
    return material;
}

class GltfMaterial : public test::EditedFile {
protected:
    Scene load(const GlbBuilder& builder) const { return loadGltf(write(builder)); }
    Material materialOf(const json& material) const { return load(painted(material)).materials.at(0); }
};

TEST_F(GltfMaterial, WebpIsReadByItsExtensionAndPlainly) {
    GlbBuilder b = painted(baseTexture());
    b.json["images"] = json::array({picture(b, test::kTwoPixelsWebp, "image/webp")});
    b.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
    b.json["extensionsRequired"] = b.json["extensionsUsed"] = {"EXT_texture_webp"};
    const Scene byExtension = load(b);
    EXPECT_EQ(byExtension.images.at(0).rgba, kPixels);
    EXPECT_TRUE(byExtension.warnings.empty()) << byExtension.warnings.front();
    b.json["textures"] = {{{"source", 0}}};
    EXPECT_EQ(load(b).images.at(0).rgba, kPixels);
}

TEST_F(GltfMaterial, WebpIsReadFromADataUriAndFallsBackToThePlainSource) {
    GlbBuilder b = painted(baseTexture());
    b.json["images"] = {{{"uri", "data:image/webp;base64,UklGRg=="}},
                        picture(b, test::kTwoPixels, "image/png")};
    b.json["textures"] = {{{"source", 1}, {"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}}};
    const Scene scene = load(b);
    EXPECT_EQ(scene.images.at(0).rgba, kPixels);
    EXPECT_EQ(scene.materials[0].baseColorTexture.texture, 0);
    EXPECT_TRUE(warnsOf(scene, "image 0 '': cannot be decoded"));
}

TEST_F(GltfMaterial, ABasisuTextureIsItsFallbackOrNone) {
    GlbBuilder b = painted(baseTexture());
    b.json["images"] = {{{"uri", "colour.ktx2"}}, picture(b, test::kTwoPixels, "image/png")};
    b.json["textures"] = {{{"source", 1}, {"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
    b.json["extensionsUsed"] = {"KHR_texture_basisu"};
    Scene scene = load(b);
    EXPECT_EQ(scene.images.at(0).rgba, kPixels);
    EXPECT_TRUE(scene.warnings.empty()) << scene.warnings.front();
    b.json["textures"][0].erase("source");
    b.json["extensionsRequired"] = {"KHR_texture_basisu"};
    scene = load(b);
    EXPECT_TRUE(scene.images.empty());
    EXPECT_EQ(scene.materials[0].baseColorTexture.texture, -1);
    EXPECT_EQ(scene.materials[0].baseColor, glm::vec4(.5f, 1, 1, 1));
    EXPECT_TRUE(warnsOf(scene, "texture 0: has only a KTX2 image"));
}

TEST_F(GltfMaterial, OfSpecularGlossinessTheDiffuseColourIsTheBase) {
    GlbBuilder b = painted(extended("KHR_materials_pbrSpecularGlossiness",
                                    {{"diffuseFactor", {.1, .2, .3, .4}},
                                     {"diffuseTexture", {{"index", 0}, {"texCoord", 1}}},
                                     {"specularFactor", {1, 1, 1}},
                                     {"glossinessFactor", .25}},
                                    {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}}}));
    b.json["images"] = json::array({picture(b, test::kTwoPixels, "image/png")});
    b.json["textures"] = {{{"source", 0}}};
    b.json["extensionsRequired"] = b.json["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
    const Material material = load(b).materials.at(0);
    EXPECT_EQ(material.baseColor, glm::vec4(.1f, .2f, .3f, .4f));
    EXPECT_EQ(material.metallic, 0.0f);
    EXPECT_EQ(material.roughness, 0.75f) << "of highlights in files that are written";
    EXPECT_EQ(material.baseColorTexture.texture, 0);
    EXPECT_EQ(material.baseColorTexture.texCoord, 1);
    // An edit goes to where the colour comes from; white is written too, or the extension would be gone.
    const std::string path = write(b);
    save(path, [](Scene& scene) { scene.materials[0].baseColor = glm::vec4(1.0f); });
    EXPECT_EQ(loadGltf(path).materials[0].baseColor, glm::vec4(1.0f));
    EXPECT_EQ(loadGltf(path).materials[0].metallic, 0.0f);
    EXPECT_EQ(test::jsonOf(path)["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"],
              json({1, 0, 0, 1}));
}

TEST_F(GltfMaterial, UnlitIsADiffuseSurfaceOfItsBaseColour) {
    const Scene scene = load(painted(
        extended("KHR_materials_unlit", json::object(),
                 {{"name", "Sign"}, {"pbrMetallicRoughness", {{"baseColorFactor", {.5, .6, .7, 1}}}}})));
    EXPECT_EQ(scene.materials.at(0).baseColor, glm::vec4(.5f, .6f, .7f, 1));
    EXPECT_EQ(scene.materials[0].metallic, 0.0f);
    EXPECT_TRUE(warnsOf(scene, "material 'Sign': KHR_materials_unlit is baked as a diffuse surface"));
}

TEST_F(GltfMaterial, TransmissionMakesAPane) {
    const auto glass = [&](double factor, double metallic) {
        GlbBuilder b =
            painted(extended("KHR_materials_transmission", {{"transmissionFactor", factor}},
                             {{"name", "Glass"}, {"pbrMetallicRoughness", {{"metallicFactor", metallic}}}}));
        b.node({{"mesh", b.mesh(b.square())}});
        return load(b);
    };
    const Scene scene = glass(0.75, 0.0);
    EXPECT_EQ(scene.materials.at(0).transmission, 0.75f);
    EXPECT_TRUE(scene.materials[0].pane);
    EXPECT_TRUE(warnsOf(scene, "material 'Glass': is seen through"));
    EXPECT_FALSE(glass(0.5, 0.0).materials.at(0).pane);
    EXPECT_FALSE(glass(0.75, 1.0).materials.at(0).pane) << "a metal";
    saveGlb(scene, folder_.path("copy.glb"));
    EXPECT_EQ(loadGltf(folder_.path("copy.glb")).materials.at(0).transmission, 0.75f);
    EXPECT_TRUE(loadGltf(folder_.path("copy.glb")).materials.at(0).pane);
}

TEST_F(GltfMaterial, TransmissionIsTimesTheMeanOfItsTexture) {
    GlbBuilder b = painted(extended("KHR_materials_transmission",
                                    {{"transmissionFactor", 1}, {"transmissionTexture", {{"index", 0}}}},
                                    {{"pbrMetallicRoughness", {{"metallicFactor", 0}}}}));
    b.json["images"] = json::array({picture(b, test::kTwoPixels, "image/png")});
    b.json["textures"] = {{{"source", 0}}};
    const Scene scene = load(b);
    EXPECT_EQ(scene.materials.at(0).transmission, 0.5f); // red is 255 and 0
    EXPECT_TRUE(scene.images.empty()) << "nothing else of it is used";
}

/// Two squares; the first has materials of its own by day and by night, the second by night alone.
GlbBuilder withVariants() {
    GlbBuilder b = squareScene();
    b.json["materials"] = {{{"name", "Plain"}}, {{"name", "Day"}}, {{"name", "Night"}}};
    b.json["extensionsUsed"] = {"KHR_materials_variants"};
    b.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "day"}}, {{"name", "night"}}};
    json& first = b.json["meshes"][0]["primitives"][0];
    first["material"] = 0;
    json second = first;
    first["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {0}}},
                                                                 {{"material", 2}, {"variants", {1}}}};
    second["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 2}, {"variants", {1}}}};
    b.json["meshes"][0]["primitives"].push_back(second);
    return b;
}

TEST_F(GltfMaterial, VariantsAreChosenByName) {
    const std::string path = write(withVariants());
    const auto materials = [&](const std::string& variant) {
        const Scene scene = loadGltf(path, {.scene = "", .variant = variant, .time = {}});
        EXPECT_EQ(scene.variantNames, (std::vector<std::string>{"day", "night"}));
        EXPECT_TRUE(scene.warnings.empty());
        return std::vector<int>{scene.meshes.at(0).primitives.at(0).material,
                                scene.meshes[0].primitives.at(1).material};
    };
    EXPECT_EQ(materials(""), (std::vector<int>{0, 0}));
    EXPECT_EQ(materials("day"), (std::vector<int>{1, 0}));
    EXPECT_EQ(materials("night"), (std::vector<int>{2, 2}));
    EXPECT_EQ(messageOf([&] { materials("dusk"); }),
              path + ": has no variant 'dusk' of its materials: choose one of 'day', 'night'");
    const std::string plain = write(squareScene(), "plain.glb");
    EXPECT_EQ(messageOf([&] { loadGltf(plain, {.scene = "", .variant = "day", .time = {}}); }),
              plain + ": has no variant 'day' of its materials: it has no variants, leave the choice out");
}

TEST_F(GltfMaterial, OddMappingsCountAsMissing) {
    for (const json& odd :
         {json(-1), json(0.5), json("x"), json(nullptr), json::array(), json::object(), json(99),
          json({1, 2}), json({{"material", 7}}), json::array({{{"variants", {0}}}}),
          json::array({{{"variants", 0}, {"material", 1}}})}) {
        SCOPED_TRACE(odd.dump());
        GlbBuilder b = withVariants();
        b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"] = odd;
        EXPECT_EQ(loadGltf(write(b), {.scene = "", .variant = "day", .time = {}})
                      .meshes.at(0)
                      .primitives[0]
                      .material,
                  0);
        b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"] = odd;
        EXPECT_EQ(loadGltf(write(b), {.scene = "", .variant = "day", .time = {}})
                      .meshes.at(0)
                      .primitives[0]
                      .material,
                  0);
        b.json["extensions"]["KHR_materials_variants"]["variants"] = odd;
        EXPECT_EQ(loadGltf(write(b)).meshes.at(0).primitives[0].material, 0);
    }
}

TEST_F(GltfMaterial, ManyPanesAreToldInOneLine) {
    GlbBuilder b = squareScene();
    for (const char* name : {"A", "B", "C"})
        b.json["materials"].push_back({{"name", name},
                                       {"alphaMode", "BLEND"},
                                       {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, .3}}}}});
    b.json["materials"].push_back({{"name", "D"}, {"alphaMode", "BLEND"}});
    const Scene scene = load(b);
    EXPECT_TRUE(warnsOf(scene, "material 'A' and 2 more: is seen through: light passes it"));
    EXPECT_TRUE(warnsOf(scene, "material 'D': alpha mode BLEND is baked as opaque"));
    EXPECT_EQ(scene.warnings.size(), 2u);
}

TEST_F(GltfMaterial, ImagesThatAreMissingOrDamagedLeaveTheFactor) {
    std::vector<uint8_t> broken = test::kTwoPixels;
    broken.resize(40);
    for (const auto& [image, problem] : std::vector<std::pair<json, std::string>>{
             {{{"uri", "nowhere.png"}}, "image file 'nowhere.png': is missing or empty"},
             {{{"uri", "data:image/png;base64,"}}, "image 0 '': is missing or empty"},
             {json::object(), "image 0 '': is missing or empty"}}) {
        GlbBuilder b = painted(baseTexture());
        b.json["images"] = json::array({image});
        b.json["textures"] = {{{"source", 0}}};
        const Scene scene = load(b);
        EXPECT_TRUE(warnsOf(scene, problem + ", materials use their factors alone")) << problem;
        EXPECT_EQ(scene.materials.at(0).baseColorTexture.texture, -1);
        EXPECT_EQ(scene.materials[0].baseColor, glm::vec4(.5f, 1, 1, 1));
        EXPECT_TRUE(scene.textures.empty());
    }
    GlbBuilder b = painted(baseTexture());
    b.json["images"] = json::array({picture(b, broken, "image/png")});
    b.json["textures"] = {{{"source", 0}}};
    EXPECT_TRUE(warnsOf(load(b), "image 0 '': cannot be decoded"));
    b.json["textures"] = json::array({json::object()});
    EXPECT_TRUE(warnsOf(load(b), "texture 0: has no PNG, JPEG or WebP image"));
}

/// Streams of the file's picture are mutated a thousand times; the scene is there each time.
TEST_F(GltfMaterial, MutatedPicturesNeverRefuseAFile) {
    std::mt19937 random(3);
    for (int round = 0; round < 200; ++round) {
        std::vector<uint8_t> bytes = round % 2 == 0 ? test::kLossyWebp : test::kLosslessWebp;
        for (uint32_t changes = 1 + random() % 3; changes > 0; --changes)
            bytes[30 + random() % (bytes.size() - 30)] ^= static_cast<uint8_t>(1 + random() % 255);
        GlbBuilder b = painted(baseTexture());
        b.json["images"] = json::array({picture(b, bytes, "image/webp")});
        b.json["textures"] = {{{"source", 0}}};
        const Scene scene = load(b);
        EXPECT_EQ(scene.textures.empty(), warnsOf(scene, "cannot be decoded"));
    }
}

/// Whatever extensions hold instead of what they should, the file is read.
TEST_F(GltfMaterial, OddExtensionsCountAsMissing) {
    const json odd[] = {-1, 0.5, "x", nullptr, true, json::array(), json::object(), {1, 2, 3}, 1e300, 99};
    for (const json& value : odd) {
        SCOPED_TRACE(value.dump());
        GlbBuilder b = painted(json::object());
        json& extensions = b.json["materials"][0]["extensions"];
        for (const char* name : {"KHR_materials_pbrSpecularGlossiness", "KHR_materials_transmission"})
            extensions[name] = {{"diffuseFactor", value},
                                {"diffuseTexture", value},
                                {"transmissionFactor", value},
                                {"transmissionTexture", {{"index", value}}}};
        b.json["textures"] = {{{"extensions", {{"EXT_texture_webp", {{"source", value}}}}}}};
        b.json["nodes"][0]["extensions"]["KHR_node_visibility"]["visible"] = value;
        b.json["nodes"][0]["extensions"]["EXT_lights_area"]["light"] = value;
        b.json["extensions"]["EXT_lights_area"]["lights"] = json::array({value});
        const Scene scene = load(b);
        EXPECT_EQ(scene.materials.size(), 1u);
        extensions = {{"KHR_materials_unlit", value}, {"KHR_materials_transmission", value}};
        b.json["extensions"]["EXT_lights_area"]["lights"] = value;
        b.json["nodes"][0]["extensions"]["KHR_node_visibility"] = value;
        EXPECT_EQ(load(b).materials.size(), 1u);
    }
}

} // namespace
} // namespace relume
