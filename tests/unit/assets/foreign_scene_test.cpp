// This tests what becomes of files that are no glTF, each made by hand; in this process, as they are good.
#include "assets/foreign/foreign_scene.h"

#include "assets/base/error.h"
#include "assets/foreign/foreign_build.h"
#include "assets/foreign/foreign_files.h"
#include "assets/gltf/gltf.h"
#include "tests/unit/foreign_files.h"
#include "tests/unit/glb_builder.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <map>
#include <new>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relume {
namespace {

using test::writeFile;

const Primitive& onlyPrimitive(const Scene& scene) {
    if (scene.meshes.size() != 1 || scene.meshes[0].primitives.size() != 1)
        throw Error("the scene has more or fewer than one primitive");
    return scene.meshes[0].primitives[0];
}

glm::vec3 cornerOf(const Primitive& primitive, size_t index) {
    return primitive.positions[primitive.indices[index]];
}

/// The areas of the triangles, each as a vector along its normal.
std::vector<glm::dvec3> areasOf(const Primitive& primitive) {
    std::vector<glm::dvec3> areas;
    for (size_t i = 0; i < primitive.indices.size(); i += 3) {
        const glm::dvec3 a = cornerOf(primitive, i), b = cornerOf(primitive, i + 1);
        areas.push_back(0.5 * glm::cross(b - a, glm::dvec3(cornerOf(primitive, i + 2)) - a));
    }
    return areas;
}

bool warnsOf(const Scene& scene, const std::string& part) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

void expectNear(const glm::vec3& a, const glm::vec3& b, float within = 1e-5f) {
    EXPECT_LE(glm::length(a - b), within)
        << a.x << ' ' << a.y << ' ' << a.z << " is not " << b.x << ' ' << b.y << ' ' << b.z;
}

std::string pngText() {
    return {test::kTwoPixels.begin(), test::kTwoPixels.end()};
}

/// A square with texture coordinates and the material "m" of the library that is given.
std::string texturedSquare(const TemporaryFolder& folder, const std::string& library) {
    writeFile(folder, "level/square.mtl", "newmtl m\n" + library);
    return writeFile(
        folder, "level/square.obj",
        "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 0.75\n"
        "usemtl m\nf 1/1 2/2 3/3 4/4\n");
}

TEST(ForeignScene, ConcavePolygonsKeepTheirAreaAndTheirSide) {
    const TemporaryFolder folder;
    // An arrow head, whose fan from the first corner would reach outside.
    const std::string path =
        writeFile(folder, "arrow.obj", "v 2 1 0\nv 4 4 0\nv 0 4 0\nv 0 0 0\nv 4 0 0\nf 1 2 3 4 5\n");
    const ForeignScene made = convertForeign(path);
    const std::vector<glm::dvec3> areas = areasOf(onlyPrimitive(made.scene));
    ASSERT_EQ(areas.size(), 3u);
    double sum = 0;
    for (const glm::dvec3& area : areas) {
        EXPECT_GT(area.z, 0.0);
        sum += area.z;
    }
    EXPECT_DOUBLE_EQ(sum, 12.0); // by the shoelace formula
}

TEST(ForeignScene, MissingNormalsAreSharpAtEdgesAndSmoothOnCurves) {
    const TemporaryFolder folder;
    const std::string box =
        writeFile(folder, "box.obj",
                  "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                  "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
    const Scene sharp = convertForeign(box).scene;
    EXPECT_EQ(onlyPrimitive(sharp).positions.size(), 24u); // four per side, by exact equality
    for (size_t i = 0; i < onlyPrimitive(sharp).indices.size(); ++i)
        expectNear(onlyPrimitive(sharp).normals[onlyPrimitive(sharp).indices[i]],
                   glm::vec3(glm::normalize(areasOf(onlyPrimitive(sharp))[i / 3])));

    std::string text;
    constexpr int kSegments = 16;
    for (int i = 0; i < kSegments; ++i)
        for (int y = 0; y < 2; ++y) {
            const double angle = 2 * M_PI * i / kSegments;
            text += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(y) + " " +
                    std::to_string(std::sin(angle)) + "\n";
        }
    for (int i = 0; i < kSegments; ++i) {
        const int a = 2 * i + 1, b = 2 * ((i + 1) % kSegments) + 1;
        text += "f " + std::to_string(a) + " " + std::to_string(a + 1) + " " + std::to_string(b + 1) + " " +
                std::to_string(b) + "\n";
    }
    const Scene tube = convertForeign(writeFile(folder, "tube.obj", text)).scene;
    const Primitive& smooth = onlyPrimitive(tube);
    EXPECT_EQ(smooth.positions.size(), size_t{2 * kSegments});
    for (size_t i = 0; i < smooth.positions.size(); ++i) {
        // Of the two triangles of a side one or both meet in a corner: the normal leans by that much.
        const glm::vec3 radial = glm::normalize(smooth.positions[i] * glm::vec3(1, 0, 1));
        EXPECT_GT(glm::dot(smooth.normals[i], radial), std::cos(glm::radians(5.0f)));
    }
}

TEST(ForeignScene, PicturesAreFoundWhateverTheirNamesLookLike) {
    const TemporaryFolder folder;
    writeFile(folder, "level/Textures/Brick Wall.PNG", pngText());
    for (const std::string name :
         {"C:\\\\art\\\\textures\\\\brick wall.png", "textures/BRICK wall.png",
          "/home/someone/textures/brick wall.png", "brick wall.png", "//textures\\brick wall.png"}) {
        const ForeignScene made =
            convertForeign(texturedSquare(folder, "Kd 0.5 0.25 1\nmap_Kd " + name + "\n"));
        ASSERT_EQ(made.scene.textures.size(), 1u) << name;
        EXPECT_EQ(made.pictures.at(0), test::kTwoPixels) << name; // the file itself, not decoded and encoded
        const Material& material = made.scene.materials.at(0);
        EXPECT_EQ(material.baseColorTexture.texture, 0);
        EXPECT_EQ(material.baseColor, glm::vec4(0.5f, 0.25f, 1.0f, 1.0f));
        EXPECT_EQ(material.alphaMode, AlphaMode::Opaque); // its alpha was not asked for
        EXPECT_TRUE(made.scene.warnings.empty()) << made.scene.warnings[0];
    }
    const Scene scene = convertForeign(texturedSquare(folder, "map_Kd brick wall.png\n")).scene;
    for (size_t i = 0; i < 4; ++i) {
        if (onlyPrimitive(scene).positions[i] != glm::vec3(0, 1, 0)) continue;
        EXPECT_EQ(onlyPrimitive(scene).texCoord0[i], glm::vec2(0, 0.25f)); // v points up in the file
    }
}

TEST(ForeignScene, NoFileFartherAwayIsOpened) {
    const TemporaryFolder folder;
    writeFile(folder, "secret.png", pngText());
    writeFile(folder, "a/shared/near.png", pngText());
    std::filesystem::create_directories(folder.path("a/level"));
    std::filesystem::create_symlink(folder.path("secret.png"), folder.path("a/level/link.png"));
    const auto texturesWith = [&](const std::string& name) {
        writeFile(folder, "a/level/s.mtl", "newmtl m\nmap_Kd " + name + "\n");
        const std::string path =
            writeFile(folder, "a/level/s.obj", std::string("mtllib s.mtl\nusemtl m\n") + test::kFloorObj);
        const Scene scene = convertForeign(path).scene;
        EXPECT_EQ(scene.textures.empty(), warnsOf(scene, "which is not in the folder")) << name;
        return scene.textures.size();
    };
    EXPECT_EQ(texturesWith("../shared/near.png"), 1u);
    EXPECT_EQ(texturesWith("../../secret.png"), 0u);
    EXPECT_EQ(texturesWith("../shared/../../secret.png"), 0u);
    EXPECT_EQ(texturesWith(folder.path("secret.png")), 0u);
    EXPECT_EQ(texturesWith("link.png"), 0u);
}

TEST(ForeignScene, OpacityAndEmissionOfMaterials) {
    const TemporaryFolder folder;
    const auto materialOf = [&](const std::string& library) {
        const Scene scene = convertForeign(texturedSquare(folder, library)).scene;
        EXPECT_EQ(library.find("d 0\n") != std::string::npos, warnsOf(scene, "has the opacity 0"));
        return scene.materials.at(0);
    };
    const Material glass = materialOf("Kd 0.1 0.2 0.3\nd 0.25\nKe 1 2 3\n");
    EXPECT_EQ(glass.alphaMode, AlphaMode::Blend);
    EXPECT_EQ(glass.baseColor, glm::vec4(0.1f, 0.2f, 0.3f, 0.25f));
    EXPECT_EQ(glass.emission, glm::vec3(1, 2, 3));
    EXPECT_EQ(glass.metallic, 0.0f);
    EXPECT_EQ(materialOf("d 0\n").baseColor.a, 1.0f);

    // A mask of grey pixels, in a .bmp file: its left pixel is black and its right one white.
    std::string bmp("BM\x3e\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x02\0\0\0\x01\0\0\0\x01\0\x18\0", 30);
    bmp += std::string(24, '\0') + std::string("\0\0\0\xff\xff\xff\0\0", 8);
    writeFile(folder, "level/mask.bmp", bmp);
    writeFile(folder, "level/brick.png", pngText());
    const ForeignScene fence =
        convertForeign(texturedSquare(folder, "map_Kd brick.png\nmap_d mask.bmp\nmap_Ke mask.bmp\n"));
    const Material& material = fence.scene.materials.at(0);
    EXPECT_EQ(material.alphaMode, AlphaMode::Mask);
    EXPECT_EQ(material.emission, glm::vec3(1.0f)); // of the picture alone
    ASSERT_EQ(fence.scene.images.size(), 2u);
    const Image& color = fence.scene.images[0];
    ASSERT_EQ(color.rgba.size(), 8u);
    EXPECT_EQ(color.rgba[0], 255); // red stays
    EXPECT_EQ(color.rgba[3], 0);
    EXPECT_EQ(color.rgba[7], 255);
    EXPECT_TRUE(fence.pictures.at(1).empty()); // decoded, as glTF knows no .bmp
    EXPECT_EQ(fence.scene.images[1].rgba, (std::vector<uint8_t>{0, 0, 0, 255, 255, 255, 255, 255}));
}

TEST(ForeignScene, ColladaHasUnitsAxesInstancesLightsAndCameras) {
    const TemporaryFolder folder;
    const Scene scene = convertForeign(writeFile(folder, "room.dae", test::kRoomDae)).scene;
    ASSERT_EQ(scene.meshes.size(), 1u); // one for both nodes
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].name, "Floor");
    EXPECT_EQ(scene.instances[1].name, "Mirrored");
    const auto corner = [&](size_t instance) { // (100, 100, 0) of the mesh
        return glm::vec3(scene.instances[instance].transform * glm::vec4(100, 100, 0, 1));
    };
    expectNear(corner(0), {1, 0, -1});
    expectNear(corner(1), {1, 2, 1});
    EXPECT_LT(glm::determinant(glm::mat3(scene.instances[1].transform)), 0.0f);
    EXPECT_EQ(scene.materials.at(0).baseColor, glm::vec4(0.25f, 0.5f, 0.75f, 1.0f));
    EXPECT_EQ(scene.materials.at(0).emission, glm::vec3(0, 4, 0));
    expectNear(scene.sky.radiance, {0.1f, 0.2f, 0.3f});

