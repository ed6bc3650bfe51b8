#include "assets/images/float_image.h"
#include "renderer/exposure.h"
#include "renderer/shader_types.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace relume {
namespace {

TEST(Tone, EncodesAsTheStandardSays) {
    for (int i = 0; i <= 1000; ++i) {
        const float linear = static_cast<float>(i) / 1000.0f;
        const float encoded = shader::srgbEncode(glm::vec3(linear)).y;
        EXPECT_NEAR(encoded, srgbFromLinear(linear), 1e-6);
    }
}

TEST(Tone, NoneOnlyClamps) {
    EXPECT_EQ(shader::toneMap(glm::vec3(0.25f, 7.0f, -1.0f), shader::kToneNone),
              glm::vec3(0.25f, 1.0f, 0.0f));
}

// With both curves greys stay grey, more light is never darker, and all is between black and white.
TEST(Tone, CurvesKeepGreysAndOrder) {
    for (const uint32_t tone : {shader::kToneAces, shader::kToneAgx}) {
        float before = -1.0f;
        for (float ev = -16.0f; ev <= 8.0f; ev += 0.125f) {
            const glm::vec3 c = shader::toneMap(glm::vec3(std::exp2(ev)), tone);
            EXPECT_NEAR(c.x, c.y, 2e-3f) << tone << " " << ev;
            EXPECT_NEAR(c.z, c.y, 2e-3f) << tone << " " << ev;
            EXPECT_GE(c.y, before - 1e-4f)
                << tone << " " << ev; // AgX' polynomial is flat to 1e-4 at its ends
            EXPECT_GE(c.y, 0.0f);
            EXPECT_LE(c.y, 1.0f);
            before = c.y;
        }
        EXPECT_GT(before, 0.95f) << tone;
        EXPECT_LT(shader::toneMap(glm::vec3(0.0f), tone).y, 2e-3f) << tone;
    }
}

// The two curves put a grey card at known places: AgX at about half of the encoded scale, ACES where its
// rational curve at 0.18 says.
TEST(Tone, PutsMiddleGreyWhereTheCurvesSay) {
    EXPECT_NEAR(std::pow(shader::toneAgx(glm::vec3(0.18f)).y, 1.0f / 2.2f), 0.48f, 0.02f);
    EXPECT_NEAR(shader::toneAces(glm::vec3(0.18f)).y, 0.1056f, 0.001f);
}

TEST(Tone, AgxFadesBrightColoursToWhite) {
    const glm::vec3 dim = shader::toneAgx(glm::vec3(0, 0, 0.5f)),
                    bright = shader::toneAgx(glm::vec3(0, 0, 16));
    EXPECT_LT(dim.x, 0.2f * dim.z);
    EXPECT_GT(bright.x, 0.5f * bright.z);
}

// The short cut that pictures take is less than half a step of 8 bits away from both powers.
TEST(Tone, AgxAsSrgbIsAgxEncoded) {
    for (float ev = -16.0f; ev <= 8.0f; ev += 0.0625f) {
        const glm::vec3 light = std::exp2(ev) * glm::vec3(1.0f, 0.4f, 0.05f);
        const glm::vec3 expected = shader::srgbEncode(shader::toneAgx(light));
        const glm::vec3 shown = shader::toneMapAsSrgb(light, shader::kToneAgx);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(shown[c], expected[c], 0.4 / 255) << ev << " " << c;
    }
}

TEST(Tone, TheMetersCodeHoldsThirtyTwoEv) {
    EXPECT_EQ(shader::meterCode(0.0f), 0.0f);
    for (float ev = -19.5f; ev < 11.5f; ev += 0.3f)
        EXPECT_NEAR(shader::meterLog2(shader::meterCode(std::exp2(ev))), ev, 1e-4f);
    EXPECT_LT(shader::meterCode(1e30f), 255.0f);
    EXPECT_GE(shader::meterCode(1.1e-6f), 1.0f);
}

TEST(Tone, LuminanceOfWhiteIsOne) {
    EXPECT_NEAR(shader::luminance(glm::vec3(1.0f)), 1.0f, 1e-6f);
}

glm::vec4 cell(double light, float pixels) {
    return {static_cast<float>(std::log2(light)) * pixels, static_cast<float>(light) * pixels, pixels, 0.0f};
}

TEST(Exposure, BringsTheMeanToMiddleGrey) {
    EXPECT_NEAR(automaticExposure(std::vector{cell(0.18, 10)}), 0.0f, 1e-5f);
    EXPECT_NEAR(automaticExposure(std::vector{cell(0.36, 10), cell(0.36, 3)}), -1.0f, 1e-5f);
    EXPECT_NEAR(automaticExposure(std::vector{cell(0.09, 5), cell(0.36, 5)}), 0.0f,
                1e-5f); // mean of the logarithms
    EXPECT_NEAR(automaticExposure(std::vector{cell(1800, 5)}), -std::log2(1e4f), 1e-4f);
}

TEST(Exposure, IsNotLedByBlackOrNothing) {
    EXPECT_EQ(automaticExposure({}), 0.0f);
    EXPECT_EQ(automaticExposure(std::vector{glm::vec4(0.0f)}), 0.0f);
    const float deep = automaticExposure(std::vector{cell(0.18, 5), cell(1e-5, 5)});
    const float deeper = automaticExposure(std::vector{cell(0.18, 5), cell(1e-7, 5)});
    EXPECT_NEAR(deep, deeper, 1e-3f);
    EXPECT_LT(deep, 4.0f);
}

} // namespace
} // namespace relume
