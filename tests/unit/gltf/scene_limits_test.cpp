// This tests scenes that are too large or too bright for floats: what is dropped, cut or dimmed, and that the
// rest bakes.
#include "assets/model/scene_limits.h"

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/world_mesh.h"
#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "assets/images/finite_image.h"
#include "bake/base/finite_light.h"
#include "bake/base/shader_types.h"
#include "bake/trace/bvh_builder.h"
#include "tests/unit/glb_builder.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume {
namespace {

using nlohmann::json;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinite = std::numeric_limits<float>::infinity();

/// Returns the positions of two triangles beside each other, the second with one corner at x.
std::vector<float> trianglesTo(float x) {
    return {0, 0, 0, 1, 0, 0, 0, 1, 0, 2, 0, 0, x, 0, 0, 2, 1, 0};
}

/// Loads a good square, and a mesh of these positions on a node.
Scene loaded(const std::vector<float>& positions, json node = json::object()) {
    test::GlbBuilder builder = test::squareScene();
    const int accessor = builder.accessor<float>(positions, "VEC3");
    node["mesh"] = builder.mesh({{"attributes", {{"POSITION", accessor}}}}, "Far");
    builder.node(node);
    return loadGltf(builder.write("far.glb"));
}

size_t triangleCountOf(const Scene& scene) {
    size_t count = 0;
    for (const Instance& instance : scene.instances)
        for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives)
            count += primitive.indices.size() / 3;
    return count;
}

void expectWarning(const Scene& scene, const std::string& text) {
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_EQ(scene.warnings[0], scene.path + ": " + text);
}

LightmapAtlas plainAtlas(const Scene& scene) {
    LightmapAtlas atlas;
    atlas.instances.resize(scene.instances.size());
    return atlas;
}

} // namespace

TEST(SceneLimits, TrianglesThatReachTooFarAreDroppedWithOneWarning) {
    for (const float x : {1.01e8f, 1e18f, 1e19f, -1e30f}) {
        const Scene scene = loaded(trianglesTo(x));
        EXPECT_EQ(triangleCountOf(scene), 3u) << x;
        expectWarning(scene, "mesh 'Far': 1 of its triangles reach beyond 1e+08 m and are dropped: make it "
                             "smaller or move it");
        for (const Instance& instance : scene.instances)
            for (const Primitive& primitive : scene.meshes[static_cast<size_t>(instance.mesh)].primitives)
                for (const glm::vec3& position : primitive.positions)
                    EXPECT_TRUE(isWithinReach(position)); // cameras and boxes are made of all of them
    }
    EXPECT_TRUE(loaded(trianglesTo(1e8f)).warnings.empty());
}

TEST(SceneLimits, ScaleAndPlaceCount) {
    const std::vector<float> small = trianglesTo(3);
    EXPECT_EQ(loaded(small, {{"scale", {1e30, 1e30, 1e30}}}).instances.size(), 1u); // of Far nothing is left
    EXPECT_EQ(loaded(small, {{"translation", {0, 2e8, 0}}}).instances.size(), 1u);
    const Scene shrunk = loaded(trianglesTo(1e30f), {{"scale", {1e-25, 1, 1}}});
    EXPECT_EQ(shrunk.instances.size(), 2u);
    EXPECT_TRUE(shrunk.warnings.empty());
}

TEST(SceneLimits, AnInstanceThatIsTooLargeLeavesOthersOfItsMeshWhole) {
    Scene scene = test::sceneOf(test::square());
    test::addInstance(scene, 0, glm::scale(glm::mat4(1), glm::vec3(1e20f)));
    test::addInstance(scene, 0, glm::translate(glm::mat4(1), glm::vec3(kFarthest - 0.5f, 0, 0)));
    Warnings warnings;
    dropFarTriangles(scene, warnings);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].mesh, 0);
    EXPECT_EQ(scene.meshes[0].primitives[0].indices.size(), 6u);
    EXPECT_EQ(warnings.lines("").size(), 1u);
}

