// This checks bakes whose buffers are in part in the host's memory.
#include "bake/baker/make_solver.h"
#include "bake/baker/memory_plan.h"
#include "bake/gather/link_cache.h"
#include "bake/layers/layer_store.h"
#include "bake/vk/commands.h"
#include "tests/gpu/bake_comparison.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/light_at.h"
#include "tests/message_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

namespace relume {
namespace {

constexpr uint32_t kSpillEdge = 96;

/// Makes a closed room with a mesh light and a panel, so that all kinds of light have their buffers. Each
/// texel of a map of kSpillEdge becomes scale * scale of them.
Scene spillRoom(uint32_t scale = 1) {
    SceneMaker maker(scale * kSpillEdge);
    const int wall = maker.material(0.6f);
    const glm::uvec2 texels = scale * glm::uvec2(46, 27); // of a wall: eight tenths of the map are covered
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, {wall, wall, wall, wall, wall, wall},
              {texels, texels, texels, texels, texels, texels});
    maker.quad({0.4f, 0.8f, 1.9f}, 0.4f * kY, 0.3f * kX, maker.material(0.0f, 5.0f), glm::uvec2(8));
    Scene scene = maker.scene();
    scene.lights.push_back(lightAt(LightType::Rectangle, {1.5f, 0.5f, 1.7f}, 10.0f, "Panel"));
    scene.lights.back().size = {0.2f, 0.2f};
    return scene;
}

vk::Device::Desc withLimit(uint64_t bytes) {
    return {.select = std::to_string(testDevice().info().index), .validation = true, .memoryLimit = bytes};
}

struct SpillCase {
    const char* name;
    BakeDesc desc;
};

void PrintTo(const SpillCase& one, std::ostream* stream) {
    *stream << one.name;
}

class SpillOf : public testing::TestWithParam<SpillCase> {};

/// Bakes to the end, as settings say, and returns what the host then holds for the device.
uint64_t bakeToEnd(Baker& baker) {
    while (!baker.solver().done())
        baker.solver().step();
    const vk::MemoryLedger& ledger = testDevice().ledger();
    return ledger.bytes() - ledger.deviceBytes();
}

FloatImage lightingOf(const Baker& baker) {
    return baker.lightmap({.quantity = Quantity::Lighting, .sew = false});
}

} // namespace

TEST_P(SpillOf, TheBytesAreTheSameAndTheDeviceHoldsLess) {
    const Scene scene = spillRoom();
    BakeDesc desc = GetParam().desc;
    desc.size = kSpillEdge;
    desc.passes = 0;
    desc.samples = 64;
    std::unique_ptr<Baker> baker = makeBaker(scene, desc);
    const uint64_t unspilled = bakeToEnd(*baker);
    const FloatImage plain = lightingOf(*baker);
    uint64_t before = 0;
    const Spill most = mostSpill(settingsOf(desc).solver);
    for (int spill = 1; spill <= static_cast<int>(most); ++spill) {
        SCOPED_TRACE(spill);
        desc.spill = static_cast<Spill>(spill);
        baker.reset();
        baker = makeBaker(scene, desc);
        const uint64_t held = bakeToEnd(*baker) - unspilled;
        const SceneExtent extent = extentOf(scene, baker->patches().scene.mesh);
        const MemoryNeeds needs = memoryNeeds(settingsOf(desc), extent,
                                              {.chunkCount = baker->patches().chunkCount(),
                                               .texels = uint64_t{kSpillEdge} * kSpillEdge,
                                               .software = testDevice().info().software()});
        EXPECT_EQ(held, needs.spilled);
        EXPECT_EQ(held, baker->spilledBytes());
        EXPECT_GE(held, before) << "each value spills what the former ones do, and more where there is more";
        before = held;
        EXPECT_TRUE(sameBytes(lightingOf(*baker), plain));
    }
    EXPECT_GT(before, 0u);
}

