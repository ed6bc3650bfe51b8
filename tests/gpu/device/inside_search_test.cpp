// The search finds the same patches inside something whether all directions are followed, as where objects
// may move later, or as many as it takes.
#include "bake/baker/inside_search.h"

#include "assets/base/watch.h"
#include "tests/gpu/bake_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace relume {
namespace {

/// Makes a floor, in a room or below the sky, on which a box stands that covers part of it.
Scene coveredFloor(bool closed) {
    SceneMaker maker(128);
    const int grey = maker.material(0.5f, 1.0f);
    if (closed) maker.box({-2, -2, -2}, {glm::vec3(8, 0, 0), {0, 8, 0}, {0, 0, 8}}, grey, 20);
    maker.quad({-1, 0, -1}, {0, 0, 4}, {4, 0, 0}, grey, {40, 40});
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), o(0, -0.5f, 0);
    for (const auto& [corner, u, v] :
         {std::tuple(o, z, y), {o, x, z}, {o, y, x}, {o + x, y, z}, {o + y, z, x}, {o + z, x, y}})
        maker.quad(corner, u, v, grey, {8, 8});
    return maker.scene();
}

std::vector<uint32_t> hiddenPatches(const Baker& baker) {
    std::vector<uint32_t> hidden;
    for (uint32_t i = 0; i < baker.patches().count; ++i)
        if ((baker.patches().scene.patches[i].flags & shader::kPatchSends) == 0) hidden.push_back(i);
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
    for (const bool closed : {true, false}) {
        const Scene scene = coveredFloor(closed);
        const BakeDesc few{.size = 128, .method = Method::Hybrid, .samples = 16};
        BakeDesc all = few;
        all.layers = true; // keeps every direction for objects that move
        const auto some = makeBaker(scene, few), whole = makeBaker(scene, all);
        EXPECT_GT(some->invalidPatches(), 20u);
        EXPECT_EQ(hiddenPatches(*some), hiddenPatches(*whole));
        EXPECT_EQ(some->invalidPatches(), whole->invalidPatches());
    }
}

TEST(InsideSearch, ABakersPhasesAreTold) {
    const PhaseRecorder recorder;
    const auto baker = makeBaker(coveredFloor(true), {.size = 128});
    for (const char* phase : {"cit", "patches", "tracer", "validity", "solver set-up"})
        EXPECT_TRUE(recorder.phases.contains(phase)) << phase;
    EXPECT_GT(recorder.most, 0.0);
}

} // namespace relume