TEST(SceneLimits, ALevelFarFromTheOriginIsTold) {
    Scene scene = test::sceneOf(test::square());
    const auto moved = [&](double metres, double scale) {
        scene.instances[0].transform =
            glm::scale(glm::translate(glm::mat4(1), glm::vec3(metres, 0, 0)), glm::vec3(scale));
        return coarsePlaces(scene);
    };
    EXPECT_EQ(moved(0, 100), "");
    EXPECT_EQ(moved(20e3, 100), "");
    EXPECT_NE(moved(200e3, 100).find("from the origin, where places are rounded to 0.016 m"),
              std::string::npos)
        << moved(200e3, 100);
    EXPECT_EQ(moved(200e3, 10e3), "") << "for its size it is near";
    EXPECT_NE(moved(20, 1e-3), "") << "a model of a millimetre, 20 m away";
    test::GlbBuilder builder;
    builder.node({{"mesh", builder.mesh(builder.square())}, {"translation", {200e3, 0, 0}}});
    const Scene read = loadGltf(builder.write("far.glb"));
    ASSERT_EQ(read.warnings.size(), 1u);
    EXPECT_NE(read.warnings[0].find("the scene: lies up to 2e+05 m"), std::string::npos) << read.warnings[0];
}

TEST(SceneLimits, ASceneOfWhichNothingIsLeftIsAnError) {
    Scene scene = test::sceneOf(test::square());
    scene.instances[0].transform = glm::scale(glm::mat4(1), glm::vec3(1e20f));
    EXPECT_THROW(flatten(scene, plainAtlas(scene)), Error);
    test::GlbBuilder builder;
    builder.node({{"mesh", builder.mesh(builder.square())}, {"scale", {1e20, 1e20, 1e20}}});
    try {
        loadGltf(builder.write("huge.glb"));
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("huge.glb: all its triangles reach beyond 1e+08 m"),
                  std::string::npos)
            << error.what();
    }
}

// Objects that were moved come here without an import.
TEST(SceneLimits, NoFarTriangleIsFlattened) {
    Scene scene = test::sceneOf(test::square());
    test::addInstance(scene, 0, glm::translate(glm::mat4(1), glm::vec3(1e19f, 0, 0)));
    test::addInstance(scene, 0, glm::scale(glm::mat4(1), glm::vec3(1e9f, 1e-9f, 1)));
    const WorldMesh mesh = flatten(scene, plainAtlas(scene));
    EXPECT_EQ(mesh.triangleCount(), 2u);
    for (const glm::vec3& position : mesh.positions)
        EXPECT_TRUE(isWithinReach(position));
}

// These multiply most lengths, which is the reason for the bound.
TEST(SceneLimits, ProductsOfLengthsWithinTheBoundsAreFinite) {
    const float f = kFarthest;
    const glm::vec3 low(-f), high(f), n(0, 0, 1);
    const float all = 3.4641f * f; // from one corner to the other
    EXPECT_TRUE(std::isfinite(6.0f * all * all * all * all));
    EXPECT_LT(2.0f * all, 1e9f);
    const float disc = shader::discFormFactor(low, n, high, -n, 4.0f * f * f);
    EXPECT_TRUE(disc > 0.0f && disc <= 1.0f);
    // A square of the largest size, half a metre above, is all that is seen.
    const float polygon =
        shader::polygonFormFactor({0, 0, 0}, n, {-f / 2, -f / 2, 0.5f}, {-f / 2, f / 2, 0.5f},
                                  {f / 2, f / 2, 0.5f}, {f / 2, -f / 2, 0.5f});
    EXPECT_NEAR(polygon, 1.0f, 1e-5f);
    WorldMesh mesh;
    for (const glm::vec3& p : {low, glm::vec3(f, -f, f), high, low, high, glm::vec3(-f, f, -f)})
        mesh.positions.push_back(p);
    mesh.material.assign(2, 0);
    mesh.opaqueCount = 2;
    const Bvh bvh = buildBvh(mesh);
    EXPECT_TRUE(std::isfinite(bvhCost(bvh)));
}

