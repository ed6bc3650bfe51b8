// The search finds the same patches inside something whether all directions are followed or as many as it
// takes.
#include "bake/baker/inside_search.h"

#include "assets/base/watch.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gpu_environment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
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
    for (const bool closed : {true, false})
        for (const TracerKind kind : {TracerKind::Embree, TracerKind::Bvh}) {
            if (!tracerProblem(kind, testDevice().info()).empty()) continue;
            BakeDesc desc{.size = 128, .method = Method::Hybrid, .samples = 16};
            desc.tracer = kind;
            const auto baker = makeBaker(coveredFloor(closed), desc);
            const PatchSet& patches = baker->patches();
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
            EXPECT_EQ(hiddenPatches(*baker), inside);
            EXPECT_EQ(baker->invalidPatches(), inside.size());
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
