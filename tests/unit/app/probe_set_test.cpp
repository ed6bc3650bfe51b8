// Light probes: what is asked for, and the file that they are in.
#include "app/offline/probe_options.h"
#include "app/offline/probe_files.h"
#include "assets/base/error.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <utility>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace relume {
namespace {

Harmonics harmonicsFrom(double first) {
    Harmonics harmonics;
    for (size_t i = 0; i < harmonics.size(); ++i)
        harmonics[i] = first + glm::dvec3(0.5, 0.25, -0.125) * static_cast<double>(i);
    return harmonics;
}

/// Two probes of two lights in a grid, as they are before they are summed.
ProbeSet twoLights() {
    ProbeSet set;
    set.grid = ProbeGrid{{0.1f, 1.0f, 2.0f}, 0.5f, {2u, 1u, 1u}};
    set.probes = {{{0.1f, 1, 2}, {}, 0.25}, {{0.6f, 1, 2}, {}, 0.75}};
    set.layers = {{{"Lamp \"A\"", {40, 20, 10}, {}, {}}, {harmonicsFrom(1), harmonicsFrom(2)}},
                  {{"rest", {1, 1, 1}, {}, {}}, {harmonicsFrom(3), harmonicsFrom(4)}}};
    set.layers[0].light.attributes = {{layer_attribute::kType, "point"},
                                      {layer_attribute::kUnit, "cd"},
                                      {layer_attribute::kIntensity, "20"},
                                      {layer_attribute::kColor, "2,1,0.5"}};
    set.layers[1].light.attributes = {{layer_attribute::kIntensity, "1"},
                                      {layer_attribute::kColor, "1,1,1"},
                                      {layer_attribute::kMembers, "B\nC"},
                                      {layer_attribute::kStale, "light 'B' moved"}};
    sumLayers(set);
    return set;
}

void expectSame(const Harmonics& a, const Harmonics& b) {
    for (size_t i = 0; i < a.size(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(a[i][c], b[i][c], 1e-6 * std::abs(b[i][c]));
}

std::string errorIn(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

/// Expects usage to be wrong, and to be told with this text.
void expectUsage(const std::function<void()>& action, const std::string& part) {
    try {
        action();
        ADD_FAILURE() << "no error: " << part;
    } catch (const UsageError& error) {
        EXPECT_TRUE(contains(error.what(), part)) << error.what();
    }
}

LayeredImage imageWith(const std::vector<std::pair<std::string, glm::vec3>>& weights) {
    LayeredImage image;
    for (const auto& [name, weight] : weights)
        image.layers.push_back({name, weight, {{layer_attribute::kIntensity, "5"}}, {}});
    return image;
}

TEST(ProbeSet, IsReadAsItWasWritten) {
    const ProbeSet set = twoLights();
    const ProbeSet read = parseProbes(probesJson(set, "p.json"), "p.json");
    ASSERT_TRUE(read.grid);
    EXPECT_EQ(read.grid->first, set.grid->first);
    EXPECT_EQ(read.grid->spacing, 0.5f);
    EXPECT_EQ(read.grid->counts, set.grid->counts);
    ASSERT_EQ(read.probes.size(), 2u);
    EXPECT_EQ(read.probes[1].position, set.probes[1].position);
    EXPECT_FALSE(read.probes[0].inside());
    EXPECT_TRUE(read.probes[1].inside());
    expectSame(read.probes[1].radiance, set.probes[1].radiance);
    ASSERT_EQ(read.layers.size(), 2u);
    for (size_t l = 0; l < 2; ++l) {
        EXPECT_EQ(read.layers[l].light.name, set.layers[l].light.name);
        EXPECT_EQ(read.layers[l].light.weight, set.layers[l].light.weight);
        EXPECT_EQ(read.layers[l].light.attributes, set.layers[l].light.attributes);
        expectSame(read.layers[l].radiance.at(1), set.layers[l].radiance[1]);
    }
}

TEST(ProbeSet, NamesOfAGroupMayHaveLineEnds) {
    ProbeSet set = twoLights();
    std::string& members = set.layers[1].light.attributes[layer_attribute::kMembers];
    members = "B\nC\\nD"; // B, and a name of two lines
    const std::string text = probesJson(set, "p.json");
    EXPECT_EQ(nlohmann::json::parse(text)["layers"][1]["members"], nlohmann::json({"B", "C\nD"}));
    EXPECT_EQ(parseProbes(text, "p.json").layers.at(1).light.attributes[layer_attribute::kMembers], members);
}

TEST(ProbeSet, WithoutLayersOrGridHasNeither) {
    ProbeSet set = twoLights();
    set.grid.reset();
    set.layers.clear();
    const std::string text = probesJson(set, "p.json");
    EXPECT_FALSE(contains(text, "layers"));
    const ProbeSet read = parseProbes(text, "p.json");
    EXPECT_FALSE(read.grid);
    EXPECT_TRUE(read.layers.empty());
    expectSame(read.probes[0].radiance, set.probes[0].radiance);
}

TEST(ProbeSet, TheSumIsThatOfWeightedLayers) {
    const ProbeSet set = twoLights();
    EXPECT_DOUBLE_EQ(set.probes[0].radiance[0].r, 40.0 * 1 + 3);
    EXPECT_DOUBLE_EQ(set.probes[1].radiance[2].g, 20.0 * 2.5 + 4.5);
}

TEST(ProbeSet, IsWeighedLikeTheLightmap) {
    ProbeSet set = twoLights();
    weighLike(set, imageWith({{"rest", glm::vec3(0.0f)}, {"Lamp \"A\"", {1, 2, 3}}}));
    EXPECT_DOUBLE_EQ(set.probes[0].radiance[0].g, 2.0);
    EXPECT_EQ(set.layers[0].light.weight, glm::vec3(1, 2, 3));
    EXPECT_EQ(set.layers[0].light.attributes.at(layer_attribute::kIntensity), "5");
    // Probes of other lights are refused, whichever side has more.
    EXPECT_TRUE(contains(errorIn([&] {
                             weighLike(set, imageWith({{"rest", {1, 1, 1}}}));
                         }),
                         "the lightmap has no light 'Lamp \"A\"'"));
    EXPECT_TRUE(contains(
        errorIn([&] {
            weighLike(set, imageWith({{"rest", {1, 1, 1}}, {"Lamp \"A\"", {1, 1, 1}}, {"Z", {1, 1, 1}}}));
        }),
        "the probes have no light 'Z'"));
    set.layers.clear();
    EXPECT_TRUE(contains(errorIn([&] { weighLike(set, imageWith({})); }), "the probes have no layers"));
}

TEST(ProbeSet, RefusesWhatIsOddInOneLine) {
    const std::string good = probesJson(twoLights(), "p.json");
    const std::pair<std::string, std::string> changes[] = {{"\"probes\":", "\"probe\":"},
                                                           {"\"probes\":[", "\"probes\":7,\"x\":["},
                                                           {"[2,1,1]", "[3,1,1]"},
                                                           {"[2,1,1]", "[2,1,0]"},
                                                           {"[2,1,1]", "[2,1,1.5]"},
                                                           {"\"spacing\":0.5", "\"spacing\":-1"},
                                                           {"\"backs\":0.25", "\"backs\":\"much\""},
                                                           {"\"position\":[", "\"position\":[1,"},
                                                           {"\"coefficients\":[[", "\"coefficients\":[["},
                                                           {"\"weight\":", "\"weights\":"},
                                                           {"\"intensity\":20", "\"intensity\":1e99"},
                                                           {"\"members\":[", "\"members\":[3,"},
                                                           {"\"name\":\"rest\"", "\"name\":null"},
                                                           {"}", ""}};
    for (const auto& [from, to] : changes) {
        std::string text = good;
        const size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        if (from == to) text.erase(text.find("], [", at), 3); // a coefficient less
        const std::string error = errorIn([&] { (void)parseProbes(text, "p.json"); });
        EXPECT_TRUE(error.starts_with("p.json: ")) << to << ": " << error;
        EXPECT_FALSE(contains(error, "\n")) << error;
    }
    for (const char* text : {"", "[]", "null", "{\"probes\":[]}", "{\"probes\":[1]}", "{\"probes\":{}}"})
        EXPECT_TRUE(errorIn([&] { (void)parseProbes(text, "p.json"); }).starts_with("p.json: ")) << text;
}

TEST(ProbeSet, IsWrittenWholeOrNotAtAll) {
    const TemporaryFolder folder;
    EXPECT_TRUE(
        contains(errorIn([&] { writeProbes(folder.path("nowhere/p.json"), twoLights()); }), "nowhere"));
    ProbeSet bright = twoLights();
    bright.probes[1].radiance[3].g = std::numeric_limits<double>::infinity();
    std::ofstream(folder.path("p.json")) << "before";
    EXPECT_TRUE(contains(errorIn([&] { writeProbes(folder.path("p.json"), bright); }), "is not finite"));
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"p.json"}));
    std::string kept;
    std::ifstream(folder.path("p.json")) >> kept;
    EXPECT_EQ(kept, "before");
    writeProbes(folder.path("p.json"), twoLights());
    EXPECT_EQ(readProbes(folder.path("p.json")).probes.size(), 2u);
    EXPECT_TRUE(contains(errorIn([&] { (void)readProbes(folder.path("none.json")); }), "none.json"));
}

ProbeOptions asked(double spacing, std::vector<std::string> at = {}, std::string output = "p.json") {
    ProbeOptions options;
    options.spacing = spacing;
    options.at = std::move(at);
    options.output = std::move(output);
    return options;
}

TEST(ProbePlans, WhatContradictsItselfIsRefused) {
    const auto check = [](const ProbeOptions& options) { checkProbeOptions(options, {}, false); };
    EXPECT_NO_THROW(check(asked(1)));
    EXPECT_NO_THROW(check({}));
    expectUsage([&] { check(asked(0)); }, "--probes-out: there are no probes");
    expectUsage([&] { check(asked(1, {}, "")); }, "nothing says where they go");
    expectUsage([&] { check(asked(1, {}, "p.txt")); }, "'p.txt'");
    for (const char* place : {"1,2", "1,2,3,4", "a,b,c", "", "nan,0,0", "1e30,0,0"})
        expectUsage([&] { check(asked(0, {place})); }, std::string("'") + place + "' is no place");
    expectUsage([&] { check(asked(0, {"1,2,3"}, "p.ktx2")); }, "needs a grid");
    EXPECT_NO_THROW(check(asked(0, {"1,2,3"}, "p.three.json")));
    ProbeOptions odd = asked(1);
    odd.samples = 12;
    expectUsage([&] { check(odd); }, "a multiple of 8");
    expectUsage([&] { check(asked(0, std::vector<std::string>(kMostProbes + 1, "0,0,0"))); },
                "probes are more than");
    expectUsage([&] { checkProbeOptions(asked(1), {}, true); }, "not with --quantity radiance");
    BakeSettings voxels;
    voxels.tracer = TracerKind::Voxel;
    expectUsage([&] { checkProbeOptions(asked(1), voxels, false); }, "not with voxels");
    BakeSettings layers;
    layers.solver.layers.on = true;
    EXPECT_NO_THROW(checkProbeOptions(asked(1), layers, false));
}

WorldMesh meshOf(std::vector<glm::vec3> positions) {
    WorldMesh mesh;
    mesh.positions = std::move(positions);
    return mesh;
}

TEST(ProbePlans, LayGridsInTheScenesBounds) {
    const WorldMesh mesh = meshOf({{0, 0, 0}, {4, 0, 0}, {4, 2, 3}});
    const ProbePlan plan = planProbes(asked(1), mesh);
    EXPECT_TRUE(plan.isGrid);
    EXPECT_EQ(plan.points.size(), 24u);
    EXPECT_EQ(planProbes(asked(100), mesh).points.size(), 1u);
    expectUsage([&] { (void)planProbes(asked(0.01), mesh); }, "a spacing of ");
    expectUsage(
        [&] {
            (void)planProbes(asked(1), meshOf({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}));
        },
        "has no size");
    expectUsage([&] { (void)planProbes(asked(1), meshOf({})); }, "has no size");
    const WorldMesh hall = meshOf({{0, 0, 0}, {3000, 0, 0}, {3000, 1, 1}});
    EXPECT_EQ(planProbes(asked(1), hall).points.size(), 3000u);
    expectUsage([&] { (void)planProbes(asked(1, {}, "p.ktx2"), hall); }, "has an edge above 2048");
    const ProbePlan single = planProbes(asked(0, {"1,2,3", "4,5,6"}), mesh);
    EXPECT_FALSE(single.isGrid);
    EXPECT_EQ(single.points.at(1), glm::vec3(4, 5, 6));
}

TEST(ProbePlans, CountRaysToLightsAndLightsToldApart) {
    Scene scene;
    scene.lights.resize(2);
    scene.lights[0].type = LightType::Point;
    scene.lights[1].type = LightType::Rectangle;
    scene.lights[1].size = {1, 1};
    ProbePlan plan;
    plan.points.resize(3);
    ProbeExtent extent = probeExtent(asked(1), plan, scene, false);
    EXPECT_EQ(extent.count, 3u);
    EXPECT_EQ(extent.samples, 4096u);
    EXPECT_EQ(extent.targets, 1 + kProbeLampSamples);
    EXPECT_EQ(extent.lights, 1u);
    extent = probeExtent(asked(1), plan, scene, true);
    EXPECT_EQ(extent.lights, 2u);
}

} // namespace
} // namespace relume
