// This checks how much of the device's memory a bake takes.
#include "assets/atlas/lightmap_atlas.h"
#include "bake/baker/make_solver.h"
#include "bake/baker/memory_plan.h"
#include "bake/direct/emitter_light.h"
#include "bake/gather/coarse_patches.h"
#include "bake/gather/link_cache.h"
#include "bake/layers/layer_bounces.h"
#include "bake/links/patch_pyramid.h"
#include "bake/pairs/bits_cache.h"
#include "bake/pairs/sender_list.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/light_at.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <ostream>
#include <utility>

namespace relume {
namespace {

constexpr double kTolerance = 0.02; // of what is estimated beyond what is taken
constexpr uint32_t kMeshLights = 4, kPanels = 5;

/// Makes a closed room with as many mesh lights and panels as take the most memory.
Scene brightRoom() {
    SceneMaker maker(128);
    maker.box({0, 0, 0}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.5f), 40);
    for (uint32_t i = 0; i < kMeshLights; ++i)
        maker.quad({0.2f + 0.4f * static_cast<float>(i), 0.8f, 1.9f}, 0.4f * kY, 0.3f * kX,
                   maker.material(0.0f, 5.0f), glm::uvec2(8));
    Scene scene = maker.scene();
    for (uint32_t i = 0; i < kPanels; ++i) {
        scene.lights.push_back(lightAt(LightType::Rectangle,
                                       {0.3f + 0.3f * static_cast<float>(i), 0.5f, 1.7f}, 10.0f,
                                       "Panel " + std::to_string(i)));
        scene.lights.back().size = {0.2f, 0.2f};
    }
    return scene;
}

constexpr LightExtent kLights{.polygons = kMeshLights, .polygonsOfOne = 1, .extended = kPanels};

/// Holds what a bake took of the device's memory.
struct Taken {
    uint64_t cit = 0, surface = 0, trace = 0;
    uint64_t inside = 0;  // before the solver came, beside what stays
    uint64_t solver = 0;  // at most at a time, caches and layers included
    uint64_t caches = 0;  // as they say it
    uint64_t counted = 0; // the same, as the ledger says it
    uint64_t layers = 0;  // with what their bounces side by side take where memory is free
    uint64_t all = 0;     // at most at a time
    uint64_t senders = 0;
};

/// Sums up the bytes of these names, whoever owns them.
template<size_t N>
uint64_t bytesNamed(const vk::MemoryLedger& ledger, const std::array<const char*, N>& names) {
    uint64_t sum = 0;
    for (const auto& [key, bytes] : ledger.entries())
        if (std::find(names.begin(), names.end(), key.name) != names.end()) sum += bytes;
    return sum;
}

constexpr std::array kLayerNames = {"layer", "direct light of a layer", "direct light of all layers",
                                    "light of lights grouped anew"};

constexpr std::array kSearchNames = {
    "links",       "links that come back", "patches that are asked", "places in texels",
    "seen places", "places near by",       "patches that ask",       "rays"};

/// Returns what bounces of several layers side by side take beyond those of one.
uint64_t besideBytes(const vk::MemoryLedger& ledger, uint64_t chunks) {
    const uint64_t beside =
        bytesNamed(ledger, std::array{LayerBounces::kBesideLight, LayerBounces::kBesideSums});
    const uint64_t lanes = bytesNamed(ledger, std::array{LayerBounces::kPacked, LayerBounces::kChanges});
    const uint64_t ofOne = 2 * chunks * (shader::kChunk * sizeof(glm::uvec2) + sizeof(glm::vec4));
    return beside + lanes - std::min(lanes, ofOne);
}

/// Bakes to the end; `patches` gets what was baked.
Taken measure(const Scene& scene, const BakeDesc& desc, PatchSet& patches) {
    vk::MemoryLedger& ledger = testDevice().ledger();
    const uint64_t before = ledger.bytes();
    Taken taken;
    uint64_t base = before, surfaceBefore = ledger.bytesOf("surface"), others = 0;
    std::string phase;
    ledger.resetPeak();
    const auto next = [&](const char* name) {
        const uint64_t most = ledger.peak() - base;
        taken.all = std::max(taken.all, ledger.peak() - before);
        if (phase == "cit") taken.cit = most;
        // Covers are made while patches are searched, too, which are the surface's. What tracers take once it
        // is known who sends, behind the last search, is left out.
        if (phase == "tracer" || std::string(name) == "validity")
            others = ledger.bytesOf("trace") - bytesNamed(ledger, kSearchNames) + ledger.bytesOf("surface") -
                     surfaceBefore;
        if (phase == "tracer" || phase == "validity")
            taken.inside = std::max(taken.inside, most - std::min(most, others));
        if (std::string(name) == "solver set-up") taken.surface = ledger.bytesOf("surface");
        if (phase != name && std::string(name) != "validity") {
            base = ledger.bytes();
            surfaceBefore = ledger.bytesOf("surface");
        }
        phase = name;
        ledger.resetPeak();
    };
    Baker baker(testDevice(), scene, flatten(scene, buildAtlas(scene, desc.size)), settingsOf(desc), next);
    while (!baker.solver().done()) {
        baker.solver().step();
        if (desc.live) (void)baker.solver().liveLight();
        taken.senders =
            std::max(taken.senders, bytesNamed(ledger, std::array{"senders"}) / sizeof(shader::Sender));
    }
    (void)baker.solver().light();
    taken.solver = ledger.peak() - base;
    taken.all = std::max(taken.all, ledger.peak() - before);
    taken.trace = ledger.bytesOf("trace");
    taken.caches = baker.solver().progress().cacheBytes;
    taken.counted = ledger.bytesOf(BitsCache::kOwner) + ledger.bytesOf(LinkCache::kOwner);
    patches = baker.patches();
    taken.layers = bytesNamed(ledger, kLayerNames) + besideBytes(ledger, patches.chunkCount());
    return taken;
}

/// Expects that the estimate is not below what was taken, nor much above it.
void expectClose(uint64_t estimate, uint64_t taken, const char* what) {
    EXPECT_GE(estimate, taken) << what;
    EXPECT_LE(static_cast<double>(estimate), (1.0 + kTolerance) * static_cast<double>(taken)) << what;
}

EmitterSet lightOf(uint32_t polygons) {
    return {.polygons = std::vector<shader::EmitterPolygon>(polygons, shader::EmitterPolygon{}),
            .nodes = std::vector<shader::EmitterNode>(2 * polygons - 1, shader::EmitterNode{}),
            .power = 1.0};
}

struct MemoryCase {
    const char* name;
    BakeDesc desc;
};

void PrintTo(const MemoryCase& one, std::ostream* stream) {
    *stream << one.name;
}

class BakeMemoryOf : public testing::TestWithParam<MemoryCase> {};

BakeDesc described(BakeDesc desc) {
    desc.size = 128;
    if (isPairMethod(desc.method)) {
        desc.passes = 2;
    } else {
        desc.samples = 32;
        desc.passes = desc.layers ? 0 : 2;
    }
    return desc;
}

SolverExtent extentOf(const BakeDesc& desc, const PatchSet& patches, const Taken& taken) {
    SolverExtent extent{.chunkCount = patches.chunkCount(),
                        .texels = uint64_t{desc.size} * desc.size,
                        .software = testDevice().info().software(),
                        .lights = kLights};
    if (desc.method == Method::Adaptive)
        extent.senders = taken.senders;
    else if (isPairMethod(desc.method) && desc.method != Method::Pure)
        extent.senders = desc.rtrad ? rtradSenders(patches, desc.pairs.window, false).senders.size()
                                    : windowSenders(patches, desc.pairs.window).senders.size();
    if (desc.indirectScale > 1)
        extent.receivers = buildCoarsePatches(patches, desc.indirectScale).receivers.size();
    if (desc.footprint) extent.nodes = buildPatchPyramid(patches).nodes.size();
    return extent;
}

} // namespace

