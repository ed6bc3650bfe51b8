// Light probes by the program itself: baked with layers, weighed anew, and ended by Ctrl-C.
#include "app/offline/probe_files.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <csignal>
#include <string>

namespace relume {
namespace {

const std::string kProbedRoom = RELUME_SOURCE_DIR "/assets/scenes/cornell_layers.glb";

} // namespace

TEST(ProbeCommands, LayersAreWeighedAnewWithoutABake) {
    const TemporaryFolder folder;
    const std::string layers = folder.path("l.exr"), probes = folder.path("p.json");
    const ProcessResult baked = runRelume({"bake", kProbedRoom, "-o", layers, "--size", "64", "--error",
                                           "0.1", "--layers", "--probe-at", "0,1,0", "--probe-at",
                                           "0,1.5,0.2", "--probe-samples", "256", "--probes-out", probes});
    ASSERT_EQ(baked.status, 0) << baked.err;
    const ProbeSet before = readProbes(probes);
    ASSERT_FALSE(before.layers.empty());
    const std::string name = before.layers[0].light.name, weighed = folder.path("w.json");
    const ProcessResult mixed =
        runRelume({"mix", layers, "--probes-in", probes, "--probes-out", weighed, "--set", name + "*=3"});
    ASSERT_EQ(mixed.status, 0) << mixed.err;
    EXPECT_FALSE(contains(mixed.err, "device:")) << "it needs none";
    const ProbeSet after = readProbes(weighed);
    ASSERT_EQ(after.probes.size(), before.probes.size());
    for (size_t p = 0; p < after.probes.size(); ++p) {
        const double weight = before.layers[0].light.weight.g;
        const double gain = 2.0 * weight * before.layers[0].radiance[p][0].g;
        EXPECT_GT(gain, 0.0);
        EXPECT_NEAR(after.probes[p].radiance[0].g, before.probes[p].radiance[0].g + gain, 1e-4 * gain);
        EXPECT_EQ(after.probes[p].position, before.probes[p].position);
    }
    EXPECT_FLOAT_EQ(after.layers[0].light.weight.g, 3.0f * before.layers[0].light.weight.g);

    const ProcessResult missing =
        runRelume({"mix", layers, "--probes-in", folder.path("none.json"), "--probes-out", weighed});
    EXPECT_EQ(missing.status, 1);
    EXPECT_TRUE(contains(missing.err, "none.json")) << missing.err;
}

TEST(ProbeCommands, CtrlCEndsThemAndNothingIsWritten) {
    const TemporaryFolder folder;
    bool sent = false;
    const ProcessResult r =
        runRelume({"bake", kProbedRoom, "-o", folder.path("map.exr"), "--size", "64", "--error", "0.2",
                   "--probes", "0.2", "--probe-samples", "16384", "--probes-out", folder.path("p.json")},
                  [&](const std::string& err) {
                      if (sent || !contains(err, "light probes: ")) return 0;
                      sent = true;
                      return SIGINT;
                  });
    EXPECT_TRUE(sent) << r.err;
    EXPECT_EQ(r.status, 1);
    EXPECT_TRUE(contains(r.err, "interrupted: nothing was written")) << r.err;
    EXPECT_TRUE(folder.files().empty());
}

TEST(ProbeCommands, WhatCannotBeIsToldBeforeTheBake) {
    const TemporaryFolder folder;
    const std::string map = folder.path("map.exr"), probes = folder.path("p.json");
    const std::vector<std::vector<std::string>> wrong = {
        {"--probes", "0", "--probes-out", probes},
        {"--probes", "-1", "--probes-out", probes},
        {"--probes", "nan", "--probes-out", probes},
        {"--probes", "0.001", "--probes-out", probes},
        {"--probe-at", "1,2", "--probes-out", probes},
        {"--probes", "1"},
        {"--probes", "1", "--probes-out", map + ".png"},
        {"--probes-out", probes},
        {"--probes", "1", "--probe-at", "1,2,3", "--probes-out", probes},
        {"--probes", "1", "--probe-samples", "12", "--probes-out", probes}};
    for (std::vector<std::string> arguments : wrong) {
        const std::string shown = arguments[0] + " " + arguments[1];
        arguments.insert(arguments.begin(), {"bake", kProbedRoom, "-o", map});
        const ProcessResult r = runRelume(arguments);
        EXPECT_EQ(r.status, 2) << shown << ": " << r.err;
        EXPECT_FALSE(contains(r.err, "device:")) << shown << ": " << r.err;
    }
    const ProcessResult r = runRelume(
        {"bake", kProbedRoom, "-o", map, "--probes", "1", "--probes-out", folder.path("nowhere/p.json")});
    EXPECT_EQ(r.status, 1);
    EXPECT_TRUE(contains(r.err, "nowhere")) << r.err;
    EXPECT_FALSE(contains(r.err, "device:")) << r.err;
    EXPECT_TRUE(folder.files().empty());
}

} // namespace relume
