// The directional and the hybrid method are held against closed forms and the pure method; this also tests
// what must not change a byte.
#include "assets/generate/generate.h"
#include "bake/links/link_solver.h"
#include "tests/gpu/bake_comparison.h"
#include "tests/gpu/bake_scene.h"
#include "tests/unit/closed_forms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

// Makes one light of the last objects.
void joinLast(Scene& scene, size_t count) {
    const size_t first = scene.meshes.size() - count;
    std::vector<Primitive>& all = scene.meshes[first].primitives;
    for (size_t i = first + 1; i < scene.meshes.size(); ++i)
        all.push_back(scene.meshes[i].primitives.front());
    scene.meshes.resize(first + 1);
    scene.instances.resize(first + 1);
}

// A wall hides half of sixteen panels from each half of the floor, and of the rest all is seen: so replicates
// know each panel's share, and a single sample pass leaves no noise, as picks among them would. Texels have
// their means, and the middles' light is off by up to 0.3 %.
void expectExactPanels(bool layers) {
    SceneMaker maker(64);
    const TexelRect floor =
        maker.quad({-2, -2, 0}, 4.0f * kX, 4.0f * kY, maker.material(0.0f), glm::uvec2(24));
    const int black = maker.material(0.0f), lit = maker.material(0.0f, 1.0f);
    maker.blocker({0.01f, -9, -1}, 18.0f * kY, 3.0f * kZ, black); // they face away from each other
    maker.blocker({-0.01f, -9, -1}, 3.0f * kZ, 18.0f * kY, black);
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 16; ++i) {
        corners.emplace_back(-1.8f + 1.0f * static_cast<float>(i % 4),
                             -1.8f + 1.0f * static_cast<float>(i / 4), 1.0f);
        maker.blocker(corners.back(), 0.3f * kY, 0.3f * kX,
                      layers ? lit : maker.material(0.0f, 1.0f + static_cast<float>(i)));
    }
    Scene scene = maker.scene();
    if (layers) joinLast(scene, corners.size());
    const Baked baked = bakeScene(scene, {.size = maker.size(),
                                          .passes = 1,
                                          .method = Method::Hybrid,
                                          .samples = layers ? shader::kReplicates : 16,
                                          .layers = layers});
    for (uint32_t row = 0; row < floor.height; ++row) {
        for (uint32_t column = 0; column < floor.width; ++column) {
            const closed::Vec p{(column + 0.5) / 6 - 2, (row + 0.5) / 6 - 2, 0};
            double exact = 0;
            for (size_t i = 0; i < corners.size(); ++i) {
                const glm::vec3 c = corners[i];
                if ((c.x < 0) != (p[0] < 0)) continue;
                exact += (layers ? 1.0 : 1.0 + static_cast<double>(i)) *
                         closed::integratedParallelogram(p, {0, 0, 1}, {c.x, c.y, c.z}, {0, 0.3, 0},
                                                         {0.3, 0, 0}, 1e-5);
            }
            EXPECT_NEAR(texel(baked.lighting, floor, column, row), exact, 5e-3 * exact)
                << column << ", " << row;
        }
    }
}

} // namespace

// A closed room with differences in albedo and light is baked by each set and each rotation: all have the
// same mean, and the thesis' sets are as good as the sequence.
TEST(Directions, SetsAndRotationsAgree) {
    SceneMaker maker(64);
    std::array<int, 6> materials;
    materials.fill(maker.material(0.5f));
    materials[0] = maker.material(0.2f), materials[5] = maker.material(0.7f, 1.0f);
    std::array<glm::uvec2, 6> texels;
    texels.fill(glm::uvec2(16));
    const auto walls = maker.box({0, 0, 0}, {2.0f * kX, 1.0f * kY, 1.0f * kZ}, materials, texels);
    const auto bake = [&](DirectionSet set, Rotation rotation, uint32_t samples) {
        return bakeScene(maker.scene(), {.size = maker.size(),
                                         .passes = 4,
                                         .method = Method::Directional,
                                         .samples = samples,
                                         .directions = set,
                                         .rotation = rotation});
    };
    const Baked reference = bake(DirectionSet::Sobol, Rotation::Patch, 4096);
    const auto errorOf = [&](const Baked& baked) { // relRMSE over all walls
        double sum = 0, mean = 0;
        for (const TexelRect& wall : walls) {
            for (uint32_t i = 0; i < wall.width * wall.height; ++i) {
                const uint32_t column = i % wall.width, row = i / wall.width;
                const double right = texel(reference.lighting, wall, column, row);
                const double d = texel(baked.lighting, wall, column, row) - right;
                sum += d * d, mean += right;
            }
        }
        const double count = 6 * 256;
        return std::sqrt(sum / count) / (mean / count);
    };
    const double sobol = errorOf(bake(DirectionSet::Sobol, Rotation::Patch, 256));
    for (const DirectionSet set : {DirectionSet::Sobol, DirectionSet::Lec}) {
        for (const Rotation rotation : {Rotation::Patch, Rotation::Interleaved, Rotation::Tile}) {
            const Baked baked = bake(set, rotation, 256);
            EXPECT_LT(errorOf(baked), 2 * sobol) << int(set) << int(rotation);
            // A wall has only four tiles, whose errors are each the same all over.
            const double tolerance = rotation == Rotation::Patch ? 0.01 : 0.03;
            for (const TexelRect& wall : walls) {
                const double right = statistics(reference.lighting, wall).mean;
                EXPECT_NEAR(statistics(baked.lighting, wall).mean, right, tolerance * right)
                    << int(set) << int(rotation);
            }
        }
    }
}

