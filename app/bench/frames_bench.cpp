#include "app/bench/frames_bench.h"

#include "app/live/live_bake.h"
#include "app/offline/solve.h"
#include "app/viewer/picture/lightmap_bridge.h"
#include "app/viewer/window/redraw_pacer.h"
#include "assets/base/clock.h"
#include "assets/base/log.h"
#include "renderer/gl/debug.h"
#include "renderer/gl/headless_context.h"
#include "renderer/gl/shared_texture.h"
#include "renderer/good_view.h"
#include "renderer/scene_renderer.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace relume {
namespace {

constexpr float kTurn = 0.01f; // [rad] of the camera per frame
// The bake's first solution must be there after so long, and the first rays of a part.
constexpr double kPatience = 300; // [s]

/// The loop of a viewer without its window.
class Loop {
public:
    Loop(const FramesBenchDesc& desc, const PreparedScene& scene, LiveBake& bake)
        : desc_(desc), scene_(scene.scene, scene.mesh), bake_(bake), bridge_(bake.exchange()),
          renderer_(desc.samples, SceneRenderer::Metering::Async),
          target_({.width = desc.width, .height = desc.height, .name = "frames"}) {
        const float aspect = static_cast<float>(desc.width) / static_cast<float>(desc.height);
        const Scene& file = scene.scene;
        camera_ = file.cameras.empty() ? goodView(scene.mesh, aspect)
                                       : cameraOfFile(file.cameras.front(), scene_.bounds());
    }

    bool update() { return bridge_.update(); }

    /// Counts rays and keeps the bake busy. Light stays on screen until there is new one.
    void follow() {
        const BakeStatus status = bake_.status();
        if (status.phase == BakeStatus::Phase::Failed) throw Error(status.doing);
        rays_.see(status.beginnings, status.rays);
        // Once for each bake: until the command is taken, the status is that of before.
        if (status.phase != BakeStatus::Phase::Done || ended_ == status.beginnings) return;
        ended_ = status.beginnings;
        bake_.reset();
    }
    bool complete() const { return bridge_.map() != nullptr && bridge_.map()->complete; }

    /// Draws one frame, for which the camera moves on if asked to. Returns how long it took [ms].
    double frame(bool moves) {
        if (moves) camera_ = look(camera_, kTurn, 0.0f);
        const auto start = Clock::now();
        renderer_.draw({.scene = scene_, .lightmap = bridge_.texture(), .camera = camera_, .settings = {}},
                       {.framebuffer = target_.get(), .width = desc_.width, .height = desc_.height});
        glFinish();
        return 1000.0 * secondsSince(start);
    }

    FramesPart moving(const std::string& name, double batchMs, bool bakes) {
        FramesPart part = begin(name);
        bake_.setBatchMs(batchMs);
        auto next = Clock::now();
        while (goesOn(bakes)) {
            update();
            if (bakes) follow();
            part.frames.push_back(frame(true));
            if (desc_.rate <= 0) continue;
            next = std::max(next + std::chrono::duration_cast<Clock::duration>(
                                       std::chrono::duration<double>(1.0 / desc_.rate)),
                            Clock::now());
            std::this_thread::sleep_until(next);
        }
        return end(std::move(part));
    }

    /// Draws only what changed, as seldom as a viewer whose camera stands still.
    FramesPart still(const std::string& name) {
        FramesPart part = begin(name);
        bake_.setBatchMs(desc_.budget);
        RedrawPacer pacer;
        while (goesOn(true)) {
            if (update()) pacer.newMap();
            follow();
            const Redraw redraw = pacer.due(secondsSince(start_));
            if (redraw.any) {
                const double ms = frame(false);
                pacer.drawn(redraw, secondsSince(start_), 1e-3 * ms);
                part.frames.push_back(ms);
            } else {
                constexpr double kIdle = 0.005; // [s], as long as a window waits for events at most
                std::this_thread::sleep_for(
                    std::chrono::duration<double>(pacer.wait(secondsSince(start_), kIdle)));
            }
        }
        return end(std::move(part));
    }

