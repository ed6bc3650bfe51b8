#include "bake/gather/host_links.h"
#include "bake/pairs/host_pairs.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

namespace relume {
namespace {

using shader::kChunk;
using shader::kSuper;
using shader::kSuperPatches;

// Holds patches all over two unit squares that face each other, some nearer than a few patch sizes, in 20
// chunks: two super-rows, the second one not full.
struct World {
    static constexpr uint32_t kChunks = 20, kCount = kChunks * kChunk;
    std::mt19937 random{7};
    std::vector<shader::Patch> patches{kCount};
    std::vector<shader::PatchEdges> edges{kCount};
    std::vector<shader::ChunkBounds> bounds{kChunks};
    std::vector<glm::vec4> radiance{kCount};
    std::vector<uint32_t> sends = std::vector<uint32_t>(kChunks, 1);
    std::vector<bool> seen = std::vector<bool>(size_t{kCount} * kCount); // [i][j], symmetric

    float draw() { return std::uniform_real_distribution<float>(0, 1)(random); }
    World() {
        for (uint32_t i = 0; i < kCount; ++i) {
            const float side = i / kChunk % 2 == 0 ? 1.0f : -1.0f, edge = 0.02f + 0.05f * draw();
            const glm::vec3 normal(0, side, 0);
            patches[i] = {.position = {draw(), side > 0 ? 0.0f : 0.15f, draw()},
                          .offset = 1e-4f,
                          .normal = normal,
                          .area = edge * edge,
                          .shading = glm::normalize(normal + 0.3f * glm::vec3(draw(), 0, draw())),
                          .flags = shader::kPatchSends | i << shader::kTexelShift};
            edges[i] = {{edge, 0, 0}, {0, 0, edge}};
            radiance[i] = {draw(), draw(), draw(), 1};
        }
        for (uint32_t c = 0; c < kChunks; ++c) {
            shader::ChunkBounds& b = bounds[c];
            b = {glm::vec3(1e9f), glm::vec3(-1e9f), 0.07f};
            for (uint32_t i = c * kChunk; i < (c + 1) * kChunk; ++i)
                b.lo = glm::min(b.lo, patches[i].position), b.hi = glm::max(b.hi, patches[i].position);
        }
        sends[3] = 0;
        for (uint32_t i = 0; i < kCount; ++i) {
            for (uint32_t j = i + 1; j < kCount; ++j)
                seen[size_t{i} * kCount + j] = seen[size_t{j} * kCount + i] =
                    shader::pairFaces(patches[i], patches[j]) && draw() < 0.5f;
        }
    }

    // Returns one receiver's light from one sender, in double where it adds up.
    glm::dvec3 light(uint32_t i, uint32_t j) const {
        const shader::Patch &p = patches[i], &s = patches[j];
        const glm::vec3 d = s.position - p.position;
        const bool close = glm::dot(d, d) <= shader::kClosePair * shader::kClosePair * s.area;
        const float f = close ? shader::parallelogramFormFactor(p.position, p.shading, s.position,
                                                                edges[j].du, edges[j].dv, s.normal)
                              : shader::discFormFactor(p.position, p.shading, s.position, s.normal, s.area);
        return glm::dvec3(double{f} * glm::dvec3(glm::vec3(radiance[j])));
    }

    std::vector<uint32_t> bitsOf(uint32_t row, uint32_t column, bool upperOnly) const {
        std::vector<uint32_t> words(shader::kSuperWords);
        for (uint32_t i = 0; i < kSuperPatches; ++i) {
            for (uint32_t j = 0; j < kSuperPatches; ++j) {
                const uint32_t a = row * kSuperPatches + i, b = column * kSuperPatches + j;
                if (a >= kCount || b >= kCount || (upperOnly && b <= a)) continue;
                if (!seen[size_t{a} * kCount + b]) continue;
                const uint32_t block = i / kChunk * kSuper + j / kChunk;
                words[block * shader::kBlockWords + i % kChunk * 2 + j % kChunk / 32] |= 1u << j % 32;
            }
        }
        return words;
    }

