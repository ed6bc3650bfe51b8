// This runs `relume bake` as a user does: it checks what it writes, what it refuses, and that a stop leaves
// nothing behind.
#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "assets/images/layered_exr.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace relume {
namespace {

using Strings = std::vector<std::string>;

/// Makes a furnace whose six charts leave room between each other.
Scene room(float albedo, float emission, uint32_t texels) {
    SceneMaker maker(64);
    maker.box({0, 0, 0}, {glm::vec3(2, 0, 0), {0, 2, 0}, {0, 0, 2}}, maker.material(albedo, emission),
              texels);
    return maker.scene();
}

class BakeCommand : public testing::Test {
protected:
    BakeCommand() { saveGlb(room(0.5f, 1.0f, 14), scene_); }

    /// Bakes by pairs unless told otherwise, under validation: `relume bake` fails when it complains.
    ProcessResult bake(const Strings& more) const {
        Strings arguments = {"bake", scene_, "--size", "64", "--validate"};
        if (std::find(more.begin(), more.end(), "--method") == more.end())
            arguments.insert(arguments.end(), {"--method", "pure"});
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runRelume(arguments);
    }
    std::string path(const std::string& name) const { return folder_.path(name); }
    /// Expects the scene and nothing else, or these too.
    void expectFiles(Strings names) const {
        names.push_back("room.glb");
        std::sort(names.begin(), names.end());
        EXPECT_EQ(folder_.files(), names);
    }

    TemporaryFolder folder_;
    const std::string scene_ = folder_.path("room.glb");
};

} // namespace

TEST_F(BakeCommand, WritesTheLightmapAndTellsHowItCameAbout) {
    const ProcessResult r = bake({"-o", path("map.exr"), "--passes", "3"});
    ASSERT_EQ(r.status, 0) << r.err;
    EXPECT_EQ(r.out, "");
    EXPECT_TRUE(contains(r.err, "wrote " + path("map.exr"))) << r.err;
    expectFiles({"map.exr"});
    const FloatImage map = readImage(path("map.exr"));
    EXPECT_EQ(map.width, 64u);
    EXPECT_EQ(map.height, 64u);
    EXPECT_EQ(map.channels, (Strings{"R", "G", "B", "coverage"}));
    // Three bounces give 1 + a + a^2.
    for (size_t i = 0; i < map.planes[0].size(); ++i) {
        if (map.planes[3][i] == 1.0f) {
            EXPECT_NEAR(map.planes[0][i], 1.75, 0.02);
        }
    }
    const auto attribute = [&](const std::string& name) {
        const auto found = map.attributes.find("relume:" + name);
        return found == map.attributes.end() ? "none" : found->second;
    };
    EXPECT_EQ(attribute("version"), RELUME_VERSION);
    EXPECT_EQ(attribute("scene"), "room.glb");
    EXPECT_EQ(attribute("method"), "pure");
    EXPECT_EQ(attribute("quantity"), "lighting");
    EXPECT_EQ(attribute("passes"), "3");
    EXPECT_TRUE(contains(attribute("settings"), "size=64 passes=3")) << attribute("settings");
    const double told = std::strtod(attribute("error").c_str(), nullptr);
    EXPECT_GT(told, 0.0);
    EXPECT_LT(told, 0.5);
}

