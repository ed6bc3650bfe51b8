// Rectangles of objects that bring their own lightmap UVs, in a file that is saved anew.
#include "assets/atlas/rect_memory.h"

#include "assets/atlas/lightmap_atlas.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

constexpr uint32_t kPageEdge = 64, kGap = 2;

// A page with four rectangles and a free corner of 30 x 30 texels.
RectMemory fourObjects() {
    return {.size = kPageEdge,
            .pages = 1,
            .density = 10.0,
            .objects = {{"Floor", 0, {32, 32, 0, 0}},
                        {"Wall", 0, {30, 20, 34, 0}},
                        {"Wall", 0, {30, 10, 34, 22}},
                        {"Lamp", 0, {32, 30, 0, 34}}}};
}

bool liesApart(const PackedRect& a, const PackedRect& b) {
    return a.x + a.width + kGap <= b.x || b.x + b.width + kGap <= a.x || a.y + a.height + kGap <= b.y ||
           b.y + b.height + kGap <= a.y;
}

void expectApart(const RememberedRects& rects) {
    for (size_t i = 0; i < rects.objects.size(); ++i) {
        const PackedRect& rect = rects.objects[i].rect;
        EXPECT_LE(rect.x + rect.width, kPageEdge);
        EXPECT_LE(rect.y + rect.height, kPageEdge);
        for (size_t k = 0; k < i; ++k) {
            const bool onOnePage = rects.objects[i].page == rects.objects[k].page;
            EXPECT_TRUE(!onOnePage || liesApart(rect, rects.objects[k].rect)) << i << " " << k;
        }
    }
}

void expectSame(const PackedRect& a, const PackedRect& b) {
    EXPECT_TRUE(a.x == b.x && a.y == b.y && a.width == b.width && a.height == b.height);
}

TEST(RectMemory, WhatDidNotChangeStaysAndEqualNamesGoByTheirOrder) {
    const RectMemory memory = fourObjects();
    const std::vector<WantedRect> wanted = {
        {"Wall", 30, 20}, {"Lamp", 32, 30}, {"Wall", 30, 10}, {"Floor", 32, 32}};
    const std::optional<RememberedRects> again = placeAgain(memory, wanted, kPageEdge, kGap);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->coarser, 0u);
    for (const auto& [now, before] : {std::pair<size_t, size_t>{0, 1}, {1, 3}, {2, 2}, {3, 0}})
        expectSame(again->objects[now].rect, memory.objects[before].rect);
}

TEST(RectMemory, WhatGrewALittleStaysAndIsCoarser) {
    const std::vector<WantedRect> wanted = {
        {"Floor", 48, 46}, {"Wall", 30, 20}, {"Wall", 30, 10}, {"Lamp", 32, 30}};
    const std::optional<RememberedRects> again = placeAgain(fourObjects(), wanted, kPageEdge, kGap);
    ASSERT_TRUE(again);
    expectSame(again->objects[0].rect, {32, 32, 0, 0});
    EXPECT_EQ(again->coarser, 1u);
    EXPECT_DOUBLE_EQ(again->leastShare, 32.0 / 48.0);
}

TEST(RectMemory, WhatIsNewOrOfOtherProportionsFindsAFreePlace) {
    const std::vector<WantedRect> wanted = {
        {"Floor", 32, 32}, {"Wall", 12, 28}, {"Wall", 30, 10}, {"Lamp", 32, 30}, {"Chair", 10, 10}};
    const std::optional<RememberedRects> again = placeAgain(fourObjects(), wanted, kPageEdge, kGap);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->coarser, 0u);
    EXPECT_EQ(again->objects[1].rect.width, 12u);
    EXPECT_EQ(again->objects[4].rect.height, 10u);
    expectSame(again->objects[3].rect, {32, 30, 0, 34});
    expectApart(*again);
}

TEST(RectMemory, WhatIsTooLargeForItsPlaceIsCoarserBeforeAllMoves) {
    std::vector<WantedRect> wanted = {
        {"Floor", 32, 32}, {"Wall", 30, 20}, {"Wall", 30, 10}, {"Lamp", 32, 30}, {"Table", 40, 40}};
    const std::optional<RememberedRects> again = placeAgain(fourObjects(), wanted, kPageEdge, kGap);
    ASSERT_TRUE(again);
    EXPECT_EQ(again->coarser, 1u);
    EXPECT_DOUBLE_EQ(again->leastShare, 0.7);
    EXPECT_EQ(again->objects[4].rect.width, 28u);
    expectApart(*again);
    wanted.back() = {"Table", 62, 62};
    EXPECT_FALSE(placeAgain(fourObjects(), wanted, kPageEdge, kGap)) << "half of it does not fit";
}

TEST(RectMemory, AnotherFileBeginsAnew) {
    std::vector<WantedRect> wanted(40, {"Stone", 1, 1});
    EXPECT_FALSE(placeAgain(fourObjects(), wanted, kPageEdge, kGap)) << "too much is new";
    wanted = {{"Wall", 30, 20}};
    EXPECT_FALSE(placeAgain(fourObjects(), wanted, kPageEdge, kGap)) << "little is still used";
}

// A row of squares with the same UVs; the third one is so much larger than the others.
Scene squares(float larger, size_t count = 6) {
    Scene scene;
    Primitive quad = test::primitiveOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
    quad.texCoord1 = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const int square = test::addMesh(scene, quad, "Square");
    for (size_t i = 0; i < count; ++i) {
        const glm::mat4 place = glm::translate(glm::mat4(1), glm::vec3(4.0f * static_cast<float>(i), 0, 0));
        test::addInstance(scene, square, glm::scale(place, glm::vec3(i == 2 ? larger : 1.0f)));
        scene.instances.back().name = "Square " + std::to_string(i);
    }
    return scene;
}

TEST(RectMemory, AnAtlasKeepsRectanglesWhereOneObjectGrew) {
    RectMemory memory;
    const LightmapAtlas first = buildAtlas(squares(1.0f), 256, false, {}, &memory);
    ASSERT_TRUE(first.repacked);
    EXPECT_EQ(memory.objects.size(), 6u);
    const LightmapAtlas same = buildAtlas(squares(1.0f), 256),
                        next = buildAtlas(squares(1.5f), 256, false, {}, &memory),
                        anew = buildAtlas(squares(1.5f), 256),
                        more = buildAtlas(squares(1.5f, 7), 256, false, {}, &memory);
    bool moved = false;
    for (size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(same.instances[i].offset, first.instances[i].offset);
        EXPECT_EQ(next.instances[i].offset, first.instances[i].offset);
        EXPECT_EQ(next.instances[i].scale, first.instances[i].scale);
        EXPECT_EQ(more.instances[i].offset, first.instances[i].offset);
        moved = moved || anew.instances[i].scale != first.instances[i].scale;
    }
    EXPECT_TRUE(moved) << "without a memory all is packed anew";
    EXPECT_EQ(memory.objects.size(), 7u);
    EXPECT_EQ(next.warnings.size(), first.warnings.size() + 1) << "it is told that one is coarser";
    const LightmapAtlas larger = buildAtlas(squares(1.5f), 128, false, {}, &memory);
    EXPECT_EQ(memory.size, 128u) << "another size begins anew";
    EXPECT_EQ(larger.warnings.size(), first.warnings.size());
}

} // namespace
} // namespace relume
