// What the bake thread publishes is seen through OpenGL as the viewer does it, with both displays and without
// a window.
#include "app/live/live_bake.h"
#include "app/viewer/picture/lightmap_bridge.h"
#include "assets/generate/generate.h"
#include "bake/show/publisher.h"
#include "renderer/good_view.h"
#include "renderer/picture.h"
#include "tests/gpu/bake_scene.h"
#include "tests/gpu/gl_environment.h"
#include "tests/gpu/gpu_environment.h"
#include "tests/live/quick_bake.h"

#include <gtest/gtest.h>
#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <thread>

#include <fcntl.h>

namespace relume {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Texels = std::vector<glm::u16vec4>;

DisplayHost hostOfContext() {
    testContext();
    const gl::GlSharing sharing = gl::querySharing();
    return {.memoryObjects = sharing.memoryObject, .deviceUuids = sharing.deviceUuids};
}

// Tells whether images can be shared. Tests of shared images are skipped where the bake thread would not
// share them either.
bool canShare() {
    const DisplayHost host = hostOfContext();
    const auto& uuids = host.deviceUuids;
    return host.memoryObjects && vk::SharedImage::possible(testDevice(), kQuickSize, kQuickSize) &&
           std::find(uuids.begin(), uuids.end(), testDevice().info().uuid) != uuids.end();
}

Texels readTexels(const LightmapTexture& lightmap) {
    Texels texels(size_t{lightmap.size} * lightmap.size);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureImage(lightmap.texture, 0, GL_RGBA, GL_HALF_FLOAT,
                      static_cast<GLsizei>(texels.size() * sizeof(texels[0])), texels.data());
    return texels;
}

/// Returns the mean of all patches [cd/m^2].
double meanOf(const LightmapTexture& lightmap) {
    double sum = 0, count = 0;
    for (const glm::u16vec4& texel : readTexels(lightmap)) {
        const glm::vec4 value = glm::unpackHalf(texel);
        if (value.a < 0.75f) continue;
        sum += double{value.r} + value.g + value.b;
        count += 3;
    }
    return lightmap.unit * sum / count;
}

/// Holds a bake and the drawing thread's end of it.
class Display {
public:
    explicit Display(DisplayMode mode, const DisplayHost& host = hostOfContext())
        : bake_({.validation = true, .display = mode, .host = host}), bridge_(bake_.exchange()) {}
    ~Display() { bake_.stop(); } // before the slots that it writes go

    LiveBake& bake() { return bake_; }
    LightmapBridge& bridge() { return bridge_; }
    LightmapTexture texture() const { return bridge_.texture(); }

    /// Runs frame after frame until it is so.
    bool until(const std::function<bool()>& what, double seconds = kPatience) {
        const auto end = Clock::now() + std::chrono::duration<double>(seconds);
        while (Clock::now() < end) {
            bridge_.update();
            if (onFrame) onFrame();
            if (what()) return true;
            std::this_thread::sleep_for(1ms);
        }
        return false;
    }
    void start(const BakeSettings& settings, bool keepLight = true) {
        newest_ =
            bake_.start({.scene = &scene, .edits = edits, .settings = settings, .keepLight = keepLight});
    }
    /// Waits until the newest bake is done and its last map is there.
    bool untilShown() {
        using Phase = BakeStatus::Phase;
        const auto done = [&] {
            const BakeStatus status = bake_.status();
            return status.phase == Phase::Done && status.bake == newest_ && bridge_.map() &&
                   bridge_.map()->bake == newest_ && bridge_.map()->complete;
        };
        if (!until(done)) return false;
        // The last map may still have waited for a slot.
        const auto start = Clock::now();
        return until([&] { return Clock::now() - start > 100ms && !bridge_.waiting(); });
    }