    ASSERT_EQ(scene.lights.size(), 3u);
    const Light &lamp = scene.lights[0], &sun = scene.lights[1], &spot = scene.lights[2];
    EXPECT_EQ(lamp.type, LightType::Point);
    expectNear(glm::vec3(lamp.transform[3]), {1, 3, -2});
    expectNear(lamp.color, {1, 0.5f, 0});
    // At d centimetres it is 2 / (0.0004 d^2): 0.5 at 1 m, where a white surface gets E = pi x 0.5 lux.
    EXPECT_NEAR(lamp.intensity, M_PI * 0.5, 1e-4);
    EXPECT_EQ(sun.type, LightType::Directional);
    expectNear(-glm::vec3(sun.transform[2]), {0, -1, 0});
    EXPECT_NEAR(sun.intensity, 3 * M_PI, 1e-5);
    EXPECT_EQ(spot.type, LightType::Spot);
    expectNear(-glm::vec3(spot.transform[2]), {0, 0, -1}); // by 90 degrees about X from -Z: +Y of the file
    EXPECT_NEAR(spot.outerConeAngle, glm::radians(30.0f), 1e-5f);

    ASSERT_EQ(scene.cameras.size(), 1u);
    const Camera& camera = scene.cameras[0];
    expectNear(glm::vec3(camera.transform[3]), {0, 1, 0});
    expectNear(-glm::vec3(camera.transform[2]), {0, 0, -1});
    expectNear(glm::vec3(camera.transform[1]), {0, 1, 0});
    EXPECT_NEAR(camera.yfov, 2 * std::atan(0.5), 1e-5); // across 90 degrees, twice as wide as high
    EXPECT_FLOAT_EQ(camera.aspect, 2.0f);
    EXPECT_FLOAT_EQ(camera.znear, 0.1f);
    EXPECT_FLOAT_EQ(camera.zfar, 100.0f);
}