TEST_P(BakeMemoryOf, WhatIsEstimatedIsWhatIsTaken) {
    const BakeDesc desc = described(GetParam().desc);
    const Scene scene = brightRoom();
    PatchSet patches;
    const uint64_t before = testDevice().ledger().bytes();
    const Taken taken = measure(scene, desc, patches);
    EXPECT_EQ(testDevice().ledger().bytes(), before) << "all is given back";

    const BakeSettings settings = settingsOf(desc);
    const SolverExtent extent = extentOf(desc, patches, taken);
    const MemoryNeeds needs = memoryNeeds(settings, extentOf(scene, patches.scene.mesh), extent);
    expectClose(needs.cit, taken.cit, "images of the CIT pass");
    expectClose(needs.surface, taken.surface, "patches and their light");
    EXPECT_GE(needs.trace, taken.trace);
    EXPECT_EQ(taken.counted, taken.caches) << "bits and links that are kept";
    if (settings.solver.transport.rtrad)
        EXPECT_EQ(needs.inside, 0u);
    else
        expectClose(needs.inside, taken.inside, "search for patches inside something");
    // LinkSolver counts the links that it keeps, the others' caches say themselves what they take.
    const bool linksCounted = !isPairMethod(desc.method) && !desc.layers;
    expectClose(needs.solver, taken.solver - taken.layers - (linksCounted ? 0 : taken.caches), "solver");
    EXPECT_GE(needs.total(), taken.all - taken.layers - (linksCounted ? 0 : taken.caches));

    // What is not known about the scene is taken as large as it can get.
    SolverExtent unknown = extent;
    unknown.lights.reset();
    unknown.senders.reset();
    unknown.receivers.reset();
    unknown.nodes.reset();
    EXPECT_GE(solverBytes(unknown, settings.solver).device, needs.solver);
    EXPECT_GE(mostMemoryNeeds(settings, extentOf(scene, patches.scene.mesh), extent.software).total(),
              taken.all - taken.layers - (linksCounted ? 0 : taken.caches));
}

