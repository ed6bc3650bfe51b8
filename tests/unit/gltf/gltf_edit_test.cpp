#include "assets/gltf/edit/gltf_edit.h"

#include "assets/base/error.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "tests/unit/edited_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace relume {
namespace {

using nlohmann::json;
using test::chunksOf;
using test::jsonOf;
using test::jsonTextOf;
using test::LitScene;
using test::readAll;

using GltfEdit = test::EditedFile;

/// Makes a file with extras everywhere, unknown extensions, numbers that only their text holds, and two
/// lights on one entry.
LitScene everything() {
    LitScene scene;
    json& root = scene.json;
    root["extras"] = {{"big", 9007199254740993}, {"bigger", 18446744073709551615u}, {"list", {1, 1.0, "x"}}};
    root["asset"]["extras"] = "text";
    root["accessors"][0]["extensions"] = {{"ACME_accessor", {{"scale", 0.30000001192092896}}}};
    root["bufferViews"][0]["extensions"] = {{"ACME_view", {{"offset", 9007199254740993}}}};
    root["meshes"][0]["extras"] = {{"relume", {{"other", 1}}}};
    root["materials"] = json::array({{{"name", "Paint"}, {"extras", {{"id", 7}}}}});
    root["meshes"][0]["primitives"][0]["material"] = 0;
    const int entry = scene.light({{"type", "point"},
                                   {"name", "Lamp"},
                                   {"color", {1, 0.5, 0.25}},
                                   {"intensity", 40},
                                   {"extras", {{"relume", {{"other", true}}}, {"maker", "A"}}}});
    scene.lamp({{"name", "First"}, {"translation", {1, 2, 3}}, {"extras", {{"id", 1}}}}, entry);
    scene.lamp({{"name", "Second"}, {"translation", {-1, 2, 3}}}, entry);
    root["extensionsUsed"].push_back("ACME_accessor");
    root["scenes"][0]["extras"] = {{"mood", "calm"}};
    return scene;
}

TEST_F(GltfEdit, WithoutAnEditTheFileStaysToTheByte) {
    const std::string path = write(everything());
    const std::string bytes = readAll(path);
    save(path, [](Scene&) {});
    EXPECT_EQ(readAll(path), bytes);
}

TEST_F(GltfEdit, OnlyWhatIsEditedDiffers) {
    const std::string path = write(everything());
    json expected = jsonOf(path);
    const std::string chunks = chunksOf(path);
    save(path, [](Scene& scene) {
        scene.lights[0].intensity = 0.3f;
        scene.lights[0].radius = 0.05f;
    });
    json copy = expected["extensions"]["KHR_lights_punctual"]["lights"][0];
    copy["intensity"] = 0.3;
    copy["extras"]["relume"]["radius"] = 0.05;
    expected["extensions"]["KHR_lights_punctual"]["lights"].push_back(copy);
    expected["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 1;
    EXPECT_EQ(jsonOf(path), expected);
    EXPECT_EQ(chunksOf(path), chunks);
    for (const char* spelling :
         {"9007199254740993", "18446744073709551615", "0.30000001192092896", "[1,1.0,"})
        EXPECT_NE(jsonTextOf(path).find(spelling), std::string::npos) << spelling;
    const Scene back = loadGltf(path);
    EXPECT_EQ(back.lights[0].intensity, 0.3f);
    EXPECT_EQ(back.lights[1].intensity, 40.0f);
}

TEST_F(GltfEdit, TheDensityOfAnObjectIsInItsNodesExtras) {
    LitScene builder = everything();
    builder.json["nodes"][0]["extras"] = {{"relume", {{"other", 1}}}, {"id", 2}};
    builder.json["nodes"].push_back({{"translation", {1, 0, 0}}}); // so that the square has a child to spare
    builder.json["nodes"][0]["children"] = json::array({builder.json["nodes"].size() - 1});
    const std::string path = write(builder);
    const json original = jsonOf(path);
    EXPECT_EQ(loadGltf(path).instances[0].density, 1.0f);
    save(path, [](Scene& scene) { scene.instances[0].density = 2.5f; });
    EXPECT_EQ(jsonOf(path)["nodes"][0]["extras"],
              json({{"relume", {{"other", 1}, {"density", 2.5}}}, {"id", 2}}));
    EXPECT_EQ(loadGltf(path).instances[0].density, 2.5f);
    // It goes along where the mesh moves into a node of its own, and without an edit it stays.
    save(path, [](Scene& scene) { scene.instances[0].transform[3] = {4, 5, 6, 1}; });
    Scene moved = loadGltf(path);
    EXPECT_EQ(moved.instances[0].density, 2.5f);
    EXPECT_EQ(moved.instances[0].transform[3], glm::vec4(4, 5, 6, 1));
    EXPECT_NE(moved.instances[0].node, 0);
    save(path, [](Scene& scene) { scene.instances[0].density = 1.0f; });
    EXPECT_EQ(jsonTextOf(path).find("density"), std::string::npos);
    EXPECT_EQ(jsonOf(path)["nodes"][0]["extras"], original["nodes"][0]["extras"]);
    EXPECT_NE(
        messageOf([&] { save(path, [](Scene& s) { s.instances[0].density = 0; }); }).find("from 0.01 to 100"),
        std::string::npos);
    // saveGlb writes it as well, and what is no factor counts as 1 with a warning.
    moved.instances[0].density = 0.25f;
    saveGlb(moved, folder_.path("again.glb"));
    EXPECT_EQ(loadGltf(folder_.path("again.glb")).instances[0].density, 0.25f);
    for (const json& bad : {json("2"), json(0), json(-1), json(1e9), json(nullptr), json::array({2})}) {
        builder.json["nodes"][0]["extras"]["relume"]["density"] = bad;
        const Scene scene = loadGltf(write(builder, "bad.glb"));
        EXPECT_EQ(scene.instances[0].density, 1.0f) << bad;
        EXPECT_TRUE(std::any_of(scene.warnings.begin(), scene.warnings.end(), [](const std::string& warning) {
            return warning.find("density is no number from 0.01 to 100") != std::string::npos;
        })) << bad;
    }
}

TEST_F(GltfEdit, UnknownChunksStay) {
    const std::string path = write(everything());
    std::string bytes = readAll(path);
    bytes += std::string("\4\0\0\0ACMEdata", 12);
    const uint32_t length = static_cast<uint32_t>(bytes.size());
    std::memcpy(bytes.data() + 8, &length, 4);
    write(bytes, "scene.glb");
    const std::string chunks = chunksOf(path);
    save(path, [](Scene& scene) { scene.lights[0].intensity = 1234.5f; });
    EXPECT_EQ(chunksOf(path), chunks);
    EXPECT_EQ(test::wordAt(readAll(path), 8), readAll(path).size());
    EXPECT_EQ(test::wordAt(readAll(path), 12) % 4, 0u);
    EXPECT_EQ(loadGltf(path).lights[0].intensity, 1234.5f);
}

TEST_F(GltfEdit, SavedEditsThatAreTakenBackLeaveNoTrace) {
    LitScene builder = everything();
    builder.json["extensionsUsed"].erase(1); // an unknown one might name nodes by their number
    const std::string path = write(builder);
    const json original = jsonOf(path);
    const std::vector<Edit> edits = {
        [](Scene& s) {
            s.lights[0].transform[3] = {4.7f, -2, 3, 1};
        },
        [](Scene& s) {
            s.lights.push_back({});
            s.lights.back().type = LightType::Spot;
            s.lights.push_back({});
            s.lights.back().type = LightType::Disc;
        },
        [](Scene& s) {
            s.sky.radiance = {1, 2, 3};
            s.sky.rotation = 1.0f;
        },
        [](Scene& s) {
            s.materials[0].emission = {5, 2.5f, 0.1f};
        },
        [](Scene& s) {
            s.materials[0].emission = {0.5f, 0.25f, 0.1f};
        },
        [](Scene& s) {
            s.materials[0].baseColor = {0.1f, 0.2f, 0.3f, 1};
        },
        [](Scene& s) {
            s.instances[0].transform[3] = {0, 0.1f, 0, 1};
        },
    };
    for (size_t i = 0; i < edits.size(); ++i) {
        const Scene first = loadGltf(path);
        Scene now = first;
        edits[i](now);
        const EditedNodes nodes = saveEditedGltf(path, first, now, path);
        EXPECT_NE(jsonOf(path), original) << i;
        for (size_t l = 0; l < now.lights.size(); ++l)
            now.lights[l].node = nodes.lights[l];
        saveEditedGltf(path, now, first, path);
        EXPECT_EQ(jsonOf(path), original) << i;
    }
}

TEST_F(GltfEdit, EmissionIsAFactorUpToOneAndAStrengthAbove) {
    LitScene builder;
    builder.json["materials"] = json::array({{{"name", "A"}}, {{"name", "B"}}});
    const std::string path = write(builder);
    save(path, [](Scene& scene) {
        scene.materials[0].emission = {300, 150, 0.1f};
        scene.materials[1].emission = {0.2f, 1, 0.3f};
        scene.materials[1].baseColor = {0.8f, 0.1f, 0.7f, 1};
    });
    json materials = jsonOf(path)["materials"];
    EXPECT_EQ(materials[0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"], 300);
    EXPECT_EQ(materials[0]["emissiveFactor"][0], 1);
    EXPECT_EQ(materials[0]["emissiveFactor"][1], 0.5);
    EXPECT_EQ(materials[1]["emissiveFactor"], json({0.2, 1, 0.3}));
    EXPECT_FALSE(materials[1].contains("extensions"));
    EXPECT_EQ(materials[1]["pbrMetallicRoughness"]["baseColorFactor"], json({0.8, 0.1, 0.7, 1}));
    EXPECT_EQ(jsonOf(path)["extensionsUsed"], json::array({"KHR_materials_emissive_strength"}));
    const Scene back = loadGltf(path);
    EXPECT_EQ(back.materials[0].emission, glm::vec3(300, 150, 0.1f));
    EXPECT_EQ(back.materials[1].emission, glm::vec3(0.2f, 1, 0.3f));

    save(path, [](Scene& scene) { scene.materials[0].emission *= 3.0f; });
    EXPECT_EQ(jsonOf(path)["materials"][0]["emissiveFactor"], materials[0]["emissiveFactor"]);
    EXPECT_EQ(loadGltf(path).materials[0].emission[0], 900);
    save(path, [](Scene& scene) { scene.materials[0].emission = {0, 0, 0}; });
    EXPECT_FALSE(jsonOf(path).contains("extensionsUsed"));
    EXPECT_EQ(jsonOf(path)["materials"][0], json::object({{"name", "A"}}));
}

/// The list of extensions, when new in the file, once moved the material away while it was written.
TEST_F(GltfEdit, AMaterialIsEditedWhileExtensionsAreAdded) {
    LitScene builder;
    builder.json["materials"] = json::array({{{"name", "A"}}});
    const std::string path = write(builder);
    save(path, [](Scene& scene) {
        scene.materials[0].emission = {7, 3, 0.1f};
        scene.materials[0].baseColor = {0.1f, 0.2f, 0.3f, 0.4f};
        scene.lights.push_back({});
    });
    const Scene back = loadGltf(path);
    EXPECT_EQ(back.materials[0].emission, glm::vec3(7, 3, 0.1f));
    EXPECT_EQ(back.materials[0].baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.4f));
    EXPECT_EQ(back.lights.size(), 1u);
}

TEST_F(GltfEdit, TheSkyIsInTheDefaultScenesExtras) {
    LitScene builder = everything();
    builder.json["scenes"].push_back({{"name", "Other"}});
    builder.json["scene"] = 1;
    builder.json["scenes"][1]["nodes"] = json::array({0});
    const std::string path = write(builder);
    save(path, [&](Scene& scene) {
        scene.sky.radiance = {0.5f, 0.7f, 1.25f};
        scene.sky.rotation = 0.1f;
        scene.sky.file = folder_.path("dome.exr");
    });
    const json scenes = jsonOf(path)["scenes"];
    const json sky = scenes[1]["extras"]["relume"]["sky"];
    EXPECT_EQ(
        sky, json({{"color", {0.4, 0.56, 1}}, {"intensity", 1.25}, {"rotation", 0.1}, {"file", "dome.exr"}}));
    EXPECT_EQ(scenes[0], builder.json["scenes"][0]);
}

TEST_F(GltfEdit, ABrighterSkyKeepsItsColor) {
    const std::string path = write(everything());
    const Scene first = loadGltf(path);
    Scene blue = first;
    blue.sky.radiance = {0.5f, 0.7f, 1.25f};
    saveEditedGltf(path, first, blue, path);
    Scene bright = blue;
    bright.sky.radiance *= 8.0f;
    saveEditedGltf(path, blue, bright, path);
    const json sky = jsonOf(path)["scenes"][0]["extras"]["relume"]["sky"];
    EXPECT_EQ(sky, json({{"color", {0.4, 0.56, 1}}, {"intensity", 10}}));
    saveEditedGltf(path, bright, first, path);
    EXPECT_EQ(jsonOf(path)["scenes"][0]["extras"], json::object({{"mood", "calm"}}));
}

/// The importer takes a sky's intensity as a float: colours written for a double were off by its last digit.
TEST_F(GltfEdit, ASkyReturnsToTheLastDigit) {
    const std::string path = write(everything());
    glm::vec3 radiance(1.9f, 0.7f, 0.3f);
    for (int i = 0; i < 50; ++i) {
        radiance = glm::vec3(radiance.z * 1.37f, radiance.x, radiance.y) + 0.01f;
        for (const float factor : {1.0f, 1.7f}) { // another colour, then the same one brighter
            save(path, [&](Scene& scene) { scene.sky.radiance = radiance * factor; });
            ASSERT_EQ(loadGltf(path).sky.radiance, radiance * factor) << i;
        }
    }
}

TEST_F(GltfEdit, AFileWithoutScenesGetsOneForItsSkyOnly) {
    LitScene builder = everything();
    builder.json.erase("scenes");
    const std::string path = write(builder);
    save(path, [](Scene& scene) {
        scene.lights.push_back({});
        scene.lights.back().transform[3] = {1, 2, 3, 1};
    });
    EXPECT_FALSE(jsonOf(path).contains("scenes"));
    EXPECT_EQ(loadGltf(path).lights.size(), 3u);
    save(path, [](Scene& scene) { scene.sky.radiance = {1, 1, 1}; });
    EXPECT_EQ(jsonOf(path)["scenes"][0]["nodes"], json({0, 1, 2, 3}));
    EXPECT_EQ(jsonOf(path)["scene"], 0);
    EXPECT_EQ(loadGltf(path).lights.size(), 3u);
}

/// Holds a .gltf in a folder of its own, with a buffer and a picture beside it whose names need escapes.
class GltfEditBeside : public GltfEdit {
protected:
    GltfEditBeside() {
        std::filesystem::create_directories(folder_.path("my scene/parts"));
        std::filesystem::create_directories(folder_.path("saved"));
        LitScene builder = everything();
        write(std::string(builder.bin.begin(), builder.bin.end()), "my scene/parts/the 100%.bin");
        write(std::string(test::kTwoPixels.begin(), test::kTwoPixels.end()), "my scene/red.png");
        builder.json["buffers"] =
            json::array({{{"uri", "parts/the%20100%25.bin"}, {"byteLength", builder.bin.size()}}});
        builder.json["images"] = json::array({{{"uri", "red.png"}}});
        builder.json["textures"] = json::array({{{"source", 0}}});
        builder.json["materials"][0]["emissiveTexture"] = {{"index", 0}};
        builder.json["materials"][0]["emissiveFactor"] = {1, 1, 1};
        builder.json["extensions"]["ACME_sounds"] =
            json::array({{{"uri", "data:text/plain,hi"}}, {{"uri", "a/b.wav"}}});
        path_ = write(builder.json.dump(2), "my scene/scene.gltf");
    }
    std::string path_;
};

TEST_F(GltfEditBeside, UrisLeadFromAnotherFolderToTheSameFiles) {
    const std::string target = folder_.path("saved/copy.gltf");
    const Scene before = loadGltf(path_);
    Scene after = before;
    after.lights[1].intensity = 7.5f;
    after.sky.file = folder_.path("my scene/dome.exr");
    FloatImage dome{.width = 2, .height = 1, .channels = {}, .planes = {}, .attributes = {}};
    for (const char* channel : {"R", "G", "B"})
        dome.add(channel)[1] = 3.0f;
    writeImage(after.sky.file, dome);
    saveEditedGltf(path_, before, after, target);
    const json copy = jsonOf(target);
    EXPECT_EQ(copy["buffers"][0]["uri"], "../my%20scene/parts/the%20100%25.bin");
    EXPECT_EQ(copy["images"][0]["uri"], "../my%20scene/red.png");
    EXPECT_EQ(copy["extensions"]["ACME_sounds"][0]["uri"], "data:text/plain,hi");
    EXPECT_EQ(copy["extensions"]["ACME_sounds"][1]["uri"], "../my%20scene/a/b.wav");
    EXPECT_EQ(copy["scenes"][0]["extras"]["relume"]["sky"]["file"], "../my scene/dome.exr");
    const Scene back = loadGltf(target);
    EXPECT_EQ(back.sky.pixels.at(1), glm::vec3(3));
    EXPECT_EQ(back.lights[1].intensity, 7.5f);
    EXPECT_EQ(back.images.size(), 1u);
    EXPECT_EQ(back.meshes[0].primitives[0].positions, before.meshes[0].primitives[0].positions);
}

// JSON holds only UTF-8, which names of folders need not be.
TEST_F(GltfEditBeside, UrisLeadOutOfAFolderWhoseNameIsNoUtf8) {
    const std::string folder = folder_.path("caf\xe9"), path = folder + "/scene.gltf";
    std::filesystem::rename(folder_.path("my scene"), folder);
    const std::string target = folder_.path("saved/copy.gltf");
    const Scene before = loadGltf(path);
    Scene after = before;
    after.lights[1].intensity = 7.5f;
    saveEditedGltf(path, before, after, target);
    EXPECT_EQ(jsonOf(target)["images"][0]["uri"], "../caf%E9/red.png");
    EXPECT_EQ(loadGltf(target).images.size(), 1u);
    // A path that is no URI has no escapes.
    after.sky.radiance = glm::vec3(1);
    after.sky.file = folder + "/dome.exr";
    const std::string bytes = readAll(target);
    EXPECT_NE(messageOf([&] { saveEditedGltf(path, before, after, target); }).find("is no UTF-8"),
              std::string::npos);
    EXPECT_EQ(readAll(target), bytes);
}

TEST_F(GltfEditBeside, InItsOwnFolderOnlyTheLinesOfTheEditChange) {
    std::string expected = readAll(path_);
    save(path_, [](Scene& scene) { scene.lights[1].transform[3].x = -1.5f; });
    const size_t place = expected.find("-1,\n");
    ASSERT_NE(place, std::string::npos);
    EXPECT_EQ(readAll(path_), expected.replace(place, 2, "-1.5"));
}

TEST_F(GltfEditBeside, AFileIsSavedAsTheKindItIs) {
    const Scene scene = loadGltf(path_);
    EXPECT_EQ(messageOf([&] { saveEditedGltf(path_, scene, scene, folder_.path("a.glb")); }),
              folder_.path("a.glb") + ": " + path_ +
                  " is saved back as the kind of file it is: name a file that ends in .gltf");
    const std::string binary = write(everything());
    const Scene other = loadGltf(binary);
    EXPECT_NE(messageOf([&] { saveEditedGltf(binary, other, other, folder_.path("a.gltf")); }).find(".glb"),
              std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder_.path("a.glb")));
    EXPECT_FALSE(std::filesystem::exists(folder_.path("a.gltf")));
}

TEST_F(GltfEdit, AFailureLeavesTheFileAlone) {
    const std::string path = write(everything());
    const std::string bytes = readAll(path);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<std::pair<Edit, std::string>> wrong = {
        {[&](Scene& s) { s.lights[0].intensity = nan; }, "light 'Lamp' has an intensity of nan: give"},
        {[&](Scene& s) { s.lights[0].color.y = -1; }, "light 'Lamp' has a colour of -1: give"},
        {[&](Scene& s) { s.lights[0].transform[3].x = nan; }, "light 'Lamp' has a position"},
        {[&](Scene& s) { s.materials[0].emission.x = nan; }, "material 'Paint' has an emission of nan: give"},
        {[&](Scene& s) { s.materials[0].baseColor.x = 2; }, "material 'Paint' has a base colour of 2: give"},
        {[&](Scene& s) { s.materials.pop_back(); }, "materials were added or removed"},
        {[&](Scene& s) { s.sky.radiance.z = -1; }, "the sky has a radiance of -1: give"},
        {[&](Scene& s) {
             s.sky.rotation = nan;
             s.sky.radiance.x = 1;
         },
         "the sky has a rotation of nan: give"},
        {[&](Scene& s) { s.instances[0].transform[1][1] = nan; }, "object 'Mesh' has a position"},
        {[&](Scene& s) { s.instances[0].node = -1; }, "object 'Mesh' is not in"},
        {[&](Scene& s) {
             s.lights[0].type = LightType::Spot;
             s.lights[0].outerConeAngle = 2;
         },
         "has cones of"},
    };
    for (const auto& [wrongEdit, expected] : wrong) {
        const std::string message = messageOf([&edit = wrongEdit, &path] { save(path, edit); });
        EXPECT_NE(message.find(expected), std::string::npos) << message;
        EXPECT_EQ(message.find(path), 0u) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos);
        EXPECT_EQ(readAll(path), bytes);
    }
    const Scene scene = loadGltf(path);
    EXPECT_THROW(saveEditedGltf(path, scene, scene, folder_.path("none/a.glb")), Error);
    EXPECT_EQ(folder_.files(), std::vector<std::string>{"scene.glb"});
}

TEST_F(GltfEdit, AnotherFileThanTheOneThatWasLoadedIsFound) {
    const std::string path = write(everything());
    const Scene scene = loadGltf(path);
    LitScene plain;
    const std::string other = write(plain, "other.glb");
    const std::string message = messageOf([&] { saveEditedGltf(other, scene, scene, other); });
    EXPECT_NE(message.find("load it again"), std::string::npos) << message;
    plain.json["materials"] = json::array({{{"name", "Paint"}}});
    write(plain, "other.glb");
    EXPECT_EQ(messageOf([&] { saveEditedGltf(other, scene, scene, other); }),
              other + ": has no light 'Lamp' any more: the file has changed, load it again");
}

} // namespace
} // namespace relume
