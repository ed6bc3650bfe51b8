// The errors that a bake of each shipped scene tells are those that are left, plain and in layers.
#include "app/edit/prepare.h"
#include "assets/images/metrics.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <ostream>
#include <string>

namespace relume {
namespace {

// Coarse aims, so that a reference of few directions is good enough: its noise is a part of what is compared.
constexpr double kError = 0.05, kLocalError = 0.25;

struct ToldCase {
    const char* scene; // of the shipped ones
    uint32_t size;
    uint32_t truth; // directions per patch of the reference, on a CPU
    // Else a texel or two beside a lamp have most of the error, which four replicates tell within a factor of
    // three, and neither is the reference good enough there.
    bool even = true;
};

void PrintTo(const ToldCase& one, std::ostream* stream) {
    *stream << one.scene;
}

class ToldErrors : public testing::TestWithParam<ToldCase> {
protected:
    Baked bake(BakeDesc desc) const {
        desc.size = GetParam().size;
        desc.passes = 0;
        desc.method = Method::Hybrid;
        PreparedScene prepared = prepareScene(
            {.path = RELUME_SOURCE_DIR "/assets/scenes/" + std::string(GetParam().scene) + ".glb",
             .size = desc.size});
        Baker baker(testDevice(), prepared.scene, std::move(prepared.mesh), settingsOf(desc));
        while (!baker.solver().done())
            baker.solver().step();
        Baked baked;
        baked.lighting = baker.lightmap({.quantity = Quantity::Lighting, .sew = false});
        baked.progress = baker.solver().progress();
        return baked;
    }
};

} // namespace

TEST_P(ToldErrors, AreThoseThatAreLeft) {
    // A point on each light goes with 64 directions on a GPU and with 16 on a CPU, and points' noise counts,
    // too.
    const uint32_t ofPoint = testDevice().info().software() ? 1 : 4;
    const Baked truth = bake({.samples = ofPoint * GetParam().truth,
                              .directions = DirectionSet::Lec,
                              .rotation = Rotation::Interleaved});
    // A GPU reaches these aims by two to six points of a replicate. A layer's variance by so few is told as
    // that of independent points, and is less: shadows of the sun in the town are off by 0.6 to 0.9 of what
    // is told.
    const double mostOfFewPoints = ofPoint > 1 ? 1.5 : 1.3;
    for (const bool layers : {false, true}) {
        const Baked baked =
            bake({.error = kError, .localError = kLocalError, .smooth = true, .layers = layers});
        const ImagePair pair({baked.lighting, "bake"}, {truth.lighting, "truth"});
        const LocalPercentiles local = pair.percentiles(pair.localErrors());
        const double error = pair.measure().relRmse;
        EXPECT_NEAR(baked.progress.localError95 / local.p95, 1.0, 0.3) << layers;
        if (!GetParam().even) continue;
        EXPECT_GT(baked.progress.error / error, 0.7) << layers;
        EXPECT_LT(baked.progress.error / error, layers ? mostOfFewPoints : 1.3) << layers;
    }
}

INSTANTIATE_TEST_SUITE_P(Shipped, ToldErrors,
                         testing::Values(ToldCase{"cornell_geom", 64, 1024},
                                         ToldCase{"cornell_small", 64, 1024},
                                         ToldCase{"cornell_layers", 64, 1024},
                                         ToldCase{"cornell_statue", 64, 1024}, ToldCase{"gallery", 96, 1024},
                                         ToldCase{"octagon", 48, 1024, false},
                                         ToldCase{"atrium", 96, 512, false}, ToldCase{"town", 128, 256}),
                         [](const auto& test) { return std::string(test.param.scene); });

} // namespace relume
