// This tests what the renderer does before OpenGL: geometry, the camera that it chooses, includes and
// messages of shaders; and the options of `relume shot`.
#include "app/pictures/shot_options.h"
#include "assets/base/error.h"
#include "assets/generate/generate.h"
#include "assets/survey/level_rays.h"
#include "renderer/gl/glsl_source.h"
#include "renderer/good_view.h"
#include "renderer/scene_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

WorldMesh meshOf(const Scene& scene) {
    return flatten(scene, buildAtlas(scene, 256));
}

TEST(SceneGeometry, DrawsEveryTriangleOnceAndSharesVertices) {
    Scene scene = generateScene("cornell_geom");
    scene.materials[0].doubleSided = true;
    const WorldMesh mesh = meshOf(scene);
    const SceneGeometry geometry = makeGeometry(scene, mesh);
    EXPECT_EQ(geometry.indices.size(), mesh.positions.size());
    EXPECT_LT(geometry.vertices.size(), mesh.positions.size() / 2); // round things share nearly all
    uint32_t next = 0;
    bool doubleSided = false;
    for (const SceneDraw& draw : geometry.draws) {
        EXPECT_EQ(draw.firstIndex, next);
        EXPECT_EQ(draw.mapped, shader::kMappedAll);
        EXPECT_EQ(geometry.vertices[geometry.indices[draw.firstIndex]].instance, draw.instance);
        next += draw.indexCount;
        EXPECT_GE(draw.doubleSided, doubleSided); // behind the single-sided ones
        doubleSided = draw.doubleSided;
        for (uint32_t i = draw.firstIndex; i < next; ++i) {
            const glm::vec3 p = geometry.vertices[geometry.indices[i]].position;
            ASSERT_TRUE(glm::all(glm::greaterThanEqual(p, draw.bounds.low)) &&
                        glm::all(glm::lessThanEqual(p, draw.bounds.high)));
        }
    }
    EXPECT_EQ(next, geometry.indices.size());
    EXPECT_TRUE(doubleSided);
    const AtlasStatistics atlas = measureAtlas(scene, buildAtlas(scene, 256), 256);
    EXPECT_NEAR(geometry.medianDensity * 256.0f, atlas.texelDensityMean, 0.2 * atlas.texelDensityMean);
}

// Every generated scene is a room; none of its cameras is used.
TEST(GoodView, StandsInsideARoom) {
    for (const char* name : {"cornell_small", "cornell_geom", "gallery"}) {
        const WorldMesh mesh = meshOf(generateScene(name));
        const Box bounds = boundsOf(mesh);
        const ViewCamera camera = goodView(mesh, 16.0f / 9.0f);
        EXPECT_TRUE(glm::all(glm::greaterThan(camera.eye, bounds.low)) &&
                    glm::all(glm::lessThan(camera.eye, bounds.high)))
            << name;
    }
}

