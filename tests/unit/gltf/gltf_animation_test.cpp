#include "assets/gltf/gltf.h"
#include "assets/gltf/edit/gltf_edit.h"
#include "assets/gltf/gltf_camera_motion.h"

#include "assets/base/error.h"
#include "tests/unit/glb_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace relume {
namespace {

using nlohmann::json;
using test::GlbBuilder;

bool toldOf(const Scene& scene, const std::string& part) {
    return std::any_of(scene.warnings.begin(), scene.warnings.end(),
                       [&](const std::string& w) { return w.find(part) != std::string::npos; });
}

void expectPoint(const glm::vec3& at, const glm::vec3& wanted, float tolerance = 1e-5f) {
    for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(at[i], wanted[i], tolerance) << i;
}

glm::vec3 placeOf(const Scene& scene, size_t instance, const glm::vec3& point = glm::vec3(0.0f)) {
    return glm::vec3(scene.instances[instance].transform * glm::vec4(point, 1.0f));
}

/// Adds a channel to the first animation.
void addChannel(GlbBuilder& b, int node, const char* path, int input, int output, const char* interpolation) {
    json& animation = b.json["animations"][0];
    const size_t sampler = animation.contains("samplers") ? animation["samplers"].size() : 0;
    animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
    animation["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
}

TEST(GltfAnimation, StepLinearAndSplineAreAsGltfDefinesThem) {
    GlbBuilder b;
    const int mesh = b.mesh(b.square());
    for (const char* name : {"Step", "Linear", "Spline", "Turn"})
        b.node({{"mesh", mesh}, {"name", name}, {"scale", {2, 2, 2}}});
    const int input = b.accessor<float>({1, 2, 4}, "SCALAR");
    const int output = b.accessor<float>({0, 0, 0, 10, 0, 0, 10, 20, 0}, "VEC3");
    // x = t^3 with its slopes 3 t^2: a cubic spline is that polynomial between its keys.
    std::vector<float> cubic;
    for (const float t : {1.0f, 2.0f, 4.0f})
        cubic.insert(cubic.end(), {3 * t * t, 0, 0, t * t * t, 0, 0, 3 * t * t, 0, 0});
    const float h = std::sqrt(0.5f);
    const int turn = b.accessor<float>({0, 0, 0, 1, 0, 0, h, h, 0, 0, -1, 0}, "VEC4");
    addChannel(b, 0, "translation", input, output, "STEP");
    addChannel(b, 1, "translation", input, output, "LINEAR");
    addChannel(b, 2, "translation", input, b.accessor<float>(cubic, "VEC3"), "CUBICSPLINE");
    addChannel(b, 3, "rotation", input, turn, "LINEAR");
    const std::string path = b.write("keys.glb");
    const auto at = [&](double time) { return loadGltf(path, {.time = time}); };
    for (const double time : {1.0, 1.5, 2.0, 3.0, 4.0}) {
        const Scene scene = at(time);
        const float t = static_cast<float>(time);
        expectPoint(placeOf(scene, 0), t < 2   ? glm::vec3(0)
                                       : t < 4 ? glm::vec3(10, 0, 0)
                                               : glm::vec3(10, 20, 0));
        expectPoint(placeOf(scene, 1),
                    t < 2 ? glm::vec3(10 * (t - 1), 0, 0) : glm::vec3(10, 10 * (t - 2), 0));
        expectPoint(placeOf(scene, 2), {t * t * t, 0, 0});
        // Scale stays, and the rotation turns evenly: a quarter in a second, a quarter more in two.
        const float angle = glm::radians(t < 2 ? 90 * (t - 1) : 90 + 45 * (t - 2));
        expectPoint(placeOf(scene, 3, {1, 0, 0}), {2 * std::cos(angle), 2 * std::sin(angle), 0});
    }
    expectPoint(placeOf(at(0.0), 1), {0, 0, 0}); // as at the first key, and as at the last one
    expectPoint(placeOf(at(9.0), 1), {10, 20, 0});
    EXPECT_TRUE(toldOf(at(9.0), "ends at 4 s"));
    EXPECT_TRUE(toldOf(at(1.5), "is shown as it is at 1.5 s"));
    EXPECT_TRUE(at(1.5).posed);
    const Scene rest = loadGltf(path);
    expectPoint(placeOf(rest, 1), {0, 0, 0});
    EXPECT_FALSE(rest.posed);
    EXPECT_TRUE(toldOf(rest, "pass --time"));
}

TEST(GltfAnimation, ChannelsThatDoNotFitAreToldAndLeftOut) {
    GlbBuilder b;
    b.node({{"mesh", b.mesh(b.square())}});
    b.node({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
    const int input = b.accessor<float>({0, 1}, "SCALAR"), back = b.accessor<float>({1, 0}, "SCALAR"),
              output = b.accessor<float>({0, 0, 0, 1, 1, 1, 2, 2, 2}, "VEC3"),
              good = b.accessor<float>({0, 0, 0, 4, 4, 4}, "VEC3"),
              nan = b.accessor<float>({NAN, 0, 0, NAN, 0, 0}, "VEC3");
    addChannel(b, 0, "translation", input, output, "LINEAR"); // 3 values for 2 keys
    addChannel(b, 0, "translation", back, good, "LINEAR");
    addChannel(b, 0, "scale", input, nan, "LINEAR");
    addChannel(b, 1, "translation", input, good, "LINEAR");
    addChannel(b, 7, "translation", input, good, "LINEAR");
    addChannel(b, 0, "pointer", input, good, "LINEAR");
    addChannel(b, 0, "rotation", input, good, "LINEAR");
    addChannel(b, 0, "translation", 99, good, "LINEAR");
    const Scene scene = loadGltf(b.write("misfits.glb"), {.time = 0.5});
    expectPoint(placeOf(scene, 0), {0, 0, 0});
    for (const char* part : {"one value for each key", "in the order of time", "not finite", "has a matrix",
                             "is damaged", "something else than nodes"})
        EXPECT_TRUE(toldOf(scene, part)) << part;
    GlbBuilder still = test::squareScene();
    try {
        loadGltf(still.write("still.glb"), {.time = 0.0});
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("has no animation: leave out --time"), std::string::npos);
    }
}

TEST(GltfAnimation, AToolsCompressedKeysMoveAsThePlainOnes) {
    const std::string folder = std::string(RELUME_SOURCE_DIR) + "/tests/data/";
    for (const double time : {0.0, 0.6, 1.3, 2.0}) {
        const Scene plain = loadGltf(folder + "plain.glb", {.time = time});
        const float angle = static_cast<float>(0.3 * time / 0.25);
        const glm::vec3 x = glm::vec3(plain.instances[5].transform[0]);
        // A turn about (0.6, 0, 0.8), by Rodrigues' formula.
        const glm::vec3 axis(0.6f, 0.0f, 0.8f), ex(1, 0, 0);
        expectPoint(x, ex * std::cos(angle) + glm::cross(axis, ex) * std::sin(angle) +
                           axis * 0.6f * (1 - std::cos(angle)));
        const Scene packed = loadGltf(folder + "meshopt.glb", {.time = time});
        glm::vec3 a(0.0f), b(0.0f);
        for (const glm::vec3& p : plain.meshes[0].primitives[0].positions)
            a += placeOf(plain, 5, p) / 49.0f;
        for (const glm::vec3& p : packed.meshes[0].primitives[0].positions)
            b += placeOf(packed, 5, p) / 49.0f;
        EXPECT_LT(glm::distance(a, b), 5e-4f);
    }
}

TEST(GltfAnimation, AMoveThatAnAnimationWouldUndoIsNotSaved) {
    GlbBuilder b = test::squareScene();
    b.node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    addChannel(b, 0, "translation", b.accessor<float>({0, 1}, "SCALAR"),
               b.accessor<float>({0, 0, 0, 4, 4, 4}, "VEC3"), "LINEAR");
    const std::string path = b.write("posed.glb"), saved = test::tempPath("posed_saved.glb");
    const Scene before = loadGltf(path, {.time = 0.5});
    Scene object = before, light = before, brighter = before;
    object.instances[0].transform[3].x += 1;
    light.lights[0].transform[3].x += 1;
    brighter.lights[0].intensity = 7;
    for (const Scene& after : {object, light})
        EXPECT_THROW(saveEditedGltf(path, partsOfEdits(before), after, saved), Error);
    saveEditedGltf(path, partsOfEdits(before), brighter, saved);
    EXPECT_EQ(loadGltf(saved).lights[0].intensity, 7.0f);
}

TEST(GltfMorph, WeightsOfMeshNodeAndAnimationCount) {
    GlbBuilder b;
    json square = b.square();
    const std::vector<float> up = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1},
                             right = {1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0};
    square["targets"] = {{{"POSITION", b.accessor<float>(up, "VEC3")}},
                         {{"POSITION", b.accessor<float>(right, "VEC3")}}};
    const int mesh = b.mesh(square, "Soft");
    b.json["meshes"][0]["weights"] = {0.5, 0};
    b.node({{"mesh", mesh}, {"name", "Own"}});
    b.node({{"mesh", mesh}, {"name", "Node"}, {"weights", {0, 3}}});
    addChannel(b, 0, "weights", b.accessor<float>({0, 1}, "SCALAR"),
               b.accessor<float>({0, 0, 2, 4}, "SCALAR"), "LINEAR");
    const std::string path = b.write("morph.glb");
    const auto corner = [&](const Scene& scene, size_t i) {
        return scene.meshes[static_cast<size_t>(scene.instances[i].mesh)].primitives[0].positions[0];
    };
    const Scene rest = loadGltf(path);
    expectPoint(corner(rest, 0), {0, 0, 0.5f});
    expectPoint(corner(rest, 1), {3, 0, 0});
    EXPECT_EQ(rest.instances[0].mesh, 0);
    const Scene posed = loadGltf(path, {.time = 0.5});
    expectPoint(corner(posed, 0), {2, 0, 1});
    expectPoint(corner(posed, 1), {3, 0, 0});
}

/// Makes a strip of three pairs of vertices at x = 0, 1 and 2 that hang at joint 0, at both, and at joint 1.
/// Joint 0 is at (0, 0, 5), and joint 1 below it, at x = 1, where it is turned by a quarter about z.
template<typename Joint, typename Weight>
GlbBuilder armScene(Weight full) {
    GlbBuilder b;
    const Weight half = static_cast<Weight>(full / 2);
    const int positions = b.accessor<float>({0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0, 1, 2, 0, 0, 2, 0, 1}, "VEC3");
    std::vector<float> normals;
    for (int i = 0; i < 6; ++i)
        normals.insert(normals.end(), {0, -1, 0});
    std::vector<Joint> joints;
    std::vector<Weight> weights;
    for (int i = 0; i < 6; ++i) {
        joints.insert(joints.end(), {0, 1, 0, 0});
        weights.insert(weights.end(), {i < 2   ? full
                                       : i < 4 ? half
                                               : Weight(0),
                                       i < 2   ? Weight(0)
                                       : i < 4 ? half
                                               : full,
                                       Weight(0), Weight(0)});
    }
    const json primitive = {
        {"attributes",
         {{"POSITION", positions},
          {"NORMAL", b.accessor<float>(normals, "VEC3")},
          {"JOINTS_0", b.accessor<Joint>(joints, "VEC4")},
          {"WEIGHTS_0", b.accessor<Weight>(weights, "VEC4", !std::is_same_v<Weight, float>)}}},
        {"indices", b.accessor<uint16_t>({0, 2, 3, 0, 3, 1, 2, 4, 5, 2, 5, 3}, "SCALAR")}};
    std::vector<float> inverse(32, 0.0f);
    for (size_t i = 0; i < 32; i += 16)
        inverse[i] = inverse[i + 5] = inverse[i + 10] = inverse[i + 15] = 1.0f;
    inverse[16 + 12] = -1.0f; // joint 1 was at x = 1 when the mesh was bound
    const float h = std::sqrt(0.5f);
    // The node's own place means nothing: joints say where a skinned mesh stands.
    b.node(
        {{"mesh", b.mesh(primitive, "Arm")}, {"skin", 0}, {"name", "Body"}, {"translation", {90, 90, 90}}});
    b.node({{"translation", {0, 0, 5}}, {"children", {2}}});
    b.node({{"translation", {1, 0, 0}}, {"rotation", {0, 0, h, h}}});
    // GlbBuilder's types have one digit: a matrix's accessor is written by hand.
    const int view = b.view(inverse);
    b.json["accessors"].push_back(
        {{"bufferView", view}, {"componentType", 5126}, {"count", 2}, {"type", "MAT4"}});
    b.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", b.json["accessors"].size() - 1}}};
    return b;
}

void expectArm(const Scene& scene) {
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_TRUE(scene.instances[0].bent);
    const Primitive& arm = scene.meshes[0].primitives[0];
    ASSERT_EQ(arm.positions.size(), 6u);
    const glm::vec3 wanted[] = {{0, 0, 5}, {0, 0, 6}, {1, 0, 5}, {1, 0, 6}, {1, 1, 5}, {1, 1, 6}};
    for (size_t i = 0; i < 6; ++i)
        expectPoint(placeOf(scene, 0, arm.positions[i]), wanted[i], 1e-4f);
    expectPoint(arm.normals[0], {0, -1, 0});
    expectPoint(arm.normals[2], {std::sqrt(0.5f), -std::sqrt(0.5f), 0}, 5e-3f);
    expectPoint(arm.normals[4], {1, 0, 0});
}

TEST(GltfSkin, JointsPlaceTheVerticesInTheRestPose) {
    expectArm(loadGltf(armScene<uint8_t, float>(1.0f).write("arm.glb")));
    expectArm(loadGltf(armScene<uint16_t, uint8_t>(254).write("arm8.glb"))); // which sums to less than 1
    const Scene scene = loadGltf(armScene<uint8_t, uint16_t>(65534).write("arm16.glb"));
    expectArm(scene);
    EXPECT_TRUE(toldOf(scene, "node 'Body': has a skin, which stands in its rest pose"));
}

TEST(GltfSkin, AnAnimatedJointBendsTheMesh) {
    GlbBuilder b = armScene<uint8_t, float>(1.0f);
    addChannel(b, 2, "rotation", b.accessor<float>({0, 2}, "SCALAR"),
               b.accessor<float>({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4"), "LINEAR");
    const std::string path = b.write("wave.glb");
    expectArm(loadGltf(path));
    for (const float time : {0.0f, 0.5f, 1.5f, 2.0f}) {
        const Scene scene = loadGltf(path, {.time = double(time)});
        const float angle = glm::radians(90.0f * time);
        expectPoint(scene.meshes[0].primitives[0].positions[4], {1 + std::cos(angle), std::sin(angle), 5},
                    1e-4f);
    }
}

TEST(GltfSkin, SkinsThatDoNotFitAreLeftOut) {
    const auto load = [](const std::function<void(GlbBuilder&)>& spoil) {
        GlbBuilder b = armScene<uint8_t, float>(1.0f);
        spoil(b);
        return loadGltf(b.write("odd_arm.glb"));
    };
    const Scene none = load([](GlbBuilder& b) { b.json["skins"][0].erase("joints"); });
    EXPECT_TRUE(toldOf(none, "skin 0: has no joints, and is left out"));
    expectPoint(placeOf(none, 0), {90, 90, 90}); // as a mesh without skin
    EXPECT_TRUE(toldOf(load([](GlbBuilder& b) { b.json["skins"][0]["joints"] = {1, 55}; }), "no node"));
    EXPECT_TRUE(toldOf(load([](GlbBuilder& b) { b.json["skins"][0]["inverseBindMatrices"] = 0; }),
                       "no inverse bind matrix for each joint"));
    const Scene lacking = load([](GlbBuilder& b) { b.json["skins"][0]["joints"] = {1}; });
    EXPECT_TRUE(toldOf(lacking, "hangs at joints that its skin lacks"));
    const Scene identity = load([](GlbBuilder& b) { b.json["skins"][0].erase("inverseBindMatrices"); });
    expectPoint(identity.meshes[0].primitives[0].positions[4], {1, 2, 5}, 1e-4f);
}

TEST(GltfSkin, NodesWithSkinsOfTheirOwnHaveMeshesOfTheirOwn) {
    GlbBuilder b = armScene<uint8_t, float>(1.0f);
    b.node({{"mesh", 0}, {"skin", 1}, {"name", "Twin"}});
    b.node({{"mesh", 0}, {"name", "Unbound"}});
    b.json["skins"].push_back({{"joints", {1, 1}}});
    const Scene scene = loadGltf(b.write("twins.glb"));
    ASSERT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.meshes.size(), 3u);
    const auto corner = [&](size_t i) {
        return scene.meshes[static_cast<size_t>(scene.instances[i].mesh)].primitives[0].positions[4];
    };
    expectPoint(corner(0), {1, 1, 5}, 1e-4f);
    expectPoint(corner(1), {2, 0, 5}, 1e-4f);
    expectPoint(corner(2), {2, 0, 0});
    EXPECT_EQ(scene.instances[2].mesh, 0); // what is shown as it is keeps the file's number
}

std::string motionError(const std::string& path, const std::string& name, uint32_t most = 1000) {
    try {
        readCameraMotion(path, {}, name, 10, most);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

// The node above the second camera rises by 4 m in 2 s; the first camera stays where it is.
TEST(GltfCameraMotion, FollowsTheCameraAndWhatIsAboveIt) {
    GlbBuilder b;
    b.node({{"mesh", b.mesh(b.square())}});
    b.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}},
                         {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}}};
    b.node({{"camera", 0}, {"name", "Still"}});
    const int crane = b.node({{"name", "Crane"}});
    const int riding = b.node({{"camera", 1}, {"name", "Riding"}, {"translation", {0, 1, 0}}});
    b.json["nodes"][static_cast<size_t>(crane)]["children"] = {riding};
    const std::string fixed = b.write("fixed.glb");
    EXPECT_NE(motionError(fixed, "Riding").find("has no animation"), std::string::npos);
    addChannel(b, crane, "translation", b.accessor<float>({0, 2}, "SCALAR"),
               b.accessor<float>({0, 0, 0, 0, 4, 0}, "VEC3"), "LINEAR");
    const std::string path = b.write("crane.glb");
    const CameraMotion motion = readCameraMotion(path, {}, "Riding", 10, 1000);
    EXPECT_DOUBLE_EQ(motion.seconds, 2.0);
    ASSERT_EQ(motion.cameras.size(), 21u) << "ten times per second, and both ends";
    for (size_t i = 0; i < motion.cameras.size(); ++i) {
        expectPoint(glm::vec3(motion.cameras[i].transform[3]), {0, 1 + 0.2f * static_cast<float>(i), 0});
        EXPECT_FLOAT_EQ(motion.cameras[i].yfov, 0.5f);
    }
    const CameraMotion moved = readCameraMotion(path, {}, "", 10, 1000);
    ASSERT_EQ(moved.cameras.size(), 21u);
    EXPECT_FLOAT_EQ(moved.cameras[0].yfov, 0.5f) << "the first camera that the animation moves";
    EXPECT_NE(motionError(path, "Still").find("does not move camera 'Still'"), std::string::npos)
        << motionError(path, "Still");
    EXPECT_NE(motionError(path, "None").find("has no camera 'None': it has 'Still', 'Riding'"),
              std::string::npos)
        << motionError(path, "None");
    EXPECT_NE(motionError(path, "Riding", 20).find("21 pictures, more than 20"), std::string::npos)
        << motionError(path, "Riding", 20);
}

} // namespace
} // namespace relume
