// Layers: their sum against other solvers and closed forms, and edits against fresh bakes of what they lead
// to.
#include "bake/layer_solver.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/light_at.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

using Light4 = std::vector<glm::vec4>;

const glm::vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);

/// A closed room of 2 m with a plate that shines, a block on the floor, a bulb, a spot and a panel.
Scene room(float albedo = 0.6f) {
    SceneMaker maker(64);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(albedo), 16);
    maker.quad({0.6f, 0.6f, 1.9f}, 0.4f * kY, 0.4f * kX, maker.material(0.0f, 8.0f), glm::uvec2(4));
    maker.quad({1.2f, 0.3f, 0.7f}, 0.5f * kX, 0.9f * kY, maker.material(0.3f), glm::uvec2(8));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {1.5f, 1.5f, 1.5f}, 3.0f, "Bulb"));
    scene.lights.back().radius = 0.1f;
    scene.lights.push_back(lightAt(LightType::Spot, {0.4f, 1.2f, 1.8f}, 9.0f, "Spot"));
    scene.lights.back().color = {0.2f, 0.5f, 1.0f};
    scene.lights.push_back(lightAt(LightType::Rectangle, {1.3f, 1.0f, 1.7f}, 20.0f, "Panel"));
    scene.lights.back().size = {0.3f, 0.2f};
    return scene;
}

constexpr BakeDesc kQuick{
    .passes = 0, .method = Method::Hybrid, .samples = 32, .smooth = true, .layers = true};

/// A bake of layers whose scene is edited.
class Layered {
public:
    explicit Layered(Scene start, const BakeDesc& desc = kQuick)
        : scene(std::move(start)), baker_(makeBaker(scene, desc)) {}

    LayerSolver& solver() { return dynamic_cast<LayerSolver&>(baker_->solver()); }
    const SolverProgress& progress() { return solver().progress(); }
    void finish() {
        while (!solver().done())
            solver().step();
    }
    void edit(const LightMix& mix = {}) {
        while (!solver().atRest())
            solver().step();
        baker_->updateMaterials();
        solver().edit(mix);
    }
    Light4 light() { return solver().light(); }
    Light4 layer(size_t i) { return solver().layerLight(*solver().layers()[i]); }
    FloatImage image() const { return baker_->lightmap({.sew = false}); }

    Scene scene;

private:
    std::unique_ptr<Baker> baker_;
};

Light4 freshLight(const Scene& scene, const BakeDesc& desc = kQuick) {
    Layered fresh(scene, desc);
    fresh.finish();
    return fresh.light();
}

bool sameBytes(const Light4& a, const Light4& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(),
                                              [](const glm::vec4& x, const glm::vec4& y) { return x == y; });
}

double meanOf(const Light4& light) {
    double sum = 0;
    for (const glm::vec4& v : light)
        sum += double{v.r} + v.g + v.b;
    return sum / (3.0 * static_cast<double>(light.size()));
}

glm::mat4 at(glm::vec3 position) {
    return glm::translate(glm::mat4(1.0f), position);
}

} // namespace

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

// The noise of the links that bounces settle over must not stay in what is gathered over many.
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

// Direct light of a point without extent: E = I cos / r^2, lighting E / pi.
TEST(Layers, HoldLightForOneCandela) {
    SceneMaker maker(32);
    const TexelRect rect =
        maker.quad({-2, -2, 0}, 4.0f * kX, 4.0f * kY, maker.material(0.0f), glm::uvec2(16));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Point, {0.25f, 0.5f, 1.5f}, 7.0f, ""));
    Layered bake(scene, {.size = 32, .passes = 1, .method = Method::Hybrid, .samples = 16, .layers = true});
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

TEST(Layers, AMovedLightMakesItsOwnLayerAnew) {
    Layered bake(room());
    bake.finish();
    const Light4 plate = bake.layer(0), spot = bake.layer(2);
    const uint64_t rays = bake.progress().rays;
    bake.scene.lights[0].transform = at({0.7f, 0.5f, 1.2f});
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.layer(0), plate));
    EXPECT_TRUE(sameBytes(bake.layer(2), spot));
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
    // Shadow rays to this light alone: as many as it has samples.
    const uint64_t patches = plate.size();
    EXPECT_GT(bake.progress().rays, rays);
    EXPECT_LE(bake.progress().rays - rays, patches * kQuick.samples);
}

TEST(Layers, UndoRestoresTheBytesWithoutARay) {
    Layered bake(room());
    bake.finish();
    const Light4 first = bake.light();
    const Scene before = bake.scene;
    bake.scene.lights[0].transform = at({0.7f, 0.5f, 1.2f});
    bake.edit();
    bake.finish();
    EXPECT_FALSE(sameBytes(bake.light(), first));
    const uint64_t rays = bake.progress().rays, pairs = bake.progress().pairs;
    bake.scene = before;
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), first));
    EXPECT_EQ(bake.progress().rays, rays);
    EXPECT_EQ(bake.progress().pairs, pairs);
}

