// The light of places between surfaces, while a bake runs beside.
#include "app/bench/map_sink.h"
#include "app/live/live_bake.h"
#include "bake/probes/probe_light.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/live/quick_bake.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <thread>

namespace relume {
namespace {

using namespace std::chrono_literals;

class LiveBalls : public testing::Test {
protected:
    ~LiveBalls() override { bake_.stop(); } // before the screen's memory goes, which it writes

    /// Takes maps and answers until this is so.
    bool until(const std::function<bool()>& what) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kPatience);
        while (std::chrono::steady_clock::now() < end) {
            screen_.update();
            if (std::optional<LitBalls> balls = bake_.takeBalls()) {
                lit_ = *balls;
                ++answers_;
                traced_ += balls->traced ? 1 : 0;
            }
            if (what()) return true;
            if (bake_.status().phase == BakeStatus::Phase::Failed) return false;
            std::this_thread::sleep_for(1ms);
        }
        return false;
    }
    bool untilDone() {
        return until([&] {
            const BakeStatus status = bake_.status();
            return status.phase == BakeStatus::Phase::Done && status.bake == newest_;
        });
    }
    void start() {
        BakeSettings settings = quickSettings();
        settings.solver.layers.on = true;
        newest_ = bake_.start({.scene = &scene_, .edits = edits_, .settings = settings, .keepLight = true});
    }
    float upwards() const { return lit_.ball->lighting[0].g + lit_.ball->lighting[1].g; }

    PreparedScene scene_ = cornell();
    SceneEdits edits_ = editsOf(scene_.scene);
    const bool software_ = testDevice().info().software(); // a device of this process comes first
    LiveBake bake_{{.validation = true}};
    MapSink screen_{bake_.exchange()};
    LitBalls lit_;
    int answers_ = 0, traced_ = 0;
    uint64_t newest_ = 0;
};

} // namespace

TEST_F(LiveBalls, AreLitByTheBakeAndFollowItsLightWithoutRays) {
    const glm::vec3 middle(0.1f, 1.0f, 0.2f);
    bake_.askBalls({.ball = middle, .grid = {{0, 0.5f, 0}, {0, 1.2f, 0}, {0, -3, 0}}});
    start();
    ASSERT_TRUE(untilDone());
    ASSERT_TRUE(until([&] { return answers_ > 0 && lit_.ball.has_value() && upwards() > 0; }));
    EXPECT_EQ(traced_, 1) << "the bake's light alone has changed since";
    EXPECT_EQ(lit_.grid.size(), 3u);
    EXPECT_EQ(lit_.ball->position, middle);

    // The last answer is of the light as the bake left it: an offline bake has the same.
    BakeSettings settings = quickSettings();
    settings.solver.layers.on = true;
    Baker baker(testDevice(), scene_.scene, scene_.mesh, settings);
    while (!baker.solver().done())
        baker.solver().step();
    const LampSet lamps = probeLamps(scene_.scene, baker.patches().scene.mesh);
    const ProbeLinks links = traceProbes(testDevice(), baker.patches(), lamps, {middle},
                                         {.samples = 2048, .tracer = parseTracerKind(baker.tracer().name())});
    const ProbeLight light =
        probeLight(scene_.scene, baker.patches(), lightSources(scene_.scene), baker.solver().light(), 1.0f);
    const Harmonics radiance = gatherProbes(testDevice().workers(), links, {&light, 1}).at(0).at(0);
    const std::array<glm::vec3, 9> expected = lightingPolynomial(radiance);
    const float wanted = expected[0].g + expected[1].g;
    ASSERT_TRUE(until([&] { return std::abs(upwards() / wanted - 1.0f) < 0.01f; }))
        << upwards() << ' ' << wanted;

    // Half the light costs no ray.
    const float before = upwards();
    for (Material& material : edits_.materials)
        material.emission *= 0.5f;
    start();
    ASSERT_TRUE(until([&] { return std::abs(upwards() / (0.5f * before) - 1.0f) < 0.01f; })) << upwards();
    EXPECT_EQ(traced_, 1);

    // A ball that is elsewhere traces itself; without any there is nothing to tell.
    bake_.askBalls({.ball = glm::vec3(0.1f, 0.3f, 0.2f)});
    ASSERT_TRUE(until([&] { return lit_.ball && lit_.ball->position.y < 0.5f; }));
    EXPECT_TRUE(lit_.grid.empty());
    EXPECT_EQ(traced_, 2);
}

TEST_F(LiveBalls, UnderRtradsPresetTheySayWhyTheyAreGrey) {
    bake_.askBalls({.ball = glm::vec3(0.1f, 1.0f, 0.2f)});
    BakeSettings settings = quickSettings();
    settings.solver.method = Method::Static;
    settings.solver.transport.rtrad = true;
    newest_ = bake_.start({.scene = &scene_, .edits = edits_, .settings = settings, .keepLight = true});
    ASSERT_TRUE(until([&] { return answers_ > 0; }));
    EXPECT_FALSE(lit_.ball);
    EXPECT_NE(lit_.remark.find("RTRad's preset"), std::string::npos) << lit_.remark;
    // By another method it is lit, and its memory is told.
    start();
    ASSERT_TRUE(until([&] { return lit_.ball && lit_.remark.empty(); }));
    ASSERT_TRUE(until([&] { return bake_.status().ballBytes > 0; }));
}

} // namespace relume