TEST(Directions, FurnaceWithTheThesisSets) {
    SceneMaker maker(64);
    const auto walls =
        maker.box({3, 1, -2}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.5f, 1.0f), 20);
    const Baked baked = bakeScene(maker.scene(), {.size = maker.size(),
                                                  .passes = 0,
                                                  .error = 0.002,
                                                  .method = Method::Directional,
                                                  .samples = 256,
                                                  .directions = DirectionSet::Lec});
    for (const TexelRect& wall : walls)
        EXPECT_NEAR(statistics(baked.radiance, wall).mean, 2.0, 0.008);
}

class LinkMethods : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Both, LinkMethods, testing::Values(Method::Directional, Method::Hybrid),
                         [](const auto& which) { return std::string(methodName(which.param)); });

TEST_P(LinkMethods, FurnaceEndsAtTheSeriesLimit) {
    for (const float albedo : {0.25f, 0.8f}) {
        SceneMaker maker(64);
        const auto walls =
            maker.box({3, 1, -2}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(albedo, 1.0f), 20);
        const Baked baked = bakeScene(
            maker.scene(),
            {.size = maker.size(), .passes = 0, .error = 0.002, .method = GetParam(), .samples = 4096});
        for (const TexelRect& wall : walls) {
            const TexelStatistics s = statistics(baked.radiance, wall);
            EXPECT_EQ(s.count, wall.width * wall.height);
            EXPECT_NEAR(s.mean, 1.0 / (1.0 - albedo), 0.004 / (1.0 - albedo)) << albedo;
        }
    }
}

TEST_P(LinkMethods, ParallelSquares) {
    SceneMaker maker(65);
    const TexelRect receiver = maker.quad({0, 0, 0}, kX, kY, maker.material(0.0f), glm::uvec2(32));
    maker.quad({0, 0, 1}, kY, kX, maker.material(0.0f, 1.0f), glm::uvec2(32));
    const Baked baked =
        bakeScene(maker.scene(), {.size = maker.size(), .passes = 1, .method = GetParam(), .samples = 256});
    const double exact = closed::parallelRectangles(1, 1, 1);
    EXPECT_NEAR(statistics(baked.lighting, receiver).mean, exact, 0.005 * exact);
}

TEST_P(LinkMethods, ADarkCellStaysDark) {
    SceneMaker maker(128);
    maker.box({-1, -1, -1}, {2.0f * kX, 2.0f * kY, 2.0f * kZ}, maker.material(0.8f, 1.0f), 20);
    const auto cell =
        maker.box({-0.3f, -0.3f, -0.3f}, {0.6f * kX, 0.6f * kY, 0.6f * kZ}, maker.material(0.8f), 12);
    const Baked baked =
        bakeScene(maker.scene(), {.size = maker.size(), .passes = 3, .method = GetParam(), .samples = 64});
    for (const TexelRect& wall : cell)
        EXPECT_EQ(statistics(baked.lighting, wall).max, 0.0);
}

// With the same number of bounces both must find what pairs find; pure itself is some percent off at this
// size, where texels meet in corners, and what is seen of texels whose middles lie inside something sends
// nothing to it: links reflect 1.2 % more in cornell_layers. Against 256 x 256 they are off by 0.3 %.
TEST_P(LinkMethods, ReflectsAsMuchAsPure) {
    for (const char* name : {"cornell_geom", "cornell_layers"}) {
        const Scene scene = generateScene(name);
        const Baked pure = bakeScene(scene, {.size = 64, .passes = 3});
        BakeDesc desc{.size = 64, .passes = 3, .method = GetParam(), .samples = 1024};
        desc.allOver = false; // pairs are of texels' middles
        const Baked links = bakeScene(scene, desc);
        EXPECT_NEAR(reflectedFlux(links) / reflectedFlux(pure), 1.0, 0.015) << name;
        EXPECT_LT(relativeError(links.lighting, pure.lighting), GetParam() == Method::Hybrid ? 0.09 : 0.3)
            << name;
    }
}