TEST(SceneLimits, LightsAreCutAndDimmed) {
    Light light;
    light.type = LightType::Rectangle;
    light.size = {1e20f, 2.0f};
    light.intensity = 3e38f;
    const std::vector<std::string> problems = limitLight(light);
    ASSERT_EQ(problems.size(), 2u);
    EXPECT_EQ(problems[0], "its size is more than 1e+08 m and is cut to that");
    EXPECT_EQ(problems[1], "is brighter than 1e+12 cd/m^2 and is dimmed to that");
    EXPECT_EQ(light.size, glm::vec2(kFarthest, 2.0f));
    EXPECT_EQ(light.intensity, kBrightest);
    EXPECT_TRUE(limitLight(light).empty());

    Light colored;
    colored.color = {1e10f, 0, 0};
    colored.intensity = 1e10f;
    EXPECT_EQ(limitLight(colored).size(), 1u);
    EXPECT_LE(colored.color.r * colored.intensity, kBrightest * 1.0001f);
    EXPECT_TRUE(limitLight(colored).empty());
}

TEST(SceneLimits, SkiesAndMaterialsAreDimmed) {
    Sky sky;
    sky.radiance = {1e20f, 1, 0};
    EXPECT_EQ(limitSky(sky).size(), 1u);
    EXPECT_EQ(sky.radiance, glm::vec3(kBrightest, 1, 0));
    sky.width = 2, sky.height = 1;
    sky.pixels = {{1e30f, 0, 0}, {5, 5, 5}};
    EXPECT_EQ(limitSky(sky).size(), 2u); // pixels, and the factor on them
    EXPECT_EQ(sky.pixels[0].r, kBrightest);
    EXPECT_LE(sky.pixels[0].r * sky.radiance.r, kBrightest);
    Material material;
    material.emission = glm::vec3(2e12f);
    ASSERT_EQ(limitMaterial(material).size(), 1u);
    EXPECT_EQ(material.emission, glm::vec3(kBrightest));
    EXPECT_TRUE(limitMaterial(material).empty());
}

TEST(SceneLimits, EmissionTimesItsStrengthIsBoundedWithAWarning) {
    test::GlbBuilder builder = test::squareScene();
    builder.json["materials"] = {
        {{"name", "Star"},
         {"emissiveFactor", {1, 0.5, 0}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e300}}}}}}};
    builder.json["extensionsUsed"] = {"KHR_materials_emissive_strength"};
    const Scene scene = loadGltf(builder.write("star.glb"));
    EXPECT_EQ(scene.materials[0].emission, glm::vec3(kBrightest, kBrightest, 0));
    expectWarning(scene, "material 'Star': emits more than 1e+12 cd/m^2 and is dimmed to that");
}

TEST(SceneLimits, LightsOfAFile) {
    test::GlbBuilder builder = test::squareScene();
    builder.json["extensionsUsed"] = {"KHR_lights_punctual"};
    builder.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"name", "Bright"}, {"intensity", 3e38}},
        {{"type", "point"}, {"name", "Far"}},
        {{"type", "directional"}, {"name", "Sun"}}};
    const auto use = [](int light) { return json{{"KHR_lights_punctual", {{"light", light}}}}; };
    builder.node({{"extensions", use(0)}});
    builder.node({{"extensions", use(1)}, {"translation", {0, 1e20, 0}}});
    builder.node({{"extensions", use(2)}, {"translation", {0, 1e20, 0}}});
    builder.node(
        {{"extras",
          {{"relume", {{"areaLight", {{"name", "Wall"}, {"type", "rectangle"}, {"size", {1e20, 1e20}}}}}}}}});
    const Scene scene = loadGltf(builder.write("lights.glb"));
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[0].intensity, kBrightest);
    EXPECT_EQ(scene.lights[1].name, "Sun");
    EXPECT_TRUE(isWithinReach(glm::vec3(scene.lights[1].transform[3])));
    EXPECT_EQ(scene.lights[2].size, glm::vec2(kFarthest));
    std::string lines;
    for (const std::string& warning : scene.warnings)
        lines += warning.substr(scene.path.size() + 2) + "\n";
    EXPECT_EQ(lines, "light 'Bright': is brighter than 1e+12 cd and is dimmed to that\n"
                     "light 'Far': stands more than 1e+08 m away and is ignored: move it\n"
                     "light 'Wall': its size is more than 1e+08 m and is cut to that\n");
}

