#include "app/viewer/picture/light_previews.h"

#include "renderer/shader_types.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

namespace relume {
namespace {

using Kind = LightKey::Kind;
using Pixel = std::array<int, 3>;

const LightKey kLamp{Kind::Lamp, 0, 0}, kEmitter{Kind::Emitter, 3, 1};

/// Holds what pixels see: nothing, a white wall, a red one, and a white one that shines.
class PreviewTest : public testing::Test {
protected:
    PreviewTest() {
        materials_.resize(2);
        materials_[1].baseColor = {1, 0, 0, 1};
        surfaces_.resize(4);
        for (size_t i = 1; i < 4; ++i)
            surfaces_[i] = {.any = true,
                            .instance = static_cast<uint32_t>(i),
                            .material = i == 2 ? 1u : 0u,
                            .lightmapUv = {}};
        surfaces_[1].lightmapUv = glm::vec2(0.26f, 0.99f);
        surfaces_[2].lightmapUv = glm::vec2(1.0f, 0.0f);
    }
    Pixel pixel(size_t index, const LightKey& key = kLamp, const glm::vec3& colour = glm::vec3(1.0f)) const {
        const std::vector<uint8_t> pixels = previewPixels({surfaces_, light_, materials_, key, colour});
        EXPECT_EQ(pixels.size(), 16u);
        return {pixels[4 * index], pixels[4 * index + 1], pixels[4 * index + 2]};
    }

    LightPreviews::Surfaces surfaces_;
    std::vector<Material> materials_;
    std::vector<glm::vec3> light_{glm::vec3(0), glm::vec3(1), glm::vec3(0.5f), glm::vec3(0)};
};

TEST_F(PreviewTest, ShowsWhatIsLitInItsColours) {
    const Pixel white = pixel(1), red = pixel(2), dark = pixel(3);
    EXPECT_GT(white[1], 100);
    EXPECT_GT(red[0], red[1] + 30);
    EXPECT_LT(dark[0], 20);
    EXPECT_NE(pixel(0), dark) << "nothing is not a dark surface";
    const Pixel warm = pixel(1, kLamp, {1.0f, 0.5f, 0.2f});
    EXPECT_GT(warm[0], warm[2] + 20);
}

TEST_F(PreviewTest, AWeakLightShowsAsMuchAsAStrongOne) {
    const Pixel strong = pixel(1);
    for (glm::vec3& value : light_)
        value *= 1e-3f;
    EXPECT_EQ(pixel(1), strong);
    std::fill(light_.begin(), light_.end(), glm::vec3(0));
    EXPECT_LT(pixel(1)[0], 5) << "what lights nothing is black";
}

TEST_F(PreviewTest, AnEmitterGlows) {
    surfaces_[3].material = 1;
    const Pixel glowing = pixel(3, kEmitter);
    EXPECT_GT(glowing[1], pixel(1, kEmitter)[1]);
    surfaces_[3].instance = 4;
    EXPECT_LT(pixel(3, kEmitter)[0], 20) << "another instance of the same material";
}

TEST_F(PreviewTest, AsksForTheTexelsThatAreSeen) {
    LightPreviews previews;
    const ProbeRequest request = previews.see(surfaces_, 4);
    EXPECT_EQ(request.texels,
              (std::vector<uint32_t>{shader::kNoPatch, 3 * 4 + 1, 0 * 4 + 3, shader::kNoPatch}));
    EXPECT_GT(previews.see(surfaces_, 4).number, request.number) << "answers to this one come too late";
}

} // namespace
} // namespace relume