    HostPairs work() const {
        HostPairs pairs;
        pairs.patches = pairs.senderPatches = patches.data();
        pairs.bounds = pairs.senderBounds = bounds.data();
        pairs.sends = sends.data();
        pairs.senderEdges = edges.data();
        pairs.radiance = radiance.data();
        pairs.rowCount = pairs.columnCount = kChunks;
        return pairs;
    }
};

std::vector<shader::SuperBlock> superBlocks(std::initializer_list<std::pair<uint32_t, uint32_t>> places) {
    std::vector<shader::SuperBlock> supers;
    for (const auto& [row, column] : places)
        supers.push_back({row, column, 0, {}, {}, 0});
    return supers;
}

// Returns the sums of the super-blocks of a table, per patch.
std::vector<glm::vec3> gather(const World& world, HostPairs work,
                              const std::vector<shader::SuperBlock>& supers, uint32_t threads) {
    std::vector<std::vector<uint32_t>> bits;
    for (const shader::SuperBlock& super : supers)
        bits.push_back(world.bitsOf(super.row, super.column, work.symmetric));
    std::vector<uint32_t*> pointers;
    for (std::vector<uint32_t>& words : bits)
        pointers.push_back(words.data());
    std::vector<glm::vec4> partial(supers.size() * 2 * kSuperPatches, glm::vec4(0.0f));
    work.supers = supers;
    work.bits = pointers;
    work.partial = partial.data();
    WorkerPool pool(threads);
    gatherPairs(pool, work);
    std::vector<glm::vec3> sums(World::kCount, glm::vec3(0.0f));
    for (size_t s = 0; s < supers.size(); ++s) {
        for (uint32_t side = 0; side < (work.symmetric && supers[s].row != supers[s].column ? 2u : 1u);
             ++side) {
            const uint32_t first = (side == 0 ? supers[s].row : supers[s].column) * kSuperPatches;
            for (uint32_t i = 0; i < kSuperPatches && first + i < World::kCount; ++i)
                sums[first + i] += glm::vec3(partial[(s * 2 + side) * kSuperPatches + i]);
        }
    }
    return sums;
}

template<typename Sender>
void expectSums(const World& world, const std::vector<glm::vec3>& sums, Sender sender) {
    for (uint32_t i = 0; i < World::kCount; ++i) {
        glm::dvec3 expected(0.0);
        for (uint32_t j = 0; j < World::kCount; ++j) {
            const uint32_t from = sender(i, j);
            if (world.seen[size_t{i} * World::kCount + j] && world.sends[j / kChunk] != 0)
                expected += world.light(i, from);
        }
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(sums[i][c], expected[c], 1e-5 + 2e-5 * expected[c]) << i;
    }
}

TEST(HostGather, pairsOfPatchesServeBothEnds) {
    const World world;
    HostPairs work = world.work();
    work.symmetric = true;
    const std::vector<shader::SuperBlock> supers = superBlocks({{0, 0}, {0, 1}, {1, 1}});
    const std::vector<glm::vec3> sums = gather(world, work, supers, 1);
    expectSums(world, sums, [](uint32_t, uint32_t j) { return j; });
    EXPECT_EQ(sums, gather(world, work, supers, 3));
}

TEST(HostGather, listedSendersServeTheirReceivers) {
    const World world;
    const std::vector<shader::SuperBlock> supers = superBlocks({{0, 0}, {0, 1}, {1, 0}, {1, 1}});
    expectSums(world, gather(world, world.work(), supers, 2), [](uint32_t, uint32_t j) { return j; });
}

TEST(HostGather, drawnSendersStandForTheirRun) {
    World world;
    // Every sender is a run of itself and its neighbour, twice as bright as the one that is drawn.
    std::vector<shader::Sender> senders;
    std::vector<uint32_t> members;
    for (uint32_t j = 0; j < World::kCount; ++j) {
        senders.push_back({.first = 2 * j, .count = 2, .key = j * 77u});
        members.insert(members.end(), {j, j ^ 1u});
    }
    HostPairs work = world.work();
    work.senders = senders.data();
    work.members = members.data();
    const std::vector<shader::SuperBlock> supers = superBlocks({{0, 0}, {0, 1}, {1, 0}, {1, 1}});
    std::vector<glm::vec3> sums = gather(world, work, supers, 2);
    for (glm::vec3& sum : sums)
        sum *= 0.5f;
    expectSums(world, sums, [&](uint32_t i, uint32_t j) {
        const uint32_t key = shader::patchTexel(world.patches[i / kChunk * kChunk].flags);
        return members[2 * j + shader::drawMember(senders[j], key)];
    });
}

TEST(HostGather, linksAreMeansOfWhatTheyEndAt) {
    const World world;
    WorkerPool pool(2);
    constexpr uint32_t kSamples = 8, kFirst = 5, kChunks = 3;
    constexpr std::array kSpecial = {shader::kLinkSky, shader::kLinkSkyBelow, shader::kLinkDark,
                                     shader::kLinkBack};
    const glm::vec3 sky(0.5f, 0.75f, 1.25f); // only what meets it above the horizon brings it
    std::mt19937 random(3);
    std::vector<uint32_t> links(size_t{kChunks} * kSamples * kChunk);
    for (uint32_t& link : links)
        link = random() % 5 == 0 ? kSpecial[random() % kSpecial.size()] : random() % World::kCount;
    std::vector<glm::vec4> direct(World::kCount, glm::vec4(0.25f)), out(World::kCount, glm::vec4(7.0f));
    std::vector<glm::vec4> sums(size_t{shader::kReplicates} * World::kCount, glm::vec4(1.0f));
    HostLinks work{.links = links.data(),
                   .radiance = world.radiance.data(),
                   .sky = sky,
                   .direct = direct.data(),
                   .ligOut = out.data(),
                   .sums = sums.data(),
                   .firstChunk = kFirst,
                   .chunkCount = kChunks,
                   .samples = kSamples,
                   .patchCount = World::kCount};
    gatherLinks(pool, work);
    std::vector<glm::vec4> anew(sums.size(), glm::vec4(std::numeric_limits<float>::quiet_NaN()));
    work.sums = anew.data();
    work.newSums = true;
    gatherLinks(pool, work);
    EXPECT_EQ(out[kFirst * kChunk - 1], glm::vec4(7.0f));
    EXPECT_EQ(out[(kFirst + kChunks) * kChunk], glm::vec4(7.0f));
    for (uint32_t i = 0; i < kChunks * kChunk; ++i) {
        glm::dvec3 mean(0.0);
        std::vector<glm::dvec3> replicate(shader::kReplicates, glm::dvec3(0.0));
        for (uint32_t k = 0; k < kSamples; ++k) {
            const uint32_t link = links[(i / kChunk * kSamples + k) * kChunk + i % kChunk];
            if (link >= shader::kLinkFirstSpecial && link != shader::kLinkSky) continue;
            const glm::dvec3 light(link == shader::kLinkSky ? sky : glm::vec3(world.radiance[link]));
            mean += light / double{kSamples};
            replicate[k % shader::kReplicates] += light;
        }
        const uint32_t index = kFirst * kChunk + i;
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(out[index][c], 0.25 + mean[c], 1e-6);
            for (uint32_t q = 0; q < shader::kReplicates; ++q) {
                EXPECT_NEAR(sums[size_t{q} * World::kCount + index][c], 1 + replicate[q][c], 1e-6);
                EXPECT_NEAR(anew[size_t{q} * World::kCount + index][c], replicate[q][c], 1e-6);
            }
        }
        EXPECT_EQ(out[index].w, 1.0f);
        EXPECT_EQ(sums[index].w, 1.0f);
    }
}

} // namespace
} // namespace relume
