// The sum of layers is held against other solvers and closed forms.
#include "tests/gpu/layered.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace relume {

TEST(Layers, HaveOneForEachLight) {
    Layered bake(room());
    ASSERT_EQ(bake.solver().layers().size(), 4u);
    bake.finish();
    for (const auto& layer : bake.solver().layers()) {
        EXPECT_TRUE(layer->has()) << layer->source.name;
        EXPECT_GT(layer->light, 0.0) << layer->source.name;
    }
    EXPECT_EQ(bake.solver().layers()[1]->source.name, "Bulb");
}

TEST(Layers, SumToWhatTheHybridBakes) {
    const BakeDesc precise{.passes = 0, .error = 0.01, .method = Method::Hybrid, .smooth = true};
    BakeDesc layered = precise;
    layered.layers = true;
    const Scene scene = room();
    Layered bake(scene, layered);
    bake.finish();
    EXPECT_LE(bake.progress().error, 0.01);
    EXPECT_LE(relativeError(bake.image(), bakeScene(scene, precise).lighting), 0.02);
}

// The noise of the links over which bounces converge must not stay in what is gathered over many.
TEST(Layers, ConvergeToWhatTheHybridConvergesTo) {
    BakeDesc many{.passes = 0, .method = Method::Hybrid, .samples = 1024};
    Scene scene = room();
    for (Material& material : scene.materials)
        material.emission = glm::vec3(0.0f);
    const FloatImage expected = bakeScene(scene, many).lighting;
    many.layers = true;
    Layered bake(scene, many);
    bake.finish();
    EXPECT_LE(relativeError(bake.image(), expected), 0.002);
}

// Lights at one place have all their indirect error in common, four times that of one of them. If layers were
// taken to be independent, patches would tell half of it.
TEST(Layers, TellOfEachPatchWhatTheyTellOfAll) {
    Scene scene = room();
    for (Material& material : scene.materials)
        material.emission = glm::vec3(0.0f);
    scene.lights.assign(4, lightAt(LightType::Point, {1.5f, 1.5f, 1.5f}, 3.0f, "Bulb"));
    BakeDesc desc = kQuick;
    desc.smooth = false;
    Layered bake(scene, desc);
    bake.finish();
    const std::vector<shader::Patch>& patches = bake.baker().patches().scene.patches;
    const std::vector<float> errors = bake.solver().errors();
    const Light4 light = bake.light();
    double squares = 0, sum = 0, count = 0;
    for (size_t i = 0; i < patches.size(); ++i) {
        if (!shader::patchIsShown(patches[i].flags)) continue;
        squares += double{errors[i]} * errors[i];
        sum += (light[i].r + light[i].g + light[i].b) / 3.0;
        count += 1;
    }
    ASSERT_GT(bake.progress().error, 0.0);
    EXPECT_NEAR(std::sqrt(squares / count) / (sum / count) / bake.progress().error, 1.0, 0.05);
}

// A step of many sample passes lasts: what is told of its rays meanwhile must not stand still, nor change the
// count.
TEST(Layers, CountRaysWhileDirectLightIsSampled) {
    BakeDesc desc = kQuick;
    desc.samples = 256;
    Layered quiet(room(), desc), asked(room(), desc);
    quiet.finish();
    uint64_t before = 0, rises = 0;
    for (LayerSolver& solver = asked.solver(); !solver.done();) {
        solver.setBatchMs(0.1);
        solver.step();
        const bool isDirect = solver.progress().pairs == 0;
        const uint64_t now = solver.raysSoFar();
        EXPECT_GE(now, before);
        rises += isDirect && now > before;
        before = now;
    }
    EXPECT_GT(rises, 3u);
    EXPECT_EQ(asked.progress().rays, quiet.progress().rays);
    EXPECT_TRUE(sameBytes(asked.light(), quiet.light()));
}

// Every wall of a closed box shines with e and reflects a: lighting is e / (1 - a) everywhere.
TEST(Layers, SumToTheFurnace) {
    constexpr float kAlbedo = 0.5f, kEmission = 2.0f;
    SceneMaker maker(64);
    const auto walls = maker.box({0, 0, 0}, {kX, kY, kZ}, maker.material(kAlbedo, kEmission), 16);
    Layered bake(maker.scene(), {.passes = 0, .error = 0.01, .method = Method::Hybrid, .layers = true});
    EXPECT_EQ(bake.solver().layers().size(), 6u);
    bake.finish();
    constexpr double kWanted = kEmission / (1.0 - kAlbedo);
    for (const TexelRect& wall : walls)
        EXPECT_NEAR(statistics(bake.image(), wall).mean, kWanted, 0.01 * kWanted);
}