TEST(ForeignScene, LightsOfBlenderAreInWatts) {
    const TemporaryFolder folder;
    const auto roomBy = [&](const std::string& tool) {
        std::string text = test::kRoomDae;
        text.replace(text.find("<asset>"), 7,
                     "<asset><contributor><authoring_tool>" + tool + "</authoring_tool></contributor>");
        return convertForeign(writeFile(folder, "room.dae", text)).scene;
    };
    const auto lampBy = [&](const std::string& tool) { return roomBy(tool).lights.at(0).intensity; };
    const Scene room = roomBy("Blender 2.93.1 commit date:2021");
    EXPECT_NEAR(room.lights.at(0).intensity, 683 * 2 / (4 * M_PI), 1e-3);
    expectNear(room.materials.at(0).emission, {0, 683 * 4, 0}); // what glows has the lamps' unit
    expectNear(room.sky.radiance, 683.0f * glm::vec3(0.1f, 0.2f, 0.3f), 1e-3f);
    EXPECT_NEAR(lampBy("Blender 2.79.0"), M_PI * 0.5, 1e-4);
    EXPECT_NEAR(lampBy("Maya 2020"), M_PI * 0.5, 1e-4);
    // An .obj file has no lights; its first line says whether what glows is in watts.
    const auto glowBy = [&](const std::string& comment) {
        texturedSquare(folder, "Ke 1 2 3\n");
        const std::string path =
            writeFile(folder, "level/named.obj", comment + "mtllib square.mtl\nusemtl m\n" + test::kFloorObj);
        return convertForeign(path).scene.materials.at(0).emission;
    };
    expectNear(glowBy("# Blender 3.4.1\n"), 683.0f * glm::vec3(1, 2, 3), 1e-3f);
    expectNear(glowBy("# Blender v2.93.1 OBJ File: 'a.blend'\n"), 683.0f * glm::vec3(1, 2, 3), 1e-3f);
    expectNear(glowBy("# Blender v2.79 OBJ File: 'a.blend'\n"), {1, 2, 3});
    expectNear(glowBy("# made after Blender 3.4.1\n"), {1, 2, 3});
}

