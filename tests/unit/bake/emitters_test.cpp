#include "bake/lights/emitters.h"

#include "assets/images/float_image.h"
#include "bake/lights/emitter_pieces.h"
#include "bake/lights/light_tree.h"
#include "tests/unit/closed_forms.h"
#include "tests/unit/emitter_scene.h"

#include <gtest/gtest.h>

#include <cmath>

namespace relume {
namespace {

using shader::EmitterPolygon;

double areaOf(const EmitterSet& set) {
    double sum = 0;
    for (const EmitterPolygon& p : set.polygons)
        sum += p.area;
    return sum;
}

// Returns the sum of area times radiance.
glm::dvec3 powerOf(const EmitterSet& set) {
    glm::dvec3 sum(0);
    for (const EmitterPolygon& p : set.polygons)
        sum += double(p.area) * glm::dvec3(p.radiance);
    return sum;
}

Primitive triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    return test::primitiveOf({a, b, c}, {0, 1, 2});
}

// Makes n x n squares over the unit square that share corners.
Primitive grid(uint32_t n) {
    std::vector<glm::vec3> positions;
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < (n + 1) * (n + 1); ++i)
        positions.push_back(glm::vec3(i % (n + 1), i / (n + 1), 0) / float(n));
    for (uint32_t i = 0; i < n * n; ++i) {
        const uint32_t a = i / n * (n + 1) + i % n, b = a + 1, c = a + n + 1, d = c + 1;
        indices.insert(indices.end(), {a, b, d, a, d, c});
    }
    return test::primitiveOf(positions, indices);
}

// Returns the mean over a receiving unit square at `corner` of the form factor towards the mesh lights.
double meanFactor(const EmitterSet& set, glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
    constexpr int n = 32;
    const glm::vec3 normal = glm::normalize(glm::cross(u, v));
    double sum = 0;
    for (int i = 0; i < n * n; ++i)
        for (const EmitterPolygon& e : set.polygons)
            sum += shader::emitterFormFactor(
                corner + (float(i % n) + 0.5f) / n * u + (float(i / n) + 0.5f) / n * v, normal, e);
    return sum / (n * n);
}

// Returns a triangle, a kite and a rectangle in z = 0, seen from above.
std::vector<EmitterPolygon> nearShapes() {
    const auto shape = [](glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, uint32_t kind, float split) {
        EmitterPolygon e{};
        e.c0 = a, e.c1 = b, e.c2 = c, e.c3 = d, e.shape = kind, e.split = split;
        e.area = 0.5f * glm::length(shader::emitterFront(e));
        return e;
    };
    return {shape({0, 0, 0}, {2, 0, 0}, {0.5f, 1, 0}, {0.5f, 1, 0}, shader::kEmitterTriangle, 1.0f),
            shape({0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 1, 0}, shader::kEmitterQuad, 0.75f),
            shape({0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, shader::kEmitterParallelogram, 0.5f)};
}

} // namespace

TEST(Emitters, SquaresLightSquaresAsInTheCatalogue) {
    for (const bool alone : {false, true}) { // as one square, and as two triangles
        EmitterSet set;
        if (alone) {
            Scene scene = test::glowing(triangle({0, 0, 0}, {1, 0, 0}, {1, 1, 0}));
            scene.meshes[0].primitives.push_back(triangle({1e-3f, 0, 0}, {1, 1, 0}, {0, 1, 0}));
            scene.meshes[0].primitives[1].positions[0].x = 0;
            scene.meshes[0].primitives[1].material = 1; // another material: they stay apart
            scene.materials.push_back(scene.materials[0]);
            set = test::emittersOf(scene);
        } else {
            set = test::emittersOf(test::glowing(test::square()));
        }
        ASSERT_EQ(set.polygons.size(), alone ? 2u : 1u);
        const double parallel = meanFactor(set, {0, 0, 1}, {0, 1, 0}, {1, 0, 0});
        EXPECT_NEAR(parallel, closed::parallelRectangles(1, 1, 1), 1e-4);
        const double perpendicular = meanFactor(set, {0, 0, 0}, {0, 1, 0}, {0, 0, 1});
        EXPECT_NEAR(perpendicular, closed::perpendicularRectangles(1, 1, 1), 2e-3); // mean of midpoints
        EXPECT_EQ(meanFactor(set, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}), 0.0);          // its back
    }
}