TEST(SceneLimits, EditsOfAViewerStayWithinThem) {
    Scene scene = test::sceneOf(test::square());
    scene.lights.emplace_back();
    scene.materials.emplace_back();
    const SceneEdits before = editsOf(scene);
    SceneEdits edits = before;
    edits.lights[0].transform[3].y = 1e30f;
    edits.lights[0].intensity = 1e30f;
    edits.materials[0].emission = glm::vec3(1e30f);
    edits.sky.radiance = glm::vec3(1e30f);
    edits.placements[0].transform = glm::scale(glm::mat4(1), glm::vec3(1e30f));
    limitEdits(scene, before, edits);
    EXPECT_EQ(edits.lights[0].transform[3].y, kFarthest);
    EXPECT_EQ(edits.lights[0].intensity, kBrightest);
    EXPECT_EQ(edits.materials[0].emission, glm::vec3(kBrightest));
    EXPECT_EQ(edits.sky.radiance, glm::vec3(kBrightest));
    EXPECT_EQ(edits.placements, before.placements);
    edits.placements[0].transform[3].x = 5.0f;
    const SceneEdits moved = edits;
    limitEdits(scene, before, edits);
    EXPECT_EQ(edits.placements, moved.placements);
}

TEST(SceneLimits, EditsThatAreNoNumbersLeaveAngles) {
    Scene scene = test::sceneOf(test::square());
    scene.lights.emplace_back();
    const SceneEdits before = editsOf(scene);
    SceneEdits edits = before;
    edits.lights[0].transform[1] = glm::vec4(kNan, 0, 0, 0);
    edits.lights[0].color.g = kInfinite;
    edits.lights[0].intensity = 0.5f;
    edits.sky.rotation = kInfinite;
    edits.lights.push_back(edits.lights[0]);
    limitEdits(scene, before, edits);
    EXPECT_EQ(edits.lights[0].transform, before.lights[0].transform);
    EXPECT_EQ(edits.lights[0].color.g, kBrightest);
    EXPECT_EQ(edits.lights[0].intensity, 0.5f);
    EXPECT_EQ(edits.lights[1].transform, glm::mat4(1.0f)) << "one that was not there before";
    EXPECT_EQ(edits.sky.rotation, before.sky.rotation);
}

TEST(SceneLimits, SumsThatAreNotFiniteAreAnError) {
    EXPECT_NO_THROW(requireFiniteLight(1e30, 1e300));
    EXPECT_THROW(requireFiniteLight(kNan, 1.0), Error);
    EXPECT_THROW(requireFiniteLight(1.0, kInfinite), Error);
}

TEST(SceneLimits, AnImageSaysWhichTexelIsNotFinite) {
    for (const float bad : {kNan, kInfinite, -kInfinite}) {
        FloatImage image{3, 2, {}, {}, {}};
        image.add("R");
        image.add("G")[4] = bad;
        try {
            requireFinite(image, "room.exr");
            FAIL();
        } catch (const Error& error) {
            EXPECT_EQ(
                std::string(error.what()).find("room.exr: channel G of texel 1,1 is not a finite number"), 0u)
                << error.what();
        }
        image.planes[1][4] = 3e38f;
        EXPECT_NO_THROW(requireFinite(image, "room.exr"));
    }
}

} // namespace relume