/// The one light that libassimp's light becomes in a .blend file whose node is placed like this.
Light lightOfBlend(const aiLight& source, const glm::dmat4& world = glm::dmat4(1.0)) {
    foreign::Build build("room.blend");
    build.ending = ".blend";
    build.inWatts = true;
    foreign::addLight(build, source, {.world = world});
    return build.made.scene.lights.at(0);
}

aiLight lightOf(aiLightSourceType type, float watts) {
    aiLight light;
    light.mType = type;
    light.mColorDiffuse = aiColor3D(watts, watts / 2, watts / 4);
    light.mDirection = type == aiLightSource_UNDEFINED ? aiVector3D() : aiVector3D(0, 0, -1);
    light.mUp = aiVector3D(0, 1, 0);
    light.mSize = aiVector2D(0.5f, 0.25f);
    return light;
}

// What a white plane 4 m below a light of 100 W (a sun of 3) has for radiance was path traced by Cycles of
// Blender 3.4: 0.15829 for a point, 0.15828 for a spot, 0.9549 for the sun; 0.4970, 0.4969, 0.4972 and 0.4967
// for area lights, square, oblong, round and in an object of scale 3.
TEST(ForeignScene, LightsOfBlenderShineAsCyclesHasThem) {
    constexpr double kTraced = 0.003, kSquared = 4.0 * 4.0; // [1], [m^2]
    const auto below = [&](const Light& light) {            // in watts, of a small light straight above
        const double area = light.type == LightType::Rectangle ? double(light.size.x) * light.size.y : 1.0;
        const double distance = light.type == LightType::Directional ? 1.0 : kSquared;
        return light.intensity * area / distance / M_PI / 683;
    };
    const Light point = lightOfBlend(lightOf(aiLightSource_POINT, 100));
    EXPECT_EQ(point.type, LightType::Point);
    EXPECT_NEAR(below(point) / 0.15829, 1, kTraced);
    expectNear(point.color, {1, 0.5f, 0.25f});
    const glm::dmat4 sideways(glm::dmat3({0, 0, -1}, {0, 1, 0}, {1, 0, 0})); // -Z becomes -X
    const Light spot = lightOfBlend(lightOf(aiLightSource_UNDEFINED, 100), sideways);
    EXPECT_EQ(spot.type, LightType::Spot);
    EXPECT_NEAR(below(spot) / 0.15828, 1, kTraced);
    EXPECT_NEAR(spot.outerConeAngle, glm::radians(22.5f), 1e-6f);
    expectNear(-glm::vec3(spot.transform[2]), {-1, 0, 0});
    EXPECT_NEAR(below(lightOfBlend(lightOf(aiLightSource_DIRECTIONAL, 3))) / 0.95492, 1, kTraced);
    const Light panel = lightOfBlend(lightOf(aiLightSource_AREA, 100));
    EXPECT_EQ(panel.type, LightType::Rectangle);
    EXPECT_NEAR(below(panel) / 0.49736, 1, kTraced);
    EXPECT_NEAR(panel.intensity, 683 * 100 / (4 * 0.5 * 0.25), 0.1);
    // A scaled object has a larger light of the same watts.
    const Light wide = lightOfBlend(lightOf(aiLightSource_AREA, 100),
                                    sideways * glm::dmat4(glm::dmat3(3.0, 0, 0, 0, 1, 0, 0, 0, 1)));
    expectNear({wide.size, 0}, {1.5f, 0.25f, 0});
    EXPECT_NEAR(below(wide) / 0.49669, 1, kTraced);
}