    FramesPart bakeAlone(const std::string& name) {
        FramesPart part = begin(name);
        bake_.setBatchMs(desc_.budget);
        while (goesOn(true)) {
            follow();
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return end(std::move(part));
    }

private:
    /// A step of a bake may last longer than a part: a rate of no ray at all would say nothing, so the part
    /// waits until the bake has told of some.
    bool goesOn(bool bakes) const {
        const double seconds = secondsSince(start_);
        if (seconds < desc_.seconds) return true;
        return bakes && rays_.total() == raysBefore_ && seconds < kPatience;
    }
    void seeRays() {
        const BakeStatus status = bake_.status();
        rays_.see(status.beginnings, status.rays);
    }
    FramesPart begin(const std::string& name) {
        start_ = Clock::now();
        seeRays();
        raysBefore_ = rays_.total();
        FramesPart part;
        part.name = name;
        return part;
    }
    FramesPart end(FramesPart part) {
        part.seconds = secondsSince(start_);
        seeRays();
        part.raysPerSecond = static_cast<double>(rays_.total() - raysBefore_) / part.seconds;
        return part;
    }

    const FramesBenchDesc& desc_;
    SceneGpu scene_;
    LiveBake& bake_;
    LightmapBridge bridge_;
    SceneRenderer renderer_;
    gl::Framebuffer target_;
    ViewCamera camera_;
    Clock::time_point start_{};
    RayCount rays_;
    uint64_t ended_ = 0;      // the last bake that came to its end
    uint64_t raysBefore_ = 0; // this part
};

void waitFor(LiveBake& bake, Loop& loop, bool (*reached)(const LiveBake&, const Loop&)) {
    const auto start = Clock::now();
    while (!reached(bake, loop)) {
        loop.update();
        const BakeStatus status = bake.status();
        if (status.phase == BakeStatus::Phase::Failed) throw Error(status.doing);
        if (secondsSince(start) > kPatience)
            throw Error("the bake has no first solution after five minutes: use a smaller --size");
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
}

} // namespace

double percentile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const double place = std::ceil(share * static_cast<double>(values.size())) - 1.0;
    return values[static_cast<size_t>(std::clamp(place, 0.0, static_cast<double>(values.size() - 1)))];
}

FramesReport measureFrames(const FramesBenchDesc& desc) {
    BakeRequest request = resolveBakeOptions(desc.bake);
    // The bake goes on for as long as it can, as in a viewer that was asked for an error that no one reaches.
    constexpr double kNoOnesError = 1e-9;
    const bool pairs = isPairMethod(request.bake.solver.method);
    request.bake.solver.error = pairs ? 0.0 : kNoOnesError;
    request.bake.solver.passes = pairs ? Solver::kMaxPasses : 0;
    request.bake.solver.links.samples = 0;
    request.bake.solver.layers.on = true; // as in the viewer
    const PreparedScene scene = prepareFor(request);
    std::unique_ptr<LiveBake> bake; // its Vulkan outlives OpenGL (picture_studio.h)
    const gl::HeadlessContext context({.debug = desc.bake.machine.validate});
    const gl::GlSharing sharing = gl::querySharing();
    bake = std::make_unique<LiveBake>(
        LiveBake::Desc{.device = desc.bake.machine.device,
                       .validation = desc.bake.machine.validate,
                       .display = desc.display,
                       .host = {.memoryObjects = sharing.memoryObject, .deviceUuids = sharing.deviceUuids},
                       .batchMs = desc.budget});
    FramesReport report;
    {
        Loop loop(desc, scene, *bake);
        bake->start({.scene = &scene, .edits = editsOf(scene.scene), .settings = request.bake});
        waitFor(*bake, loop, [](const LiveBake&, const Loop& l) { return l.complete(); });
        constexpr int kWarmUp = 10; // frames: shaders are compiled when they are first used
        for (int i = 0; i < kWarmUp; ++i)
            loop.frame(true);
        report.bakeAlone = loop.bakeAlone("bake alone");
        report.moving = loop.moving("both, camera moves", std::max(1.0, 0.25 * desc.budget), true);
        report.still = loop.still("both, camera still");
        bake->pause();
        waitFor(*bake, loop, [](const LiveBake& b, const Loop&) {
            const BakeStatus::Phase phase = b.status().phase;
            return phase == BakeStatus::Phase::Paused || phase == BakeStatus::Phase::Done;
        });
        report.alone = loop.moving("frames alone", desc.budget, false);
        const BakeStatus status = bake->status();
        report.device = status.device;
        report.display = status.display;
        report.opengl = gl::describeContext();
        bake->stop();
        failOnValidation(status.validationMessages);
    }
    return report;
}

} // namespace relume