TEST(Emitters, PointsAreUniformInAreaWhateverTheShape) {
    Scene scene = test::glowing(triangle({0, 0, 0}, {2, 0, 0}, {0.5f, 1, 0}));
    test::addInstance(scene, test::addMesh(scene, test::square()));
    Primitive kite = test::primitiveOf({{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
    kite.material = scene.meshes[1].primitives[0].material = 0;
    test::addInstance(scene, test::addMesh(scene, kite));
    const EmitterSet set = test::emittersOf(scene);
    ASSERT_EQ(set.polygons.size(), 3u);
    for (const EmitterPolygon& e : set.polygons) {
        // Moments are held against those of the two triangles.
        glm::dvec3 mean(0), square(0), meanRight(0), squareRight(0);
        const glm::dvec3 c[4] = {e.c0, e.c1, e.c2, e.c3};
        double area = 0;
        for (int k = 1; k <= 2; ++k) {
            const glm::dvec3 a = c[0], b = c[k], d = c[k + 1];
            const double part = 0.5 * glm::length(glm::cross(b - a, d - a));
            meanRight += part * (a + b + d) / 3.0;
            squareRight += part * (a * a + b * b + d * d + (a + b + d) * (a + b + d)) / 12.0;
            area += part;
        }
        EXPECT_NEAR(e.area, area, 1e-5);
        constexpr int n = 128;
        for (int i = 0; i < n * n; ++i) {
            const glm::vec3 y = shader::emitterPoint(e, (glm::vec2(i % n, i / n) + 0.5f) / float(n));
            for (int k = 0; k < 4; ++k) { // inside
                if (e.shape == shader::kEmitterTriangle && k == 2) continue;
                const glm::dvec3 edge = c[(k + 1) % 4] - c[k];
                EXPECT_GE(glm::cross(edge, glm::dvec3(y) - c[k]).z, -1e-5);
            }
            mean += glm::dvec3(y) / double(n * n), square += glm::dvec3(y * y) / double(n * n);
        }
        EXPECT_LT(glm::length(mean - meanRight / area), 1e-3) << e.shape;
        EXPECT_LT(glm::length(square - squareRight / area), 2e-3) << e.shape;
    }
}

TEST(Emitters, PointFactorsAverageToTheFormFactor) {
    Scene scene = test::glowing(triangle({0, 0, 0}, {2, 0, 0}, {0.5f, 1, 0}));
    Primitive kite = test::primitiveOf({{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
    kite.material = 0;
    test::addInstance(scene, test::addMesh(scene, kite));
    const EmitterSet set = test::emittersOf(scene);
    ASSERT_EQ(set.polygons.size(), 2u);
    const glm::vec3 p(0.3f, 0.4f, 0.5f);
    for (const glm::vec3 n : {glm::vec3(0, 0, -1), glm::vec3(1, 0, 0), glm::normalize(glm::vec3(1, 1, -1))}) {
        for (const EmitterPolygon& e : set.polygons) {
            constexpr int side = 256; // fine enough for the horizon's edge
            double sum = 0;
            for (int i = 0; i < side * side; ++i) {
                const glm::vec2 u = (glm::vec2(i % side, i / side) + 0.5f) / float(side);
                sum += shader::emitterPointFactor(p, n, e, shader::emitterPoint(e, u));
            }
            const double exact = shader::emitterFormFactor(p, n, e);
            EXPECT_GT(exact, 0.01);
            EXPECT_NEAR(sum / (side * side), exact, 2e-3 * exact) << e.shape;
        }
    }
    const EmitterPolygon& e = set.polygons[0];
    EXPECT_EQ(shader::emitterPointFactor({0, 0, -1}, {0, 0, 1}, e, {0.5f, 0.5f, 0}), 0.0f); // behind
    EXPECT_EQ(shader::emitterPointFactor({0, 0, 1}, {0, 0, 1}, e, {0.5f, 0.5f, 0}), 0.0f);  // turned away
}

TEST(Emitters, SamplesOfNearEmittersAverageToTheFormFactorAndAreEven) {
    for (const EmitterPolygon& e : nearShapes()) {
        for (const glm::vec3 p : {glm::vec3(0.3f, 0.4f, 0.5f), {0.8f, 0.3f, 0.02f}, {0.7f, -0.001f, 0.01f}}) {
            for (const glm::vec3 n : {glm::vec3(0, 0, -1), glm::normalize(glm::vec3(1, 1, -1))}) {
                constexpr int side = 256;
                double sum = 0, squares = 0;
                for (int i = 0; i < side * side; ++i) {
                    const glm::vec2 u = (glm::vec2(i % side, i / side) + 0.5f) / float(side);
                    const double f = shader::emitterSample(p, n, e, u).factor;
                    sum += f, squares += f * f;
                }
                const double mean = sum / (side * side), exact = shader::emitterFormFactor(p, n, e);
                EXPECT_NEAR(mean, exact, 0.015 * exact)
                    << e.shape << " at " << p.z; // what a grid of numbers leaves
                const double variance = squares / (side * side) - mean * mean;
                EXPECT_LT(std::sqrt(std::max(0.0, variance)), 0.7 * mean) << e.shape << " at " << p.z;
            }
        }
    }
    const EmitterPolygon e = nearShapes()[0]; // far away nothing is halved
    const glm::vec2 u(0.3f, 0.8f);
    EXPECT_EQ(shader::emitterSample({1, 1, 9}, {0, 0, -1}, e, u).point, shader::emitterPoint(e, u));
}

// The few points of each sample pass tell the share of a near mesh light that is seen; the mean of many
// sample passes is the share, whatever the numbers were scrambled with. The part of it where x < .7 is
// hidden, so that the rest's own form factor is exact.
TEST(Emitters, SharesOfNearEmittersConvergeWhateverTheSeed) {
    const EmitterPolygon e = nearShapes()[2];
    ASSERT_EQ(e.shape, shader::kEmitterParallelogram);
    constexpr float edge = 0.7f;
    for (const glm::vec3 p : {glm::vec3(0.72f, 0.4f, 0.03f), {0.6f, 0.5f, 0.2f}, {0.69f, 1.2f, 0.01f}}) {
        const glm::vec3 n(0, 0, -1);
        const double exact =
            shader::polygonFormFactor(p, n, {edge, 0, 0}, {2, 0, 0}, {2, 2, 0}, {edge, 2, 0}) /
            shader::emitterFormFactor(p, n, e);
        for (uint32_t seed : {1u, 77u, 4242u, 987'654u}) {
            constexpr uint32_t samplePasses = 8192, points = 4;
            double mean = 0;
            for (uint32_t samplePass = 0; samplePass < samplePasses; ++samplePass) {
                double visible = 0, all = 0;
                for (uint32_t s = 0; s < points; ++s) {
                    const shader::EmitterSample y =
                        shader::emitterSample(p, n, e, shader::sobolPoint(samplePass * points + s, seed));
                    all += y.factor;
                    if (y.point.x > edge) visible += y.factor;
                }
                if (all > 0) mean += visible / all / samplePasses;
            }
            EXPECT_NEAR(mean, exact, 0.006) << p.z << " seed " << seed;
        }
    }
}

TEST(Emitters, TrianglesOfOnePlaneBecomeQuadrilaterals) {
    const EmitterSet cube = test::emittersOf(test::glowing(test::cube(), {1, 2, 3}));
    EXPECT_EQ(cube.polygons.size(), 6u);
    EXPECT_NEAR(areaOf(cube), 6, 1e-5);
    EXPECT_NEAR(cube.power, 6 * 2, 1e-5);
    for (const EmitterPolygon& e : cube.polygons) {
        EXPECT_EQ(e.shape, shader::kEmitterParallelogram);
        const glm::vec3 centre = 0.25f * (e.c0 + e.c1 + e.c2 + e.c3);
        EXPECT_NEAR(glm::dot(shader::emitterNormal(e), centre - 0.5f), 0.5f, 1e-6f); // outwards
    }
    const EmitterSet squares = test::emittersOf(test::glowing(grid(8)));
    EXPECT_EQ(squares.polygons.size(), 64u);
    EXPECT_NEAR(areaOf(squares), 1, 1e-5);
    for (const EmitterPolygon& e : squares.polygons)
        EXPECT_NEAR(glm::length(e.c2 - e.c0), std::sqrt(2.0f) / 8, 1e-6f); // squares, no slanted ones
    const Primitive knot = test::torusKnot(100, 12);
    const EmitterSet bent = test::emittersOf(test::glowing(knot));
    const WorldMesh mesh = test::flattened(test::glowing(knot));
    double area = 0;
    for (size_t i = 0; i < mesh.positions.size(); i += 3)
        area += 0.5 * glm::length(glm::cross(glm::dvec3(mesh.positions[i + 1] - mesh.positions[i]),
                                             glm::dvec3(mesh.positions[i + 2] - mesh.positions[i])));
    EXPECT_NEAR(areaOf(bent), area, 1e-4 * area);
    EXPECT_GT(bent.polygons.size(), mesh.triangleCount() * 99 / 100); // bent nearly everywhere
}

TEST(Emitters, ConcaveAndFoldedPairsStayTriangles) {
    // These are an arrow head and a sheet folded by 3 degrees.
    const Primitive arrow =
        test::primitiveOf({{0, 0, 0}, {2, 1, 0}, {0.5f, 1, 0}, {0, 3, 0}}, {0, 1, 2, 0, 2, 3});
    EXPECT_EQ(test::emittersOf(test::glowing(arrow)).polygons.size(), 2u);
    const Primitive fold =
        test::primitiveOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.05f}}, {0, 1, 2, 0, 2, 3});
    EXPECT_EQ(test::emittersOf(test::glowing(fold)).polygons.size(), 2u);
}

TEST(Emitters, DoubleSidedOnesShineBothWays) {
    for (const Primitive& shape : {test::square(), triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})}) {
        Scene scene = test::glowing(shape);
        scene.materials[0].doubleSided = true;
        const EmitterSet set = test::emittersOf(scene);
        ASSERT_EQ(set.polygons.size(), 2u);
        EXPECT_EQ(shader::emitterNormal(set.polygons[0]), glm::vec3(0, 0, 1));
        EXPECT_EQ(shader::emitterNormal(set.polygons[1]), glm::vec3(0, 0, -1));
        const glm::vec3 up(0, 0, 1), above(0.2f, 0.3f, 0.4f), below(0.2f, 0.3f, -0.4f);
        EXPECT_NEAR(shader::emitterFormFactor(above, -up, set.polygons[0]),
                    shader::emitterFormFactor(below, up, set.polygons[1]), 1e-6f);
        EXPECT_EQ(shader::emitterFormFactor(below, up, set.polygons[0]), 0.0f);
    }
}

TEST(Emitters, RaysEndABitOfATexelAboveTheSurface) {
    const Scene mapped = test::glowing(test::square());
    const EmitterSet set = test::emittersOf(mapped, {.size = 100}); // 1 m over 100 texels
    const float rounding = 4 * 1.2e-7f;
    EXPECT_NEAR(set.polygons[0].offset, 1e-4f * 0.01f + rounding, 1e-8f);
    Scene scaled = mapped;
    scaled.instances[0].transform = glm::scale(glm::mat4(1), glm::vec3(1000));
    EXPECT_NEAR(test::emittersOf(scaled, {.size = 100}).polygons[0].offset, 1000 * set.polygons[0].offset,
                1e-5f);
    Scene bare = test::glowing(test::cube()); // without lightmap UVs, and nobody else has any
    EXPECT_NEAR(test::emittersOf(bare).polygons[0].offset, 1e-4f * std::sqrt(0.5f) + rounding, 1e-6f);
}

TEST(Emitters, PlainTexturesStayOnePiece) {
    const EmitterSet plain =
        test::emittersOf(test::glowingPicture(64, 64, [](auto...) { return glm::u8vec3(188); }));
    ASSERT_EQ(plain.polygons.size(), 1u);
    EXPECT_NEAR(plain.polygons[0].radiance.g, linearFromSrgb(188 / 255.0), 1e-6);
    // The picture is half black and read without interpolation: exactly the white half is left.
    Scene scene =
        test::glowingPicture(64, 32, [](uint32_t x, uint32_t) { return glm::u8vec3(x < 32 ? 255 : 0); });
    scene.textures[0].nearest = true;
    const EmitterSet half = test::emittersOf(scene);
    ASSERT_EQ(half.polygons.size(), 1u);
    EXPECT_NEAR(half.polygons[0].area, 0.5f, 1e-6f);
    EXPECT_NEAR(shader::emitterPoint(half.polygons[0], {0.5f, 0.5f}).x, 0.25f, 1e-6f);
    // All black leaves nothing.
    EXPECT_TRUE(test::emittersOf(test::glowingPicture(8, 8, [](auto...) {
                    return glm::u8vec3(0);
                })).polygons.empty());
}

namespace {

glm::u8vec3 pattern(uint32_t x, uint32_t y) {
    const auto wave = [](double t) { return uint8_t(127.5 * (1 + std::sin(t))); };
    return {wave(0.2 * x), wave(0.13 * y + 0.05 * x), uint8_t(x / 7 % 2 == y / 5 % 2 ? 255 : 0)};
}

// Returns the power by brute force: 8 x 8 samples per texel of the picture, bilinear between the texels'
// centres.
glm::dvec3 densePower(const Scene& scene, glm::dvec2 repeats) {
    const Image& image = scene.images[0];
    const auto texel = [&](int x, int y) {
        const int w = int(image.width), h = int(image.height);
        x = (x % w + w) % w, y = (y % h + h) % h;
        const uint8_t* p = &image.rgba[size_t(y * w + x) * 4];
        return glm::dvec3(linearFromSrgb(p[0] / 255.0), linearFromSrgb(p[1] / 255.0),
                          linearFromSrgb(p[2] / 255.0));
    };
    const glm::ivec2 n = glm::ivec2(8.0 * repeats * glm::dvec2(image.width, image.height));
    glm::dvec3 sum(0);
    for (int i = 0; i < n.x * n.y; ++i) {
        const glm::dvec2 p = (glm::dvec2(i % n.x, i / n.x) + 0.5) / 8.0 - 0.5;
        const glm::ivec2 c = glm::ivec2(glm::floor(p));
        const glm::dvec2 f = p - glm::floor(p);
        sum += glm::mix(glm::mix(texel(c.x, c.y), texel(c.x + 1, c.y), f.x),
                        glm::mix(texel(c.x, c.y + 1), texel(c.x + 1, c.y + 1), f.x), f.y);
    }
    return sum / double(n.x * n.y);
}

void expectPower(const EmitterSet& set, glm::dvec3 right) {
    const glm::dvec3 power = powerOf(set);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(power[c], right[c], 0.005 * right[c]) << "component " << c;
}

} // namespace

TEST(Emitters, TexturedPowerIsThatOfADenseQuadrature) {
    Scene scene = test::glowingPicture(61, 47, pattern);
    const EmitterSet set = test::emittersOf(scene);
    EXPECT_GT(set.polygons.size(), 100u);
    EXPECT_LT(set.polygons.size(), 61u * 47u);
    expectPower(set, densePower(scene, {1, 1}));
    EXPECT_NEAR(areaOf(set), 1, 0.01); // hardly anything of it is black
    // The picture is repeated and moved by KHR_texture_transform.
    scene.materials[0].emissionTexture.transform = glm::mat3(2, 0, 0, 0, 3, 0, 0.25f, 0.5f, 1);
    expectPower(test::emittersOf(scene), densePower(scene, {2, 3}));
    // On a triangle it is half the square's, for a picture symmetrical about the diagonal.
    const auto symmetrical = [](uint32_t x, uint32_t y) { return pattern(std::min(x, y), std::max(x, y)); };
    Scene half = test::glowingPicture(48, 48, symmetrical);
    half.meshes[0].primitives[0].indices.resize(3);
    expectPower(test::emittersOf(half), 0.5 * densePower(half, {1, 1}));
}

TEST(Emitters, WrapModesAreTheSamplers) {
    // This is a ramp in x over uv 0 to 2: mirrored it comes back, clamped it stays bright.
    Scene scene = test::glowingPicture(64, 4, [](uint32_t x, uint32_t) { return glm::u8vec3(x * 4); });
    scene.materials[0].emissionTexture.transform = glm::mat3(2, 0, 0, 0, 1, 0, 0, 0, 1);
    double once = 0, last = 0;
    for (uint32_t x = 0; x < 64; ++x)
        last = linearFromSrgb(x * 4 / 255.0), once += last / 64;
    const auto powerWith = [&](Wrap wrap) {
        scene.textures[0].wrapS = wrap;
        return powerOf(test::emittersOf(scene)).r;
    };
    EXPECT_NEAR(powerWith(Wrap::MirroredRepeat), once, 0.01 * once);
    EXPECT_NEAR(powerWith(Wrap::Repeat), once, 0.01 * once);
    EXPECT_NEAR(powerWith(Wrap::ClampToEdge), 0.5 * (once + last), 0.01 * once);
}

TEST(Emitters, HolesOfMasksDoNotShine) {
    Scene scene = test::glowingPicture(32, 32, [](auto...) { return glm::u8vec3(255); });
    scene.materials[0].emissionTexture.texture = -1;
    scene.materials[0].baseColorTexture.texture = 0;
    scene.materials[0].alphaMode = AlphaMode::Mask;
    for (uint32_t i = 0; i < 32 * 32; ++i)
        scene.images[0].rgba[i * 4 + 3] = i % 32 < 8 && i / 32 < 16 ? 0 : 255; // an eighth is a hole
    const EmitterSet set = test::emittersOf(scene);
    EXPECT_NEAR(powerOf(set).r, 7.0 / 8, 1e-3);
    EXPECT_LE(set.polygons.size(), 3u); // the cuts follow the hole
    for (const EmitterPolygon& e : set.polygons)
        EXPECT_EQ(e.radiance.r, 1.0f);
}

TEST(Emitters, ACapOnPiecesKeepsThePower) {
    const Scene scene = test::glowingPicture(61, 47, pattern);
    const EmitterSet set = test::emittersOf(scene, {.maxPieces = 50});
    EXPECT_EQ(set.polygons.size(), 50u);
    expectPower(set, densePower(scene, {1, 1}));
    const WorldMesh mesh = test::flattened(scene);
    EmitterSurface surface;
    surface.position[1] = {1, 0, 0}, surface.position[2] = {0, 1, 0};
    surface.emissionUv[1] = {1, 0}, surface.emissionUv[2] = {0, 1};
    surface.area = 1, surface.isTriangle = false;
    EXPECT_TRUE(splitEmission(scene, {surface}, 50).capped);
    EXPECT_FALSE(splitEmission(scene, {surface}, 5000).capped);
}

} // namespace relume