// Direct light of a point without extent is E = I cos / r^2, and lighting is E / pi.
TEST(Layers, HoldLightForOneCandela) {
    SceneMaker maker(32);
    const TexelRect rect =
        maker.quad({-2, -2, 0}, 4.0f * kX, 4.0f * kY, maker.material(0.0f), glm::uvec2(16));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {0.25f, 0.5f, 1.5f}, 7.0f, ""));
    // The closed form is of the middles of texels.
    Layered bake(
        scene,
        {.size = 32, .passes = 1, .allOver = false, .method = Method::Hybrid, .samples = 16, .layers = true});
    bake.finish();
    const FloatImage image = bake.image();
    for (uint32_t row = 0; row < 16; ++row) {
        for (uint32_t column = 0; column < 16; ++column) {
            const glm::dvec3 p(-2 + (column + 0.5) * 0.25, -2 + (row + 0.5) * 0.25, 0);
            const glm::dvec3 d = glm::dvec3(0.25, 0.5, 1.5) - p;
            const double wanted = 7.0 * d.z / (std::numbers::pi * std::pow(glm::length(d), 3));
            EXPECT_NEAR(texel(image, rect, column, row), wanted, 1e-4 * wanted);
        }
    }
    double brightest = 0;
    for (const glm::vec4& v : bake.layer(0))
        brightest = std::max(brightest, double{v.r});
    double composite = 0;
    for (const glm::vec4& v : bake.light())
        composite = std::max(composite, double{v.r});
    EXPECT_NEAR(composite, 7.0 * brightest, 1e-5 * composite);
}

TEST(Layers, WeightsTraceNothingAndGatherNothing) {
    Layered bake(room());
    bake.finish();
    const uint64_t rays = bake.progress().rays, pairs = bake.progress().pairs;
    bake.scene.lights[0].intensity = 11.0f;
    bake.scene.lights[1].color = {1.0f, 0.3f, 0.0f};
    for (Material& material : bake.scene.materials)
        material.emission *= 0.25f;
    bake.edit();
    const Light4 edited = bake.light();
    bake.finish();
    EXPECT_EQ(bake.progress().rays, rays);
    EXPECT_EQ(bake.progress().pairs, pairs);
    EXPECT_TRUE(sameBytes(bake.light(), edited)) << "there at once";
    EXPECT_TRUE(sameBytes(edited, freshLight(bake.scene)));
}

TEST(Layers, SixteenRandomWeightsAreAFreshBake) {
    Scene scene = room();
    scene.lights.clear();
    for (int i = 0; i < 15; ++i)
        scene.lights.push_back(lightAt(LightType::Point, {0.2f + 0.1f * i, 1.7f - 0.08f * i, 1.4f}, 1.0f,
                                       "Bulb " + std::to_string(i)));
    Layered bake(scene);
    bake.finish();
    std::mt19937 random(7);
    std::uniform_real_distribution<float> number(0.1f, 10.0f);
    for (Light& light : bake.scene.lights) {
        light.intensity = number(random);
        light.color = {0.1f * number(random), 0.1f * number(random), 0.1f * number(random)};
    }
    bake.edit();
    const Light4 edited = bake.light(), fresh = freshLight(bake.scene);
    double most = 0;
    for (size_t i = 0; i < edited.size(); ++i)
        for (int k = 0; k < 3; ++k)
            most = std::max(most, std::abs(double{edited[i][k]} - fresh[i][k]));
    EXPECT_LT(most, 1e-3 * meanOf(fresh));
}

TEST(Layers, GoOnFromAState) {
    const BakeDesc desc{.passes = 0, .error = 0.02, .batchMs = 2.0, .method = Method::Hybrid, .layers = true};
    Layered whole(room(), desc);
    whole.finish();
    Layered first(room(), desc), second(room(), desc);
    while (first.progress().passes < whole.progress().passes / 2)
        first.solver().step();
    ASSERT_FALSE(first.solver().done());
    const SolverState state = first.solver().state();
    std::vector<StatePart> from = first.solver().stateParts(), to = second.solver().stateParts();
    ASSERT_EQ(from.size(), to.size());
    for (size_t i = 0; i < from.size(); ++i) {
        std::vector<uint8_t> bytes(from[i].bytes);
        from[i].read(bytes.data(), 0, bytes.size());
        to[i].write(bytes.data(), 0, bytes.size());
    }
    second.solver().restore(state);
    second.finish();
    EXPECT_TRUE(sameBytes(second.light(), whole.light()));
}

// What bounces change is told chunk by chunk: of large charts there are more chunks than anything else that
// is read back has values.
TEST(Layers, HaveRoomForWhatManyChunksTell) {
    constexpr uint32_t kEdge = 300; // 1,407 chunks
    SceneMaker maker(320);
    const TexelRect floor = maker.quad({0, 0, 0}, kX, kY, maker.material(0.5f), glm::uvec2(kEdge));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {0.5f, 0.5f, 1.0f}, 10.0f, "Lamp"));
    Layered bake(scene, {.size = 320, .passes = 0, .method = Method::Hybrid, .samples = 16, .layers = true});
    bake.finish();
    EXPECT_NEAR(texel(bake.image(), floor, kEdge / 2, kEdge / 2), 10.0 / std::numbers::pi, 0.01);
    EXPECT_LT(bake.progress().rays, uint64_t{kEdge} * kEdge * 100);
}

TEST(Layers, TellMemoryThatDoesNotDo) {
    BakeDesc desc = kQuick;
    desc.layerBytes = 1024;
    try {
        Layered bake(room(), desc);
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("layers of 4 lights"), std::string::npos) << error.what();
    }
}

} // namespace relume