TEST(GoodView, StandsOutsideAnObject) {
    Scene scene = generateScene("cornell_small");
    // The tall box is alone: only backs are seen from its middle.
    scene.instances = {scene.instances.back()};
    const WorldMesh mesh = meshOf(scene);
    const Box bounds = boundsOf(mesh);
    const ViewCamera camera = goodView(mesh, 1.5f);
    EXPECT_FALSE(glm::all(glm::greaterThan(camera.eye, bounds.low)) &&
                 glm::all(glm::lessThan(camera.eye, bounds.high)));
    EXPECT_EQ(camera.target, bounds.centre());
    // It fills the picture: one of its corners is near the edge, and none beyond.
    float most = 0.0f;
    const glm::mat4 projection = projectionMatrix(camera, 1.5f) * viewMatrix(camera);
    for (const glm::vec3& corner : mesh.positions) {
        const glm::vec4 clip = projection * glm::vec4(corner, 1.0f);
        ASSERT_GT(clip.w, 0.0f);
        most = std::max({most, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
    }
    EXPECT_GT(most, 0.9f);
    EXPECT_LE(most, 0.96f);
}

TEST(GoodView, StandsInTheStreetsOfATown) {
    for (const char* name : {"town", "raw"}) {
        const Scene scene = generateScene(name);
        LightmapAtlas none;
        none.instances.resize(scene.instances.size());
        const WorldMesh mesh = flatten(scene, none);
        const ViewCamera camera = goodView(mesh, 16.0f / 9.0f);
        const LevelRays rays(mesh);
        EXPECT_NEAR(rays.trace(camera.eye, {0, -1, 0}).distance, 1.7f, 0.01f) << name << ": it stands";
        EXPECT_TRUE(std::isinf(rays.trace(camera.eye, {0, 1, 0}).distance)) << name << ": outdoors";
        EXPECT_GT(rays.clearance(camera.eye), 0.5f) << name;
        EXPECT_GT(rays.trace(camera.eye, forward(camera)).distance, 5.0f) << name << ": no wall in its face";
    }
}

TEST(GlslSource, ReplacesIncludesOnceAndNumbersFiles) {
    const gl::GlslSource source = gl::loadGlsl("gl/scene.frag", {"SAMPLES=4"});
    EXPECT_EQ(source.text.rfind("#version 450 core\n", 0), 0u);
    EXPECT_NE(source.text.find("#define SAMPLES 4\n"), std::string::npos);
    EXPECT_EQ(source.text.find("#include"), std::string::npos);
    EXPECT_EQ(source.files.front(), "gl/scene.frag");
    const std::vector<std::string>& files = source.files;
    EXPECT_EQ(std::count(files.begin(), files.end(), "lib/tone.glsl"), 1);
    EXPECT_THROW(gl::loadGlsl("gl/missing.frag", {}), Error);
}

TEST(GlslSource, NamesFileAndLineOfAnError) {
    const gl::GlslSource source{"", {"gl/scene.frag", "lib/tone.glsl"}};
    EXPECT_EQ(gl::describeLog(source, "0:3(2): warning: unused\n1:12(5): error: `x' undeclared\n"),
              "lib/tone.glsl:12: `x' undeclared");
    EXPECT_EQ(gl::describeLog(source, "0(7) : error C1008: undefined variable \"x\"\n"),
              "gl/scene.frag:7: C1008: undefined variable \"x\"");
    EXPECT_EQ(gl::describeLog(source, "out of registers"), "gl/scene.frag: out of registers");
    EXPECT_NE(gl::describeLog(source, ""), "");
}

ShotOptions shot() {
    ShotOptions options;
    options.bake.files.scene = "room.glb";
    options.bake.files.output = "shot.png";
    return options;
}

TEST(ShotOptions, ReadsSizesAndExposures) {
    ShotOptions options = shot();
    options.size = "640x360";
    options.exposure = "-1.5";
    options.view = "density";
    options.tone = "aces";
    const ShotRequest request = resolveShotOptions(options);
    EXPECT_EQ(request.width, 640u);
    EXPECT_EQ(request.height, 360u);
    EXPECT_FLOAT_EQ(request.draw.exposure.value(), -1.5f);
    EXPECT_EQ(request.draw.view, View::Density);
    EXPECT_EQ(request.draw.tone, ToneMap::Aces);
    EXPECT_FALSE(resolveShotOptions(shot()).draw.exposure);
}

TEST(ShotOptions, RefusesWhatIsWrong) {
    for (const char* size :
         {"640", "640x", "x360", "640x360x2", "8x360", "640x99999", "6.5x360", "-640x360", ""}) {
        ShotOptions options = shot();
        options.size = size;
        EXPECT_THROW(resolveShotOptions(options), UsageError) << size;
    }
    for (const char* point : {"1,2", "1,2,3,4", "1,2,", "a,b,c", "1,2,inf"}) {
        ShotOptions options = shot();
        options.eye = point;
        options.target = "0,0,0";
        EXPECT_THROW(resolveShotOptions(options), UsageError) << point;
    }
    for (const char* exposure : {"bright", "", "nan", "1000"}) {
        ShotOptions options = shot();
        options.exposure = exposure;
        EXPECT_THROW(resolveShotOptions(options), UsageError) << exposure;
    }
}

TEST(ShotOptions, AVideoHasItsEnding) {
    ShotOptions options = shot();
    options.mp4 = true;
    EXPECT_THROW(resolveShotOptions(options), UsageError) << "of one picture there is no video";
    options.turntable = 8;
    for (const auto& [output, named] :
         {std::pair("turn", "turn.mp4"), {"turn/", "turn.mp4"}, {"a.mp4", "a.mp4"}}) {
        options.bake.files.output = output;
        EXPECT_EQ(shotOutput(options), named);
        EXPECT_NO_THROW(resolveShotOptions(options)) << output;
    }
    options.size = "641x360";
    options.bake.files.output = "turn";
    EXPECT_THROW(resolveShotOptions(options), UsageError) << "a video's width is even";
    options.mp4 = false;
    EXPECT_EQ(shotOutput(options), "turn");
}

TEST(ShotOptions, ChoosesTheCameraAskedFor) {
    const Scene scene = generateScene("cornell_geom");
    const WorldMesh mesh = meshOf(scene);
    ASSERT_GE(scene.cameras.size(), 2u);
    ShotOptions options = shot();
    EXPECT_EQ(chooseCamera(options, scene, mesh, 1.5f).eye, glm::vec3(scene.cameras[0].transform[3]));
    options.camera = scene.cameras[1].name;
    EXPECT_EQ(chooseCamera(options, scene, mesh, 1.5f).eye, glm::vec3(scene.cameras[1].transform[3]));
    options.camera = "";
    options.eye = "1,-2.5,3e0";
    options.target = "0,0,0";
    options.fov = 90;
    const ViewCamera camera = chooseCamera(options, scene, mesh, 1.5f);
    EXPECT_EQ(camera.eye, glm::vec3(1, -2.5f, 3));
    EXPECT_NEAR(camera.yfov, 1.5708f, 1e-4f);
}

} // namespace
} // namespace relume