INSTANTIATE_TEST_SUITE_P(
    Methods, SpillOf,
    testing::Values(
        SpillCase{"hybrid", {.method = Method::Hybrid, .smooth = true}},
        SpillCase{"hybridOnDevice", {.method = Method::Hybrid, .smooth = true, .deviceGather = true}},
        SpillCase{"hybridRoughLive", {.method = Method::Hybrid, .live = true}},
        SpillCase{"hybridCoarse", {.method = Method::Hybrid, .smooth = true, .indirectScale = 2}},
        SpillCase{"footprint", {.method = Method::Directional, .footprint = true}},
        SpillCase{"layers", {.method = Method::Hybrid, .smooth = true, .layers = true}},
        SpillCase{"layersOnDevice",
                  {.method = Method::Hybrid, .smooth = true, .deviceGather = true, .layers = true}}),
    [](const auto& test) { return std::string(test.param.name); });

// Layers that the device has no room for are no worse, nor are there fewer of them.
TEST(Spill, LayersBeyondTheDeviceAreOnTheHost) {
    const Scene scene = spillRoom();
    BakeDesc desc{.size = kSpillEdge, .passes = 0, .method = Method::Hybrid, .samples = 64, .layers = true};
    const vk::MemoryLedger& ledger = testDevice().ledger();
    std::unique_ptr<Baker> baker = makeBaker(scene, desc);
    (void)bakeToEnd(*baker);
    const FloatImage plain = lightingOf(*baker);
    const uint64_t all = ledger.bytesOf(kLayerLightOwner);
    EXPECT_EQ(ledger.deviceBytesOf(kLayerLightOwner), all);
    ASSERT_EQ(baker->layers()->layers().size(), 2u);
    baker.reset();

    desc.layerDeviceBytes = all / 2;
    baker = makeBaker(scene, desc);
    (void)bakeToEnd(*baker);
    EXPECT_TRUE(sameBytes(lightingOf(*baker), plain));
    EXPECT_EQ(ledger.bytesOf(kLayerLightOwner), all);
    EXPECT_LE(ledger.deviceBytesOf(kLayerLightOwner), all / 2);
    EXPECT_GT(ledger.deviceBytesOf(kLayerLightOwner), 0u);
}

// Links that the device has no room for are kept in the host's memory: no ray more is traced.
TEST(Spill, LinksBeyondTheDeviceAreKeptOnTheHost) {
    const Scene scene = spillRoom();
    const vk::MemoryLedger& ledger = testDevice().ledger();
    for (const bool layers : {false, true}) {
        SCOPED_TRACE(layers);
        BakeDesc desc{.size = kSpillEdge,
                      .passes = 0,
                      .method = Method::Hybrid,
                      .samples = 256, // a GPU takes 64 in a sample pass
                      .deviceGather = true,
                      .layers = layers};
        std::unique_ptr<Baker> baker = makeBaker(scene, desc);
        (void)bakeToEnd(*baker);
        const FloatImage plain = lightingOf(*baker);
        const uint64_t rays = baker->solver().progress().rays, all = ledger.bytesOf(LinkCache::kOwner);
        EXPECT_EQ(ledger.deviceBytesOf(LinkCache::kOwner), all);
        EXPECT_EQ(baker->solver().progress().cacheBytes, all);
        baker.reset();

        desc.cache = {.bytes = all, .deviceBytes = all / 2};
        baker = makeBaker(scene, desc);
        (void)bakeToEnd(*baker);
        EXPECT_TRUE(sameBytes(lightingOf(*baker), plain));
        EXPECT_EQ(baker->solver().progress().rays, rays);
        EXPECT_EQ(ledger.bytesOf(LinkCache::kOwner), all);
        EXPECT_LE(ledger.deviceBytesOf(LinkCache::kOwner), all / 2);
        EXPECT_GT(ledger.deviceBytesOf(LinkCache::kOwner), 0u);
        baker.reset();

        desc.cache = {.kind = CacheSettings::Kind::None};
        EXPECT_GT(bakeScene(scene, desc).progress.rays, rays) << "without a cache there are more";
    }
}

