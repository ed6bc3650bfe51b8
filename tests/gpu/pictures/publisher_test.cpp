// What is published is what makeLightmap makes of the same patches, as halves, and only what changed is
// copied.
#include "assets/generate/generate.h"
#include "bake/show/publisher.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/read_image.h"

#include <gtest/gtest.h>
#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

namespace relume {
namespace {

using Texels = std::vector<uint64_t>;

/// Holds the patches of a scene, a light of random numbers and a publisher of them.
class Published {
public:
    Published(const Scene& scene, const BakeDesc& desc, uint32_t rings = 4)
        : baker_(makeBaker(scene, desc)), publisher_(testDevice(), baker_->patches(), {.rings = rings}),
          light_(randomLight(1)), values_(vk::makeBuffer(testDevice(), light_, "light")), rings_(rings),
          rtrad_(desc.rtrad) {}

    Publisher& publisher() { return publisher_; }
    const PatchSet& patches() const { return baker_->patches(); }
    const std::vector<glm::vec4>& light() const { return light_; }

    std::vector<glm::vec4> randomLight(uint32_t seed) const {
        std::mt19937 random(seed);
        std::lognormal_distribution<float> bright(0.0f, 1.5f);
        std::vector<glm::vec4> light(baker_->patches().scene.patches.size());
        for (glm::vec4& l : light)
            l = {bright(random), bright(random), -0.01f * bright(random), 1.0f};
        return light;
    }

    void update(const std::vector<uint32_t>& chunks, float unit) {
        unit_ = unit;
        publisher_.update({.values = values_, .chunks = chunks, .unit = unit});
    }
    void updateAll(float unit) {
        unit_ = unit;
        publisher_.update({.values = values_, .chunks = publisher_.allChunks(), .unit = unit});
    }

    /// Gives some chunks another light.
    void change(const std::vector<uint32_t>& chunks, uint32_t seed) {
        const std::vector<glm::vec4> other = randomLight(seed);
        for (uint32_t chunk : chunks)
            for (uint32_t i = chunk * shader::kChunk; i < (chunk + 1) * shader::kChunk; ++i)
                light_[i] = other[i];
        vk::upload(testDevice(), values_, light_.data(), light_.size() * sizeof(glm::vec4));
    }

    /// Brings slot 0's copy up to date and returns it.
    const Texels& copied() {
        slot_.resize(size_t{publisher_.size()} * publisher_.size());
        publisher_.publish(std::as_writable_bytes(std::span(slot_)), 0);
        return slot_;
    }