TEST(ForeignScene, FbxHasUnitsAxesAndLights) {
    const TemporaryFolder folder;
    std::string text = test::kFloorFbx;
    const Scene scene = convertForeign(writeFile(folder, "floor.fbx", text)).scene;
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_EQ(scene.instances[0].name, "Floor");
    expectNear(glm::vec3(scene.instances[0].transform * glm::vec4(2, 3, 0, 1)), {2, 5, -3});
    EXPECT_EQ(scene.materials.at(0).baseColor, glm::vec4(0.25f, 0.5f, 0.75f, 0.5f));
    EXPECT_EQ(scene.materials[0].alphaMode, AlphaMode::Blend);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.lights[0].type, LightType::Directional);
    EXPECT_NEAR(scene.lights[0].intensity, 2 * M_PI, 1e-5); // 200 % of what makes white shine with 1
    expectNear(scene.lights[0].color, {1, 0.5f, 0.25f});
    expectNear(-glm::vec3(scene.lights[0].transform[2]), {0, 0, 1}); // -Y of the file

    text.replace(text.find("Made by hand"), 12, "Blender (stable FBX IO) - 3.6.2 - 5.4.0");
    text.replace(text.find("\"UnitScaleFactor\", \"double\", \"Number\", \"\",100"), 46,
                 "\"UnitScaleFactor\", \"double\", \"Number\", \"\",1");
    const Scene small = convertForeign(writeFile(folder, "small.fbx", text)).scene; // in centimetres
    expectNear(glm::vec3(small.instances.at(0).transform * glm::vec4(2, 3, 0, 1)), {0.02f, 0.05f, -0.03f});
    EXPECT_NEAR(small.lights.at(0).intensity, 2 * 683, 1e-3); // of 2 watts per square metre
}

