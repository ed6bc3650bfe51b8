// What comes next in a pass of a pair method, without a device.
#include "bake/pairs/pair_batch.h"
#include "bake/pairs/pair_light.h"
#include "bake/pairs/pair_view.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <utility>

namespace relume {
namespace {

using shader::kSuper;
using shader::kSuperBlocks;
using Pair = std::pair<uint32_t, uint32_t>;

constexpr uint32_t kRows = 4, kChunksOfFour = kRows * kSuper;

PairPlan planOf(uint32_t chunks, bool symmetric) {
    return {{.rows = chunks, .columns = chunks, .symmetric = symmetric}, std::vector<uint32_t>(chunks, 1)};
}

/// Walks to the end of the pass and returns the super-blocks in their order.
std::vector<Pair> walkToTheEnd(PairWalk& walk, std::vector<uint32_t>* rows = nullptr) {
    std::vector<Pair> supers;
    while (!walk.through()) {
        supers.emplace_back(walk.row(), walk.column());
        const std::optional<uint32_t> ended = walk.next();
        if (ended && rows) rows->push_back(*ended);
    }
    return supers;
}

} // namespace

TEST(PairWalk, ASymmetricPassHasEachSuperBlockOfTheUpperHalfOnce) {
    PairWalk walk(kChunksOfFour);
    walk.begin(planOf(kChunksOfFour, true));
    std::vector<uint32_t> rows;
    const std::vector<Pair> supers = walkToTheEnd(walk, &rows);
    EXPECT_EQ(supers.size(), kRows * (kRows + 1) / 2);
    EXPECT_EQ(std::set<Pair>(supers.begin(), supers.end()).size(), supers.size());
    for (const auto& [row, column] : supers)
        EXPECT_LE(row, column);
    EXPECT_EQ(rows, (std::vector<uint32_t>{0, 1, 2, 3}));
}

TEST(PairWalk, APassOverAListHasAllSuperBlocksRowByRow) {
    PairWalk walk(kChunksOfFour);
    walk.begin(planOf(kChunksOfFour, false));
    const std::vector<Pair> supers = walkToTheEnd(walk);
    ASSERT_EQ(supers.size(), kRows * kRows);
    for (uint32_t i = 0; i < supers.size(); ++i)
        EXPECT_EQ(supers[i], Pair(i / kRows, i % kRows));
}

TEST(PairWalk, ARowThatIsSeenComesFirstAndTakesAllOfItsPatches) {
    PairWalk walk(kChunksOfFour);
    walk.prefer({0, 0, 1, 0});
    walk.begin(planOf(kChunksOfFour, true));
    std::vector<uint32_t> rows;
    const std::vector<Pair> supers = walkToTheEnd(walk, &rows);
    EXPECT_EQ(rows, (std::vector<uint32_t>{2, 0, 1, 3}));
    const std::vector<Pair> first(supers.begin(), supers.begin() + kRows);
    EXPECT_EQ(first, (std::vector<Pair>{{0, 2}, {1, 2}, {2, 2}, {2, 3}}));
    EXPECT_EQ(std::set<Pair>(supers.begin(), supers.end()).size(), kRows * (kRows + 1) / 2);
}

TEST(PairWalk, ARowThatHasBegunIsDoneBeforeOneThatIsSeen) {
    PairWalk walk(kChunksOfFour);
    walk.begin(planOf(kChunksOfFour, false));
    walk.prefer({0, 0, 0, 1});
    EXPECT_EQ(walk.row(), 3u) << "nothing had begun";
    (void)walk.next();
    walk.prefer({0, 1, 0, 0});
    EXPECT_EQ(walk.row(), 3u);
    std::vector<uint32_t> rows;
    (void)walkToTheEnd(walk, &rows);
    EXPECT_EQ(rows, (std::vector<uint32_t>{3, 1, 0, 2}));
}

TEST(PairWalk, GoesOnWhereItStood) {
    PairWalk walk(kChunksOfFour);
    walk.begin(planOf(kChunksOfFour, true));
    for (int i = 0; i < 5; ++i)
        (void)walk.next();
    PairWalk other(kChunksOfFour);
    other.rows().marks() = walk.rows().marks();
    other.resume(planOf(kChunksOfFour, true), walk.place());
    EXPECT_EQ(walkToTheEnd(other), walkToTheEnd(walk));
    EXPECT_TRUE(walk.inPass());
    walk.leave();
    EXPECT_FALSE(walk.inPass());
}

TEST(PairBatch, BatchesOfAnySizeTraceEveryUnitOnceAndSumEverySuperBlockOnce) {
    constexpr uint32_t kChunks = 40; // the last super-blocks are not full
    for (const double aim : {0.5, 3.0, 1000.0}) {
        PairWalk walk(kChunks);
        const PairPlan plan = planOf(kChunks, true);
        walk.begin(plan);
        PairTally tally;
        PairRates rates;
        std::map<Pair, UnitMask> traced;
        uint64_t units = 0, pairs = 0, complete = 0;
        while (!walk.through()) {
            const PairBatch batch = cutPairBatch(walk, tally,
                                                 {.known = [](uint32_t, uint32_t) { return UnitMask{}; },
                                                  .rates = rates,
                                                  .aim = aim,
                                                  .capacity = 3});
            EXPECT_LE(batch.supers.size(), 3u);
            for (const PairBatch::Super& super : batch.supers) {
                UnitMask& seen = traced[{super.row, super.column}];
                EXPECT_EQ(seen.within(super.traced).count(), 0u) << "traced twice";
                seen = seen.with(super.traced);
                units += super.traced.count();
            }
            pairs += batch.pairs;
            complete += batch.complete;
            rates.learn(batch, 0.01 * batch.tracedUnits, 0.002 * batch.gatheredUnits);
        }
        EXPECT_EQ(units, plan.unitCount());
        EXPECT_EQ(tally.done, plan.unitCount());
        EXPECT_EQ(tally.known, 0u);
        EXPECT_EQ(complete, 6u);
        EXPECT_EQ(pairs, uint64_t{kChunks} * kChunks * shader::kChunk * shader::kChunk);
    }
}

TEST(PairBatch, AFirstBatchIsShortAndBitsThatAreKeptCostNoRay) {
    PairWalk walk(kChunksOfFour);
    walk.begin(planOf(kChunksOfFour, false));
    PairTally tally;
    PairRates rates;
    const auto nothing = [](uint32_t, uint32_t) { return UnitMask{}; };
    const PairBatch first =
        cutPairBatch(walk, tally, {.known = nothing, .rates = rates, .aim = 20, .capacity = 16});
    EXPECT_LE(first.tracedUnits, 16.0);
    EXPECT_EQ(first.complete, 0u);
    EXPECT_GT(walk.place().unit, 0u) << "it goes on within the super-block";

    walk.leave();
    walk.begin(planOf(kChunksOfFour, false));
    tally = {};
    rates.learn(first, 1, 0);
    const auto all = [](uint32_t, uint32_t) { return UnitMask::range(0, kSuperBlocks); };
    const PairBatch kept =
        cutPairBatch(walk, tally, {.known = all, .rates = rates, .aim = 20, .capacity = 16});
    EXPECT_EQ(kept.tracedUnits, 0.0);
    EXPECT_EQ(kept.complete, 1u) << "what gathering costs is to be learnt first";
    EXPECT_EQ(tally.known, kSuperBlocks);
}

TEST(PairBatch, SuperBlocksWithoutASenderAreLeftOut) {
    PairWalk walk(kChunksOfFour);
    std::vector<uint32_t> sends(kChunksOfFour, 0);
    sends[kSuper] = 1;
    walk.begin({{.rows = kChunksOfFour, .columns = kChunksOfFour, .symmetric = false}, sends});
    PairTally tally;
    PairRates rates;
    std::set<uint32_t> columns, rows;
    while (!walk.through()) {
        const PairBatch batch =
            cutPairBatch(walk, tally,
                         {.known = [](uint32_t, uint32_t) { return UnitMask::range(0, kSuperBlocks); },
                          .rates = rates,
                          .aim = 20,
                          .capacity = 16});
        for (const PairBatch::Super& super : batch.supers)
            columns.insert(super.column);
        rows.insert(batch.rowsEnded.begin(), batch.rowsEnded.end());
    }
    EXPECT_EQ(columns, std::set<uint32_t>{1});
    EXPECT_EQ(rows.size(), kRows);
}

TEST(FreshRows, AViewerGetsEveryRowOnceFromWhereItsNewestLightIs) {
    constexpr uint32_t kChunks = 2 * kSuper + 3;
    FreshRows rows(kChunks);
    FreshRows::Chunks chunks = rows.take();
    EXPECT_EQ(chunks.fromLast, (std::vector<ChunkRange>{{0, kChunks}}));
    EXPECT_TRUE(chunks.fromPass.empty());
    EXPECT_TRUE(rows.take().fromLast.empty());

    rows.end(2);
    chunks = rows.take();
    EXPECT_TRUE(chunks.fromLast.empty());
    EXPECT_EQ(chunks.fromPass, (std::vector<ChunkRange>{{2 * kSuper, 3}}));

    rows.end(0);
    rows.endPass(false);
    chunks = rows.take();
    EXPECT_EQ(chunks.fromLast, (std::vector<ChunkRange>{{0, kSuper}})) << "the others were shown before";
    rows.endPass(true);
    EXPECT_EQ(rows.take().fromLast, (std::vector<ChunkRange>{{0, kChunks}}));
    rows.end(1);
    rows.startOver();
    EXPECT_EQ(rows.take().fromLast, (std::vector<ChunkRange>{{0, kChunks}}));
}

PatchSet oneChunk() {
    PatchSet patches;
    patches.count = shader::kChunk;
    patches.scene.patches.resize(patches.count);
    for (shader::Patch& patch : patches.scene.patches)
        patch.flags = shader::kPatchSends;
    return patches;
}

TEST(PairLight, TellsWhatAGeometricSeriesStillBrings) {
    const PatchSet patches = oneChunk();
    WorkerPool pool(2);
    PairLight light(patches, std::vector<glm::vec4>(patches.count, glm::vec4(0.0f)), true);
    const auto bounce = [&](float value) {
        return light.take(pool, [&](std::vector<glm::vec4>& to) {
            std::fill(to.begin(), to.end(), glm::vec4(glm::vec3(value), 1.0f));
        });
    };
    // Each bounce brings half of what the one before did: 1, 1.5, 1.75 ... 2.
    EXPECT_FALSE(bounce(1.0f).has_value());
    EXPECT_TRUE(light.errors().empty());
    EXPECT_EQ(light.missing(), 1.0);
    const std::optional<double> error = bounce(1.5f);
    ASSERT_TRUE(error.has_value());
    EXPECT_NEAR(*error, 0.5 / 1.5, 1e-6);
    EXPECT_NEAR(light.missing(), 0.5 / 1.5, 1e-6);
    ASSERT_EQ(light.errors().size(), patches.count);
    EXPECT_NEAR(light.errors()[7], 0.5f, 1e-6f);

    const PairLight::State state = light.state();
    PairLight other(patches, {}, true);
    other.restore(state, light.light());
    EXPECT_TRUE(other.errors().empty()) << "the light of the pass before is not known";
    EXPECT_EQ(other.missing(), light.missing());
    EXPECT_THROW(bounce(std::numeric_limits<float>::infinity()), Error);
}

// Light that grows for ever is an error of its own, told long before it is too large for a float. RTRad's
// preset goes on as RTRad does.
TEST(PairLight, LightThatGrowsWithoutEndIsAnError) {
    const PatchSet patches = oneChunk();
    WorkerPool pool(2);
    const auto passesUntilError = [&](bool dark, float growth) {
        PairLight light(patches, std::vector<glm::vec4>(patches.count, glm::vec4(0.0f)), dark);
        float value = 0, change = 1;
        for (int pass = 1; pass <= 64; ++pass, change *= growth) {
            value += change;
            try {
                light.take(pool, [&](std::vector<glm::vec4>& to) {
                    std::fill(to.begin(), to.end(), glm::vec4(glm::vec3(value), 1.0f));
                });
            } catch (const Error& error) {
                EXPECT_NE(std::string(error.what()).find("--window"), std::string::npos);
                return pass;
            }
        }
        return 0;
    };
    EXPECT_EQ(passesUntilError(true, 1.1f), 13);
    EXPECT_EQ(passesUntilError(true, 0.99f), 0);
    EXPECT_EQ(passesUntilError(false, 1.1f), 0);
}

// Each process has the super-blocks that give light to rows of its own, and together they have all pairs.
TEST(PairPlan, OwnRowsHaveAllOfTheirSuperBlocks) {
    const std::vector<uint32_t> sends(kChunksOfFour, 1);
    const std::vector<std::vector<uint8_t>> owners = {{1, 0, 0, 1}, {0, 1, 1, 0}};
    for (const bool symmetric : {true, false}) {
        const PairPlan::Desc all{.rows = kChunksOfFour, .columns = kChunksOfFour, .symmetric = symmetric};
        const PairPlan whole(all, sends);
        uint64_t pairs = 0, wholePairs = 0;
        for (const std::vector<uint8_t>& own : owners) {
            PairPlan::Desc desc = all;
            desc.own = own;
            const PairPlan plan(desc, sends);
            uint64_t there = 0, units = 0;
            for (uint32_t row = 0; row < kRows; ++row)
                for (uint32_t column = plan.firstColumn(row); column < kRows; ++column) {
                    const bool wanted = own[row] != 0 || (symmetric && own[column] != 0);
                    EXPECT_EQ(plan.units(row, column).count(),
                              wanted ? whole.units(row, column).count() : 0u);
                    there += wanted;
                    units += plan.units(row, column).count();
                    pairs += wanted ? plan.pairs(row, column) : 0;
                }
            EXPECT_EQ(PairPlan::superBlocks(desc), there);
            EXPECT_EQ(plan.unitCount(), units);
        }
        for (uint32_t row = 0; row < kRows; ++row)
            for (uint32_t column = whole.firstColumn(row); column < kRows; ++column)
                wholePairs += whole.pairs(row, column);
        EXPECT_EQ(pairs, wholePairs);
    }
}

} // namespace relume