    /// Compares every texel with makeLightmap's, within what rounding to halves, once per ring, may do.
    void expectLightmap(const Texels& texels) const {
        const FloatImage expected =
            makeLightmap(patches(), light_,
                         {.quantity = rtrad_ ? Quantity::Radiance : Quantity::Lighting,
                          .dilate = rings_,
                          .rtrad = rtrad_});
        for (size_t t = 0; t < texels.size(); ++t) {
            const glm::vec4 texel = glm::unpackHalf4x16(texels[t]);
            ASSERT_EQ(texel.a, expected.planes[3][t]) << "texel " << t;
            for (int c = 0; c < 3; ++c) {
                const float want = expected.planes[static_cast<size_t>(c)][t] / unit_;
                ASSERT_NEAR(texel[c], want, std::abs(want) * 2e-3f + 1e-7f) << "texel " << t;
            }
        }
    }

private:
    std::unique_ptr<Baker> baker_;
    Publisher publisher_;
    std::vector<glm::vec4> light_;
    vk::Buffer values_;
    Texels slot_;
    float unit_ = 1.0f;
    uint32_t rings_;
    bool rtrad_;
};

// Makes a box half sunk into the floor of a closed room: texels of the floor lie inside it.
Scene sunkenBox() {
    SceneMaker scene(96);
    const int grey = scene.material(0.5f), lamp = scene.material(0.5f, 5.0f);
    scene.box(
        glm::vec3(0), {glm::vec3(4, 0, 0), glm::vec3(0, 4, 0), glm::vec3(0, 0, 4)},
        {grey, grey, grey, grey, lamp, grey},
        {glm::uvec2(16), glm::uvec2(22, 17), glm::uvec2(9), glm::uvec2(12), glm::uvec2(7), glm::uvec2(11)});
    // Its faces look outwards: the edges are left-handed.
    scene.box(glm::vec3(1, -1, 1), {glm::vec3(0, 2, 0), glm::vec3(2, 0, 0), glm::vec3(0, 0, 2)}, grey, 8);
    return scene.scene();
}

std::vector<Scene> scenes() {
    return {generateScene("cornell_small"), sunkenBox()};
}

TEST(Publisher, TexelsAreMakeLightmaps) {
    for (const Scene& scene : scenes()) {
        for (uint32_t size : {96u, 130u}) {
            Published published(scene, {.size = size});
            published.updateAll(1.0f);
            published.expectLightmap(published.copied());
        }
    }
}

TEST(Publisher, InvalidPatchesAreFilled) {
    Published published(sunkenBox(), {.size = 96});
    uint32_t invalid = 0;
    for (uint32_t i = 0; i < published.patches().count; ++i)
        invalid += (published.patches().scene.patches[i].flags & shader::kPatchSends) == 0;
    EXPECT_GT(invalid, 4u);
    published.updateAll(1.0f);
    const Texels& texels = published.copied();
    uint32_t filled = 0;
    for (size_t t = 0; t < texels.size(); ++t) {
        const uint32_t patch = published.patches().scene.texelToPatch[t];
        if (patch == shader::kNoPatch ||
            (published.patches().scene.patches[patch].flags & shader::kPatchSends) != 0)
            continue;
        ASSERT_LT(glm::unpackHalf4x16(texels[t]).a, 1.0f);
        filled += glm::unpackHalf4x16(texels[t]).a == 0.5f;
    }
    EXPECT_GT(filled, invalid / 2); // all but those in the middle of the box
}

TEST(Publisher, RtradsSeamsTakeTheDarkest) {
    Published published(generateScene("cornell_small"), {.size = 64, .rtrad = true});
    published.updateAll(1.0f);
    published.expectLightmap(published.copied());
}

// Some chunks are updated at a time, in any order: each time everything is as if all had been updated.
TEST(Publisher, PartialUpdatesAddUp) {
    for (const Scene& scene : scenes()) {
        Published published(scene, {.size = 128});
        published.updateAll(0.25f);
        std::mt19937 random(5);
        std::vector<uint32_t> order(published.publisher().allChunks().begin(),
                                    published.publisher().allChunks().end());
        ASSERT_GT(order.size(), 20u);
        for (uint32_t turn = 0; turn < 6; ++turn) {
            std::shuffle(order.begin(), order.end(), random);
            const std::vector<uint32_t> some(order.begin(), order.begin() + 1 + turn * turn / 2);
            published.change(some, 100 + turn);
            published.update(some, 0.25f);
            published.expectLightmap(published.copied());
        }
    }
}

TEST(Publisher, FirstUpdateTakesAll) {
    Published published(generateScene("cornell_small"), {.size = 96});
    published.update({3}, 1.0f);
    published.expectLightmap(published.copied());
}

// What the renderer is told to upload, and nothing else, makes its copy the present one, in every slot.
TEST(Publisher, AreasCoverWhatChangedAndNoMore) {
    Published published(generateScene("cornell_small"), {.size = 200});
    Publisher& publisher = published.publisher();
    published.updateAll(1.0f);
    std::array<Texels, Publisher::kSlots> slots;
    std::mt19937 random(9);
    for (uint32_t turn = 0; turn < 12; ++turn) {
        const uint32_t slot = turn < 3 ? turn : random() % Publisher::kSlots;
        Texels& texels = slots[slot];
        texels.resize(size_t{200} * 200);
        const Texels before = texels;
        const std::vector<TexelArea> areas =
            publisher.publish(std::as_writable_bytes(std::span(texels)), slot);
        published.expectLightmap(texels);
        std::vector<uint8_t> told(texels.size(), 0);
        uint64_t toldCount = 0;
        for (const TexelArea& a : areas) {
            toldCount += uint64_t{a.width} * a.height;
            for (uint32_t y = a.y; y < a.y + a.height; ++y)
                for (uint32_t x = a.x; x < a.x + a.width; ++x) {
                    EXPECT_EQ(told[y * 200 + x], 0) << "told twice";
                    told[y * 200 + x] = 1;
                }
        }
        for (size_t t = 0; t < texels.size(); ++t)
            ASSERT_TRUE(told[t] != 0 || texels[t] == before[t]) << t;
        if (turn < 3)
            EXPECT_EQ(toldCount, texels.size()); // never written before
        else
            EXPECT_LT(toldCount, texels.size());
        EXPECT_TRUE(publisher.publish(std::as_writable_bytes(std::span(texels)), slot).empty());
        const uint32_t chunk = static_cast<uint32_t>(random() % publisher.allChunks().size());
        published.change({chunk}, turn);
        published.update({chunk}, 1.0f);
    }
}

TEST(Publisher, SameLightChangesNothing) {
    Published published(generateScene("cornell_small"), {.size = 128});
    published.updateAll(2.0f);
    (void)published.copied();
    published.updateAll(2.0f);
    Texels texels(size_t{128} * 128, 77);
    EXPECT_TRUE(published.publisher().publish(std::as_writable_bytes(std::span(texels)), 0).empty());
    EXPECT_EQ(texels, Texels(size_t{128} * 128, 77));
    EXPECT_EQ(published.publisher().publish(std::as_writable_bytes(std::span(texels)), 1).size(), 1u);
    published.publisher().forget();
    EXPECT_EQ(published.publisher().publish(std::as_writable_bytes(std::span(texels)), 1).size(), 1u);
}

TEST(Publisher, ImagesHoldTheSameTexels) {
    if (!vk::SharedImage::possible(testDevice(), 200, 200)) GTEST_SKIP() << "images cannot be shared";
    Published published(generateScene("cornell_small"), {.size = 200});
    const vk::SharedImage image(testDevice(), {.width = 200, .height = 200, .name = "published"});
    published.updateAll(1.0f);
    EXPECT_EQ(published.publisher().publish(image, 1).size(), 1u);
    EXPECT_EQ(readImage(image), published.copied());
    for (uint32_t turn = 0; turn < 4; ++turn) {
        const uint32_t chunk = 11 * turn;
        published.change({chunk}, turn + 20);
        published.update({chunk}, 1.0f);
        const std::vector<TexelArea> areas = published.publisher().publish(image, 1);
        EXPECT_FALSE(areas.empty());
        EXPECT_TRUE(published.publisher().publish(image, 1).empty());
        published.expectLightmap(readImage(image));
        EXPECT_EQ(readImage(image), published.copied());
    }
}

TEST(Publisher, MeanIsOfShownPatches) {
    Published published(sunkenBox(), {.size = 96});
    published.updateAll(1.0f);
    glm::dvec3 sum(0.0);
    double count = 0;
    for (size_t t = 0; t < published.patches().scene.texelToPatch.size(); ++t) {
        const uint32_t p = published.patches().scene.texelToPatch[t];
        if (p == shader::kNoPatch || (published.patches().scene.patches[p].flags & shader::kPatchSends) == 0)
            continue;
        sum += glm::dvec3(published.light()[p]);
        count += 1;
    }
    const glm::vec3 mean = published.publisher().mean();
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[c], sum[c] / count, 1e-5 * std::abs(sum[c] / count));
}

// The light of a bake at its end lies within a half's range by far, however bright or dim its lamps are.
TEST(Publisher, UnitFollowsTheLamps) {
    for (float emission : {1e-6f, 20.0f, 3e7f}) {
        SceneMaker maker(64);
        const int white = maker.material(0.8f), lamp = maker.material(0.8f, emission);
        maker.box(glm::vec3(0), {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)},
                  {white, white, white, white, lamp, white},
                  {glm::uvec2(8), glm::uvec2(8), glm::uvec2(8), glm::uvec2(8), glm::uvec2(8), glm::uvec2(8)});
        const auto baker = makeBaker(maker.scene(), {.size = 64, .passes = 30});
        while (!baker->solver().done())
            baker->solver().step();
        const std::vector<glm::vec4>& light = baker->solver().light();
        Publisher publisher(testDevice(), baker->patches(), {});
        const float unit = publisher.unit();
        EXPECT_EQ(std::exp2(std::round(std::log2(unit))), unit);
        const vk::Buffer values = vk::makeBuffer(testDevice(), light, "light");
        publisher.update({.values = values, .chunks = publisher.allChunks(), .unit = unit});
        Texels texels(size_t{64} * 64);
        publisher.publish(std::as_writable_bytes(std::span(texels)), 0);
        float largest = 0;
        for (uint64_t t : texels)
            largest = std::max(largest, glm::unpackHalf4x16(t).x);
        EXPECT_GT(largest, 256.0f) << emission;
        EXPECT_LE(largest, 16384.0f) << emission;
    }
}

} // namespace
} // namespace relume
