// The device's memory ends at any point of a bake: the bake is given up, and nothing stays behind.
#include "tests/gpu/gpu_environment.h"
#include "tests/gpu/layered.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <optional>
#include <ostream>

namespace relume {
namespace {

// At most so many allocations of a bake fail in turn: all of the first ones, where different things are made,
// then every so many.
constexpr uint64_t kFirstFailures = 8, kMostFailures = 40;

struct FailureCase {
    const char* name;
    BakeDesc desc;
};

void PrintTo(const FailureCase& one, std::ostream* stream) {
    *stream << one.name;
}

class BakeFailure : public testing::TestWithParam<FailureCase> {};

BakeDesc smallBake(BakeDesc desc) {
    desc.size = 64;
    desc.passes = isPairMethod(desc.method) ? 2 : 0;
    if (!isPairMethod(desc.method) && desc.samples == 0) desc.samples = 32;
    return desc;
}

void finishBake(Baker& baker, bool live) {
    while (!baker.solver().done()) {
        baker.solver().step();
        if (live) (void)baker.solver().liveLight();
    }
}

/// Bakes, and with layers follows an edit of a light, a colour and an object. The settings decide what it
/// returns.
Light4 bakeAll(const BakeDesc& desc) {
    const Scene start = relume::room(); // not the one of another test
    if (!desc.layers) {
        const std::unique_ptr<Baker> baker = makeBaker(start, desc);
        finishBake(*baker, desc.live);
        return baker->solver().light();
    }
    const LightmapAtlas atlas = buildAtlas(start, desc.size);
    Layered bake(start, desc);
    finishBake(bake.baker(), desc.live);
    bake.scene.lights[0].transform = at({0.7f, 0.5f, 1.2f});
    bake.scene.materials[0].baseColor = glm::vec4(0.7f, 0.4f, 0.4f, 1.0f);
    bake.editNow();
    finishBake(bake.baker(), desc.live);
    bake.scene.instances.back().transform = at({0.1f, 0.0f, 0.0f});
    bake.editNow({}, &atlas);
    finishBake(bake.baker(), desc.live);
    return bake.light();
}

} // namespace

TEST_P(BakeFailure, AFullDeviceEndsABakeThatLeavesNothingBehind) {
    const BakeDesc desc = smallBake(GetParam().desc);
    vk::MemoryLedger& ledger = testDevice().ledger();
    const Light4 whole = bakeAll(desc);
    const uint64_t before = ledger.bytes(), start = ledger.allocations();
    EXPECT_TRUE(sameBytes(bakeAll(desc), whole));
    const uint64_t count = ledger.allocations() - start;
    ASSERT_EQ(ledger.bytes(), before);
    ASSERT_GT(count, kFirstFailures);

    const uint64_t stride =
        std::max<uint64_t>(1, (count - kFirstFailures) / (kMostFailures - kFirstFailures));
    for (uint64_t n = 1; n <= count; n += n < kFirstFailures ? 1 : stride) {
        ledger.failAt(n);
        std::optional<Light4> light;
        try {
            light = bakeAll(desc);
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("out of memory for"), std::string::npos) << error.what();
        }
        (void)ledger.withdrawFailure();
        // A cache takes no more than there is: the bake goes on without.
        if (light) {
            EXPECT_TRUE(sameBytes(*light, whole)) << "allocation " << n << " of " << count;
        }
        EXPECT_EQ(ledger.bytes(), before) << "allocation " << n << " of " << count;
    }
    EXPECT_TRUE(sameBytes(bakeAll(desc), whole)) << "the device bakes as before";
}

INSTANTIATE_TEST_SUITE_P(
    Methods, BakeFailure,
    testing::Values(
        FailureCase{"pure", {.method = Method::Pure, .live = true}},
        FailureCase{"static", {.method = Method::Static, .pairs = {.window = 2}}},
        FailureCase{"montecarlo", {.method = Method::MonteCarlo, .pairs = {.window = 2}}},
        FailureCase{"mipmapped", {.method = Method::Mipmapped, .pairs = {.window = 2}}},
        FailureCase{"adaptive", {.method = Method::Adaptive}},
        FailureCase{"directional", {.method = Method::Directional, .footprint = true}},
        FailureCase{"hybrid", {.method = Method::Hybrid, .smooth = true, .indirectScale = 2, .live = true}},
        FailureCase{"layers", {.method = Method::Hybrid, .smooth = true, .live = true, .layers = true}},
        FailureCase{
            "layersByShaders",
            {.tracer = TracerKind::Bvh, .method = Method::Hybrid, .deviceGather = true, .layers = true}},
        // The memory of sample passes is taken while the device traces those before.
        FailureCase{"layersOfManyLinks",
                    {.tracer = TracerKind::Bvh,
                     .method = Method::Hybrid,
                     .samples = 128,
                     .deviceGather = true,
                     .layers = true}},
        FailureCase{"voxels", {.tracer = TracerKind::Voxel, .method = Method::Hybrid}}),
    [](const auto& test) { return std::string(test.param.name); });

} // namespace relume
