// The search finds the same patches inside something whether all directions are followed or as many as it
// takes.
#include "bake/validity/inside_search.h"
#include "bake/validity/step_aside.h"

#include "assets/base/watch.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

namespace relume {
namespace {

/// Makes a floor of 4 m, of 40 texels if nothing else is said, in a room or below the sky, on which a box
/// stands that covers part of it. It is shifted by so many metres against the texels' edges.
Scene coveredFloor(bool closed, float shift = 0, int texels = 40) {
    SceneMaker maker(128);
    const int grey = maker.material(0.5f, 1.0f);
    if (closed) maker.box({-2, -2, -2}, {glm::vec3(8, 0, 0), {0, 8, 0}, {0, 0, 8}}, grey, 20);
    maker.quad({-1, 0, -1}, {0, 0, 4}, {4, 0, 0}, grey, {texels, texels});
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(shift, -0.5f, shift);
    for (const auto& [corner, u, v] :
         {std::tuple(o, z, y), {o, x, z}, {o, y, x}, {o + x, y, z}, {o + y, z, x}, {o + z, x, y}})
        maker.quad(corner, u, v, grey, {8, 8});
    return maker.scene();
}

std::vector<uint32_t> hiddenPatches(const PatchSet& patches) {
    std::vector<uint32_t> hidden;
    for (uint32_t i = 0; i < patches.count; ++i)
        if ((patches.scene.patches[i].flags & shader::kPatchSends) == 0) hidden.push_back(i);
    return hidden;
}

class PhaseRecorder final : public Watch {
public:
    PhaseRecorder() : scope_(*this) {}
    void hear(const char* phase, double done) override {
        phases.insert(phase);
        most = std::max(most, done);
    }
    std::set<std::string> phases;
    double most = -1.0;

private:
    WatchScope scope_;
};

} // namespace

TEST(InsideSearch, AsManyDirectionsAsItTakesFindWhatAllFind) {
    for (const bool closed : {true, false})
        for (const TracerKind kind : {TracerKind::Embree, TracerKind::Bvh}) {
            if (!tracerProblem(kind, testDevice().info()).empty()) continue;
            BakeDesc desc{.size = 128, .method = Method::Hybrid, .samples = 16};
            desc.tracer = kind;
            const auto baker = makeBaker(coveredFloor(closed), desc);
            PatchSet patches = baker->patches();
            stepBack(patches); // from where the middles of texels are seen
            const vk::Buffer onDevice = vk::makeBuffer(testDevice(), patches.scene.patches, "patches");
            const auto tracer = makeTracer(kind, testDevice(), patches.scene, onDevice);
            std::vector<uint32_t> all(patches.count);
            std::iota(all.begin(), all.end(), 0u);
            std::vector<MetBits> met(patches.scene.patches.size());
            followAll(testDevice(), *tracer, patches, all, met);
            std::vector<uint32_t> inside;
            for (const uint32_t i : all) {
                ASSERT_EQ(met[i].backs & met[i].sky, 0u) << "all directions were followed";
                if (insideBy(met[i]) == Inside::Yes) inside.push_back(i);
            }
            EXPECT_GT(inside.size(), 20u);
            EXPECT_EQ(hiddenPatches(patches), inside);
            EXPECT_EQ(baker->invalidPatches() + asideFromInside(baker->patches()), inside.size());
        }
}

// Beside a box the floor's texels are seen, though their middles lie in it; below it none is. Whoever traces,
// the same patches step aside, to where nothing is around them, and see no more of their texels than what
// lies outside.
TEST(InsideSearch, PatchesBesideTheBoxStepAside) {
    for (const bool closed : {true, false}) {
        std::vector<OwnPoint> first;
        for (const TracerKind kind : tracersOfTestDevice()) {
            BakeDesc desc{.size = 128, .method = Method::Hybrid, .samples = 16};
            desc.tracer = kind;
            const float shift = 0.04f;
            const auto baker = makeBaker(coveredFloor(closed, shift), desc);
            const PatchSet& patches = baker->patches();
            const std::vector<OwnPoint> aside = pointsAside(patches);
            EXPECT_GT(aside.size(), 10u);
            for (const OwnPoint& point : aside) {
                const glm::vec3 p = point.position;
                const glm::vec3 local = p - glm::vec3(shift, 0, shift);
                EXPECT_TRUE(local.x < 0 || local.x > 1 || local.z < 0 || local.z > 1 ||
                            std::abs(local.y) >= 0.5f)
                    << p.x << ", " << p.y << ", " << p.z;
                EXPECT_NE(point.cells, 0u);
                EXPECT_NE(patches.scene.patches[point.patch].flags & shader::kPatchSends, 0u);
            }
            if (first.empty()) first = aside;
            EXPECT_EQ(aside, first) << int(kind);
        }
    }
}

// Where sizes are round, walls stand exactly on the middles of texels: the floor goes on below them, half of
// what such a texel looks at is the wall's inside, and no ray along the floor meets the wall from there. It
// would have half the light. At a corner of the box that is a quarter.
TEST(InsideSearch, PatchesUponASurfaceLeaveIt) {
    constexpr float kShift = 0.0625f, kClear = 1e-3f; // [m]; the first is half a texel
    for (const TracerKind kind : tracersOfTestDevice()) {
        BakeDesc desc{.size = 128, .method = Method::Hybrid, .samples = 16};
        desc.tracer = kind;
        const auto baker = makeBaker(coveredFloor(true, kShift, 32), desc);
        const PatchSet& patches = baker->patches();
        EXPECT_GT(std::count_if(patches.aside.begin(), patches.aside.end(),
                                [](const OwnPoint& home) { return home.sends; }),
                  10);
        for (uint32_t i = 0; i < patches.count; ++i) {
            const shader::Patch& patch = patches.scene.patches[i];
            if ((patch.flags & shader::kPatchSends) == 0 || std::abs(patch.position.y) > kClear) continue;
            const glm::vec3 local = patch.position - glm::vec3(kShift, 0, kShift);
            const auto clear = [](float x) { return x < -kClear || x > 1 + kClear; };
            EXPECT_TRUE(clear(local.x) || clear(local.z)) << local.x << " " << local.z;
        }
    }
}

// Methods that know no parts of texels have everybody at home, and light as of a bake by them alone.
TEST(InsideSearch, PatchesStepBackWhereAnotherMethodIsTaken) {
    const Scene scene = coveredFloor(true, 0.04f);
    const BakeDesc hybrid{.size = 128, .method = Method::Hybrid, .samples = 16};
    const BakeDesc pure{.size = 128, .passes = 2, .method = Method::Pure};
    const auto bake = [](Baker& baker) {
        while (!baker.solver().done())
            baker.solver().step();
        return baker.lightmap({.sew = false});
    };
    const auto baker = makeBaker(scene, hybrid), fresh = makeBaker(scene, pure);
    const FloatImage first = bake(*baker);
    EXPECT_GT(baker->patches().aside.size(), 0u);
    baker->resetSolver(settingsOf(pure).solver);
    EXPECT_TRUE(baker->patches().aside.empty());
    EXPECT_EQ(bake(*baker).planes, bake(*fresh).planes);
    EXPECT_EQ(baker->invalidPatches(), fresh->invalidPatches());
    baker->resetSolver(settingsOf(hybrid).solver);
    EXPECT_EQ(bake(*baker).planes, first.planes);
}

TEST(InsideSearch, ABakersPhasesAreTold) {
    const PhaseRecorder recorder;
    const auto baker = makeBaker(coveredFloor(true), {.size = 128});
    for (const char* phase : {"cit", "patches", "tracer", "validity", "solver set-up"})
        EXPECT_TRUE(recorder.phases.contains(phase)) << phase;
    EXPECT_GT(recorder.most, 0.0);
}

} // namespace relume