TEST(Layers, ADeletedLightLeavesTheOthersAsTheyWere) {
    Layered bake(room());
    bake.finish();
    const Light4 first = bake.light(), panel = bake.layer(3);
    const uint64_t rays = bake.progress().rays;
    const Light bulb = bake.scene.lights[0];
    bake.scene.lights.erase(bake.scene.lights.begin());
    bake.edit();
    bake.finish();
    EXPECT_EQ(bake.progress().rays, rays);
    EXPECT_TRUE(sameBytes(bake.layer(2), panel));
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
    bake.scene.lights.insert(bake.scene.lights.begin(), bulb);
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), first));
    EXPECT_EQ(bake.progress().rays, rays);
}

TEST(Layers, AnAddedLightIsAFreshBake) {
    Layered bake(room());
    bake.finish();
    bake.scene.lights.push_back(lightAt(LightType::Disc, {1.0f, 0.8f, 1.6f}, 30.0f, "Disc"));
    bake.scene.lights.back().radius = 0.2f;
    bake.edit();
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
}

TEST(Layers, ASkyThatTurnsIsAFreshBake) {
    SceneMaker maker(32);
    maker.quad({-1, -1, 0}, 2.0f * kX, 2.0f * kY, maker.material(0.5f), glm::uvec2(16));
    maker.quad({0, -1, 0}, 1.0f * kZ, 2.0f * kY, maker.material(0.5f), glm::uvec2(8));
    Scene scene = maker.scene();
    scene.sky.radiance = glm::vec3(2.0f);
    scene.sky.width = 4;
    scene.sky.height = 2;
    scene.sky.file = "bright to one side";
    scene.sky.pixels = {glm::vec3(9), glm::vec3(1), glm::vec3(1), glm::vec3(1),
                        glm::vec3(1), glm::vec3(1), glm::vec3(1), glm::vec3(1)};
    BakeDesc desc = kQuick;
    desc.size = 32;
    Layered bake(scene, desc);
    bake.finish();
    const Light4 first = bake.light();
    bake.scene.sky.rotation = 1.5f;
    bake.edit();
    bake.finish();
    EXPECT_FALSE(sameBytes(bake.light(), first));
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene, desc)));
}

TEST(Layers, AColouredSurfaceGathersLinksAnewWithoutARay) {
    Layered bake(room());
    bake.finish();
    const uint64_t rays = bake.progress().rays;
    bake.scene.materials[0].baseColor = {0.9f, 0.2f, 0.1f, 1.0f};
    bake.edit();
    bake.finish();
    EXPECT_EQ(bake.progress().rays, rays);
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
}

// Relative root mean square.
double distance(const Light4& a, const Light4& b) {
    double squares = 0, sum = 0;
    for (size_t i = 0; i < b.size(); ++i) {
        const glm::vec3 difference = glm::vec3(a[i]) - glm::vec3(b[i]);
        squares += glm::dot(difference, difference);
        sum += b[i].r + b[i].g + b[i].b;
    }
    return std::sqrt(squares / (3.0 * static_cast<double>(b.size()))) /
           (sum / (3.0 * static_cast<double>(b.size())));
}

TEST(Layers, AColouredSurfaceIsSeenInAllLightsAtOnce) {
    BakeDesc desc = kQuick;
    desc.live = true;
    desc.smooth = false; // each layer has a width of its own
    Layered bake(room(), desc);
    bake.finish();
    EXPECT_TRUE(bake.solver().current());
    const Light4 before = bake.light();
    const uint64_t rays = bake.progress().rays;
    for (const float green : {0.2f, 0.5f}) {
        bake.scene.materials[0].baseColor = {0.8f, green, 0.1f, 1.0f};
        bake.edit();
        EXPECT_FALSE(bake.solver().current());
        while (!bake.solver().current())
            bake.solver().step();
        const auto& layers = bake.solver().layers();
        EXPECT_TRUE(
            std::none_of(layers.begin(), layers.end(), [](const auto& layer) { return layer->has(); }));
    }
    const Light4 atOnce = bake.light();
    // A weight counts in it, too.
    bake.scene.lights[0].intensity *= 2.0f;
    bake.edit();
    while (!bake.solver().current())
        bake.solver().step();
    const Light4 stronger = bake.light();
    bake.finish();
    EXPECT_EQ(bake.progress().rays, rays);
    const Light4 after = bake.light();
    EXPECT_TRUE(sameBytes(after, freshLight(bake.scene, desc)));
    EXPECT_LT(distance(stronger, after), 1e-3) << "of the same links";
    EXPECT_GT(distance(before, after), 0.1);
    EXPECT_GT(distance(atOnce, after), 0.05);
}

