// This tests the walk through a voxel map and its rules on the CPU; the source text is the kernels' own.
#include "bake/base/shader_types.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <vector>

namespace relume::shader {
namespace {

std::function<bool(ivec3)> isSet;
bool voxelSet(ivec3 voxel) {
    return isSet(voxel);
}
#include "shaders/lib/rays/voxel_walk.glsl"
#include "shaders/lib/rays/cvm.glsl"

using Voxel = std::array<int, 3>;
Voxel keyOf(ivec3 v) {
    return {v.x, v.y, v.z};
}

struct Segments {
    std::mt19937 random{3};
    std::uniform_real_distribution<float> unit{-3.0f, 12.0f};
    vec3 point() { return {unit(random), unit(random), unit(random)}; }
};

TEST(VoxelWalk, passesEveryVoxelOnTheWayInOrder) {
    Segments segments;
    for (int n = 0; n < 500; ++n) {
        vec3 a = segments.point(), b = segments.point();
        if (n % 3 == 0) b[n % 2] = a[n % 2]; // along a plane
        if (n % 7 == 0) b = vec3(a.x, a.y, b.z);
        VoxelWalk w = startWalk(a, b);
        std::set<Voxel> walked = {keyOf(w.voxel)};
        EXPECT_EQ(keyOf(w.voxel), keyOf(ivec3(floor(a))));
        for (ivec3 before = w.voxel; stepWalk(w); before = w.voxel) {
            const ivec3 step = abs(w.voxel - before);
            EXPECT_EQ(step.x + step.y + step.z, 1);
            walked.insert(keyOf(w.voxel));
        }
        EXPECT_EQ(keyOf(w.voxel), keyOf(ivec3(floor(b))));
        for (int k = 0; k <= 1000; ++k) {
            const vec3 p = mix(a, b, float(k) / 1000), in = p - floor(p);
            const bool nearEdge =
                std::min({in.x, in.y, in.z}) < 1e-3f || std::max({in.x, in.y, in.z}) > 0.999f;
            if (nearEdge) continue;
            EXPECT_TRUE(walked.contains(keyOf(ivec3(floor(p)))));
        }
    }
}

bool blocks(const std::string& row) { // '#': set; the segment runs from the first to the last
    isSet = [&](ivec3 v) { return row[size_t(v.x)] == '#'; };
    const vec3 from(0.5f), to(float(row.size()) - 0.5f, 0.5f, 0.5f);
    EXPECT_EQ(voxelsBlock(from, to), voxelsBlock(to, from)) << row;
    return voxelsBlock(from, to);
}

TEST(VoxelWalk, onlyWhatStandsFreeBlocks) {
    EXPECT_FALSE(blocks("........"));
    EXPECT_TRUE(blocks("...#...."));
    EXPECT_TRUE(blocks(".#"
                       "#..#"));
    EXPECT_FALSE(blocks("#......."));
    EXPECT_FALSE(blocks("###...##"));
    EXPECT_TRUE(blocks("####...."));
    EXPECT_TRUE(blocks("....####"));
    EXPECT_TRUE(blocks("##.#.##"));
    EXPECT_FALSE(blocks("###"));
    EXPECT_TRUE(blocks("#####"));
}

TEST(VoxelWalk, endsClearOfAPlaneAreOutOfItsVoxels) {
    Segments segments;
    for (int n = 0; n < 300; ++n) {
        const vec3 p = segments.point(), normal = normalize(segments.point());
        const vec3 above = liftedAbove(segments.point(), p, normal, planeClearance(normal) + 1e-4f);
        // The plane leaves the voxel around that point aside: all its corners lie on one side.
        float lowest = 1e30f;
        for (int corner = 0; corner < 8; ++corner)
            lowest = std::min(lowest,
                              dot(floor(above) + vec3(corner & 1, corner >> 1 & 1, corner >> 2) - p, normal));
        EXPECT_GT(lowest, -1e-3f);
    }
}

// Points go from an end on, moved inwards, at multiples of 2 / resolution of what remains.
TEST(VoxelWalk, rtradsMarchTakesItsPoints) {
    VoxelGrid grid{};
    grid.origin = vec3(-1);
    grid.scale = vec3(31.49f / 2);
    grid.resolution = 32;
    std::vector<Voxel> asked;
    isSet = [&](ivec3 v) {
        asked.push_back(keyOf(v));
        return false;
    };
    EXPECT_FALSE(rtradMarchBlocked(vec3(-1, 0, 0), vec3(1, 0, 0), grid));
    ASSERT_EQ(asked.size(), 16u);
    EXPECT_EQ(asked[0], (Voxel{1, 15, 15})); // 0.07 * 15.745 = 1.1
    EXPECT_EQ(asked[8], (Voxel{15, 15, 15}));
    EXPECT_EQ(asked[15], (Voxel{28, 15, 15})); // 0.07 + 1.86 * 15 / 16 = 1.814 -> 28.6
    isSet = [&](ivec3 v) { return v.x == 15; };
    EXPECT_TRUE(rtradMarchBlocked(vec3(-1, 0, 0), vec3(1, 0, 0), grid));
}

TEST(Cvm, axesTurnForthAndBack) {
    const vec3 p(1, 2, 3);
    for (uint axis = 0; axis < 3; ++axis) {
        EXPECT_EQ(alongAxis(p, axis).z, p[int(axis)]);
        EXPECT_EQ(fromAxis(alongAxis(p, axis), axis), p);
    }
    EXPECT_EQ(dominantAxis(vec3(-2, 1, 1)), 0u);
    EXPECT_EQ(dominantAxis(vec3(0, 1, -2)), 2u);
    EXPECT_EQ(dominantAxis(vec3(1, 1, 1)), 0u); // as RTRad decides a tie
}

TEST(Cvm, weightsReproduceThePointAndStayOnTheTriangle) {
    const VoxelTriangle t = voxelTriangle(vec3(0, 0, 0), vec3(4, 0, 1), vec3(0, 4, 2));
    EXPECT_NEAR(cornerWeights(t, vec2(1, 2)).x, 0.25f, 1e-6f);
    EXPECT_NEAR(cornerWeights(t, vec2(1, 2)).y, 0.5f, 1e-6f);
    const vec2 outside = cornerWeights(t, vec2(9, -3));
    EXPECT_GE(outside.x, 0.0f);
    EXPECT_GE(outside.y, 0.0f);
    EXPECT_LE(outside.x + outside.y, 1.0f + 1e-6f);
}

} // namespace
} // namespace relume::shader