TEST(ForeignScene, SmallKindsOfFiles) {
    const TemporaryFolder folder;
    const std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 255 0 0\n1 0 0 255 188 0\n1 1 0 255 0 0\n0 1 0 255 0 0\n4 0 1 2 3\n";
    const Scene colored = convertForeign(writeFile(folder, "a.ply", ply)).scene;
    const Primitive& square = onlyPrimitive(colored);
    EXPECT_EQ(square.indices.size(), 6u);
    ASSERT_EQ(square.colors.size(), 4u);
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(square.normals[i], glm::vec3(0, 0, 1)); // shared vertices, no normals in the file
        EXPECT_NEAR(square.colors[i].g, square.positions[i] == glm::vec3(1, 0, 0) ? 0.5029f : 0.0f, 1e-3f);
    }
    const std::string stl =
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 2 0\n"
        "endloop\nendfacet\nendsolid s\n";
    EXPECT_EQ(areasOf(onlyPrimitive(convertForeign(writeFile(folder, "a.stl", stl)).scene)).at(0),
              glm::dvec3(0, 0, 2));
    const std::string off = "OFF\n3 1 0\n0 0 0\n2 0 0\n0 2 0\n3 0 1 2\n";
    EXPECT_EQ(areasOf(onlyPrimitive(convertForeign(writeFile(folder, "a.off", off)).scene)).at(0),
              glm::dvec3(0, 0, 2));
    const Scene wedge = convertForeign(writeFile(folder, "a.3ds", test::triangle3ds())).scene;
    EXPECT_EQ(wedge.instances.size(), 1u); // whose name libassimp drops where there is no hierarchy
    const glm::mat4& upright = wedge.instances[0].transform; // Z up in the file
    expectNear(glm::vec3(upright * glm::vec4(areasOf(onlyPrimitive(wedge)).at(0), 0)), {0, 3, 0});
}

TEST(ForeignScene, ScaleAndUpAxisCanBeTold) {
    const TemporaryFolder folder;
    const std::string path = writeFile(folder, "floor.obj", test::kFloorObj);
    const auto placed = [&](const ForeignChoice& choice) {
        const Scene scene = convertForeign(path, choice).scene;
        return glm::vec3(scene.instances.at(0).transform * glm::vec4(1, 2, 3, 1));
    };
    expectNear(placed({}), {1, 2, 3});
    expectNear(placed({.scale = 0.5}), {0.5f, 1, 1.5f});
    expectNear(placed({.scale = 1, .up = 'z'}), {1, 3, -2});
    expectNear(placed({.scale = 1, .up = 'x'}), {-2, 1, 3});
}