TEST(Layers, ALightUnmutedWhileAllAreSeenAtOnceIsBaked) {
    BakeDesc desc = kQuick;
    desc.live = true;
    Layered bake(room(), desc);
    bake.edit({.muted = {{LightKey::Kind::Lamp, 0, 0}}, .solo = {}});
    bake.finish();
    bake.scene.materials[0].baseColor.g = 0.2f;
    bake.edit({.muted = {{LightKey::Kind::Lamp, 0, 0}}, .solo = {}});
    while (!bake.solver().current())
        bake.solver().step();
    bake.solver().step(); // a layer is under way
    bake.solver().edit({});
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene, desc)));
}

TEST(Layers, MuteAndSoloWeighLightsWithNothing) {
    Layered bake(room());
    bake.finish();
    const uint64_t pairs = bake.progress().pairs;
    const LightKey bulb{LightKey::Kind::Lamp, 0, 0};
    bake.edit({.muted = {}, .solo = {bulb}});
    const Light4 alone = bake.light();
    const Light4 layer = bake.layer(1);
    for (size_t i = 0; i < alone.size(); ++i)
        ASSERT_FLOAT_EQ(alone[i].g, 3.0f * layer[i].g);
    bake.edit({.muted = {bulb}, .solo = {}});
    Scene without = bake.scene;
    without.lights.erase(without.lights.begin());
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(without)));
    bake.finish();
    EXPECT_EQ(bake.progress().pairs, pairs);
}

TEST(Layers, ALightOfNoIntensityWaitsUntilItShines) {
    Scene scene = room();
    scene.lights[0].intensity = 0.0f;
    Layered bake(scene);
    bake.finish();
    EXPECT_FALSE(bake.solver().layers()[1]->has());
    bake.scene.lights[0].intensity = 2.0f;
    bake.edit();
    bake.finish();
    EXPECT_TRUE(bake.solver().layers()[1]->has());
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene)));
}

TEST(Layers, ALightInsideAWallIsDark) {
    Scene scene = room();
    scene.lights[0].transform = at({1.0f, 1.0f, -0.5f}); // below the floor
    scene.lights[0].radius = 0.0f;
    Layered bake(scene);
    bake.finish();
    for (const glm::vec4& v : bake.layer(1))
        ASSERT_EQ(glm::vec3(v), glm::vec3(0.0f));
    EXPECT_TRUE(bake.solver().layers()[1]->converged);
}

// A light that is dragged: each edit comes before the one before was followed to its end.
TEST(Layers, ALightThatIsDraggedIsSeenAndEndsAsAFreshBake) {
    BakeDesc desc = kQuick;
    desc.batchMs = 1.0;
    desc.live = true;
    Layered bake(room(), desc);
    bake.finish();
    uint64_t version = bake.solver().liveLight().version, seen = 0;
    for (int i = 0; i < 300; ++i) {
        bake.scene.lights[0].transform = at({0.3f + 0.004f * i, 0.5f, 1.2f});
        bake.solver().edit({});
        bake.solver().step();
        const LiveLight live = bake.solver().liveLight();
        EXPECT_TRUE(live.complete) << "what was shown stays until there is more";
        seen += live.version != version;
        version = live.version;
    }
    EXPECT_GT(seen, 3u);
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), freshLight(bake.scene, desc)));
}

TEST(Layers, AHundredRandomEditsAreUndone) {
    Layered bake(room());
    bake.finish();
    const Light4 first = bake.light();
    const Scene start = bake.scene;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> number(0.2f, 1.8f);
    std::vector<Scene> former;
    for (int i = 0; i < 100; ++i) {
        former.push_back(bake.scene);
        std::vector<Light>& lights = bake.scene.lights;
        switch (random() % 6) {
        case 0:
            if (!lights.empty()) lights[random() % lights.size()].intensity *= number(random);
            break;
        case 1:
            if (!lights.empty())
                lights[random() % lights.size()].transform =
                    at({number(random), number(random), number(random)});
            break;
        case 2:
            if (!lights.empty()) lights.erase(lights.begin() + static_cast<long>(random() % lights.size()));
            break;
        case 3:
            lights.push_back(lightAt(LightType::Point, {number(random), number(random), 1.0f}, 1.0f, "New"));
            break;
        case 4:
            bake.scene.materials[random() % bake.scene.materials.size()].baseColor.g = 0.5f * number(random);
            break;
        default:
            for (Material& material : bake.scene.materials)
                material.emission *= number(random);
        }
        bake.edit();
        for (uint32_t steps = random() % 12; steps > 0; --steps)
            bake.solver().step();
    }
    EXPECT_EQ(former.front().lights, start.lights);
    while (!former.empty()) {
        bake.scene = former.back();
        former.pop_back();
        bake.edit();
        if (random() % 4 == 0) bake.solver().step();
    }
    bake.finish();
    EXPECT_TRUE(sameBytes(bake.light(), first));
}

TEST(Layers, GoOnFromAState) {
    const BakeDesc desc{.passes = 0, .error = 0.02, .batchMs = 2.0, .method = Method::Hybrid, .layers = true};
    Layered whole(room(), desc);
    whole.finish();
    Layered first(room(), desc), second(room(), desc);
    for (int i = 0; i < 60 && !first.solver().done(); ++i)
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
