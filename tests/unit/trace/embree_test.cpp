#include "bake/trace/embree_scene.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "bake/links/directions.h"
#include "bake/trace/bvh_builder.h"
#include "bake/trace/embree_blockers.h"
#include "bake/trace/embree_chunks.h"
#include "tests/unit/trace_world.h"

namespace relume {
namespace shader {
namespace {

// Tests every ray against every triangle, with the shaders' own functions.
struct AllTriangles {
    const TraceScene& scene;
#include "shaders/lib/rays/intersect.glsl"
    float alphaTexel(uint offset) {
        return float(scene.alphaTexels[offset]) / 255.0f;
    }
#include "shaders/lib/rays/alpha.glsl"
    uint texelPatch(uint texel) {
        return scene.texelToPatch[texel];
    }
    uint chartOfPatch(uint patch) {
        return scene.patchChart[patch];
    }
#include "shaders/lib/rays/hit.glsl"

    struct Found {
        uint triangle = kNoPatch;
        TriangleHit hit{};
    };
    Found nearest(vec3 origin, vec3 direction, float tMin, float tMax) {
        const BvhRay ray = bvhRay(origin, direction);
        Found best;
        for (uint t = 0; t < scene.mesh.triangleCount(); ++t) {
            const vec3* p = &scene.mesh.positions[t * 3];
            const TriangleHit hit = intersectTriangle({p[0], t, p[1], 0, p[2], 0}, ray, tMin, tMax);
            if (!hit.hit) continue;
            if (t >= scene.mesh.opaqueCount) {
                const AlphaTriangle& alpha = scene.alphaTriangles[t - scene.mesh.opaqueCount];
                if (!alphaSolid(alpha, scene.alphaMaterials[alpha.material], hit.b1, hit.b2)) continue;
            }
            best = {t, hit};
            tMax = hit.t;
        }
        return best;
    }
    bool sees(uint i, uint j) {
        const Segment s = pairSegment(scene.patches[i], scene.patches[j], scene.rtrad);
        return s.tMax <= s.tMin || nearest(s.origin, s.direction, s.tMin, s.tMax).triangle == kNoPatch;
    }
    uint link(const Patch& patch, vec3 direction) {
        const Found found = nearest(patch.position + patch.offset * patch.normal, direction, 0, 1e30f);
        if (found.triangle == kNoPatch) return kLinkSky;
        const HitTriangle& t = scene.hitTriangles[found.triangle];
        if (dot(direction, t.normal) > 0) return t.doubleSided ? kLinkDark : kLinkBack;
        if (t.representative == kNoPatch) return kLinkDark;
        return patchAtHit(t, found.hit.b1, found.hit.b2, scene.size);
    }
};

} // namespace
} // namespace shader

namespace {

using shader::kBlockWords;
using shader::kChunk;
using shader::Patch;

// Makes a room with a sphere and a masked screen: all that occlusion knows.
TraceScene furnishedRoom() {
    TraceWorld world;
    world.addRoom({0, 0, 0}, {4, 3, 5}, 2);
    world.addBumpySphere({2, 1.2f, 1.5f}, 0.8f, 8);
    // It is placed so that no row of patches looks along a border of its holes.
    world.add([](float u, float v) { return glm::vec3(0.537f + 2.913f * u, 0.217f + 2.041f * v, 3.5f); }, 2,
              {.masked = true});
    return world.build();
}

struct Bits {
    std::vector<SuperBlock> supers;
    std::vector<uint32_t> words;
    std::vector<uint32_t> rays = std::vector<uint32_t>(shader::kRayCounters, 0);

