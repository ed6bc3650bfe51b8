// Light probes as three.js itself reads them, and a volume for Bevy as a reader of KTX 2.0 does.
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"
#include "tests/web/web_page.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relume {
namespace {

using Json = nlohmann::json;

// Returns the irradiance [lux] by the coefficients of our file [Ramamoorthi and Hanrahan 2001, equation 13].
double irradianceBy(const Json& coefficients, size_t channel, const Json& normal) {
    const double x = normal[0], y = normal[1], z = normal[2];
    const auto c = [&](size_t i) { return coefficients[i][channel].get<double>(); };
    constexpr double kC1 = 0.429043, kC2 = 0.511664, kC3 = 0.743125, kC4 = 0.886227, kC5 = 0.247708;
    return kC1 * c(8) * (x * x - y * y) + kC3 * c(6) * z * z + kC4 * c(0) - kC5 * c(6) +
           2 * kC1 * (c(4) * x * y + c(7) * x * z + c(5) * y * z) +
           2 * kC2 * (c(3) * x + c(1) * y + c(2) * z);
}

void runWell(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "-q");
    const ProcessResult result = runRelume(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
}

} // namespace

TEST(LightProbesForEngines, AreReadAsTheyWereMeant) {
    if (const std::string why = whyNoPages(); !why.empty()) GTEST_SKIP() << why;
    const TemporaryFolder folder;
    const std::string layers = folder.path("l.exr"), probes = folder.path("p.json");
    const std::string three = folder.path("p.three.json"), volume = folder.path("p.ktx2");
    runWell({"bake", std::string(RELUME_SOURCE_DIR) + "/assets/scenes/cornell_layers.glb", "-o", layers,
             "--layers", "--size", "64", "--error", "0.1", "--probes", "0.9", "--probe-samples", "512",
             "--probes-out", probes});
    for (const std::string& to : {three, volume})
        runWell({"mix", layers, "--probes-in", probes, "--probes-out", to});
    const ProcessResult node =
        runProgram("/usr/bin/env",
                   {"node", std::string(RELUME_SOURCE_DIR) + "/tests/web/light_probes.mjs", three, volume});
    ASSERT_EQ(node.status, 0) << node.err;
    const Json read = Json::parse(node.out), ours = Json::parse(bytesOf(probes));
    const Json& all = ours["probes"];
    ASSERT_EQ(read["probes"].size(), all.size());
    const size_t nx = ours["grid"]["counts"][0], ny = ours["grid"]["counts"][1],
                 nz = ours["grid"]["counts"][2];
    const Json& cubes = read["volume"];
    EXPECT_EQ(cubes["width"], nx);
    EXPECT_EQ(cubes["height"], 2 * ny);
    EXPECT_EQ(cubes["depth"], 3 * nz);
    EXPECT_EQ(cubes["format"], 97); // RGBA16F
    ASSERT_EQ(cubes["texels"].size(), nx * 2 * ny * 3 * nz * 4);
    const double brightest = irradianceBy(all[0]["coefficients"], 0, read["normals"][3]);
    EXPECT_GT(brightest, 0.0);
    size_t compared = 0;
    for (size_t p = 0; p < all.size(); ++p) {
        const Json& probe = read["probes"][p];
        EXPECT_EQ(probe["inside"], all[p]["inside"]);
        for (size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(probe["position"][c], all[p]["position"][c].get<double>(), 1e-6);
        for (size_t n = 0; n < read["normals"].size(); ++n)
            for (size_t c = 0; c < 3; ++c) {
                const double expected = irradianceBy(all[p]["coefficients"], c, read["normals"][n]);
                // Digits are lost where bands cancel each other.
                const double mean = 0.886227 * all[p]["coefficients"][0][c].get<double>();
                EXPECT_NEAR(probe["irradiance"][n][c], expected, 1e-5 * mean);
                if (n >= 6 || all[p]["inside"]) continue;
                // Sides come in the order +X, -X, +Y, -Y, +Z, -Z; negative ones are in the upper half of t.
                const size_t x = p % nx, y = p / nx % ny + n % 2 * ny, z = p / nx / ny + n / 2 * nz;
                const double texel = cubes["texels"][((z * 2 * ny + y) * nx + x) * 4 + c];
                const double lighting = std::max(expected, 0.0) / std::numbers::pi;
                EXPECT_NEAR(texel, lighting, 1e-3 * lighting + 1e-5 * mean) << p << ' ' << n;
                ++compared;
            }
    }
    EXPECT_GT(compared, all.size() * 6);
}

} // namespace relume