    const PreparedScene scene = cornell();
    SceneEdits edits = editsOf(scene.scene);
    std::function<void()> onFrame;

private:
    LiveBake bake_;
    LightmapBridge bridge_;
    uint64_t newest_ = 0;
};

/// Runs each test with both displays.
class DisplayTest : public testing::TestWithParam<DisplayMode> {
protected:
    void SetUp() override {
        if (GetParam() == DisplayMode::Shared && !canShare()) GTEST_SKIP() << "images cannot be shared";
    }
    static const char* choice() { return GetParam() == DisplayMode::Shared ? "shared" : "copied"; }
};

std::string nameOf(const testing::TestParamInfo<DisplayMode>& mode) {
    return mode.param == DisplayMode::Shared ? "Shared" : "Copied";
}

INSTANTIATE_TEST_SUITE_P(Both, DisplayTest, testing::Values(DisplayMode::Shared, DisplayMode::Copied),
                         nameOf);

TEST_P(DisplayTest, EndsWithMakeLightmapsTexels) {
    Display display(GetParam());
    display.start(quickSettings(), false);
    ASSERT_TRUE(display.untilShown());
    EXPECT_EQ(display.bake().status().display.rfind(choice(), 0), 0u) << display.bake().status().display;

    Baker baker(testDevice(), display.scene.scene, display.scene.mesh, quickSettings());
    while (!baker.solver().done())
        baker.solver().step();
    const FloatImage expected = baker.lightmap({});
    const Texels texels = readTexels(display.texture());
    ASSERT_EQ(texels.size(), expected.planes[0].size());
    const float unit = display.texture().unit;
    for (size_t t = 0; t < texels.size(); ++t) {
        const glm::vec4 got = glm::unpackHalf(texels[t]);
        ASSERT_EQ(got.a, expected.planes[3][t]) << "texel " << t;
        for (int c = 0; c < 3; ++c) {
            // The values are rounded to halves once per ring of filled texels.
            const float want = expected.planes[static_cast<size_t>(c)][t] / unit;
            ASSERT_NEAR(got[c], want, std::abs(want) * 2e-3f + 1e-7f) << "texel " << t;
        }
    }
}

// Neither black nor another map is shown while a lightmap of another size is made.
TEST_P(DisplayTest, AnotherSizeKeepsTheOldMapUntilItsOwnIsThere) {
    Display display(GetParam());
    display.start(quickSettings(), false);
    ASSERT_TRUE(display.untilShown());
    const double before = meanOf(display.texture());
    ASSERT_GT(before, 0);
    std::vector<uint32_t> sizes;
    display.onFrame = [&] {
        const LightmapTexture shown = display.texture();
        if (sizes.empty() || sizes.back() != shown.size) sizes.push_back(shown.size);
        ASSERT_NE(shown.texture, 0u);
        // Coarse texels miss a part of small shadows; black would be far away.
        ASSERT_NEAR(meanOf(shown), before, 0.1 * before) << shown.size;
    };
    BakeSettings settings = quickSettings();
    for (const uint32_t size : {kQuickSize / 2, 2 * kQuickSize, kQuickSize}) {
        settings.size = size;
        display.start(settings);
        ASSERT_TRUE(display.untilShown());
        EXPECT_EQ(display.texture().size, size);
    }
    EXPECT_EQ(sizes, (std::vector<uint32_t>{kQuickSize, kQuickSize / 2, 2 * kQuickSize, kQuickSize}));
}

TEST(Display, SharedAndCopiedShowTheSamePixels) {
    if (!canShare()) GTEST_SKIP() << "images cannot be shared";
    struct Seen {
        Texels texels;
        float unit = 0;
        FloatImage picture;
    };
    const auto look = [](Display& display, SceneRenderer& renderer, const SceneGpu& gpu) {
        const gl::Framebuffer target({.width = 320, .height = 200, .name = "display"});
        renderer.draw({.scene = gpu,
                       .lightmap = display.texture(),
                       .camera = goodView(display.scene.mesh, 1.6f),
                       .settings = {.exposure = 0.0f}},
                      {.framebuffer = target.get(), .width = 320, .height = 200});
        return Seen{readTexels(display.texture()), display.texture().unit, readPicture(target)};
    };
    std::array<std::vector<Seen>, 2> seen;
    for (const DisplayMode mode : {DisplayMode::Shared, DisplayMode::Copied}) {
        Display display(mode);
        const SceneGpu gpu(display.scene.scene, display.scene.mesh);
        SceneRenderer renderer(4);
        auto& own = seen[mode == DisplayMode::Copied];
        display.start(quickSettings(), false);
        ASSERT_TRUE(display.untilShown());
        own.push_back(look(display, renderer, gpu));
        // An edit comes over what the slots hold already.
        for (Material& material : display.edits.materials)
            material.emission *= 0.25f;
        display.start(quickSettings());
        ASSERT_TRUE(display.untilShown());
        own.push_back(look(display, renderer, gpu));
    }
    for (size_t i = 0; i < seen[0].size(); ++i) {
        EXPECT_EQ(seen[0][i].texels, seen[1][i].texels);
        EXPECT_EQ(seen[0][i].unit, seen[1][i].unit);
        EXPECT_EQ(seen[0][i].picture.planes, seen[1][i].picture.planes);
    }
    EXPECT_NE(seen[0][0].picture.planes, seen[0][1].picture.planes) << "the edit is not seen";
}

/// Does what a drawing thread does whose OpenGL cannot import the images.
bool refuseOffer(Display& display) {
    const auto end = Clock::now() + std::chrono::duration<double>(kPatience);
    while (Clock::now() < end) {
        if (const auto offer = display.bake().exchange().takeOffer()) {
            EXPECT_TRUE(offer->shared);
            for (const int fd : offer->fds)
                close(fd);
            display.bake().exchange().refuse(offer->set);
            return true;
        }
        std::this_thread::sleep_for(1ms);
    }
    return false;
}

TEST(Display, RefusedImagesAreCopied) {
    if (!canShare()) GTEST_SKIP() << "images cannot be shared";
    Display display(DisplayMode::Auto);
    display.start(quickSettings(), false);
    ASSERT_TRUE(refuseOffer(display));
    ASSERT_TRUE(display.untilShown());
    EXPECT_EQ(display.bake().status().display, "copied (OpenGL did not take the images)");
    EXPECT_GT(meanOf(display.texture()), 0);
}

TEST(Display, RefusedImagesAreAnErrorWhereTheyMustBeShared) {
    if (!canShare()) GTEST_SKIP() << "images cannot be shared";
    Display display(DisplayMode::Shared);
    display.start(quickSettings(), false);
    ASSERT_TRUE(refuseOffer(display));
    ASSERT_TRUE(display.until([&] { return display.bake().status().phase == BakeStatus::Phase::Failed; }));
    EXPECT_NE(display.bake().status().doing.find("--display copied"), std::string::npos)
        << display.bake().status().doing;
    EXPECT_EQ(display.bridge().map(), nullptr);
}

TEST(Display, ADeviceThatOpenGlDoesNotKnowIsCopiedFrom) {
    DisplayHost host = hostOfContext();
    host.deviceUuids = {{1, 2, 3}};
    host.memoryObjects = true;
    Display display(DisplayMode::Auto, host);
    display.start(quickSettings(), false);
    ASSERT_TRUE(display.untilShown());
    EXPECT_EQ(display.bake().status().display, "copied (OpenGL draws on another device)");

    Display forced(DisplayMode::Shared, host);
    ASSERT_TRUE(forced.until([&] { return forced.bake().status().phase == BakeStatus::Phase::Failed; }));
    const std::string why = "--display shared: OpenGL draws on another device: use --display copied";
    EXPECT_EQ(forced.bake().status().doing, why) << "told before anything is asked for";
    forced.start(quickSettings());
    forced.until([] { return false; }, 0.2);
    EXPECT_EQ(forced.bake().status().doing, why) << "a scene changes nothing";
}

// A lightmap may be larger than OpenGL's textures, or than what memory the driver has left.
TEST(Display, ACopyThatOpenGlCannotHoldIsToldAndASmallerOneIsTaken) {
    testContext();
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    LightmapExchange exchange;
    exchange.offer({.set = 1, .size = static_cast<uint32_t>(most) + 1});
    LightmapBridge bridge(exchange);
    EXPECT_FALSE(bridge.update());
    EXPECT_FALSE(exchange.claim());
    exchange.offer({.set = 2, .size = kQuickSize});
    EXPECT_FALSE(bridge.update()) << "nothing is drawn yet";
    EXPECT_TRUE(exchange.claim());
}

// There are descriptors without memory behind them. NVIDIA's driver (580.159) refuses them, and then also the
// process' next memory.
TEST(Display, WhatOpenGlCannotImportIsRefused) {
    if (!canShare()) GTEST_SKIP() << "images cannot be shared";
    if (!testDevice().info().software()) GTEST_SKIP() << "the driver would refuse memory after it";
    LightmapExchange exchange;
    MapOffer offer{.set = 1, .size = kQuickSize, .shared = true, .memorySize = kQuickSize * kQuickSize * 8};
    for (int& fd : offer.fds)
        fd = open("/dev/null", O_RDWR | O_CLOEXEC);
    exchange.offer(offer);
    GLint muted = GL_FALSE;
    glGetIntegerv(GL_DEBUG_OUTPUT, &muted);
    glDisable(GL_DEBUG_OUTPUT); // that it is refused is what is asked for
    LightmapBridge bridge(exchange);
    EXPECT_FALSE(bridge.update());
    if (muted == GL_TRUE) glEnable(GL_DEBUG_OUTPUT);
    if (!exchange.refused()) GTEST_SKIP() << "this driver does not tell";
    for (const int fd : offer.fds)
        EXPECT_EQ(fcntl(fd, F_GETFD), -1) << "it stays open";
    exchange.offer({.set = 2, .size = kQuickSize});
    bridge.update();
    EXPECT_TRUE(exchange.claim()) << "memory is taken after that";
}

} // namespace
} // namespace relume
