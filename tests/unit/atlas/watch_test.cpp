// This tests what long jobs tell while they work, and that each of them can be ended.
#include "assets/base/watch.h"

#include "assets/atlas/lightmap_atlas.h"
#include "assets/atlas/unwrap.h"
#include "assets/atlas/world_mesh.h"
#include "assets/gltf/gltf.h"
#include "tests/unit/glb_builder.h"
#include "tests/unit/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace relume {
namespace {

struct Ended {};

/// Writes down what it hears, and ends the job at that phase.
class WatchRecorder final : public Watch {
public:
    explicit WatchRecorder(std::string end = "") : end_(std::move(end)), scope_(*this) {}
    void hear(const char* phase, double done) override {
        if (phases.empty() || phases.back() != phase) phases.emplace_back(phase);
        most = std::max(most, done);
        if (phase == end_) throw Ended();
    }
    bool heard(const std::string& phase) const {
        return std::find(phases.begin(), phases.end(), phase) != phases.end();
    }

    std::vector<std::string> phases;
    double most = -1.0;

private:
    std::string end_;
    WatchScope scope_;
};

/// Makes many squares that stand apart.
Scene manySquares(int count) {
    Scene scene;
    scene.path = "many.glb";
    for (int i = 0; i < count; ++i)
        test::addInstance(scene, test::addMesh(scene, test::square()),
                          glm::translate(glm::mat4(1), glm::vec3(2 * i, 0, 0)));
    return scene;
}

/// Expects that the job tells of the phase, and ends when it is ended there.
void expectPhase(const std::string& phase, const std::function<void()>& job) {
    {
        const WatchRecorder recorder;
        job();
        EXPECT_TRUE(recorder.heard(phase)) << phase;
    }
    const WatchRecorder recorder(phase);
    EXPECT_THROW(job(), Ended) << phase;
}

} // namespace

TEST(Watch, HearsOfItsOwnThreadOnlyAndAsLongAsItIsThere) {
    tellWatch("nobody");
    WatchRecorder outer;
    tellWatch("first", 0.25);
    {
        const WatchRecorder inner;
        tellWatch("second");
        EXPECT_EQ(inner.phases, std::vector<std::string>{"second"});
    }
    std::thread([] { tellWatch("elsewhere"); }).join();
    tellWatch("third", 0.75);
    EXPECT_EQ(outer.phases, (std::vector<std::string>{"first", "third"}));
    EXPECT_EQ(outer.most, 0.75);
}

TEST(Watch, ALoopTellsItsShareNowAndThen) {
    WatchRecorder recorder;
    WatchedLoop loop("loop", 100, 10);
    for (int i = 0; i < 95; ++i)
        loop.step();
    EXPECT_DOUBLE_EQ(recorder.most, 0.9);
}

TEST(Watch, EveryPhaseBeforeABakeCanBeEnded) {
    test::GlbBuilder builder = test::squareScene();
    const std::string path = builder.write("watched.glb");
    expectPhase("loading", [&] { loadGltf(path); });
    expectPhase("atlas", [] { buildAtlas(manySquares(20), 256); });
    const auto unwrapSome = [] {
        Scene scene = manySquares(20);
        for (Mesh& mesh : scene.meshes)
            mesh.primitives[0].texCoord1.clear();
        unwrap(scene, {.density = 0, .size = 256});
    };
    expectPhase("unwrapping", unwrapSome);
    expectPhase("packing charts", unwrapSome);
    expectPhase("triangles", [] {
        Scene scene = test::sceneOf(test::sphere(128));
        LightmapAtlas atlas;
        atlas.instances.resize(1);
        flatten(scene, atlas);
    });
}

} // namespace relume