    uint32_t units() const { return uint32_t(supers.size()) * shader::kSuperBlocks; }
    std::vector<uint32_t*> addresses() {
        std::vector<uint32_t*> result;
        for (size_t s = 0; s < supers.size(); ++s)
            result.push_back(&words[s * shader::kSuperWords]);
        return result;
    }
    // Returns the bit of patches i < j, or of a patch and a sender.
    bool at(uint32_t i, uint32_t j) const {
        const uint32_t row = i / kChunk, column = j / kChunk;
        const auto super = std::find_if(supers.begin(), supers.end(), [&](const SuperBlock& s) {
            return s.row == row / shader::kSuper && s.column == column / shader::kSuper;
        });
        const size_t unit = size_t(super - supers.begin()) * shader::kSuperBlocks +
                            row % shader::kSuper * shader::kSuper + column % shader::kSuper;
        return words[unit * kBlockWords + i % kChunk * 2 + j % kChunk / 32] >> j % 32 & 1;
    }
};

Bits traceBits(const TraceScene& scene, uint32_t threads) {
    WorkerPool pool(threads);
    EmbreeScene embree(scene, pool);
    Bits bits;
    const uint32_t rows = (scene.chunkCount() + shader::kSuper - 1) / shader::kSuper;
    for (uint32_t row = 0; row < rows; ++row)
        for (uint32_t column = row; column < rows; ++column)
            bits.supers.push_back({row, column, 0, {}, {}, 0});
    bits.words.assign(size_t(bits.units()) * kBlockWords, 0);
    const std::vector<uint32_t> sends(scene.chunkCount(), kChunk);
    const std::vector<uint32_t*> addresses = bits.addresses();
    embree.occlusion({.supers = bits.supers,
                      .bits = addresses,
                      .firstUnit = 0,
                      .unitCount = bits.units(),
                      .sends = sends.data(),
                      .rays = bits.rays.data()});
    return bits;
}

std::vector<uint32_t> traceLinks(const TraceScene& scene, uint32_t threads, Rotation rotation,
                                 uint32_t firstSample = 0, uint32_t sampleCount = 8) {
    WorkerPool pool(threads);
    EmbreeScene embree(scene, pool);
    std::vector<uint32_t> links(size_t(scene.patches.size()) * sampleCount, 12345);
    embree.closest({.firstChunk = 0,
                    .chunkCount = scene.chunkCount(),
                    .firstSample = firstSample,
                    .sampleCount = sampleCount,
                    .rotation = rotation,
                    .links = links.data()});
    return links;
}

uint32_t linkOf(const std::vector<uint32_t>& links, uint32_t patch, uint32_t sample,
                uint32_t sampleCount = 8) {
    return links[(patch / kChunk * sampleCount + sample) * kChunk + patch % kChunk];
}

void expectTrueBits(const TraceScene& scene, const Bits& bits) {
    shader::AllTriangles all{scene};
    std::mt19937 random(3);
    const uint32_t count = uint32_t(scene.patches.size());
    uint32_t facing = 0, seen = 0, wrong = 0;
    for (int k = 0; k < 30000; ++k) {
        const uint32_t a = random() % count, b = random() % count;
        if (a == b) continue;
        const uint32_t i = std::min(a, b), j = std::max(a, b);
        const bool faces = shader::pairFaces(scene.patches[i], scene.patches[j]);
        const bool sees = faces && all.sees(i, j);
        facing += faces, seen += sees, wrong += sees != bits.at(i, j);
    }
    EXPECT_GT(facing, 5000u);
    EXPECT_GT(seen, 2000u);
    EXPECT_LT(seen, facing * 9 / 10); // the test scene does hide something
    EXPECT_LE(wrong, 1u);             // grazing an edge, rounding may decide
}

TEST(Embree, bitsAreThoseOfBruteForce) {
    const TraceScene scene = furnishedRoom();
    expectTrueBits(scene, traceBits(scene, 2));
}

TEST(Embree, bitsFollowRtradsRayRule) {
    TraceScene scene = furnishedRoom();
    scene.rtrad = true;
    expectTrueBits(scene, traceBits(scene, 2));
}

TEST(Embree, bitsDoNotDependOnScale) {
    const Bits one = traceBits(furnishedRoom(), 2);
    for (float scale : {0.015625f, 1024.0f}) { // powers of two, so that nothing rounds differently
        TraceScene scene = furnishedRoom();
        for (glm::vec3& p : scene.mesh.positions)
            p *= scale;
        for (Patch& patch : scene.patches)
            patch.position *= scale, patch.offset *= scale;
        EXPECT_EQ(traceBits(scene, 2).words, one.words) << scale;
    }
}

TEST(Embree, countsItsRays) {
    const TraceScene scene = furnishedRoom();
    const Bits bits = traceBits(scene, 2);
    uint64_t expected = 0;
    for (size_t i = 0; i < scene.patches.size(); ++i)
        for (size_t j = i + 1; j < scene.patches.size(); ++j)
            expected += shader::pairFaces(scene.patches[i], scene.patches[j]);
    EXPECT_EQ(std::accumulate(bits.rays.begin(), bits.rays.end(), uint64_t(0)), expected);
}

TEST(Embree, resultsDoNotDependOnTheNumberOfThreads) {
    const TraceScene scene = furnishedRoom();
    const Bits bits = traceBits(scene, 1);
    const std::vector<uint32_t> links = traceLinks(scene, 1, Rotation::Patch);
    for (uint32_t threads : {2u, 5u}) {
        EXPECT_EQ(traceBits(scene, threads).words, bits.words);
        EXPECT_EQ(traceLinks(scene, threads, Rotation::Patch), links);
    }
}

TEST(Embree, partsOfTheWorkGiveTheSameBitsAndLeaveSkippedUnitsAlone) {
    const TraceScene scene = furnishedRoom();
    const Bits whole = traceBits(scene, 2);
    WorkerPool pool(2);
    EmbreeScene embree(scene, pool);
    std::vector<uint32_t> sends(scene.chunkCount(), 0);
    sends[3] = 1;
    constexpr uint32_t kUnits = 40, kMark = 0xabcdabcdu, kKnown = 7; // a unit of every super-block
    Bits parts = whole;
    parts.words.assign(whole.words.size(), kMark);
    for (SuperBlock& super : parts.supers)
        super.known0.x = 1u << kKnown;
    const std::vector<uint32_t*> addresses = parts.addresses();
    for (uint32_t first = 0; first < whole.units(); first += kUnits) {
        embree.occlusion({.supers = parts.supers,
                          .bits = addresses,
                          .firstUnit = first,
                          .unitCount = std::min(kUnits, whole.units() - first),
                          .sends = sends.data()});
    }
    for (uint32_t unit = 0; unit < whole.units(); ++unit) {
        const SuperBlock& super = whole.supers[unit / 256];
        const uint32_t row = super.row * 16 + unit % 256 / 16, column = super.column * 16 + unit % 16;
        const bool traced = row <= column && column < scene.chunkCount() && (sends[row] || sends[column]) &&
                            unit % 256 != kKnown;
        for (uint32_t k = 0; k < kBlockWords; ++k)
            ASSERT_EQ(parts.words[unit * kBlockWords + k],
                      traced ? whole.words[unit * kBlockWords + k] : kMark);
    }
}

// Lists are held against the bits of all pairs, for senders drawn from runs of patches.
TEST(Embree, listsGiveTheBitsOfTheDrawnPatches) {
    const TraceScene scene = furnishedRoom();
    const Bits whole = traceBits(scene, 2);
    std::vector<shader::Sender> senders;
    std::vector<uint32_t> members;
    for (uint32_t i = 0; i + 5 < scene.patches.size(); i += 9) {
        const uint32_t count = 1 + senders.size() % 5;
        senders.push_back({uint32_t(members.size()), count, i});
        for (uint32_t m = 0; m < count; ++m)
            members.push_back(i + m);
    }
    while (senders.size() % kChunk != 0)
        senders.push_back({0, 0, 0});
    const auto columns = uint32_t(senders.size() / kChunk);
    Bits bits;
    for (uint32_t row = 0; row * shader::kSuper < scene.chunkCount(); ++row)
        for (uint32_t column = 0; column * shader::kSuper < columns; ++column)
            bits.supers.push_back({row, column, 0, {}, {}, 0});
    bits.words.assign(size_t(bits.units()) * kBlockWords, 0);
    const std::vector<uint32_t> sends(columns, 1);
    const std::vector<uint32_t*> addresses = bits.addresses();
    WorkerPool pool(2);
    EmbreeScene(scene, pool)
        .occlusion({.supers = bits.supers,
                    .bits = addresses,
                    .firstUnit = 0,
                    .unitCount = bits.units(),
                    .sends = sends.data(),
                    .senders = senders,
                    .members = members});
    uint32_t seen = 0, others = 0;
    for (uint32_t i = 0; i < scene.patches.size(); i += 3) {
        const uint32_t key = shader::patchTexel(scene.patches[i / kChunk * kChunk].flags);
        for (uint32_t j = 0; j < senders.size(); ++j) {
            if (senders[j].count == 0) {
                ASSERT_FALSE(bits.at(i, j));
                continue;
            }
            const uint32_t draw = shader::drawMember(senders[j], key), m = members[senders[j].first + draw];
            ASSERT_LT(draw, senders[j].count);
            ASSERT_EQ(bits.at(i, j), i != m && whole.at(std::min(i, m), std::max(i, m))) << i << " " << m;
            seen += bits.at(i, j), others += draw > 0;
        }
    }
    EXPECT_GT(seen, 10000u);
    EXPECT_GT(others, 10000u);
}

TEST(Embree, linksAreThoseOfBruteForce) {
    const TraceScene scene = furnishedRoom();
    shader::AllTriangles all{scene};
    for (const Rotation rotation : {Rotation::Patch, Rotation::Interleaved, Rotation::Tile}) {
        const std::vector<uint32_t> links = traceLinks(scene, 2, rotation, 24);
        uint32_t wrong = 0, checked = 0;
        for (uint32_t i = 0; i < scene.patches.size(); i += 3) {
            const Patch& patch = scene.patches[i];
            const uint32_t key = shader::rotationKey(patch, scene.patches[i / kChunk * kChunk],
                                                     uint32_t(rotation), scene.size);
            const uint32_t k = i % 8;
            if (!(patch.flags & shader::kPatchSends)) continue;
            wrong += linkOf(links, i, k) != all.link(patch, shader::patchDirection(patch, key, 24 + k));
            ++checked;
        }
        EXPECT_GT(checked, 1000u);
        EXPECT_LE(wrong, 2u); // a hit on a texel's border may fall to either side
    }
}

TEST(Embree, linksOfADiscAreThoseOfBruteForce) {
    const TraceScene scene = furnishedRoom();
    shader::AllTriangles all{scene};
    constexpr uint32_t count = 5; // the second round through the set begins within the samples
    std::vector<glm::vec2> disc;
    for (const glm::dvec2 p : evenRings(largestEmptyCircleDisc(count)))
        disc.emplace_back(p);
    std::vector<uint32_t> links(size_t(scene.patches.size()) * 8, 12345);
    WorkerPool pool(2);
    EmbreeScene embree(scene, pool);
    embree.closest({.firstChunk = 0,
                    .chunkCount = scene.chunkCount(),
                    .firstSample = 16,
                    .sampleCount = 8,
                    .disc = disc.data(),
                    .discCount = count,
                    .links = links.data()});
    uint32_t wrong = 0, checked = 0;
    for (uint32_t i = 0; i < scene.patches.size(); i += 3) {
        const Patch& patch = scene.patches[i];
        if (!(patch.flags & shader::kPatchSends)) continue;
        const uint32_t k = i % 8, index = 16 + k;
        const uint32_t key = shader::rotationKey(patch, patch, shader::kRotatePatch, scene.size);
        const uint32_t seed = shader::discSeed(key, index, count);
        const glm::vec3 local =
            shader::discDirection(disc[shader::discPoint(index, count, seed)], count, seed);
        wrong += linkOf(links, i, k) != all.link(patch, shader::aroundPatch(patch, local));
        ++checked;
    }
    EXPECT_GT(checked, 1000u);
    EXPECT_LE(wrong, 2u);
}

// Makes a floor below a lid, whose front is on top unless it is `turned`.
TraceScene floorAndLid(const TraceWorld::Look& look, bool turned) {
    TraceWorld world;
    world.add([](float u, float v) { return glm::vec3(u, 0, -v); }, 1);
    world.add(
        [=](float u, float v) { return glm::vec3(20 * u - 10, 0.01f, turned ? 20 * v - 10 : 10 - 20 * v); },
        1, look);
    return world.build();
}

TEST(Embree, linksTellSkyBacksAndDarkGeometryApart) {
    TraceWorld open;
    open.add([](float u, float v) { return glm::vec3(u, 0, -v); }, 1);
    EXPECT_EQ(linkOf(traceLinks(open.build(), 1, Rotation::Patch), 100, 3), shader::kLinkSky);

    const auto link = [](const TraceWorld::Look& look, bool turned) {
        return linkOf(traceLinks(floorAndLid(look, turned), 1, Rotation::Patch), 100, 3);
    };
    EXPECT_EQ(link({}, false), shader::kLinkBack);
    EXPECT_EQ(link({.doubleSided = true}, false), shader::kLinkDark);
    EXPECT_EQ(link({.receives = false}, true), shader::kLinkDark);
    EXPECT_EQ(link({.receives = false}, false), shader::kLinkBack);
    const uint32_t lid = link({}, true); // its front
    EXPECT_TRUE(lid >= 512 && lid < 1024) << lid;
}

TEST(Embree, patchesThatDoNotSendGetDarkLinksAndNoBits) {
    TraceScene scene = furnishedRoom();
    for (uint32_t i = 0; i < 100; ++i)
        scene.patches[i].flags &= ~shader::kPatchSends;
    const std::vector<uint32_t> links = traceLinks(scene, 2, Rotation::Patch);
    const Bits bits = traceBits(scene, 2);
    for (uint32_t i = 0; i < 100; ++i) {
        for (uint32_t k = 0; k < 8; ++k)
            EXPECT_EQ(linkOf(links, i, k), shader::kLinkDark);
        for (uint32_t j = i + 1; j < scene.patches.size(); ++j)
            ASSERT_FALSE(bits.at(i, j));
    }
    EXPECT_NE(linkOf(links, 100, 0), shader::kLinkDark);
}

TEST(Embree, maskedHolesLetRaysPass) {
    TraceWorld world;
    world.add([](float u, float v) { return glm::vec3(u, 0, -v); }, 1);
    world.add([](float u, float v) { return glm::vec3(u, 2, v - 1); }, 1);
    world.add([](float u, float v) { return glm::vec3(4 * u - 1.5f, 1, -4 * v + 1.5f); }, 1,
              {.masked = true});
    const TraceScene scene = world.build();
    const Bits bits = traceBits(scene, 1);
    uint32_t open = 0, shut = 0;
    for (uint32_t i = 0; i < 512; ++i) {
        for (uint32_t j = 512; j < 1024; ++j) {
            const glm::vec3 middle = (scene.patches[i].position + scene.patches[j].position) * 0.5f;
            // The screen is solid where both coordinates are in the same half of it.
            const float x = middle.x + 1.5f - 2, y = 1.5f - middle.z - 2;
            if (std::abs(x) < 1e-3f || std::abs(y) < 1e-3f) continue;
            const bool solid = (x < 0) == (y < 0);
            ASSERT_EQ(bits.at(i, j), !solid) << middle.x << " " << middle.z;
            ++(solid ? shut : open);
        }
    }
    EXPECT_GT(open, 10000u);
    EXPECT_GT(shut, 10000u);
}

TEST(Embree, takesSceneOfMaskedTrianglesOnlyAndOfOneTriangle) {
    TraceWorld masked;
    masked.add([](float u, float v) { return glm::vec3(u, 0, -v); }, 1, {.masked = true});
    EXPECT_EQ(traceBits(masked.build(), 2).at(0, 511), false);

    TraceScene one = floorAndLid({}, true);
    one.mesh.positions.resize(3);
    one.mesh.material.resize(1);
    one.mesh.chart.resize(1);
    one.mesh.opaqueCount = 1;
    one.hitTriangles.resize(1);
    EXPECT_TRUE(traceBits(one, 2).at(0, 512)); // the lid has patches but no triangle left
    EXPECT_EQ(linkOf(traceLinks(one, 2, Rotation::Patch), 0, 0), shader::kLinkSky);
}

TEST(EmbreeChunks, facingIsThatOfTheShaders) {
    const TraceScene scene = furnishedRoom();
    const std::vector<PatchChunk> chunks = buildChunks(scene.patches, false);
    uint32_t skipped = 0;
    for (uint32_t a = 0; a < chunks.size(); ++a) {
        for (uint32_t b = 0; b < chunks.size(); ++b) {
            std::array<uint64_t, kChunk> rows;
            facingRows(chunks[a], chunks[b], rows);
            uint64_t any = 0;
            for (uint32_t i = 0; i < kChunk; ++i) {
                uint64_t expected = 0;
                for (uint32_t j = 0; j < kChunk; ++j)
                    expected |= uint64_t(shader::pairFaces(scene.patches[a * kChunk + i],
                                                           scene.patches[b * kChunk + j]))
                                << j;
                ASSERT_EQ(rows[i], expected) << a << " " << b << " " << i;
                ASSERT_EQ(facingRow(chunks[a], i, chunks[b]), expected);
                any |= expected;
            }
            const bool may = chunksMayFace(chunks[a], chunks[b]);
            ASSERT_TRUE(may || any == 0) << a << " " << b;
            skipped += !may;
        }
    }
    EXPECT_GT(skipped, 6u * 64u / 2); // at least most pairs within a wall
}

TEST(EmbreeBlockers, stopOnlyWhatTheirTrianglesStop) {
    const TraceScene scene = furnishedRoom();
    const std::vector<PatchChunk> chunks = buildChunks(scene.patches, false);
    std::mt19937 random(5);
    uint32_t hits = 0, found = 0, wrong = 0;
    for (int k = 0; k < 20000; ++k) {
        const uint32_t triangle = random() % scene.mesh.opaqueCount,
                       i = random() % uint32_t(scene.patches.size());
        const uint32_t column = random() % uint32_t(chunks.size());
        Blockers blockers(scene.mesh.positions.data());
        blockers.add(triangle);
        const Patch& patch = scene.patches[i];
        const uint64_t stopped =
            blockers.stopped(patch.position + patch.offset * patch.normal, chunks[column], ~uint64_t(0));
        TraceScene one;
        one.mesh.positions.assign(&scene.mesh.positions[triangle * 3],
                                  &scene.mesh.positions[triangle * 3] + 3);
        one.mesh.material.resize(1);
        one.mesh.opaqueCount = 1;
        shader::AllTriangles all{one};
        for (uint32_t j = 0; j < kChunk; ++j) {
            const Patch& other = scene.patches[column * kChunk + j];
            if (!shader::pairFaces(patch, other)) continue;
            const shader::Segment s = shader::pairSegment(patch, other, false);
            const bool hit = all.nearest(s.origin, s.direction, 0, 1).triangle != shader::kNoPatch;
            hits += hit, found += stopped >> j & 1, wrong += (stopped >> j & 1) && !hit;
        }
    }
    EXPECT_GT(hits, 300u);
    EXPECT_GT(found, hits * 9 / 10);
    EXPECT_EQ(wrong, 0u);
}

} // namespace
} // namespace relume