TEST(ForeignScene, WhatHasNoTrianglesIsAnErrorOfOneLine) {
    const TemporaryFolder folder;
    const auto errorOf = [&](const std::string& name, const std::string& text) -> std::string {
        const std::string path = writeFile(folder, name, text);
        try {
            convertForeign(path);
            return "none";
        } catch (const Error& error) {
            const std::string line = error.what();
            EXPECT_TRUE(line.starts_with(path + ": ")) << line;
            EXPECT_EQ(line.find('\n'), std::string::npos);
            return line;
        }
    };
    EXPECT_NE(errorOf("points.obj", "v 0 0 0\nv 1 0 0\nv 1 1 1\np 1 2 3\nl 1 2\n").find("no mesh"),
              std::string::npos);
    EXPECT_NE(errorOf("empty.3ds", "").find("cannot be read"), std::string::npos);
    EXPECT_NE(errorOf("odd.fbx", "this is no scene").find("cannot be read"), std::string::npos);
    EXPECT_NE(errorOf("odd.obj", "f 1 2 3\n").find("odd.obj"), std::string::npos);
    EXPECT_THROW(convertForeign(folder.path("missing.obj")), Error);
}

TEST(ForeignScene, WhichFilesAreConverted) {
    const TemporaryFolder folder;
    EXPECT_TRUE(isForeign("nowhere/Level.OBJ"));
    EXPECT_TRUE(isForeign("nowhere/level.3ds"));
    EXPECT_FALSE(isForeign("nowhere/level.glb"));
    EXPECT_FALSE(isForeign("nowhere/level"));
    EXPECT_FALSE(isForeign(writeFile(folder, "binary.obj", "glTF\2\0\0\0")));
    EXPECT_FALSE(isForeign(writeFile(folder, "text", "{\"asset\": {}}")));
    EXPECT_TRUE(isForeign(writeFile(folder, "collada.bin", test::kRoomDae)));
    EXPECT_TRUE(isForeign(writeFile(folder, "cloud.bin", "ply\nformat ascii 1.0\n")));
}

/// Converts a file in a process of its own and returns how that ended: 's' with a scene, 'e' with an Error,
/// 'm' for want of memory, 'c' by a crash.
char endOf(const std::string& path) {
    const pid_t child = fork();
    if (child == 0) {
        alarm(20); // which is a crash
        char end = 's';
        try {
            const ForeignScene made = convertForeign(path);
            glbBytes(made.scene, made.pictures);
        } catch (const Error& error) {
            end = std::string(error.what()).find(path) == std::string::npos ? 'x' : 'e';
        } catch (const std::bad_alloc&) {
            end = 'm';
        }
        _exit(end);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? static_cast<char>(WEXITSTATUS(status)) : 'c';
}

TEST(ForeignScene, MutatedFilesEndInAnErrorOrAScene) {
    const TemporaryFolder folder;
    std::map<char, uint32_t> ends;
    uint32_t all = 0;
    for (const auto& [ending, text] : test::filesToMutate()) {
        const uint32_t mutations = ending == ".obj" ? 60 : 120; // libassimp takes 10 ms for the smallest .obj
        for (uint32_t i = 0; i < mutations; ++i, ++all)
            ++ends[endOf(writeFile(folder, "m" + ending, test::mutated(text, i)))];
    }
    EXPECT_EQ(ends['s'] + ends['e'] + ends['m'], all) << ends['c'] << " crashes";
    EXPECT_GT(ends['s'], all / 10); // it is no use to change all so that nothing is read
    EXPECT_GT(ends['e'], all / 10);
}

} // namespace
} // namespace relume