// The size is the one that the scene's charts are made for: see agreement_test.cpp.
TEST_P(LinkMethods, TracersAgree) {
    const Scene scene = generateScene("cornell_geom");
    const BakeDesc desc{.size = 128, .passes = 2, .method = GetParam(), .samples = 16};
    expectTracersAgree(scene, desc, 5e-3);
}

TEST_P(LinkMethods, CacheAndBatchesChangeNoByte) {
    const Scene scene = generateScene("cornell_geom");
    const BakeDesc desc{.size = 48, .passes = 3, .method = GetParam(), .samples = 32};
    const Baked first = bakeScene(scene, desc);
    EXPECT_EQ(first.progress.cachedShare, 1.0);
    EXPECT_GT(first.progress.raysSaved, 0u);
    BakeDesc other = desc;
    other.batchMs = 1;
    EXPECT_TRUE(sameBytes(first.lighting, bakeScene(scene, other).lighting)) << "small batches";
    other.cache.kind = CacheSettings::Kind::None;
    const Baked without = bakeScene(scene, other);
    EXPECT_TRUE(sameBytes(first.lighting, without.lighting)) << "no cache";
    EXPECT_EQ(without.progress.raysSaved, 0u);
    EXPECT_GT(without.progress.rays, first.progress.rays);
    other.cache = {.kind = CacheSettings::Kind::Links, .bytes = 5 * 16 * shader::kChunk * sizeof(uint32_t)};
    const Baked some = bakeScene(scene, other);
    EXPECT_TRUE(sameBytes(first.lighting, some.lighting)) << "five chunks cached";
    EXPECT_GT(some.progress.raysSaved, 0u);
    EXPECT_LT(some.progress.raysSaved, first.progress.raysSaved);
}

// The error that is told is the distance to a bake with sixteen times the samples.
TEST_P(LinkMethods, ErrorIsTold) {
    const Scene scene = generateScene("cornell_geom");
    BakeDesc desc{.size = 48, .passes = 0, .error = 0, .method = GetParam(), .samples = 128};
    const Baked reference = [&] {
        BakeDesc longer = desc;
        longer.samples *= 16;
        return bakeScene(scene, longer);
    }();
    for (const bool smooth : {false, true}) {
        desc.smooth = smooth;
        const Baked baked = bakeScene(scene, desc);
        const double distance = relativeError(baked.lighting, reference.lighting);
        EXPECT_NEAR(baked.progress.error / distance, 1.0, 0.3) << "smoothed: " << smooth;
    }
}

// A near mesh light leans below the horizon; texel by texel, its light is exact where nothing is hidden.
TEST(Hybrid, UnhiddenEmittersAreExact) {
    const glm::vec3 corner(-0.3f, 0.0f, -0.5f), u = kY, v = glm::vec3(-0.3f, 0.1f, 1.2f);
    SceneMaker maker(64);
    const TexelRect plate = maker.quad({0, 0, 0}, kX, kY, maker.material(0.0f), glm::uvec2(16));
    maker.quad(corner, u, v, maker.material(0.0f, 1.0f), glm::uvec2(32));
    const Baked baked = bakeScene(
        maker.scene(), {.size = maker.size(), .passes = 1, .method = Method::Hybrid, .samples = 64});
    const auto vec = [](glm::vec3 p) { return closed::Vec{p.x, p.y, p.z}; };
    for (uint32_t row = 0; row < plate.height; ++row) {
        for (uint32_t column = 0; column < plate.width; ++column) {
            const glm::vec3 p((static_cast<float>(column) + 0.5f) / 16.0f,
                              (static_cast<float>(row) + 0.5f) / 16.0f, 0.0f);
            const double exact =
                closed::integratedParallelogram(vec(p), {0, 0, 1}, vec(corner), vec(u), vec(v), 1e-6);
            EXPECT_NEAR(texel(baked.lighting, plate, column, row), exact, 1e-3 * exact + 1e-5);
        }
    }
}