TEST_F(BakeCommand, CoverageTellsPatchesFromFilledAndEmptyTexels) {
    const auto counts = [&](const Strings& more) {
        Strings arguments = {"-o", path("map.exr"), "--passes", "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProcessResult r = bake(arguments);
        EXPECT_EQ(r.status, 0) << r.err;
        std::array<uint32_t, 3> found{};
        const FloatImage map = readImage(path("map.exr"));
        for (size_t i = 0; i < map.planes[3].size(); ++i) {
            const float c = map.planes[3][i];
            EXPECT_TRUE(c == 0.0f || c == 0.5f || c == 1.0f) << c;
            ++found[static_cast<size_t>(2 * c)];
            const double expected = c == 0.0f ? 0.0 : 1.0; // a filled one is as its neighbours
            EXPECT_NEAR(map.planes[0][i], expected, 0.01);
        }
        return found;
    };
    const auto bare = counts({"--no-sew"}), sewn = counts({"--dilate", "1"}), wide = counts({});
    EXPECT_EQ(bare[2], 6u * 14u * 14u);
    EXPECT_EQ(bare[1], 0u);
    EXPECT_EQ(sewn[2], bare[2]);
    EXPECT_EQ(wide[2], bare[2]);
    EXPECT_GT(sewn[1], 50u);
    EXPECT_GT(wide[1], sewn[1]);
    EXPECT_GT(wide[0], 0u);
}

TEST_F(BakeCommand, RadianceIsEmissionAndAlbedoTimesLighting) {
    ASSERT_EQ(bake({"-o", path("l.exr"), "--passes", "2"}).status, 0);
    ASSERT_EQ(bake({"-o", path("r.exr"), "--passes", "2", "--quantity", "radiance"}).status, 0);
    const FloatImage lighting = readImage(path("l.exr")), radiance = readImage(path("r.exr"));
    for (size_t i = 0; i < lighting.planes[0].size(); ++i) {
        if (lighting.planes[3][i] == 1.0f) {
            EXPECT_NEAR(radiance.planes[0][i], 1.0f + 0.5f * lighting.planes[0][i], 1e-4);
        }
    }
}

// The command uses the hybrid when nothing is said about the method; its error is written, too.
TEST_F(BakeCommand, TheDefaultIsHybrid) {
    const ProcessResult r = runRelume({"bake", scene_, "--size", "64", "--validate", "--error", "0.02", "-o",
                                       path("map.exr"), "--error-map", path("error.exr")});
    ASSERT_EQ(r.status, 0) << r.err;
    expectFiles({"error.exr", "map.exr"});
    const FloatImage map = readImage(path("map.exr")), error = readImage(path("error.exr"));
    EXPECT_EQ(map.attributes.at("relume:method"), "hybrid");
    double squares = 0, count = 0, distance = 0;
    for (size_t i = 0; i < map.planes[0].size(); ++i) {
        if (map.planes[3][i] != 1.0f) continue;
        squares += double{error.planes[0][i]} * error.planes[0][i];
        distance += (map.planes[0][i] - 2.0) * (map.planes[0][i] - 2.0); // 1 / (1 - a)
        ++count;
    }
    EXPECT_GT(squares, 0.0);
    EXPECT_LT(std::sqrt(squares / count), 0.02 * 2.0);
    EXPECT_LT(std::sqrt(distance / count), 1.5 * 0.02 * 2.0);
}

TEST_F(BakeCommand, ErrorEndsTheBake) {
    const ProcessResult r = bake({"-o", path("map.exr"), "--error", "0.001", "--quantity", "radiance"});
    ASSERT_EQ(r.status, 0) << r.err;
    const FloatImage map = readImage(path("map.exr"));
    const auto centre = static_cast<size_t>(7 * 64 + 7); // of the first wall
    EXPECT_NEAR(map.planes[0][centre], 2.0, 0.02);
    EXPECT_LE(std::strtod(map.attributes.at("relume:error").c_str(), nullptr), 0.001);
}

TEST_F(BakeCommand, HalfAndPng) {
    ASSERT_EQ(bake({"-o", path("full.exr"), "--passes", "2"}).status, 0);
    ASSERT_EQ(bake({"-o", path("half.exr"), "--passes", "2", "--half"}).status, 0);
    ASSERT_EQ(bake({"-o", path("map.png"), "--passes", "1", "--reflectivity", "0.5"}).status, 0);
    expectFiles({"full.exr", "half.exr", "map.png"});
    const FloatImage full = readImage(path("full.exr")), half = readImage(path("half.exr"));
    EXPECT_LT(std::filesystem::file_size(path("half.exr")), std::filesystem::file_size(path("full.exr")));
    double largest = 0;
    for (size_t i = 0; i < full.planes[0].size(); ++i)
        largest = std::max(largest, std::abs(double{full.planes[0][i]} - half.planes[0][i]));
    EXPECT_GT(largest, 0.0);
    EXPECT_LT(largest, 1e-3);
    const FloatImage png = readImage(path("map.png"));
    EXPECT_EQ(png.width, 64u);
    EXPECT_NEAR(png.planes[0][7 * 64 + 7], 1.0, 0.01);
    EXPECT_EQ(bytesOf(path("map.png")).substr(1, 3), "PNG");
}

// bench trace --whole does what bake does, and its parts sum up.
TEST_F(BakeCommand, AWholeBakeIsToldPartByPart) {
    const ProcessResult r = runRelume({"bench", "trace", scene_, "--whole", "--sizes", "32,64", "--samples",
                                       "16", "--json", path("whole.json")});
    ASSERT_EQ(r.status, 0) << r.err;
    expectFiles({"whole.json"});
    EXPECT_NE(r.out.find("all but solve"), std::string::npos) << r.out;
    const auto json = nlohmann::json::parse(bytesOf(path("whole.json")));
    ASSERT_EQ(json["whole"].size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
        const auto& whole = json["whole"][i];
        EXPECT_EQ(whole["size"], i == 0 ? 32 : 64);
        EXPECT_GT(whole["patches"], 0);
        const auto& seconds = whole["seconds"];
        EXPECT_EQ(seconds.contains("start"), i == 0); // the process starts but once
        for (const char* phase : {"load", "unwrap", "atlas", "device", "cit", "patches", "tracer", "validity",
                                  "solver set-up", "solve", "write", "other"})
            EXPECT_TRUE(seconds.contains(phase)) << phase;
        double sum = 0;
        for (const auto& [phase, value] : seconds.items())
            if (phase != "sum" && phase != "all but solve") sum += double(value);
        EXPECT_NEAR(sum, seconds["sum"], 1e-9);
        EXPECT_NEAR(sum - double(seconds["solve"]), seconds["all but solve"], 1e-9);
    }
}

TEST_F(BakeCommand, StatisticsNameEverything) {
    const ProcessResult r = bake({"-o", path("map.exr"), "--passes", "2", "--json", path("map.json")});
    ASSERT_EQ(r.status, 0) << r.err;
    expectFiles({"map.exr", "map.json"});
    const auto json = nlohmann::json::parse(bytesOf(path("map.json")));
    for (const char* key : {"version", "scene", "output", "method", "size", "device", "tracer", "triangles",
                            "patches", "passes", "error", "converged", "pairs", "rays", "raysPerSecond",
                            "passSeconds", "seconds", "atlas"})
        EXPECT_TRUE(json.contains(key)) << key;
    EXPECT_EQ(json["size"], 64);
    EXPECT_EQ(json["passes"], 2);
    EXPECT_EQ(json["patches"], 6 * 14 * 14);
    EXPECT_EQ(json["triangles"], 12);
    EXPECT_EQ(json["passSeconds"].size(), 2u);
    EXPECT_GT(json["pairs"], 2u * 1000u * 1000u);
    for (const char* phase : {"start", "load", "cit", "solve", "write", "total"}) {
        ASSERT_TRUE(json["seconds"].contains(phase)) << phase;
        EXPECT_GT(json["seconds"][phase], 0.0) << phase;
    }
    double first = 0; // ray: whatever comes before is set up
    for (const char* phase : {"start", "load", "unwrap", "atlas", "device", "cit", "patches", "tracer"})
        first += json["seconds"].value(phase, 0.0);
    EXPECT_NEAR(json["secondsToFirstRay"], first, 1e-9);
    for (const char* kind :
         {"seconds", "cpuSeconds"}) { // with what is in no part, they are the whole process
        double sum = 0;
        for (const auto& [phase, value] : json[kind].items()) {
            EXPECT_GE(value, 0.0) << phase;
            if (phase != "total") sum += double(value);
        }
        EXPECT_TRUE(json[kind].contains("other"));
        EXPECT_NEAR(sum, json[kind]["total"], 1e-9);
    }
    // The numbers go to standard output, and nothing else does.
    const ProcessResult toOut = bake({"-o", path("map.exr"), "--passes", "1", "--json", "-"});
    ASSERT_EQ(toOut.status, 0) << toOut.err;
    EXPECT_EQ(nlohmann::json::parse(toOut.out)["passes"], 1);
}

TEST_F(BakeCommand, TwoRunsGiveTheSameFile) {
    ASSERT_EQ(bake({"-o", path("a.exr"), "--passes", "2"}).status, 0);
    ASSERT_EQ(bake({"-o", path("b.exr"), "--passes", "2", "--batch-ms", "2"}).status, 0);
    EXPECT_EQ(bytesOf(path("a.exr")), bytesOf(path("b.exr")));
}

TEST_F(BakeCommand, ASceneWithoutLightBakesBlackWithAWarning) {
    saveGlb(room(0.5f, 0.0f, 14), scene_);
    const ProcessResult r = bake({"-o", path("map.exr"), "--no-daylight"});
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_TRUE(contains(r.err, "the lightmap will be black")) << r.err;
    EXPECT_TRUE(contains(r.err, "emissive factor")) << r.err;
    const FloatImage map = readImage(path("map.exr"));
    EXPECT_EQ(*std::max_element(map.planes[0].begin(), map.planes[0].end()), 0.0f);
    EXPECT_EQ(*std::max_element(map.planes[3].begin(), map.planes[3].end()), 1.0f);
}

TEST_F(BakeCommand, ASceneWithoutLightIsLitByAPreview) {
    saveGlb(room(0.5f, 0.0f, 14), scene_);
    const ProcessResult strict = bake({"-o", path("map.exr"), "--strict"});
    EXPECT_EQ(strict.status, 1);
    EXPECT_TRUE(contains(strict.err, "nothing in it shines")) << strict.err;
    expectFiles({});
    const ProcessResult r = bake({"-o", path("map.exr"), "--scene-out", path("out.glb"), "--passes", "1"});
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_TRUE(contains(r.err, "a preview lamp lights it, which is not in the file")) << r.err;
    const FloatImage map = readImage(path("map.exr"));
    EXPECT_GT(*std::max_element(map.planes[0].begin(), map.planes[0].end()), 0.0f);
    EXPECT_TRUE(loadGltf(path("out.glb")).lights.empty()) << "a preview is in no file";
}

TEST_F(BakeCommand, AContradictionIsAUsageError) {
    const std::string out = path("map.exr");
    for (const Strings& more : {Strings{"--tracer", "sloppy"},
                                {"--quantity", "lighting", "--preset", "rtrad"},
                                {"--distance-factor", "0.5"},
                                {"--density", "4", "--no-unwrap"},
                                {"--size", "4"},
                                {"--passes", "0"},
                                {"--error", "0"},
                                {"--method", "magic"},
                                {"--window", "3", "--method", "static"},
                                {"--window", "64", "--method", "static"},
                                {"--window", "2", "--method", "pure"},
                                {"--threshold", "-1", "--method", "adaptive"},
                                {"--threshold", "0.1", "--method", "static"},
                                {"--node", "6", "--method", "adaptive"},
                                {"--threshold-ramp", "0", "--method", "adaptive"},
                                {"--cache", "links", "--method", "pure"},
                                {"--cache", "bits", "--method", "hybrid"},
                                {"--cache-memory", "much"},
                                {"--cache-memory", "-1M"},
                                {"--cache-memory", "0"},
                                {"--cache-memory", "1G", "--cache", "none"},
                                {"--method", "hybrid", "--preset", "rtrad"},
                                {"--samples", "0", "--method", "directional"},
                                {"--no-smooth", "--method", "directional"},
                                {"--samples", "64"},
                                {"--indirect-scale", "2"},
                                {"--footprint"},
                                {"--footprint", "--method", "static"},
                                {"--indirect-scale", "3", "--method", "hybrid"},
                                {"--picture", "x.jpg"},
                                {"--batch-ms", "1000"}}) {
        Strings arguments = {"-o", out};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProcessResult r = bake(arguments);
        EXPECT_EQ(r.status, 2) << more[0] << ": " << r.err;
        EXPECT_TRUE(contains(r.err, more[0])) << more[0] << ": " << r.err;
        EXPECT_FALSE(contains(r.err, "device:")) << r.err;
    }
    expectFiles({});
}

TEST_F(BakeCommand, WhatCannotBeWrittenIsToldBeforeTheBake) {
    std::ofstream(path("file")) << "in the way";
    for (const std::string& output : {path("nowhere/map.exr"), path("file/map.exr"), path("map.jpg"),
                                      path("map"), std::string("/proc/map.exr")}) {
        const ProcessResult r = bake({"-o", output});
        EXPECT_NE(r.status, 0) << output;
        EXPECT_TRUE(contains(r.err, output)) << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        EXPECT_FALSE(contains(r.err, "device:")) << r.err;
    }
    EXPECT_EQ(bake({"-o", path("map.exr"), "--json", path("nowhere/map.json")}).status, 1);
    EXPECT_EQ(folder_.files(), (Strings{"file", "room.glb"}));
}

TEST_F(BakeCommand, LightsBeyondTheMemoryForLayersShareOne) {
    const std::string layers = path("layers.exr");
    // Six walls shine, in three layers or four.
    const ProcessResult baked =
        bake({"--method", "hybrid", "--samples", "32", "--layers", "--layer-memory", "160K", "-o", layers});
    ASSERT_EQ(baked.status, 0) << baked.err;
    EXPECT_TRUE(contains(baked.err, "others share 'rest' (")) << baked.err;
    EXPECT_TRUE(contains(baked.err, "layer 'rest': error")) << baked.err;
    const ProcessResult mixed = runRelume({"mix", layers, "--set", "surface 5=3", "-o", path("map.exr")});
    EXPECT_EQ(mixed.status, 1);
    EXPECT_TRUE(contains(mixed.err, "light 'surface 5' is part of 'rest' and cannot be set apart"))
        << mixed.err;
    const ProcessResult list = runRelume({"mix", layers, "--set", "rest*=0.5", "--list"});
    EXPECT_EQ(list.status, 0) << list.err;
    EXPECT_TRUE(contains(list.out, " lights")) << list.out;
    const ProcessResult alone = bake({"--layer-memory", "160K", "-o", path("map.exr")});
    EXPECT_EQ(alone.status, 2);
}

TEST_F(BakeCommand, LayersTellHowGoodEachIsByItself) {
    const std::string layers = path("layers.exr"), json = path("layers.json");
    const ProcessResult baked = bake({"--method", "hybrid", "--error", "0.1", "--local-error", "0.5",
                                      "--layers", "-o", layers, "--json", json});
    ASSERT_EQ(baked.status, 0) << baked.err;
    const auto told = nlohmann::json::parse(bytesOf(json)).at("layers");
    const LayeredImage image = readLayeredExr(layers);
    ASSERT_EQ(told.size(), image.layers.size());
    double shares = 0;
    for (size_t i = 0; i < told.size(); ++i) {
        const auto error = told[i].at("error").get<double>();
        EXPECT_GT(error, 0.0) << i;
        EXPECT_LT(error, 1.0) << i;
        EXPECT_EQ(image.layers[i].attributes.at("relume:error"), fmt::format("{:.6g}", error)) << i;
        EXPECT_GE(told[i].at("linkSamplePasses"), 1) << i;
        shares += told[i].at("share").get<double>();
    }
    EXPECT_NEAR(shares, 1.0, 1e-3);
}

TEST_F(BakeCommand, AMissingSceneIsNamed) {
    const ProcessResult r = runRelume({"bake", path("none.glb"), "-o", path("map.exr")});
    EXPECT_EQ(r.status, 1);
    EXPECT_TRUE(contains(r.err, "none.glb")) << r.err;
    EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    expectFiles({});
}

TEST_F(BakeCommand, ASceneWithoutLightmapUvsNamesTheMend) {
    SceneMaker maker(64);
    maker.blocker({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, maker.material(0.5f, 1.0f));
    saveGlb(maker.scene(), scene_);
    const ProcessResult r = bake({"-o", path("map.exr"), "--no-unwrap"});
    EXPECT_EQ(r.status, 1) << r.err;
    EXPECT_TRUE(contains(r.err, "--no-unwrap")) << r.err;
    const ProcessResult strict = bake({"-o", path("map.exr"), "--strict"});
    EXPECT_EQ(strict.status, 1) << strict.err;
    EXPECT_TRUE(contains(strict.err, "1 of 1 meshes have no usable lightmap UVs")) << strict.err;
    expectFiles({});
    const ProcessResult made = bake({"-o", path("map.exr"), "--passes", "1"});
    EXPECT_EQ(made.status, 0);
    EXPECT_TRUE(contains(made.err, "lightmap UVs were made for 1 of 1 meshes")) << made.err;
}

// The preset is held against RTRad's own picture, through the command line and the reference's own tool.
TEST(BakeReference, PresetOnTheCommandLineMatchesRtradsPicture) {
    const std::string shared = RELUME_SHARED_DIR, tool = shared + "/tools/rtrad_dfpr.py",
                      picture = shared + "/references/rtrad/128_1x1.png",
                      lucy = shared + "/scenes/rtrad/CornellLucy.glb", python = "/usr/bin/python3";
    for (const std::string& file : {tool, picture, lucy}) {
        if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
    }
    if (runProgram(python, {"-c", "import numpy, OpenImageIO"}).status != 0)
        GTEST_SKIP() << "needs python3-openimageio and python3-numpy";
    const TemporaryFolder folder;
    const std::string map = folder.path("l.exr");
    const ProcessResult bake = runRelume({"bake", lucy, "--preset", "rtrad", "--method", "pure", "--passes",
                                          "2", "--size", "128", "--quantity", "radiance", "-o", map});
    ASSERT_EQ(bake.status, 0) << bake.err;
    const ProcessResult compared = runProgram(python, {tool, map, picture});
    ASSERT_EQ(compared.status, 0) << compared.err;
    ASSERT_TRUE(compared.out.starts_with("DFPR ")) << compared.out;
    EXPECT_LE(std::strtod(compared.out.c_str() + 5, nullptr), 0.001) << compared.out;
}

// Ctrl-C comes in the middle of the bounces; an older lightmap stays as it was.
TEST_F(BakeCommand, AnInterruptLeavesNothingBehind) {
    saveGlb(room(0.97f, 1.0f, 20), scene_);
    std::ofstream(path("map.exr")) << "older";
    for (const int number : {SIGINT, SIGTERM}) {
        bool sent = false;
        const ProcessResult r = runRelume({"bake", scene_, "-o", path("map.exr"), "--size", "256", "--error",
                                           "1e-6", "--json", path("map.json")},
                                          [&](const std::string& err) {
                                              if (sent || !contains(err, " patches\n")) return 0;
                                              sent = true;
                                              return number;
                                          });
        EXPECT_TRUE(sent);
        EXPECT_EQ(r.status, 1) << r.err;
        EXPECT_TRUE(contains(r.err, "nothing was written")) << r.err;
        expectFiles({"map.exr"});
        EXPECT_EQ(bytesOf(path("map.exr")), "older");
    }
}

} // namespace relume
