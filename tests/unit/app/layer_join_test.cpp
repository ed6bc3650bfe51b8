#include "app/offline/layer_join.h"

#include "app/offline/light_mix.h"
#include "assets/base/error.h"
#include "bake/layers/composite.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>

#include <spdlog/fmt/fmt.h>

namespace relume {
namespace {

const std::string kAllLights = "Lamp\nSun\nSky\n";

/// Makes a layer of one texel with what it tells of its error: without a sketch.
LayeredImage::Layer jobLayer(const char* name, double light, double variance, double error) {
    LayeredImage::Layer layer{name, glm::vec3(2.0f), {}, {1, 1, {}, {}, {}}};
    for (const char* channel : {"R", "G", "B"})
        layer.image.add(channel) = {0.5f};
    layer.attributes[job_attribute::kEstimate] =
        fmt::format("{} {} {} {} {}", light, variance, variance, error, 0.001);
    return layer;
}

LayerFile jobFile(const char* path, std::vector<LayeredImage::Layer> layers, int passes) {
    LayerFile file{path, {{1, 1, {}, {}, {}}, std::move(layers)}};
    for (const char* channel : {"R", "G", "B", "coverage"})
        file.image.composite.add(channel) = {1.0f};
    file.image.composite.attributes = {{"relume:version", "1"},
                                       {"relume:scene", "room.glb"},
                                       {"relume:settings", "size=1 samples=64 passes=0"},
                                       {"relume:passes", std::to_string(passes)},
                                       {"relume:error", "0.5"},
                                       {job_attribute::kLights, kAllLights},
                                       {job_attribute::kScene, "00000000000000ff"}};
    return file;
}

LayerFile lampAndSky() {
    return jobFile("a.exr", {jobLayer("Lamp", 3, 2, 0.02), jobLayer("Sky", 4, 1, 0.03)}, 7);
}
LayerFile sun() {
    return jobFile("b.exr", {jobLayer("Sun", 5, 3, 0.01)}, 5);
}

std::string whyNot(const LayerFile& a, const LayerFile& b) {
    try {
        joinLayers({a, b});
    } catch (const Error& error) {
        return error.what();
    }
    return "joined";
}

std::string whyNotWith(const std::function<void(LayerFile& b)>& change) {
    LayerFile b = sun();
    change(b);
    return whyNot(lampAndSky(), b);
}

TEST(JoinedLayers, StandInTheScenesOrderWithoutTheMarksOfJobs) {
    for (const bool turned : {false, true}) {
        const LayeredImage image =
            turned ? joinLayers({sun(), lampAndSky()}) : joinLayers({lampAndSky(), sun()});
        ASSERT_EQ(image.layers.size(), 3u);
        EXPECT_EQ(image.layers[0].name, "Lamp");
        EXPECT_EQ(image.layers[1].name, "Sun");
        EXPECT_EQ(image.layers[2].name, "Sky");
        EXPECT_FALSE(image.layers[1].attributes.contains(job_attribute::kEstimate));
        EXPECT_FALSE(image.composite.attributes.contains(job_attribute::kLights));
        EXPECT_FALSE(image.composite.attributes.contains(job_attribute::kScene));
        EXPECT_EQ(image.composite.attributes.at("relume:passes"), "12");
        EXPECT_TRUE(missingLights(image).empty());
    }
}

TEST(JoinedLayers, TellTheErrorOfTheirSum) {
    const LayeredImage image = joinLayers({lampAndSky(), sun()});
    std::vector<std::unique_ptr<Layer>> layers;
    std::vector<Layer*> all;
    for (const auto& [light, variance, error] :
         {std::tuple{3.0, 2.0, 0.02}, {5.0, 3.0, 0.01}, {4.0, 1.0, 0.03}}) {
        auto layer = std::make_unique<Layer>();
        layer->source.weight = glm::vec3(2.0f);
        layer->light = light;
        layer->directVariance = layer->indirectVariance = variance;
        layer->error = error;
        layer->iterationError = 0.001;
        all.push_back(layer.get());
        layers.push_back(std::move(layer));
    }
    const double error = compositeOf(all).error;
    EXPECT_GT(error, 0.005);
    EXPECT_EQ(image.composite.attributes.at("relume:error"), fmt::format("{:.6g}", error));
}

TEST(JoinedLayers, MayBeJoinedAgainWhereSomeAreMissing) {
    const LayeredImage part = joinLayers({jobFile("a.exr", {jobLayer("Sky", 4, 1, 0.03)}, 3),
                                          jobFile("b.exr", {jobLayer("Sun", 5, 3, 0.01)}, 5)});
    EXPECT_EQ(missingLights(part), std::vector<std::string>{"Lamp"});
    EXPECT_TRUE(part.composite.attributes.contains(job_attribute::kScene));
    const LayeredImage inTwo =
        joinLayers({{"part.exr", part}, jobFile("c.exr", {jobLayer("Lamp", 3, 2, 0.02)}, 4)});
    const LayeredImage atOnce = joinLayers({lampAndSky(), sun()});
    EXPECT_EQ(inTwo.composite.attributes, atOnce.composite.attributes);
    ASSERT_EQ(inTwo.layers.size(), 3u);
    EXPECT_EQ(inTwo.layers[0].name, "Lamp");
}

TEST(JoinedLayers, OfOneFileAreAsTheyAre) {
    LayerFile whole = sun();
    whole.image.composite.attributes.erase(job_attribute::kLights);
    const LayeredImage image = joinLayers({whole});
    EXPECT_EQ(image.composite.attributes, whole.image.composite.attributes);
    EXPECT_EQ(image.layers[0].attributes, whole.image.layers[0].attributes);
}

TEST(JoinedLayers, NeedNoErrorOfALightThatIsOff) {
    LayerFile b = sun();
    b.image.layers[0].weight = glm::vec3(0.0f);
    b.image.layers[0].attributes.clear();
    EXPECT_EQ(whyNot(lampAndSky(), b), "joined");
}

TEST(JoinedLayers, AreRefusedWhereOneIsThereTwice) {
    LayerFile b = jobFile("b.exr", {jobLayer("Sun", 5, 3, 0.01), jobLayer("Sky", 4, 1, 0.03)}, 5);
    EXPECT_EQ(whyNot(lampAndSky(), b),
              "b.exr: has layer 'Sky', which a.exr has, too: leave one of the two files out");
}

TEST(JoinedLayers, AreRefusedWhereTheirBakesDiffer) {
    EXPECT_EQ(
        whyNotWith([](LayerFile& b) {
            b.image.composite.width = 2;
            for (std::vector<float>& plane : b.image.composite.planes)
                plane.resize(2);
        }),
        "b.exr: cannot be joined with a.exr: it has 2 x 1 texels, not 1 x 1: bake both with the same --size");
    EXPECT_EQ(
        whyNotWith([](LayerFile& b) { b.image.composite.attributes["relume:version"] = "2"; }),
        "b.exr: cannot be joined with a.exr: it was baked by version 2, not 1: bake both by one program");
    EXPECT_EQ(
        whyNotWith([](LayerFile& b) { b.image.composite.attributes["relume:scene"] = "hall.glb"; }),
        "b.exr: cannot be joined with a.exr: it is of 'hall.glb', not of 'room.glb': bake both of one scene");
    EXPECT_EQ(
        whyNotWith([](LayerFile& b) {
            b.image.composite.attributes["relume:settings"] = "size=1 samples=32 passes=0";
        }),
        "b.exr: cannot be joined with a.exr: it was baked with other options (samples=32, not samples=64): "
        "bake both with the same ones");
    const std::string another = "b.exr: cannot be joined with a.exr: the scene was another one, or made into "
                                "patches by another kind of device: bake both anew";
    EXPECT_EQ(whyNotWith([](LayerFile& b) { b.image.composite.attributes[job_attribute::kScene] = "00fe"; }),
              another);
    EXPECT_EQ(
        whyNotWith([](LayerFile& b) { b.image.composite.attributes[job_attribute::kLights] = "Sun\n"; }),
        another);
    EXPECT_EQ(whyNotWith([](LayerFile& b) { b.image.composite.planes[3] = {0.5f}; }), another);
}

TEST(JoinedLayers, AreRefusedWhereAFileIsOfAllLights) {
    EXPECT_EQ(whyNotWith([](LayerFile& b) { b.image.composite.attributes.erase(job_attribute::kLights); }),
              "b.exr: has all lights of its scene, or was not baked with --lights: leave it out");
}

TEST(JoinedLayers, AreRefusedWhereAFileIsDamaged) {
    const std::string silent = "b.exr: layer 'Sun' does not tell its error: bake it again with --lights";
    EXPECT_EQ(whyNotWith([](LayerFile& b) { b.image.layers[0].attributes.clear(); }), silent);
    for (const char* text : {"", "1 2 3 4", "1 2 3 4 nan", "1 2 3 4 5 6", "1 2 3 4 x"})
        EXPECT_EQ(
            whyNotWith([&](LayerFile& b) { b.image.layers[0].attributes[job_attribute::kEstimate] = text; }),
            silent)
            << text;
    EXPECT_EQ(whyNotWith([](LayerFile& b) { b.image.layers[0].name = "Moon"; }),
              "b.exr: layer 'Moon' is of none of the lights that it names: bake with --lights");
    EXPECT_EQ(whyNotWith([](LayerFile& b) { b.image.composite.attributes["relume:passes"] = "many"; }),
              "b.exr: does not tell its number of passes: bake it again");
}

TEST(JoinedLayers, MayHaveOddNames) {
    LayerFile a = jobFile("a.exr", {jobLayer("two\nlines\\", 3, 2, 0.02)}, 1);
    LayerFile b = jobFile("b.exr", {jobLayer("\xff\\n", 3, 2, 0.02)}, 1);
    for (LayerFile* file : {&a, &b})
        file->image.composite.attributes[job_attribute::kLights] = "\xff\\\\n\ntwo\\nlines\\\\\n";
    const LayeredImage image = joinLayers({a, b});
    ASSERT_EQ(image.layers.size(), 2u);
    EXPECT_EQ(image.layers[0].name, "\xff\\n");
    EXPECT_EQ(image.layers[1].name, "two\nlines\\");
}

TEST(LayerSum, IsOfHalvesWhereTheFileHoldsThem) {
    LayeredImage image = joinLayers({sun()});
    image.layers[0].image.planes[0] = {1.0f + 0x1p-13f}; // between two halves
    roundLayers("out.exr", image, ExrType::Float);
    EXPECT_EQ(image.layers[0].image.planes[0][0], 1.0f + 0x1p-13f);
    roundLayers("out.exr", image, ExrType::Half);
    EXPECT_EQ(image.layers[0].image.planes[0][0], 1.0f);
    mixLayers(image, {});
    EXPECT_EQ(image.composite.planes[0][0], 2.0f);
}

} // namespace
} // namespace relume
