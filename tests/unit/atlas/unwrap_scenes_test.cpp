// This unwraps the scenes that ship, and looks at every texel of their atlases.
#include "assets/atlas/unwrap.h"

#include "assets/atlas/lightmap_atlas.h"
#include "assets/gltf/gltf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

// What reaches less far into a texel does not touch it: masks allow that, and floats are rounded.
constexpr double kInside = 0.01; // [texels]

bool isTouched(const glm::dvec2* p, int x, int y) { // separating axes
    const glm::dvec2 centre(x + 0.5, y + 0.5);
    const double half = 0.5 - kInside;
    for (int e = 0; e < 3; ++e) {
        const glm::dvec2 edge = p[(e + 1) % 3] - p[e];
        glm::dvec2 normal(-edge.y, edge.x);
        if (glm::dot(normal, p[(e + 2) % 3] - p[e]) < 0.0) normal = -normal;
        if (glm::dot(normal, centre - p[e]) + half * (std::abs(normal.x) + std::abs(normal.y)) <= 0.0)
            return false;
    }
    return true;
}

struct Texels {
    uint64_t touched = 0, twice = 0;
};

/// Counts the texels that charts touch, and those that two do.
Texels countTexels(const UnwrapMemory& memory, int size) {
    std::vector<int> owner(static_cast<size_t>(size) * size, -1);
    std::vector<uint8_t> shared(owner.size());
    int chart = 0;
    const auto add = [&](const glm::dvec2* p) {
        const glm::dvec2 low = glm::min(p[0], glm::min(p[1], p[2])) + kInside;
        const glm::dvec2 high = glm::max(p[0], glm::max(p[1], p[2])) - kInside;
        for (int y = std::max(int(low.y), 0); y < std::min(high.y, double(size)); ++y)
            for (int x = std::max(int(low.x), 0); x < std::min(high.x, double(size)); ++x) {
                const size_t texel = static_cast<size_t>(y) * size + static_cast<size_t>(x);
                if (owner[texel] == chart || !isTouched(p, x, y)) continue;
                if (owner[texel] < 0)
                    owner[texel] = chart;
                else
                    shared[texel] = 1;
            }
    };
    for (const UnwrapMemory::Object& object : memory.objects)
        for (size_t i = 0; i < object.places.size(); ++i, ++chart) {
            const std::vector<glm::dvec2>& uv = memory.shapes[object.shape].charts[i].uv;
            for (size_t k = 0; k < uv.size(); k += 3) {
                const glm::dvec2 p[3] = {object.places[i].texelOf(uv[k]), object.places[i].texelOf(uv[k + 1]),
                                         object.places[i].texelOf(uv[k + 2])};
                add(p);
            }
        }
    Texels texels;
    for (size_t i = 0; i < owner.size(); ++i) {
        texels.touched += owner[i] >= 0;
        texels.twice += shared[i];
    }
    return texels;
}

struct Expected {
    const char* name;
    uint32_t size;
    double covered; // at least
};

void PrintTo(const Expected& expected, std::ostream* out) {
    *out << expected.name << " at " << expected.size;
}

class UnwrappedScene : public testing::TestWithParam<Expected> {};

TEST_P(UnwrappedScene, NoTexelIsTouchedTwice) {
    const auto [name, size, covered] = GetParam();
    Scene scene = loadGltf(std::string(RELUME_SOURCE_DIR) + "/assets/scenes/" + name + ".glb");
    UnwrapMemory memory;
    const UnwrapResult result = unwrap(scene, {.size = size, .onlyMissing = false}, &memory);
    EXPECT_EQ(result.objects, scene.instances.size());
    const LightmapAtlas atlas = buildAtlas(scene, size, true);
    EXPECT_FALSE(atlas.repacked);
    const AtlasStatistics statistics = measureAtlas(scene, atlas, size);
    EXPECT_EQ(statistics.overlap, 0.0); // of the UVs as they are written
    EXPECT_LE(statistics.coverage, result.covered);
    EXPECT_LE(statistics.stretch, 1.15);
    const Texels texels = countTexels(memory, int(size));
    EXPECT_EQ(texels.twice, 0u);
    const double share = double(texels.touched) / (double(size) * size);
    EXPECT_NEAR(share, result.covered, 0.005);
    EXPECT_GE(share, covered);
    EXPECT_GT(result.reserved, share);
}

INSTANTIATE_TEST_SUITE_P(Shipped, UnwrappedScene,
                         testing::Values(Expected{"cornell_statue", 1024, 0.88},
                                         Expected{"atrium", 1024, 0.90}, Expected{"gallery", 512, 0.80},
                                         Expected{"octagon", 256, 0.45}, Expected{"cornell_geom", 384, 0.80},
                                         Expected{"town", 1024, 0.90}, Expected{"raw", 1024, 0.88},
                                         Expected{"cornell_layers", 64, 0.5},
                                         Expected{"cornell_small", 128, 0.6}),
                         [](const testing::TestParamInfo<Expected>& tested) {
                             return std::string(tested.param.name);
                         });

} // namespace
} // namespace relume
