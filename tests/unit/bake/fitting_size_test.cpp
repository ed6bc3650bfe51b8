#include "bake/baker/fitting_size.h"

#include "bake/baker/host_room.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace relume {
namespace {

constexpr uint64_t kGiB = uint64_t{1} << 30;
constexpr SceneExtent kLevel{.triangles = 1'000'000};
constexpr uint32_t kLeastEdge = 512, kMostEdge = 8192;

BakeSettings layered() {
    BakeSettings settings;
    settings.solver.method = Method::Hybrid;
    settings.solver.layers.on = true;
    return settings;
}

TEST(FittingSize, TakesHalfOfTheRoomAndNoMore) {
    BakeSettings settings = layered();
    uint32_t before = kLeastEdge;
    for (const bool software : {false, true})
        for (uint64_t gib = 1; gib <= 128; gib *= 2) {
            const BakeRoom room{gib * kGiB, gib * kGiB, 16384, software};
            const uint32_t size = fittingSize(settings, kLevel, room, kLeastEdge, kMostEdge);
            const auto needs = [&](uint32_t edge) {
                settings.size = edge;
                return std::max(mostMemoryNeeds(settings, kLevel, software).total(),
                                hostNeeds(settings, kLevel));
            };
            EXPECT_TRUE(size == kLeastEdge || needs(size) <= room.device / 2) << gib << " GiB";
            EXPECT_TRUE(size == kMostEdge || needs(size + kSizeStride) > room.device / 2) << gib << " GiB";
            before = gib == 1 ? size : std::max(before, size);
            EXPECT_EQ(size, before) << "more memory takes no smaller one";
        }
    EXPECT_EQ(before, kMostEdge);
}

TEST(FittingSize, KeepsToTheDevicesImagesAndPages) {
    const BakeSettings settings = layered();
    const BakeRoom room{1024 * kGiB, 1024 * kGiB, 4096, false};
    EXPECT_EQ(fittingSize(settings, kLevel, room, kLeastEdge, kMostEdge), 4096u);
    EXPECT_EQ(fittingSize(settings, kLevel, room, kLeastEdge, 2048), 2048u) << "as many as are wanted";
    SceneExtent four = kLevel;
    four.pages = {4};
    EXPECT_EQ(fittingSize(settings, four, room, kLeastEdge, kMostEdge), 2048u) << "side by side on one image";
}

TEST(FittingSize, TheLeastIsTakenWhateverThereIs) {
    const BakeRoom none{};
    EXPECT_EQ(fittingSize(layered(), kLevel, none, kLeastEdge, kMostEdge), kLeastEdge);
    EXPECT_LE(fittingSize(layered(), kLevel, {1024 * kGiB, kGiB, 16384, false}, kLeastEdge, kMostEdge), 1024u)
        << "the host's memory counts, too";
    EXPECT_EQ(
        fittingSize(layered(), kLevel, {1024 * kGiB, std::nullopt, 16384, false}, kLeastEdge, kMostEdge),
        kMostEdge)
        << "a host that does not tell bounds nothing";
}

} // namespace
} // namespace relume
