// What exporters leave out of files, or write beside it, is no reason to lose anything of a scene.
#include "assets/foreign/foreign_scene.h"

#include "assets/base/error.h"
#include "assets/foreign/foreign_files.h"
#include "assets/foreign/smoothing_groups.h"
#include "tests/unit/foreign_files.h"
#include "tests/unit/glb_builder.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <gtest/gtest.h>

namespace relume {
namespace {

using test::writeFile;

const std::string kPixels(test::kTwoPixels.begin(), test::kTwoPixels.end());

bool tells(const Scene& scene, const std::string& part) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

// A square with texture coordinates and the material "m" of this library.
std::string squareOfLibrary(const TemporaryFolder& folder, const std::string& library) {
    writeFile(folder, "level/square.mtl", "newmtl m\n" + library);
    return writeFile(
        folder, "level/square.obj",
        "mtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl m\nf 1/1 2/2 3/3\n");
}

std::string wedgeOfGroups(std::initializer_list<uint32_t> groups) {
    return test::file3ds({{"A", test::wedge3ds(test::chunk3ds(0x4150, test::bytesOf(groups)))}});
}

// Exporters write blanks behind names and quotation marks around them.
TEST(ForeignHabits, ANameMayHaveBlanksOrQuotationMarksAroundIt) {
    const TemporaryFolder folder;
    writeFile(folder, "level/brick wall.png", kPixels);
    for (const char* name :
         {"brick wall.png   ", "\"brick wall.png\"", "'brick wall.png'\t", "\" brick wall.png \""})
        EXPECT_EQ(convertForeign(squareOfLibrary(folder, std::string("map_Kd ") + name + "\n"))
                      .scene.textures.size(),
                  1u)
            << name;
    EXPECT_TRUE(convertForeign(squareOfLibrary(folder, "map_Kd \"\"\n")).scene.textures.empty());
}

// Editors write a mark before UTF-8.
TEST(ForeignHabits, AMarkBeforeTheFirstWordIsPassedOver) {
    const TemporaryFolder folder;
    const std::string mark = "\xEF\xBB\xBF";
    writeFile(folder, "red.mtl", mark + "newmtl m\nKd 1 0 0\n");
    const std::string path =
        writeFile(folder, "floor.obj", mark + "mtllib red.mtl\nusemtl m\n" + test::kFloorObj);
    const Scene scene = convertForeign(path).scene;
    EXPECT_EQ(scene.materials.at(0).baseColor, glm::vec4(1, 0, 0, 1));
    EXPECT_THROW(convertForeign(writeFile(folder, "empty.obj", mark)), Error);
}

TEST(ForeignHabits, AMaterialLibraryThatIsMissingIsTold) {
    const TemporaryFolder folder;
    const auto sceneWith = [&](const std::string& line) {
        return convertForeign(writeFile(folder, "s.obj", line + "usemtl m\n" + test::kFloorObj)).scene;
    };
    EXPECT_TRUE(
        tells(sceneWith("mtllib gone.mtl\n"), "the material library 'gone.mtl': is not in the folder"));
    EXPECT_TRUE(tells(sceneWith("mtllib s.mtl\n"), "the material library 's.mtl': is not in the folder"));
    EXPECT_FALSE(tells(sceneWith(""), "material library"));
    writeFile(folder, "s.mtl", "newmtl m\nKd 1 0 0\n"); // takes the place of any other
    EXPECT_FALSE(tells(sceneWith("mtllib gone.mtl\n"), "material library"));
    EXPECT_FALSE(tells(sceneWith("mtllib s.mtl\n"), "material library"));
    EXPECT_EQ(sceneWith("mtllib gone.mtl\n").materials.at(0).baseColor, glm::vec4(1, 0, 0, 1));
}

// libassimp smooths over all edges where a file has no smoothing groups: a box would be shaded like a pillow.
TEST(ForeignHabits, EdgesAreSharpWhereAFileHasNoSmoothingGroups) {
    const TemporaryFolder folder;
    const auto isSharp = [&](const std::string& name, const std::string& file) {
        const Scene scene = convertForeign(writeFile(folder, name, file)).scene;
        const Primitive& primitive = scene.meshes.at(0).primitives.at(0);
        return std::all_of(primitive.normals.begin(), primitive.normals.end(), [](const glm::vec3& normal) {
            return std::abs(std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z) - 1.0f) < 1e-5f;
        });
    };
    EXPECT_TRUE(isSharp("a.3ds", test::file3ds({{"A", test::wedge3ds("")}})));
    EXPECT_TRUE(isSharp("b.3ds", wedgeOfGroups({0, 0})));
    EXPECT_FALSE(isSharp("c.3ds", wedgeOfGroups({4, 4})));
    EXPECT_TRUE(isSharp("d.3ds", wedgeOfGroups({4, 8})));
}

TEST(ForeignHabits, WhichFilesMeanTheirNormals) {
    const TemporaryFolder folder;
    const auto means = [&](const std::string& name, const std::string& text) {
        return meansItsNormals(writeFile(folder, name, text));
    };
    EXPECT_FALSE(means("a.ASE", "*MESH_FACE 0: A: 0 B: 1 C: 2 *MESH_SMOOTHING \t*MESH_MTLID 1\n"));
    EXPECT_FALSE(means("b.ase", "*MESH_SMOOTHING 0 *MESH_MTLID 1\n*MESH_SMOOTHING"));
    EXPECT_TRUE(means("c.ase", "*MESH_SMOOTHING 0\n*MESH_SMOOTHING 2,4\n"));
    EXPECT_TRUE(means("d.ase", "*MESH_NORMALS {\n"));
    EXPECT_FALSE(means("e.blend", "BLENDER-v279")); // it tells by face what is smooth, which is lost
    EXPECT_TRUE(means("f.obj", ""));
    // Damaged files end where their chunks do.
    const std::string whole = wedgeOfGroups({4, 8});
    for (size_t length = 0; length < whole.size(); ++length)
        EXPECT_EQ(means("g.3ds", whole.substr(0, length)), length > whole.size() - 8) << length;
    std::string nested;
    for (int i = 0; i < 1000; ++i)
        nested += std::string("\x4d\x4d\xff\xff\xff\x7f", 6);
    EXPECT_FALSE(means("h.3ds", nested));
}

// 3ds Max writes places twice, as those of the lights and as the first keys of their tracks.
TEST(ForeignHabits, LightsAndCamerasStandWhereA3dsFileSays) {
    const TemporaryFolder folder;
    const auto track = [](uint16_t id, const std::string& name, std::initializer_list<float> place) {
        const std::string node = name + '\0' + test::bytesOf<uint16_t>({0, 0, 0xffff});
        const std::string keys =
            test::bytesOf<uint16_t>({0, 0, 0, 0, 0, 1, 0, 0, 0, 0}) + test::bytesOf(place);
        return test::chunk3ds(id, test::chunk3ds(0xb010, node) + test::chunk3ds(0xb020, keys));
    };
    const std::string white = test::chunk3ds(0x0010, test::bytesOf<float>({1, 1, 1}));
    const std::string lamp = test::chunk3ds(0x4600, test::bytesOf<float>({1, 2, 3}) + white);
    const std::string camera = test::chunk3ds(0x4700, test::bytesOf<float>({5, 6, 7, 1, 6, 7, 0, 50}));
    for (const bool tracked : {false, true}) {
        const std::string tracks =
            test::chunk3ds(0xb000, track(0xb002, "A", {0, 0, 0}) + track(0xb005, "Lamp", {1, 2, 3}) +
                                       track(0xb003, "View", {5, 6, 7}) + track(0xb004, "View", {1, 6, 7}));
        const std::string file = test::file3ds({{"A", test::wedge3ds("")}, {"Lamp", lamp}, {"View", camera}},
                                               tracked ? tracks : "");
        const Scene scene = convertForeign(writeFile(folder, "lit.3ds", file)).scene;
        EXPECT_LE(glm::length(glm::vec3(scene.lights.at(0).transform[3]) - glm::vec3(1, 3, -2)), 1e-5f);
        EXPECT_LE(glm::length(glm::vec3(scene.cameras.at(0).transform[3]) - glm::vec3(5, 7, -6)), 1e-5f);
        EXPECT_LE(glm::length(glm::vec3(scene.cameras.at(0).transform[2]) - glm::vec3(1, 0, 0)), 1e-5f);
    }
}

TEST(ForeignHabits, AnimationsAreTold) {
    const TemporaryFolder folder;
    const auto moved = [&](std::initializer_list<float> places) {
        const auto count = static_cast<uint16_t>(places.size() / 3);
        std::string keys = test::bytesOf<uint16_t>({0, 0, 0, 0, 0, count, 0});
        for (uint16_t key = 0; key < count; ++key)
            keys +=
                test::bytesOf<uint16_t>({key, 0, 0}) + test::bytesOf({places.begin()[3 * key], 0.0f, 0.0f});
        const std::string node = std::string("A") + '\0' + test::bytesOf<uint16_t>({0, 0, 0xffff});
        const std::string track =
            test::chunk3ds(0xb002, test::chunk3ds(0xb010, node) + test::chunk3ds(0xb020, keys));
        const std::string file = test::file3ds({{"A", test::wedge3ds("")}}, test::chunk3ds(0xb000, track));
        return convertForeign(writeFile(folder, "moved.3ds", file)).scene;
    };
    EXPECT_TRUE(tells(moved({0, 0, 0, 1, 0, 0}), "animations: are not supported"));
    EXPECT_FALSE(tells(moved({0, 0, 0}), "animations"));
}

TEST(ForeignHabits, WhatHelpsWithABlendFileIsBlender) {
    EXPECT_NE(mendOf("room.BLEND").find("install Blender"), std::string::npos);
    EXPECT_EQ(mendOf("room.lwo").find("Blender"), std::string::npos);
}

} // namespace
} // namespace relume
