// What sample passes count in a layer's direct light, within penumbrae and outside.
#include "bake/layers/layer_passes.h"

#include <gtest/gtest.h>

#include <vector>

namespace relume {
namespace {

// Returns by how much each sample pass counts in the end, for patches outside penumbrae (0) or within (1),
// after steps that end before these.
std::vector<double> weights(int kind, const std::vector<uint32_t>& ends) {
    std::vector<double> weight;
    uint32_t before = 0;
    for (const uint32_t end : ends) {
        const DirectShares shares = directShares(before, end - before);
        const double share = shares.share[kind], scale = shares.scale[kind];
        if (share > 0)
            for (double& w : weight)
                w *= 1.0 - share;
        for (uint32_t pass = before; pass < end; ++pass)
            weight.push_back(kind == 1 || shader::allTakeSamplePass(pass) ? share * scale : 0.0);
        before = end;
    }
    return weight;
}

TEST(DirectShares, WithinAPenumbraAllCountAlike) {
    for (const double w : weights(1, {2, 4, 8, 16, 32}))
        EXPECT_NEAR(w, 1.0 / 32, 1e-6);
}

TEST(DirectShares, OutsideTheFirstCountsUntilThereIsAnother) {
    EXPECT_EQ(weights(0, {2, 4}), (std::vector<double>{1, 0, 0, 0}));
    EXPECT_EQ(weights(0, {2, 4, 8}), (std::vector<double>{0, 0, 0, 0, 1, 0, 0, 0}));
    const std::vector<double> weight = weights(0, {2, 4, 8, 16, 32});
    for (size_t pass = 0; pass < weight.size(); ++pass)
        EXPECT_NEAR(weight[pass], pass == 4 || pass == 8 || pass == 16 || pass == 24 ? 0.25 : 0.0, 1e-6)
            << pass;
}

TEST(SamplePassesTogether, AreWholeInTheirStep) {
    std::vector<uint32_t> begins;
    for (uint32_t pass = 0; pass < 18; pass += samplePassesTogether(pass, 18))
        begins.push_back(pass);
    EXPECT_EQ(begins, (std::vector<uint32_t>{0, 1, 2, 3, 4, 8, 12, 16, 17}));
    EXPECT_EQ(samplePassesTogether(6, 16), 1u) << "they begin at a multiple of their number";
    EXPECT_EQ(samplePassesTogether(4, 7), 1u);
}

// Patches outside penumbrae take the first of them or none.
TEST(SamplePassesTogether, TheFirstAloneIsForAll) {
    for (uint32_t pass = shader::kSamplePassesTogether; pass < 200; ++pass)
        if (pass % shader::kSamplePassesTogether != 0) {
            EXPECT_FALSE(shader::allTakeSamplePass(pass)) << pass;
        }
}

} // namespace
} // namespace relume