constexpr CacheSettings kNoCache{.kind = CacheSettings::Kind::None};
// So much holds some super-blocks, or the links of some chunks: what does not fit needs a place of its own.
constexpr CacheSettings kSmallCache{.bytes = uint64_t{1} << 20};
constexpr PairSettings kWindow{.window = 2};

INSTANTIATE_TEST_SUITE_P(
    Methods, BakeMemoryOf,
    testing::Values(
        MemoryCase{"pure", {.method = Method::Pure, .cache = kSmallCache}},
        MemoryCase{"pureLive", {.method = Method::Pure, .cache = kNoCache, .live = true}},
        MemoryCase{"pureRtrad", {.method = Method::Pure, .cache = kSmallCache, .rtrad = true}},
        MemoryCase{"static", {.method = Method::Static, .cache = kNoCache, .pairs = kWindow}},
        MemoryCase{"montecarlo", {.method = Method::MonteCarlo, .cache = kSmallCache, .pairs = kWindow}},
        MemoryCase{"montecarloRtrad",
                   {.method = Method::MonteCarlo, .cache = kNoCache, .pairs = kWindow, .rtrad = true}},
        MemoryCase{"mipmapped", {.method = Method::Mipmapped, .cache = kSmallCache, .pairs = kWindow}},
        MemoryCase{"adaptive", {.method = Method::Adaptive, .cache = kNoCache}},
        MemoryCase{"adaptiveOnDevice", {.method = Method::Adaptive, .cache = kNoCache, .deviceGather = true}},
        MemoryCase{"directional", {.method = Method::Directional}},
        MemoryCase{"directionalLive", {.method = Method::Directional, .cache = kSmallCache, .live = true}},
        MemoryCase{"directionalLec", {.method = Method::Directional, .directions = DirectionSet::Lec}},
        MemoryCase{"hybrid", {.method = Method::Hybrid, .smooth = true}},
        MemoryCase{"hybridLive", {.method = Method::Hybrid, .smooth = true, .live = true}},
        MemoryCase{"hybridRough", {.method = Method::Hybrid, .cache = kNoCache, .live = true}},
        MemoryCase{"hybridOnDevice", {.method = Method::Hybrid, .smooth = true, .deviceGather = true}},
        MemoryCase{"hybridCoarse", {.method = Method::Hybrid, .smooth = true, .indirectScale = 2}},
        MemoryCase{"hybridFootprint", {.method = Method::Hybrid, .smooth = true, .footprint = true}},
        MemoryCase{"footprintOnDevice",
                   {.method = Method::Directional, .footprint = true, .deviceGather = true, .live = true}},
        MemoryCase{"layers", {.method = Method::Hybrid, .smooth = true, .cache = kNoCache, .layers = true}},
        MemoryCase{"layersRough", {.method = Method::Hybrid, .cache = kSmallCache, .layers = true}},
        MemoryCase{
            "layersLive",
            {.method = Method::Hybrid, .smooth = true, .cache = kNoCache, .live = true, .layers = true}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(BakeMemory, AVoxelMapTakesWhatItSays) {
    vk::MemoryLedger& ledger = testDevice().ledger();
    const Scene scene = brightRoom();
    const auto baker = makeBaker(scene, {.size = 128, .passes = 1, .method = Method::Hybrid, .samples = 16});
    const uint64_t before = ledger.bytes();
    constexpr uint32_t kResolution = 64;
    const VoxelMap map(testDevice(), baker->patches().scene, {.resolution = kResolution},
                       baker->light().patches.address());
    expectClose(VoxelMap::bytes(kResolution, map.setVoxels()), ledger.bytes() - before, "voxel map");
    EXPECT_GE(VoxelMap::bytes(kResolution), ledger.bytes() - before);
}

TEST(BakeMemory, ASizeThatDoesNotFitIsRefusedWithOneThatDoes) {
    BakeSettings settings;
    settings.size = 2048;
    BakeRoom room = roomOn(testDevice());
    room.device = uint64_t{512} << 20;
    const auto problemNow = [&] { return planMemory(settings, {.triangles = 1000}, room).problem; };
    const std::string problem = problemNow();
    ASSERT_TRUE(problem.ends_with(" fits")) << problem;
    const size_t end = problem.rfind(" fits"), begin = problem.rfind(' ', end - 1);
    const auto fits = static_cast<uint32_t>(std::stoul(problem.substr(begin, end - begin)));
    EXPECT_GE(fits, 64u);
    EXPECT_LT(fits, settings.size);
    settings.size = fits;
    EXPECT_EQ(problemNow(), "");
    settings.size = fits + 64;
    EXPECT_NE(problemNow(), "");
    room.device = 0;
    EXPECT_NE(problemNow().find("no size fits"), std::string::npos);
}

// How many chunks a batch has depends on the light that has most points, and what each has room for on all:
// beside a light that picks others take the most where they have four polygons, on a CPU where they have
// most.
TEST(EmitterMemory, IsEnoughForLightsOfAnySizesSideBySide) {
    constexpr uint32_t kChunks = 9000, kMany = 100; // more than any device's batch; they pick
    PatchSet patches;
    patches.scene.patches.resize(size_t{kChunks} * shader::kChunk);
    const EmitterLight::Desc desc{.links = shader::kReplicates, .lightByLight = true};
    const uint64_t estimate = EmitterLight::bytes(kChunks, testDevice().info().software(), desc, kMany);
    uint64_t most = 0;
    for (const uint32_t others : {1u, 4u, 8u, EmitterLight::kAllOfLight}) {
        EmitterLight lights(testDevice(), patches, desc);
        lights.setGroups({lightOf(kMany), lightOf(others)});
        ASSERT_TRUE(lights.picks(0) && !lights.picks(1));
        const uint64_t taken =
            bytesNamed(testDevice().ledger(), std::array{"whole mesh lights", "picked emitters",
                                                         "points on emitters", "seen points"});
        EXPECT_LE(taken, estimate) << others;
        most = std::max(most, taken);
    }
    EXPECT_LE(static_cast<double>(estimate), (1.0 + kTolerance) * static_cast<double>(most));
}

} // namespace relume
