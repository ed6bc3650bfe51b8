// Where links would end elsewhere after patches came to send, or ceased to.
#include "bake/baker/link_ends.h"

#include <gtest/gtest.h>

#include <set>

namespace relume {
namespace {

constexpr uint32_t kSheetEdge = 16; // texels

// A lightmap of two charts side by side, a patch in each texel in the order of the texels.
struct Charts {
    TraceScene scene;

    Charts() {
        scene.size = kSheetEdge;
        for (uint32_t texel = 0; texel < kSheetEdge * kSheetEdge; ++texel) {
            shader::Patch p{};
            p.flags = shader::kPatchSends | texel << shader::kTexelShift;
            scene.patches.push_back(p);
            scene.patchChart.push_back(texel % kSheetEdge < 10 ? 0 : 1);
            scene.texelToPatch.push_back(texel);
        }
        for (const uint32_t patch : {at(2, 14), at(12, 1)}) {
            shader::HitTriangle triangle{};
            triangle.chart = scene.patchChart[patch];
            triangle.representative = patch;
            scene.hitTriangles.push_back(triangle);
        }
        shader::HitTriangle outside{};
        outside.chart = kNoChart;
        outside.representative = shader::kNoPatch;
        scene.hitTriangles.push_back(outside);
    }
    static uint32_t at(uint32_t column, uint32_t row) { return row * kSheetEdge + column; }
    void silence(uint32_t patch) { scene.patches[patch].flags &= ~shader::kPatchSends; }
    // Returns the patches that links are traced again of which end there.
    std::set<uint32_t> ends(const std::vector<uint32_t>& patches) const {
        ObjectMove move;
        move.changed.assign(scene.chunkCount(), glm::uvec2(0));
        addLinkEnds(scene, patches, move);
        std::set<uint32_t> result;
        for (uint32_t i = 0; i < scene.patches.size(); ++i)
            if (move.hasEnd(i)) result.insert(i);
        return result;
    }
};

TEST(LinkEnds, OfAPatchThatSendsNoMoreAreItself) {
    Charts charts;
    charts.silence(Charts::at(5, 5));
    EXPECT_EQ(charts.ends({Charts::at(5, 5)}), std::set{Charts::at(5, 5)});
    EXPECT_TRUE(charts.ends({}).empty());
}

TEST(LinkEnds, OfAPatchThatSendsAreAroundItInItsChart) {
    const Charts charts;
    const std::set<uint32_t> ends = charts.ends({Charts::at(8, 1)});
    for (uint32_t row = 0; row < kSheetEdge; ++row) {
        for (uint32_t column = 0; column < kSheetEdge; ++column) {
            const bool around = column >= 4 && column < 10 && row <= 5;
            const bool representative = column == 2 && row == 14;
            EXPECT_EQ(ends.count(Charts::at(column, row)), around || representative ? 1u : 0u)
                << column << ", " << row;
        }
    }
}

TEST(LinkEnds, OfPatchesWithoutAChartAreNone) {
    Charts charts;
    charts.scene.patchChart[Charts::at(3, 3)] = kNoChart;
    EXPECT_TRUE(charts.ends({Charts::at(3, 3)}).empty());
}

TEST(LinkEnds, OfTwoMovesAreThoseOfBoth) {
    ObjectMove first, second;
    first.changed.assign(4, glm::uvec2(0));
    second.changed.assign(4, glm::uvec2(0));
    first.change(3);
    second.addEnd(70);
    ObjectMove both = first;
    both.add(second);
    EXPECT_TRUE(both.has(3) && both.hasEnd(70));
    EXPECT_FALSE(both.hasEnd(3) || both.has(70) || first.hasEnd(70));
    second.add(first);
    EXPECT_TRUE(second.has(3) && second.hasEnd(70));
}

} // namespace
} // namespace relume