// The mesh light is a hundredth of a texel wide, and the only light there is.
TEST(Hybrid, ATinyEmitterIsFound) {
    SceneMaker maker(64);
    const TexelRect floor =
        maker.quad({-1, -1, 0}, 2.0f * kX, 2.0f * kY, maker.material(0.5f), glm::uvec2(32));
    constexpr float kEdge = 6e-4f;
    maker.quad({0, 0, 1}, kEdge * kY, kEdge * kX, maker.material(0.0f, 1e6f), glm::uvec2(1));
    const Baked baked = bakeScene(
        maker.scene(), {.size = maker.size(), .passes = 2, .method = Method::Hybrid, .samples = 16});
    for (uint32_t row = 0; row < floor.height; ++row) {
        for (uint32_t column = 0; column < floor.width; ++column) {
            const double x = (column + 0.5) / 16 - 1 - 0.5 * kEdge, y = (row + 0.5) / 16 - 1 - 0.5 * kEdge;
            const double r2 = x * x + y * y + 1;
            const double exact = 1e6 * kEdge * kEdge / (closed::kPi * r2 * r2);
            EXPECT_NEAR(texel(baked.lighting, floor, column, row), exact, 0.002 * exact);
        }
    }
}

// Forty mesh lights are all sampled, 320 are more than EmitterLight::kAllEmitters.
TEST(Hybrid, ManyEmittersAddUp) {
    for (const glm::ivec2 rows : {glm::ivec2(8, 5), glm::ivec2(20, 16)}) {
        SceneMaker maker(128);
        const TexelRect floor =
            maker.quad({-2, -2, 0}, 4.0f * kX, 4.0f * kY, maker.material(0.0f), glm::uvec2(24));
        const bool few = rows.x == 8;
        const glm::vec2 apart = few ? glm::vec2(0.4f, 0.8f) : glm::vec2(0.2f, 0.25f);
        const float step = few ? 0.1f : 0.0f; // so many would hide each other
        std::vector<glm::vec3> corners;
        for (int i = 0; i < rows.x * rows.y; ++i) {
            corners.emplace_back(-2.0f + apart.x * static_cast<float>(i % rows.x),
                                 -2.0f + apart.y * static_cast<float>(i / rows.x),
                                 1.0f + step * static_cast<float>(i % 3));
            maker.quad(corners.back(), 0.1f * kY, 0.1f * kX,
                       maker.material(0.0f, 1.0f + static_cast<float>(i)), glm::uvec2(2));
        }
        const Baked baked = bakeScene(
            maker.scene(), {.size = maker.size(), .passes = 1, .method = Method::Hybrid, .samples = 256});
        double sum = 0, exactSum = 0;
        for (uint32_t row = 0; row < floor.height; ++row) {
            for (uint32_t column = 0; column < floor.width; ++column) {
                const closed::Vec p{(column + 0.5) / 6 - 2, (row + 0.5) / 6 - 2, 0};
                for (size_t i = 0; i < corners.size(); ++i) {
                    const glm::vec3 c = corners[i];
                    exactSum += (1.0 + static_cast<double>(i)) *
                                closed::integratedParallelogram(p, {0, 0, 1}, {c.x, c.y, c.z}, {0, 0.1, 0},
                                                                {0.1, 0, 0}, 1e-5);
                }
                sum += texel(baked.lighting, floor, column, row);
            }
        }
        EXPECT_NEAR(sum / exactSum, 1.0, 0.005) << corners.size() << " mesh lights";
    }
}

TEST(Hybrid, LightsSeenOrHiddenAsAWholeAreExact) {
    expectExactPanels(false);
}

TEST(Hybrid, ALayersPolygonsSeenOrHiddenAsAWholeAreExact) {
    expectExactPanels(true);
}

// This holds also where so little is left that smoothing would do harm.
TEST(Hybrid, TheErrorToldFallsToTheOneAskedFor) {
    const double asked = 0.001;
    const auto baker =
        makeBaker(generateScene("cornell_small"),
                  {.size = 32, .passes = 0, .error = asked, .method = Method::Hybrid, .smooth = true});
    Solver& solver = baker->solver();
    double least = 1;
    while (!solver.done()) {
        solver.step();
        const double error = solver.progress().error;
        ASSERT_LT(error, 1.5 * least) << solver.progress().samples << " samples";
        least = std::min(least, error);
    }
    EXPECT_TRUE(solver.progress().converged);
    EXPECT_LE(solver.progress().error, asked);
}

TEST(Hybrid, AnErrorOutOfReachEndsWithTheMostSamples) {
    const Baked baked =
        bakeScene(generateScene("cornell_small"),
                  {.size = 12, .passes = 0, .error = 1e-7, .method = Method::Hybrid, .smooth = true});
    EXPECT_EQ(baked.progress.samples, LinkSolver::kMaxSamples);
    EXPECT_FALSE(baked.progress.converged);
}

} // namespace relume
