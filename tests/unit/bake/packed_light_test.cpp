#include <gtest/gtest.h>

#include <cmath>

#include "bake/base/shader_types.h"

namespace relume {
namespace {

TEST(PackedLight, isWithinHalfAStepOfWhatItWas) {
    const float step = std::ldexp(1.0f, -15);
    for (float light = 1e-15f; light < 1e15f; light *= 1.0371f) {
        const glm::vec3 in(light, 3.3f * light, 0.013f * light);
        const glm::vec3 out = shader::unpackLight(shader::packLight(in));
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(out[c], in[c], 1.001f * step * in[c]) << light;
    }
}

TEST(PackedLight, isUnbiased) {
    double in = 0, out = 0;
    for (uint32_t i = 0; i < 1000000; ++i) {
        const float light = 1.0f + float(i) * 1e-6f;
        in += light;
        out += shader::unpackLight(shader::packLight(glm::vec3(light))).y;
    }
    EXPECT_NEAR(out / in, 1.0, 1e-7);
}

TEST(PackedLight, keepsNothingAndMeetsNoLimitsBadly) {
    EXPECT_EQ(shader::unpackLight(shader::packLight(glm::vec3(0.0f))), glm::vec3(0.0f));
    EXPECT_EQ(shader::unpackLight(shader::packLight(glm::vec3(-1.0f))), glm::vec3(0.0f));
    const glm::vec3 most = shader::unpackLight(shader::packLight(glm::vec3(1e30f, 1.0f, 1e-30f)));
    EXPECT_GT(most.x, 1e19f);
    EXPECT_EQ(most.y, 1.0f);
    EXPECT_GE(most.z, 0.0f);
    EXPECT_LT(most.z, 1e-18f);
}

} // namespace
} // namespace relume
