#include "bake/trace/embree_shaft.h"

#include <gtest/gtest.h>

#include "bake/trace/bvh_builder.h"
#include "tests/unit/trace_world.h"

namespace relume {
namespace {

// Tells whether the shaft is open: two squares of 1 m face each other 2 m apart, and a small one stands
// between them or beside.
bool openPast(glm::vec3 obstacle, bool masked = false) {
    TraceWorld world;
    world.add([](float u, float v) { return glm::vec3(u, 0, -v); }, 1);
    world.add([](float u, float v) { return glm::vec3(u, 2, v - 1); }, 1);
    world.add([=](float u, float v) { return obstacle + glm::vec3(0.1f * u, 0, -0.1f * v); }, 1,
              {.masked = masked});
    const TraceScene scene = world.build();
    const std::vector<PatchChunk> chunks = buildChunks(scene.patches, false);
    EndBox floor = chunks[0].ends, lid = chunks[8].ends;
    for (uint32_t c = 1; c < 8; ++c) {
        floor = {glm::min(floor.lo, chunks[c].ends.lo), glm::max(floor.hi, chunks[c].ends.hi)};
        lid = {glm::min(lid.lo, chunks[8 + c].ends.lo), glm::max(lid.hi, chunks[8 + c].ends.hi)};
    }
    return Shaft(chunks[0], floor, chunks[8], lid).isOpen(buildBvh(scene.mesh));
}

TEST(EmbreeShaft, isOpenUnlessSomethingReachesIn) {
    EXPECT_TRUE(openPast({0.5f, 5, -0.5f})); // behind the lid
    EXPECT_TRUE(openPast({1.1f, 1, -0.5f})); // beside
    EXPECT_FALSE(openPast({0.5f, 1, -0.5f}));
    EXPECT_FALSE(openPast({0.95f, 1, -0.5f})); // half in
    EXPECT_FALSE(openPast({0.5f, 1, -0.5f}, true));
    EXPECT_FALSE(openPast({0.5f, 1e-3f, -0.5f})); // close above the floor's patches
}

} // namespace
} // namespace relume