TEST(Spill, ACacheKnowsItsChunksOnBothSides) {
    LinkCache cache(testDevice(), {.chunkCount = 10,
                                   .links = 16,
                                   .batch = 4,
                                   .bytes = 8 * 16 * 64 * 4,
                                   .deviceBytes = 5 * 16 * 64 * 4,
                                   .oneSamplePass = true});
    EXPECT_EQ(cache.share(), 0.8);
    cache.note(0, {3, 6}); // beyond what is kept, too
    const auto at = [&](uint32_t first) { return cache.find(0, first, 10 - first); };
    EXPECT_FALSE(at(0).known);
    EXPECT_EQ(at(0).count, 3u);
    EXPECT_TRUE(at(3).known);
    EXPECT_EQ(at(3).count, 2u) << "the device's end there";
    EXPECT_EQ(at(3).offset, 3u * 16 * 64);
    EXPECT_NE(at(5).links, at(3).links);
    EXPECT_TRUE(at(5).known);
    EXPECT_EQ(at(5).count, 3u);
    EXPECT_EQ(at(5).offset, 0u);
    EXPECT_FALSE(at(8).known);
    EXPECT_EQ(at(8).count, 2u);
    EXPECT_EQ(cache.passing(2, 10).count, 2u);
    EXPECT_FALSE(at(5).known) << "what goes through forgets";
}

// While the device works, the links' next memory is taken, and no other.
TEST(Spill, ACacheIsPreparedForTheNextSamplePass) {
    constexpr uint64_t kSamplePass = 10 * 16 * 64 * 4;
    const vk::MemoryLedger& ledger = testDevice().ledger();
    LinkCache cache(testDevice(), {.chunkCount = 10,
                                   .links = 16,
                                   .batch = 4,
                                   .bytes = 2 * kSamplePass,
                                   .deviceBytes = 2 * kSamplePass});
    const auto takes = [&](uint32_t samplePass, bool prepares) {
        const uint64_t before = ledger.allocations();
        prepares ? cache.prepare(samplePass) : void(cache.find(samplePass, 0, 10));
        return ledger.allocations() - before;
    };
    EXPECT_EQ(takes(1, true), 0u) << "this one is not the next";
    EXPECT_EQ(takes(0, true), 1u);
    EXPECT_EQ(takes(0, true), 0u);
    EXPECT_EQ(takes(0, false), 0u);
    EXPECT_FALSE(cache.find(0, 0, 10).known) << "nobody has traced them";
    EXPECT_EQ(takes(1, false), 1u);
    EXPECT_EQ(takes(2, true), 0u) << "there is no room";
    EXPECT_EQ(cache.bytes(), 2 * kSamplePass);
    cache.note(0, {3, 1});
    const std::deque<LinkCache::SamplePass> left = cache.release();
    ASSERT_EQ(left.size(), 1u) << "of the second one there is no link yet";
    EXPECT_EQ(left[0].known[3], 1);
}

