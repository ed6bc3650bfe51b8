#include "app/live/lightmap_exchange.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

namespace relume {
namespace {

using Memory = std::array<std::vector<std::byte>, LightmapExchange::kSlots>;
using Spans = std::array<std::span<std::byte>, LightmapExchange::kSlots>;

Spans spansOf(Memory& memory, size_t bytes) {
    Spans spans;
    for (size_t slot = 0; slot < memory.size(); ++slot) {
        memory[slot].assign(bytes, std::byte{0});
        spans[slot] = memory[slot];
    }
    return spans;
}

TEST(LightmapExchange, GrantsNothingBeforeASetIsAccepted) {
    LightmapExchange exchange;
    EXPECT_FALSE(exchange.claim());
    exchange.offer({.set = 1, .size = 8});
    EXPECT_FALSE(exchange.claim());
    ASSERT_TRUE(exchange.takeOffer());
    EXPECT_FALSE(exchange.takeOffer()) << "an offer comes once";
    Memory memory;
    exchange.accept(1, spansOf(memory, 512));
    EXPECT_TRUE(exchange.claim());
}

TEST(LightmapExchange, OneIsShownOneWaitsForItsFenceOneIsWritten) {
    LightmapExchange exchange;
    Memory memory;
    exchange.offer({.set = 1, .size = 8});
    exchange.takeOffer();
    exchange.accept(1, spansOf(memory, 512));
    EXPECT_FALSE(exchange.take());

    const auto publish = [&] {
        const auto slot = exchange.claim();
        ASSERT_TRUE(slot);
        exchange.publish({.slot = *slot, .set = 1});
    };
    publish();
    EXPECT_FALSE(exchange.claim()) << "nobody has seen the first one yet";
    const auto first = exchange.take();
    ASSERT_TRUE(first);
    EXPECT_FALSE(exchange.take()) << "a map comes once";
    publish();
    const auto second = exchange.take();
    ASSERT_TRUE(second);
    EXPECT_NE(first->slot, second->slot);
    publish();
    const auto third = exchange.take();
    ASSERT_TRUE(third);
    EXPECT_FALSE(exchange.claim()) << "all three are read";
    exchange.release(1, first->slot);
    EXPECT_EQ(exchange.claim(), first->slot);
    exchange.giveUp(first->slot);
    EXPECT_EQ(exchange.claim(), first->slot);
}

TEST(LightmapExchange, ANewSetForgetsTheOldOne) {
    LightmapExchange exchange;
    Memory small, large;
    exchange.offer({.set = 1, .size = 8});
    exchange.takeOffer();
    exchange.accept(1, spansOf(small, 512));
    exchange.publish({.slot = *exchange.claim(), .set = 1});
    const auto shown = exchange.take();
    exchange.publish({.slot = *exchange.claim(), .set = 1});
    exchange.offer({.set = 2, .size = 16});
    EXPECT_FALSE(exchange.take()) << "what waited was of the old set";
    exchange.accept(1, {}); // too late: another one is wanted by now
    EXPECT_FALSE(exchange.claim());
    exchange.release(1, shown->slot);
    exchange.accept(2, spansOf(large, 2048));
    EXPECT_FALSE(exchange.retiredBefore(2));
    exchange.retire(1);
    EXPECT_TRUE(exchange.retiredBefore(2));
    for (int i = 0; i < 3; ++i) {
        const auto slot = exchange.claim();
        ASSERT_TRUE(slot);
        EXPECT_EQ(exchange.memory(*slot).size(), 2048u);
        exchange.publish({.slot = *slot, .set = 2});
        ASSERT_TRUE(exchange.take());
    }
}

TEST(LightmapExchange, ClosesImagesThatNobodyTook) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    {
        LightmapExchange exchange;
        exchange.offer({.set = 1, .size = 8, .shared = true, .fds = {ends[0], -1, -1}});
        EXPECT_NE(fcntl(ends[0], F_GETFD), -1);
    }
    EXPECT_EQ(fcntl(ends[0], F_GETFD), -1);
    close(ends[1]);
}

TEST(LightmapExchange, RefusedImagesAreToldOfOnce) {
    LightmapExchange exchange;
    exchange.offer({.set = 1, .size = 8, .shared = true});
    exchange.takeOffer();
    exchange.refuse(1);
    EXPECT_TRUE(exchange.refused());
    exchange.offer({.set = 2, .size = 8});
    EXPECT_FALSE(exchange.refused());
}

// Two threads work as in the viewer, without OpenGL and Vulkan: every map that is taken must be whole and
// newer than the one before. ThreadSanitizer looks at the rest.
TEST(LightmapExchange, NoMapIsTornInAThousandSwaps) {
    constexpr size_t kBytes = 4096;
    constexpr uint32_t kMaps = 1000;
    LightmapExchange exchange;
    Memory memory;
    exchange.offer({.set = 1, .size = 16});
    exchange.takeOffer();
    exchange.accept(1, spansOf(memory, kBytes));
    std::thread writer([&] {
        for (uint32_t n = 1; n <= kMaps;) {
            const auto slot = exchange.claim();
            if (!slot) {
                std::this_thread::yield();
                continue;
            }
            std::memset(exchange.memory(*slot).data(), static_cast<int>(n % 251), kBytes);
            exchange.publish({.slot = *slot, .set = 1, .bake = n});
            ++n;
        }
    });
    uint64_t newest = 0;
    std::optional<uint32_t> shown;
    uint32_t torn = 0, swaps = 0;
    while (newest < kMaps) {
        const auto map = exchange.take();
        if (!map) continue;
        EXPECT_GT(map->bake, newest);
        newest = map->bake;
        ++swaps;
        for (const std::byte b : memory[map->slot])
            torn += b != static_cast<std::byte>(newest % 251);
        if (shown) exchange.release(1, *shown);
        shown = map->slot;
    }
    writer.join();
    EXPECT_EQ(torn, 0u);
    EXPECT_EQ(swaps, kMaps);
}

TEST(LightmapExchange, OfEachLightTheNewestProbeIsTaken) {
    LightmapExchange exchange;
    EXPECT_FALSE(exchange.takeProbe());
    const LightKey lamp{LightKey::Kind::Lamp, 0, 0}, sky{LightKey::Kind::Sky, 0, 0};
    exchange.publish(LayerProbe{1, lamp, {}});
    exchange.publish(LayerProbe{1, sky, {}});
    exchange.publish(LayerProbe{2, lamp, {glm::vec3(3)}});
    EXPECT_TRUE(exchange.hasProbe());
    const std::optional<LayerProbe> first = exchange.takeProbe(), second = exchange.takeProbe();
    ASSERT_TRUE(first && second);
    EXPECT_EQ(first->key, lamp);
    EXPECT_EQ(first->request, 2u);
    EXPECT_EQ(second->key, sky);
    EXPECT_FALSE(exchange.hasProbe());
}

} // namespace
} // namespace relume
