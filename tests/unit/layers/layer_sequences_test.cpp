// Whole bakes by LayerSchedule's decisions, with edits at random moments, held against what must always hold.
#include "tests/unit/fake_bake.h"

#include <gtest/gtest.h>

#include <random>

namespace relume {
namespace {

// An edit is taken, and what it changed is seen, after no more than so many steps.
constexpr int kPatience = 400;

/// Edits a bake at random moments, the same for the same seed.
class Script {
public:
    Script(const FakeBake::Desc& desc, uint32_t seed) : random_(seed), bake_(desc) {}

    /// Makes so many edits and whatever steps come between them, then all that are left.
    void play(int edits) {
        for (int i = 0; i < edits && bake_.wrong().empty(); ++i) {
            steps(random_() % 4 == 0 ? 0 : static_cast<int>(random_() % 40));
            editOnce();
        }
        bake_.finish();
    }
    FakeBake& bake() { return bake_; }
    const std::string& wrong() const { return wrong_; }

private:
    void steps(int count) {
        for (int i = 0; i < count; ++i) {
            bake_.step();
            waits_ = bake_.waits() ? waits_ + 1 : 0;
            blind_ = bake_.unseen() && !edited_ ? blind_ + 1 : 0;
            edited_ = false;
            if (waits_ > kPatience) wrong_ = "an edit is not taken";
            if (blind_ > kPatience) wrong_ = "an edit is not seen";
        }
    }

    void editOnce() {
        former_.push_back(bake_.scene);
        const size_t lamp = bake_.scene.lights.empty() ? 0 : random_() % bake_.scene.lights.size();
        const uint32_t kind = random_() % 12;
        if (kind < 2)
            undo();
        else if (kind < 4)
            changeSurroundings(kind == 2);
        else if (bake_.scene.lights.empty() || kind == 4)
            bake_.addLamp();
        else if (kind == 5)
            bake_.scene.lights.erase(bake_.scene.lights.begin() + static_cast<std::ptrdiff_t>(lamp));
        else if (kind < 9)
            bake_.scene.lights[lamp].transform[3].y += static_cast<float>(1 + random_() % 3);
        else if (kind == 9)
            bake_.scene.lights[lamp].intensity = static_cast<float>(random_() % 3);
        else if (kind == 10)
            bake_.mix.muted = {{LightKey::Kind::Lamp, static_cast<uint32_t>(lamp), 0}};
        else
            bake_.mix.muted.clear();
        bake_.edit();
        edited_ = true;
    }

    // Colours and objects wait until they may change.
    void waitForRest() {
        for (int i = 0; i < kPatience && !bake_.atRest(); ++i)
            steps(1);
        if (!bake_.atRest()) wrong_ = "colours may never be changed";
    }
    void changeSurroundings(bool objects) {
        waitForRest();
        if (objects)
            bake_.scene.instances[0].transform[3].x += static_cast<float>(1 + random_() % 2);
        else
            bake_.scene.materials[0].baseColor.x += 0.125f;
    }
    void undo() {
        waitForRest();
        bake_.scene = former_[random_() % former_.size()];
    }