// A bake takes no more of a device than its limit, and spills what has no room.
TEST(Spill, ALimitIsKept) {
    constexpr uint32_t kScale = 4; // more patches than a batch has: what the batches take is not spilled
    const Scene scene = spillRoom(kScale);
    BakeDesc desc{
        .size = kScale * kSpillEdge, .passes = 0, .method = Method::Hybrid, .samples = 16, .smooth = true};
    const Baked plain = bakeScene(scene, desc);
    const SceneExtent extent = extentOf(scene, plain.patches.scene.mesh);
    const auto planWith = [&](uint64_t limit) {
        BakeRoom room = roomOn(testDevice());
        room.device = limit;
        return planMemory(settingsOf(desc), extent, room);
    };
    // This is the least that everything spilled does with, to the nearest 64 KiB.
    constexpr uint64_t kLimitStep = uint64_t{1} << 16;
    uint64_t least = kLimitStep;
    while (!planWith(least).problem.empty())
        least += kLimitStep;
    EXPECT_EQ(planWith(least).spill, kMostSpill);

    const vk::Device limited(withLimit(least));
    desc.device = &limited;
    limited.ledger().resetPeak();
    const std::unique_ptr<Baker> baker = makeBaker(scene, desc);
    (void)bakeToEnd(*baker);
    EXPECT_TRUE(sameBytes(lightingOf(*baker), plain.lighting));
    EXPECT_LE(limited.ledger().devicePeak(), least);
    // A GPU's batches are larger than this map.
    const uint64_t atLeast = testDevice().info().software() ? uint64_t{1} << 20 : 0;
    EXPECT_GE(baker->spilledBytes(), atLeast);
    const uint64_t spilled = limited.ledger().peak() - limited.ledger().devicePeak();
    EXPECT_GE(spilled, baker->spilledBytes());

    const vk::Device less(withLimit(least / 2));
    desc.device = &less;
    const std::string problem = messageOf([&] { bakeScene(scene, desc); });
    EXPECT_NE(problem.find("MiB to give by --device-memory: --size"), std::string::npos) << problem;
}

// All cores get the memory of a large buffer of the host; it is used like any other.
TEST(Spill, LargeBuffersOfTheHostHoldWhatIsWritten) {
    const vk::Device& device = testDevice();
    const vk::MemoryLedger& ledger = device.ledger();
    const auto taken = [&] { return ledger.bytes() - ledger.bytesOf("staging"); }; // which a GPU keeps
    const uint64_t before = taken(), onDevice = ledger.deviceBytes();
    constexpr size_t kWords = (size_t{65} << 18) + 3; // 65 MiB and no whole page
    {
        const vk::Buffer buffer(
            device, {.size = kWords * sizeof(uint32_t), .memory = vk::Memory::Host, .name = "large"});
        EXPECT_GE(taken() - before, kWords * sizeof(uint32_t));
        EXPECT_EQ(ledger.deviceBytes(), onDevice);
        std::vector<uint32_t> words(kWords);
        std::iota(words.begin(), words.end(), 1u);
        const vk::Buffer source = vk::makeBuffer(device, words, "numbers");
        vk::Commands commands(device);
        VkCommandBuffer cmd = commands.begin();
        const VkBufferCopy all{0, 0, buffer.size()};
        vkCmdCopyBuffer(cmd, source.handle(), buffer.handle(), 1, &all);
        vk::hostBarrier(cmd);
        commands.run();
        EXPECT_TRUE(std::equal(words.begin(), words.end(), buffer.as<uint32_t>()));
        vk::Buffer moved;
        moved = vk::Buffer(device, {.size = buffer.size(), .memory = vk::Memory::Host, .name = "other"});
        std::memcpy(moved.mapped(), buffer.mapped(), buffer.size());
        EXPECT_EQ(vk::readBuffer<uint32_t>(device, moved, 1, kWords - 1).front(), kWords);
    }
    EXPECT_EQ(taken(), before);
}

TEST(Spill, MemoryBeyondALimitIsRefused) {
    constexpr uint64_t kLimit = uint64_t{1} << 20;
    const vk::Device limited(withLimit(kLimit));
    EXPECT_EQ(limited.freeMemory(), kLimit - limited.ledger().deviceBytes());
    const vk::Buffer half(limited, {.size = kLimit / 2, .name = "half"});
    EXPECT_LE(limited.freeMemory(), kLimit / 2);
    const std::string problem =
        messageOf([&] { vk::Buffer(limited, {.size = kLimit * 3 / 4, .name = "too much"}); });
    EXPECT_NE(problem.find("out of memory for buffer 'too much'"), std::string::npos) << problem;
    const vk::Buffer host(limited, {.size = kLimit * 4, .memory = vk::Memory::Host, .name = "on the host"});
    EXPECT_TRUE(host.mapped());
}

} // namespace relume
