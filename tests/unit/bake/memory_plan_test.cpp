#include "bake/baker/memory_plan.h"

#include "bake/baker/host_room.h"
#include "bake/baker/make_solver.h"

#include <gtest/gtest.h>

#include <string>

namespace relume {
namespace {

constexpr uint64_t kGiBOfPlan = uint64_t{1} << 30;

BakeSettings hybridOf(uint32_t size) {
    BakeSettings settings;
    settings.size = size;
    settings.solver.method = Method::Hybrid;
    return settings;
}

BakeRoom roomOf(uint64_t device, uint64_t host) {
    return {.device = device, .host = host, .imageEdge = 32768, .name = "Some GPU"};
}

uint32_t proposedIn(const std::string& problem) {
    return static_cast<uint32_t>(std::stoul(problem.substr(problem.rfind("--size ") + 7)));
}

TEST(MemoryPlan, WhatTheHostCannotTakeIsRefusedWithTheSizeThatFits) {
    BakeSettings settings = hybridOf(8192);
    const SceneExtent one{.triangles = 1000}, four{.triangles = 1000, .pages = {4}};
    EXPECT_EQ(hostNeeds(settings, four), 4 * hostNeeds(settings, one));
    EXPECT_EQ(planMemory(settings, one, roomOf(1024 * kGiBOfPlan, 64 * kGiBOfPlan)).problem, "");
    const BakeRoom room = roomOf(1024 * kGiBOfPlan, 8 * kGiBOfPlan);
    const std::string problem = planMemory(settings, four, room).problem;
    ASSERT_TRUE(problem.ends_with(" of 4 pages fits")) << problem;
    settings.size = proposedIn(problem);
    EXPECT_GE(settings.size, 1024u);
    EXPECT_EQ(planMemory(settings, four, room).problem, "");
    settings.size += 64;
    EXPECT_NE(planMemory(settings, four, room).problem, "");
    EXPECT_NE(planMemory(settings, four, roomOf(1024 * kGiBOfPlan, 0)).problem.find("no size fits"),
              std::string::npos);
}

// The less the device has, the more is spilled, and no more than that.
TEST(MemoryPlan, AsLittleIsSpilledAsFits) {
    const BakeSettings settings = hybridOf(4096);
    const SceneExtent scene{.triangles = 1000};
    Spill before = Spill::None;
    uint32_t steps = 0;
    for (uint64_t tenths = 200; tenths > 0; --tenths) {
        const BakeRoom room = roomOf(tenths * kGiBOfPlan / 10, 64 * kGiBOfPlan);
        const MemoryPlan plan = planMemory(settings, scene, room);
        if (!plan.problem.empty()) break;
        EXPECT_GE(plan.spill, before) << tenths;
        EXPECT_EQ(plan.spilled > 0, plan.spill != Spill::None);
        BakeSettings planned = settings;
        planned.solver.cache.kind = CacheSettings::Kind::None;
        planned.solver.spill = plan.spill;
        EXPECT_LE(mostMemoryNeeds(planned, scene, false).total(), room.device * 9 / 10);
        if (plan.spill != Spill::None) {
            planned.solver.spill = static_cast<Spill>(static_cast<int>(plan.spill) - 1);
            EXPECT_GT(mostMemoryNeeds(planned, scene, false).total(), room.device * 9 / 10);
        }
        steps += plan.spill != before ? 1 : 0;
        before = plan.spill;
    }
    EXPECT_EQ(before, kMostSpill);
    EXPECT_EQ(steps, 4u) << "each value is of use";
}

// Half of the texels covered need half of the memory, and less of it is spilled.
TEST(MemoryPlan, PatchesThatAreKnownSpillNoMore) {
    const BakeSettings settings = hybridOf(4096);
    const SceneExtent scene{.triangles = 1000};
    const auto texels = uint64_t{settings.size} * settings.size;
    const auto spilled = [&](uint64_t patches, uint64_t free) {
        return spillOf(settings, scene,
                       {.chunkCount = static_cast<uint32_t>(patches / shader::kChunk + 1), .texels = texels},
                       free);
    };
    bool differs = false;
    for (uint64_t gib = 3; gib < 12; ++gib) {
        const uint64_t free = gib * kGiBOfPlan;
        const Spill planned = planMemory(settings, scene, roomOf(free, 64 * kGiBOfPlan)).spill;
        EXPECT_EQ(spilled(texels, free), planned);
        EXPECT_LE(spilled(texels / 2, free), planned);
        differs = differs || spilled(texels / 2, free) != planned;
    }
    EXPECT_TRUE(differs);
}

// A size of twice the patches fits, and the host must have room for what the device has not.
TEST(MemoryPlan, ASpilledBakeNeedsTheHostsMemory) {
    const SceneExtent scene{.triangles = 1000};
    const BakeRoom small = roomOf(8 * kGiBOfPlan, 64 * kGiBOfPlan);
    const BakeSettings large = hybridOf(6144);
    const MemoryPlan plan = planMemory(large, scene, small);
    EXPECT_EQ(plan.problem, "");
    EXPECT_NE(plan.spill, Spill::None);
    BakeSettings spilled = large;
    spilled.solver.spill = plan.spill;
    const uint64_t host = hostNeeds(spilled, scene, plan.spilled);
    EXPECT_GT(host, hostNeeds(spilled, scene));
    EXPECT_EQ(planMemory(large, scene, roomOf(8 * kGiBOfPlan, host)).problem, "");
    const std::string problem = planMemory(large, scene, roomOf(8 * kGiBOfPlan, host / 2)).problem;
    EXPECT_LT(proposedIn(problem), 6144u) << problem;
    BakeRoom limited = roomOf(kGiBOfPlan, 64 * kGiBOfPlan);
    EXPECT_NE(planMemory(large, scene, limited).problem.find(" MiB to give: "), std::string::npos);
    limited.limited = true;
    EXPECT_NE(planMemory(large, scene, limited).problem.find(" MiB to give by --device-memory: "),
              std::string::npos);
    // On a CPU there is nothing to gain: it is the same memory.
    BakeRoom cpu = roomOf(8 * kGiBOfPlan, 8 * kGiBOfPlan);
    cpu.software = cpu.shared = true;
    EXPECT_NE(planMemory(large, scene, cpu).problem, "");
}

// On five pages' sheet there is room for nine.
TEST(MemoryPlan, WhatIsLeftOverOnTheSheetHasNoPatches) {
    BakeSettings settings;
    settings.size = 1024;
    EXPECT_LT(hostNeeds(settings, {.pages = {5}}), hostNeeds(settings, {.pages = {9}}));
    EXPECT_GT(hostNeeds(settings, {.pages = {5}}), hostNeeds(settings, {.pages = {4}}));
}

TEST(MemoryPlan, LinksAndLayersGetAThirdOfTheDeviceAndAQuarterOfTheHost) {
    SolverSettings layered = hybridOf(512).solver;
    layered.layers.on = true;
    SolverSettings shared = layered;
    const SolverRoom gpu{.device = 30'000, .host = 60'000, .own = {.device = 1000}};
    shareMemory(gpu, shared);
    EXPECT_EQ(shared.layers.bytes, 25'000u);
    EXPECT_EQ(shared.layers.deviceBytes, 10'000u);
    EXPECT_EQ(shared.cache.bytes, 25'000u);
    EXPECT_EQ(shared.cache.deviceBytes, 10'000u);
    // The solver's own buffers leave less of the device, and spilled ones less of the host.
    shared = layered;
    shareMemory({.device = 30'000, .host = 60'000, .own = {.device = 21'000, .host = 40'000}}, shared);
    EXPECT_EQ(shared.layers.deviceBytes, 3'000u);
    EXPECT_EQ(shared.layers.bytes, 8'000u);
    // What the user says is the most, and as much of it as there is room for is on the device.
    shared = layered;
    shared.layers.bytes = shared.cache.bytes = 12'000;
    shareMemory(gpu, shared);
    EXPECT_EQ(shared.layers.bytes, 12'000u);
    EXPECT_EQ(shared.layers.deviceBytes, 12'000u);
    EXPECT_EQ(shared.cache.deviceBytes, 12'000u);
    shared.layers.bytes = 50'000;
    shared.layers.deviceBytes = 0;
    shareMemory(gpu, shared);
    EXPECT_EQ(shared.layers.deviceBytes, 13'000u);
    // With a CPU and an integrated GPU there is but one memory, and pairs' bits are read on the device alone.
    shared = layered;
    shareMemory({.device = 30'000, .host = 60'000, .own = {}, .shared = true}, shared);
    EXPECT_EQ(shared.layers.bytes, 10'000u);
    EXPECT_EQ(shared.layers.deviceBytes, 10'000u);
    shared = SolverSettings();
    shareMemory(gpu, shared);
    EXPECT_EQ(shared.cache.bytes, 10'000u);
}

TEST(MemoryPlan, MethodsThatReadAnywhereAreNotSpilled) {
    BakeSettings settings = hybridOf(512);
    settings.solver.method = Method::Pure;
    EXPECT_EQ(mostSpill(settings.solver), Spill::None);
    EXPECT_EQ(mostMemoryNeeds(settings, {}, false).spilled, 0u);
    settings.solver.method = Method::Hybrid;
    settings.solver.links.footprint = true;
    EXPECT_EQ(mostSpill(settings.solver), Spill::Links);
}

} // namespace
} // namespace relume