    std::mt19937 random_;
    FakeBake bake_;
    std::vector<Scene> former_;
    std::string wrong_;
    int waits_ = 0, blind_ = 0; // steps
    bool edited_ = false;
};

struct Kind {
    const char* name;
    FakeBake::Desc desc;
};

const Kind kKinds[] = {
    {"Viewer", {.rules = viewerRules()}},
    {"ViewerOnCpu", {.rules = {.live = true}}},
    {"ViewerOfManyLights", {.rules = viewerRules(), .lamps = 11}},
    {"ViewerOfGroups", {.rules = viewerRules(), .lamps = 7, .room = 4}},
    {"ViewerWithLittleMemory", {.rules = viewerRules(), .lamps = 4, .room = 6, .lanes = 2}},
    {"ViewerOfDirectLight", {.rules = {.passes = 1, .live = true, .together = true}}},
    {"ViewerOfAFewBounces", {.rules = {.samples = 256, .passes = 3, .live = true, .together = true}}},
    {"ViewerOfAllSamples", {.rules = {.samples = 256, .error = 0, .live = true, .together = true}}},
    {"ViewerOfFewSamples", {.rules = {.samples = 4, .live = true, .together = true}}},
    {"Offline", {.rules = offlineRules()}},
    {"OfflineOnCpu", {.rules = ScheduleRules()}},
    {"OfflineOfManyLights", {.rules = offlineRules(), .lamps = 11}},
    {"OfflineOfGroups", {.rules = offlineRules(), .lamps = 7, .room = 4}},
    {"OfflineOfAllSamples", {.rules = {.samples = 100, .error = 0, .together = true}}},
    {"OfflineOfDirectLight", {.rules = {.passes = 1, .together = true}}},
};

class EditSequence : public testing::TestWithParam<Kind> {};

TEST_P(EditSequence, EndsWithAllLayersDone) {
    for (uint32_t seed = 0; seed < 60; ++seed) {
        SCOPED_TRACE(seed);
        FakeBake::Desc desc = GetParam().desc;
        desc.seed = seed;
        Script script(desc, seed);
        script.play(12);
        FakeBake& bake = script.bake();
        ASSERT_EQ(bake.wrong(), "");
        ASSERT_EQ(script.wrong(), "");
        ASSERT_TRUE(bake.done());
        EXPECT_FALSE(bake.waits());
        EXPECT_FALSE(bake.unseen());
        EXPECT_FALSE(bake.showsSum());
        for (const std::unique_ptr<Layer>& layer : bake.layers()) {
            if (!layer->shines()) continue;
            EXPECT_TRUE(layer->plan.converged) << layer->source.name;
            EXPECT_TRUE(layer->dirty.empty()) << layer->source.name;
            EXPECT_FALSE(layer->redo) << layer->source.name;
        }
    }
}

TEST_P(EditSequence, IsTheSameAgain) {
    for (uint32_t seed = 0; seed < 10; ++seed) {
        Script once(GetParam().desc, seed), again(GetParam().desc, seed);
        once.play(8);
        again.play(8);
        EXPECT_EQ(once.bake().steps(), again.bake().steps()) << seed;
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, EditSequence, testing::ValuesIn(kKinds), CaseName());

// Each layer comes out as it would alone: its levels are a function of itself.
TEST(BakeWithoutEdits, HasTheSameLevelsHoweverItIsMade) {
    for (uint32_t seed = 0; seed < 100; ++seed) {
        FakeBake alone({.rules = ScheduleRules(), .lamps = 10, .seed = seed});
        alone.finish();
        ASSERT_EQ(alone.wrong(), "");
        EXPECT_EQ(alone.levels().size(), 10u);
        for (const bool live : {false, true}) {
            for (const size_t lanes : {1, 2, 8}) {
                FakeBake bake(
                    {.rules = {.live = live, .together = true}, .lamps = 10, .lanes = lanes, .seed = seed});
                bake.finish();
                ASSERT_EQ(bake.wrong(), "");
                EXPECT_EQ(bake.levels(), alone.levels()) << seed;
            }
        }
    }
}

TEST(BakeWithoutEdits, IsMadeLayerByLayerOnTheCpu) {
    FakeBake bake({.rules = {.samples = 4}, .lamps = 2});
    bake.finish();
    EXPECT_EQ(bake.steps().substr(0, 14), "layer 0 to 1+1");
    EXPECT_LT(bake.steps().find("layer 0"), bake.steps().find("layer 1"));
    EXPECT_EQ(bake.steps().find("direct"), std::string::npos);
    EXPECT_EQ(bake.steps().find("sum"), std::string::npos);
}

std::vector<std::string> levelsOf(const FakeBake& bake, const std::string& lamp) {
    const auto found = bake.levels().find(lamp);
    return found == bake.levels().end() ? std::vector<std::string>() : found->second;
}

// An undo brings back the bytes: the level, and the steps of direct light, whatever was forgotten meanwhile.
TEST(UndoneMove, OfALightBringsBackLevelAndSteps) {
    for (uint32_t seed = 0; seed < 60; ++seed) {
        for (const bool live : {false, true}) {
            FakeBake bake({.rules = {.live = live, .together = true}, .lamps = 3, .room = 4, .seed = seed});
            bake.finish();
            const LayerLevel level = bake.layers()[1]->level;
            const std::vector<uint32_t> steps = bake.layers()[1]->directSteps;
            const Scene before = bake.scene;
            for (int i = 0; i < 3; ++i) {
                bake.scene.lights[1].transform[3].y += 1.0f;
                bake.edit();
                bake.finish();
            }
            const size_t made = levelsOf(bake, "lamp 1").size();
            bake.scene = before;
            bake.edit();
            bake.finish();
            ASSERT_EQ(bake.wrong(), "");
            EXPECT_GT(levelsOf(bake, "lamp 1").size(), made) << "it was not forgotten";
            EXPECT_EQ(bake.layers()[1]->level, level) << seed;
            EXPECT_EQ(bake.layers()[1]->directSteps, steps) << seed;
        }
    }
}

TEST(UndoneMove, OfALightCostsNothingWhileTheLayerIsKept) {
    FakeBake bake({.rules = viewerRules()});
    bake.finish();
    const Scene before = bake.scene;
    bake.scene.lights[1].transform[3].y += 1.0f;
    bake.edit();
    bake.finish();
    const auto levels = bake.levels();
    bake.scene = before;
    bake.edit();
    bake.finish();
    EXPECT_EQ(bake.levels(), levels);
}

// After colours and objects each layer is made anew to the level that it had, in the same steps.
TEST(Recoloured, LayersComeBackToTheirLevels) {
    for (uint32_t seed = 0; seed < 60; ++seed) {
        for (const bool objects : {false, true}) {
            FakeBake bake({.rules = {.live = seed % 2 == 0, .together = true}, .seed = seed});
            bake.finish();
            std::vector<LayerLevel> levels;
            std::vector<std::vector<uint32_t>> steps;
            for (const std::unique_ptr<Layer>& layer : bake.layers()) {
                levels.push_back({layer->directSamplePasses, layer->level.linkSamplePasses});
                steps.push_back(layer->directSteps);
            }
            const auto before = bake.levels();
            (objects ? bake.scene.instances[0].transform[3].x : bake.scene.materials[0].baseColor.x) += 0.5f;
            bake.edit();
            bake.finish();
            ASSERT_EQ(bake.wrong(), "");
            for (size_t i = 0; i < levels.size(); ++i) {
                const std::string lamp = "lamp " + std::to_string(i);
                const std::vector<std::string> all = levelsOf(bake, lamp);
                const size_t known = before.at(lamp).size();
                EXPECT_NE(
                    std::find(all.begin() + static_cast<std::ptrdiff_t>(known), all.end(), textOf(levels[i])),
                    all.end())
                    << seed << ": " << lamp;
                const std::vector<uint32_t>& now = bake.layers()[i]->directSteps;
                ASSERT_GE(now.size(), steps[i].size());
                EXPECT_TRUE(std::equal(steps[i].begin(), steps[i].end(), now.begin())) << seed;
            }
        }
    }
}

// Plays until the newest picture is whole and tells whether it is the sum of all lights.
bool seesSum(FakeBake& bake) {
    for (int i = 0; i < kPatience && (bake.waits() || bake.unseen()); ++i)
        bake.step();
    EXPECT_FALSE(bake.unseen());
    return bake.showsSum();
}

TEST(Recoloured, AViewerSeesTheSumOfAllLightsFirst) {
    FakeBake bake({.rules = viewerRules()});
    bake.finish();
    bake.scene.materials[0].baseColor.x = 0.5f;
    bake.edit();
    EXPECT_TRUE(seesSum(bake));
    bake.finish();
    EXPECT_EQ(bake.wrong(), "");
}

// Returns the steps that an edit makes until all is done.
std::string stepsOf(FakeBake& bake) {
    const size_t before = bake.steps().size();
    bake.edit();
    bake.finish();
    EXPECT_EQ(bake.wrong(), "");
    return bake.steps().substr(before);
}

TEST(Recoloured, TheSumIsTheFirstStepAndIsMadeOnce) {
    FakeBake bake({.rules = viewerRules()});
    bake.finish();
    bake.scene.materials[0].baseColor.x = 0.5f;
    const std::string steps = stepsOf(bake);
    EXPECT_EQ(steps.substr(0, 26), ", sum, continue, layer 0 t") << steps;
    EXPECT_EQ(steps.rfind("sum"), steps.find("sum")) << steps;
}

TEST(Recoloured, OfflineThereIsNoSum) {
    FakeBake bake({.rules = offlineRules()});
    bake.finish();
    bake.scene.materials[0].baseColor.x = 0.5f;
    EXPECT_EQ(stepsOf(bake).find("sum"), std::string::npos);
}

TEST(MovedObject, IsSeenBeforeAllLinksHaveFollowed) {
    int repairs = 0;
    for (uint32_t seed = 0; seed < 20; ++seed) {
        FakeBake bake({.rules = {.samples = 256, .error = 0, .live = true, .together = true}, .seed = seed});
        bake.finish();
        bake.scene.instances[0].transform[3].x = 1.0f;
        const std::string steps = stepsOf(bake);
        const size_t sum = steps.find("sum");
        EXPECT_EQ(steps.substr(0, 11), ", relink x4") << "these are the sum's own links: " << steps;
        EXPECT_LT(sum, steps.size()) << steps;
        EXPECT_GT(steps.rfind("relink"), sum) << "these are all others: " << steps;
        repairs += steps.find("layer") < sum; // of direct light, where the object was in its way
    }
    EXPECT_GT(repairs, 0);
}

TEST(MovedObject, OfflineAllLinksFollowFirst) {
    FakeBake bake({.rules = offlineRules()});
    bake.finish();
    bake.scene.instances[0].transform[3].x = 1.0f;
    const std::string steps = stepsOf(bake);
    EXPECT_EQ(steps.substr(0, 13), ", relink x8, ") << steps;
    EXPECT_EQ(steps.rfind("relink"), steps.find("relink")) << steps;
}

// Recolours a scene of four lights and goes on until the sum of all lights is shown and a layer is under way.
void showSum(FakeBake& bake) {
    bake.edit();
    bake.finish();
    bake.scene.materials[0].baseColor.x = 0.5f;
    bake.edit();
    while (bake.waits() || bake.unseen())
        bake.step();
    bake.step();
    EXPECT_TRUE(bake.showsSum());
}

TEST(BesideTheSum, ALightThatIsSwitchedOnIsAmongAllLightsAtOnce) {
    FakeBake bake({.rules = viewerRules(), .lamps = 4});
    bake.mix.muted = {{LightKey::Kind::Lamp, 3, 0}};
    showSum(bake);
    bake.mix.muted.clear();
    const std::string steps = stepsOf(bake);
    EXPECT_NE(steps.find("direct light of 3 to 2+2, sum"), std::string::npos) << steps;
}

TEST(BesideTheSum, ALayerGivesWayToTheSumOfOtherWeights) {
    FakeBake bake({.rules = viewerRules(), .lamps = 4});
    showSum(bake);
    bake.scene.lights[3].intensity = 0.5f;
    const std::string steps = stepsOf(bake);
    EXPECT_EQ(steps.substr(0, 11), ", drop, sum") << steps;
    EXPECT_EQ(steps.find("direct light"), std::string::npos) << "nothing new is made: " << steps;
}

TEST(Dragged, AnObjectIsSeenAtEachPlaceThatIsTaken) {
    for (uint32_t seed = 0; seed < 60; ++seed) {
        FakeBake bake({.rules = viewerRules(), .lamps = 4, .seed = seed});
        bake.finish();
        for (int place = 0; place < 6; ++place) {
            ASSERT_TRUE(bake.atRest());
            bake.scene.instances[0].transform[3].x += 1.0f;
            bake.edit();
            bake.step();
            EXPECT_FALSE(bake.waits()) << "at rest it is taken at once";
            EXPECT_TRUE(seesSum(bake)) << seed;
        }
        bake.finish();
        EXPECT_EQ(bake.wrong(), "");
    }
}

TEST(Dragged, ALightIsSeenAtItsFirstLevels) {
    FakeBake bake({.rules = viewerRules(), .lamps = 4});
    bake.finish();
    size_t seen = levelsOf(bake, "lamp 2").size();
    for (int place = 0; place < 6; ++place) {
        bake.scene.lights[2].transform[3].y += 1.0f;
        bake.edit();
        for (int i = 0; i < kPatience && levelsOf(bake, "lamp 2").size() == seen; ++i)
            bake.step();
        ASSERT_GT(levelsOf(bake, "lamp 2").size(), seen);
        EXPECT_EQ(levelsOf(bake, "lamp 2")[seen], "2+2");
        seen = levelsOf(bake, "lamp 2").size();
        EXPECT_FALSE(bake.showsSum()) << "one light alone is seen as soon itself";
    }
}

TEST(SeveralEdits, TheNewestCounts) {
    FakeBake bake({.rules = viewerRules()});
    bake.finish();
    const size_t made = levelsOf(bake, "lamp 0").size();
    bake.scene.lights[0].transform[3].y = 1.0f;
    bake.edit();
    bake.step(); // its first level is under way
    for (float place = 2.0f; place < 6.0f; ++place) {
        bake.scene.lights[0].transform[3].y = place;
        bake.edit();
        EXPECT_TRUE(bake.waits());
    }
    while (bake.waits())
        bake.step();
    EXPECT_EQ(bake.layers()[0]->cacheKey.light.transform[3].y, 5.0f);
    EXPECT_EQ(levelsOf(bake, "lamp 0").size(), made + 1) << "places between were not taken";
    bake.finish();
    EXPECT_EQ(bake.wrong(), "");
}

} // namespace
} // namespace relume
