#include "app/live/bake_loop.h"

#include "app/live/lightmap_export.h"
#include "app/live/seen_chunks.h"
#include "app/live/warm_up.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/base/watch.h"
#include "shaders/shader_library.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <functional>
#include <iterator>
#include <string_view>
#include <utility>

#include <sched.h>

namespace relume {
namespace {

// The status is reported so often while baking: no eye follows more.
constexpr double kReportSeconds = 0.05;
// A map waits so long for a slot before the exchange is asked again.
constexpr auto kSlotWait = std::chrono::milliseconds(5);
// A first glance at the light may delay the bake by so much.
constexpr double kGlanceSeconds = 1.0;
// This exception ends a preparation that nobody waits for any more.
struct Cancelled {};

// The phases stand in the order in which a baker tells them, for the progress bar.
constexpr std::array<std::string_view, 6> kPhases = {"cit",      "patches", "tracer",
                                                     "validity", "voxels",  "solver set-up"};

// Passes on to a function how a preparation stands.
class Hearer final : public Watch {
public:
    using Hear = std::function<void(const char* phase, double done)>;
    explicit Hearer(Hear hear) : hear_(std::move(hear)), scope_(*this) {}
    void hear(const char* phase, double done) override { hear_(phase, done); }

private:
    Hear hear_;
    WatchScope scope_;
};

// Lets pictures come first where the CPU bakes: threads inherit the low priority of this one.
void yieldToOthers() {
    const sched_param none{};
    if (sched_setscheduler(0, SCHED_IDLE, &none) != 0)
        spdlog::debug("the bake thread keeps its ordinary priority: SCHED_IDLE was refused");
}

} // namespace

BakeLoop::BakeLoop(BakeDesk& desk, const BakeDeviceDesc& desc) : desk_(desk), desc_(desc) {}

BakeLoop::~BakeLoop() = default;

void BakeLoop::run() {
    try {
        openDevice();
    } catch (const std::exception& error) {
        desk_.room.set_value(std::nullopt);
        fail(error.what());
        report(true); // there may never be a command
    }
    BakeOrders orders;
    while (takeOrders(orders)) {
        try {
            obey(orders);
            if (waiting_) prepare(*std::exchange(waiting_, {}));
            exportAll();
            if (steps()) stepSolver();
            publish();
        } catch (const Cancelled&) {
            continue; // the newer command is there, and exports wait for what it makes
        } catch (const std::bad_alloc&) {
            fail("out of memory: use a smaller lightmap or close other programs");
        } catch (const std::exception& error) {
            fail(error.what());
        }
        if (!triesWaiting()) report(status_.phase != Phase::Baking);
    }
    endExports(orders);
    giveUp();
}

// Tells whether the bake goes on now. One that is paused does so until it can follow an edit that an export
// waits for.
bool BakeLoop::steps() const {
    const bool wanted = waiting_ && !(exports_.empty() && engineExports_.empty());
    return status_.phase == Phase::Baking || (status_.phase == Phase::Paused && wanted);
}

// Tells whether a bake failed while an edit waited for it: what is newer than the failure may mend it.
bool BakeLoop::triesWaiting() const {
    return waiting_ && status_.phase == Phase::Failed;
}

void BakeLoop::openDevice() {
    const bool second = desc_.device == kSecondGpu;
    if (second && desc_.host.deviceUuids.empty())
        throw Error("OpenGL does not say by which GPU it draws: choose the one that bakes by its number, as "
                    "'relume devices' lists it");
    device_ = std::make_unique<vk::Device>(
        vk::Device::Desc{.select = second ? "" : desc_.device,
                         .beside = second ? desc_.host.deviceUuids : std::vector<vk::DeviceUuid>{},
                         .validation = desc_.validation,
                         .memoryLimit = desc_.deviceMemory,
                         .chosen = [](const vk::DeviceInfo& info) {
                             if (info.software()) yieldToOthers();
                         }});
    const BakeRoom room = roomOn(*device_);
    const vk::DeviceInfo& info = device_->info();
    status_.device = fmt::format("{} ({})", info.name, info.driver);
    spdlog::info("device: {}", status_.device);
    maps_ = std::make_unique<MapPublisher>(*device_, desk_.exchange,
                                           MapSlots::Desc{.display = desc_.display, .host = desc_.host});
    balls_.emplace(*device_);
    status_.display = maps_->choice();
    spdlog::info("display: {}", status_.display);
    report(true);
    desk_.room.set_value(room);
    if (info.software()) compileAhead();
}

// Compiles what a bake needs while the first level is read. A bake does so where this fails.
void BakeLoop::compileAhead() {
    try {
        warmUp(*device_, [this] {
            const std::lock_guard lock(desk_.mutex);
            return desk_.orders.quit || desk_.orders.start;
        });
    } catch (const std::exception& error) {
        spdlog::debug("nothing was compiled ahead: {}", error.what());
    }
}

// Waits where there is nothing to do. Returns false when the thread is to quit.
bool BakeLoop::takeOrders(BakeOrders& orders) {
    std::unique_lock lock(desk_.mutex);
    const auto something = [&] {
        const BakeOrders& o = desk_.orders;
        return o.quit || o.start || o.reset || o.abort || o.reload || o.run != BakeOrders::Run::Keep ||
               o.batchMs || o.seenTiles || o.inspect || o.probes || o.balls || o.voxels ||
               !o.exports.empty() || !o.engineExports.empty();
    };
    if (!steps() && !triesWaiting()) {
        if (maps_ && (maps_->owes() || balls_->owes()))
            desk_.news.wait_for(lock, kSlotWait, something);
        else
            desk_.news.wait(lock, something);
    }
    orders = std::exchange(desk_.orders, {});
    if (orders.start) desk_.held = orders.start->scene;
    return !orders.quit;
}

void BakeLoop::takeExports(BakeOrders& orders) {
    std::move(orders.exports.begin(), orders.exports.end(), std::back_inserter(exports_));
    std::move(orders.engineExports.begin(), orders.engineExports.end(), std::back_inserter(engineExports_));
}

void BakeLoop::obey(BakeOrders& orders) {
    takeExports(orders);
    if (!maps_) return; // the phase is Failed and stays so
    if (orders.batchMs) desc_.batchMs = *orders.batchMs;
    if (orders.seenTiles) seenTiles_ = std::move(*orders.seenTiles);
    if (orders.inspect) inspect_ = *orders.inspect;
    if (orders.probes) maps_->setProbes(std::move(*orders.probes));
    if (orders.balls) balls_->ask(std::move(*orders.balls));
    if (orders.start) prepare(std::move(*orders.start));
    if (!bake_.baker()) return;
    if (orders.reload) reloadShaders();
    if (orders.reset) reset();
    steer(orders);
    if (orders.seenTiles) applySeen();
    if (orders.batchMs) bake_.baker()->solver().setBatchMs(desc_.batchMs);
    inspectMore(orders);
}

// Follows a start. Light of the same scene stays until there is better, that of another one is of no use: so
// it is for an edit of a scene whose first preparation it ends, too.
void BakeLoop::prepare(BakeOrders::Start start) {
    if (unlit_) start.keepLight = false;
    unlit_ = !start.keepLight;
    waiting_.reset();
    const uint64_t moves = texelMoves();
    const Applied applied = bake_.edit(start);
    if (applied == Applied::Later) {
        waiting_ = std::move(start);
        return;
    }
    if (applied == Applied::Now) {
        unlit_ = false;
        return goOnEdited(start, moves);
    }
    const bool solverOnly = bake_.keepsPatches(start);
    bake_.takeUp(start, desc_.batchMs);
    status_.bake = start.number;
    status_.settings = bake_.settings();
    begin(bake_.goesOn());
    const Hearer hearer([this](const char* phase, double done) { onPhase(phase, done); });
    if (solverOnly) onPhase("solver set-up");
    endMaps();
    if (solverOnly)
        bake_.makeSolver();
    else
        bake_.make(*device_, start);
    const bool glance = bake_.isGlance();
    if (glance) showGlance();
    beginMaps(start.keepLight ? KeptLight::Whole : glance ? KeptLight::Glance : KeptLight::None);
    unlit_ = false;
    letGo();
    ready();
}

// Shows the first light of a bake that is not prepared to its end, and prepares the rest of it. onPhase()
// shows a map that has to wait for its slot.
void BakeLoop::showGlance() {
    beginMaps(KeptLight::None);
    try {
        const Clock::time_point begun = Clock::now();
        while (!allLit(bake_.layers()->layers()) && secondsSince(begun) < kGlanceSeconds) {
            onPhase("validity", 0.0);
            bake_.baker()->solver().step();
        }
        publishGlance();
        bake_.complete();
        endMaps();
        onPhase("solver set-up");
        bake_.makeSolver();
    } catch (...) {
        giveUp();
        throw;
    }
}

bool BakeLoop::publishGlance() {
    const bool published = maps_->publish(inspect_);
    if (published) wake();
    return published;
}

// Goes on with a bake that follows an edit. Maps begin again where texels have other patches now.
void BakeLoop::goOnEdited(const BakeOrders::Start& start, uint64_t movesBefore) {
    if (texelMoves() != movesBefore) {
        endMaps();
        beginMaps(KeptLight::Whole);
    }
    status_.bake = start.number;
    maps_->edited(start.number);
    if (status_.phase == Phase::Done) status_.phase = Phase::Baking;
    letGo();
}

uint64_t BakeLoop::texelMoves() const {
    return bake_.baker() ? bake_.baker()->moves().texels : 0;
}

// Tells that the scene of the start is read no more.
void BakeLoop::letGo() {
    const std::lock_guard lock(desk_.mutex);
    desk_.held = nullptr;
}

// Compiles all shaders before it gives up anything.
void BakeLoop::reloadShaders() {
    try {
        for (const std::string& name : shaderNames())
            shaderCode(name);
    } catch (const Error& error) {
        spdlog::error("{}", error.what());
        return;
    }
    begin();
    const Hearer hearer([this](const char* phase, double done) { onPhase(phase, done); });
    endMaps();
    bake_.makeAgain(*device_);
    beginMaps(KeptLight::Whole);
    ready();
}

// Begins again from no light, with the same patches.
void BakeLoop::reset() {
    begin();
    endMaps();
    bake_.makeSolver();
    beginMaps(KeptLight::Whole);
    ready();
}

void BakeLoop::beginMaps(KeptLight kept) {
    maps_->begin({.baker = *bake_.baker(),
                  .number = status_.bake,
                  .kept = kept,
                  .rings = bake_.rings(),
                  .settings = bake_.settings()});
}

// Begins a preparation, of a bake that begins anew or that goes on with what the one before has.
void BakeLoop::begin(bool goesOn) {
    status_.phase = Phase::Preparing;
    status_.doing.clear();
    status_.fraction = 0;
    if (!goesOn) {
        ++status_.beginnings;
        meter_.begin(status_);
    }
    report(true);
}

void BakeLoop::ready() {
    status_.phase = Phase::Baking;
    status_.doing.clear();
    status_.fraction = 1;
    status_.patches = bake_.baker()->patches().count;
    status_.layered = bake_.layers() != nullptr;
    status_.remark = bake_.remark();
    status_.tracer = bake_.baker()->tracerChoice();
    applySeen();
    report(true);
    // A driver compiles for seconds what the next start of the viewer then has, however this one ends.
    device_->keepPipelines();
}

// Follows the phases of a preparation, and ends it where something newer is wanted.
void BakeLoop::onPhase(const char* phase, double done) {
    {
        const std::lock_guard lock(desk_.mutex);
        if (desk_.orders.quit || desk_.orders.start) throw Cancelled();
    }
    if (bake_.isGlance() && maps_->owes()) publishGlance();
    const auto place = std::find(kPhases.begin(), kPhases.end(), phase);
    if (place == kPhases.end()) return; // a part of one of them
    const bool isNew = status_.doing != phase;
    status_.doing = phase;
    const double now = static_cast<double>(place - kPhases.begin()) + std::clamp(done, 0.0, 1.0);
    status_.fraction = std::max(status_.fraction, now / kPhases.size());
    report(isNew);
}

// Follows the commands to pause, to resume and so on.
void BakeLoop::steer(const BakeOrders& orders) {
    using Run = BakeOrders::Run;
    Solver& solver = bake_.baker()->solver();
    if (orders.abort) {
        solver.abortPass();
        spdlog::info("the pass under way was given up");
    }
    if (orders.run == Run::Keep) return;
    run_ = orders.run;
    if (solver.done()) return;
    status_.phase = run_ == Run::Pause ? Phase::Paused : Phase::Baking;
}

void BakeLoop::stepSolver() {
    using Run = BakeOrders::Run;
    Solver& solver = bake_.baker()->solver();
    solver.step();
    if (solver.done())
        status_.phase = Phase::Done;
    else if (run_ == Run::Step || (run_ == Run::Pass && solver.passBoundary()))
        status_.phase = Phase::Paused;
    if (status_.phase == Phase::Done) logEnd();
}

void BakeLoop::logEnd() {
    const SolverProgress& p = bake_.baker()->solver().progress();
    const uint32_t size = bake_.settings().size;
    spdlog::info("baked {} x {} in {:.2f} s, remaining error {:.2g}", size, size, p.seconds, p.error);
}

// Gives priority to what the camera sees.
void BakeLoop::applySeen() {
    if (!bake_.baker() || seenTiles_.empty()) return;
    bake_.baker()->solver().setPriority(seenChunks(bake_.baker()->patches().scene, seenTiles_));
}

// Answers with light paths and voxels, which maps cannot hold.
void BakeLoop::inspectMore(const BakeOrders& orders) {
    std::optional<InspectPaths> paths;
    std::optional<InspectVoxels> voxels;
    if (orders.inspect && inspect_.content == MapContent::Seen)
        paths = maps_->inspection().paths(inspect_.texel);
    if (orders.voxels) voxels = maps_->inspection().voxels(*orders.voxels);
    const std::lock_guard lock(desk_.mutex);
    if (paths) desk_.paths = std::move(paths);
    if (voxels) desk_.voxels = std::move(voxels);
}

// Writes what was asked for, once the bake follows the edits before it.
void BakeLoop::exportAll() {
    if (waiting_) return;
    if (!bake_.baker()) return refuseExports("there is no bake: begin one");
    for (const BakeOrders::Export& wanted : std::exchange(exports_, {}))
        exportLightmap(wanted, bake_, [this] { return maps_->lightNow(); });
    for (const BakeOrders::EngineExport& wanted : std::exchange(engineExports_, {}))
        exportForEngine(wanted, *device_, bake_, [this] { return maps_->lightNow(); });
}

void BakeLoop::refuseExports(const char* why) {
    for (const BakeOrders::Export& wanted : std::exchange(exports_, {}))
        spdlog::error("{}: not written, as {}", wanted.path, why);
    for (const BakeOrders::EngineExport& wanted : std::exchange(engineExports_, {}))
        spdlog::error("{}: not written, as {}", wanted.path(), why);
}

// Writes what was asked for before the end, as far as the bake is the one that it was asked of.
void BakeLoop::endExports(BakeOrders& last) {
    takeExports(last);
    const bool stands =
        status_.phase == Phase::Baking || status_.phase == Phase::Paused || status_.phase == Phase::Done;
    if (stands && !last.start) exportAll();
    refuseExports("the viewer was closed before it could be: wait for its light");
}

void BakeLoop::publish() {
    if (!maps_) return;
    const bool map = maps_->publish(inspect_);
    if (publishBalls() || map) wake();
    status_.display = maps_->choice();
}

// Tells the light at places that the viewer looks at, where it has changed. Returns whether it did.
bool BakeLoop::publishBalls() {
    if (!bake_.baker() || waiting_) return false;
    const std::function<std::vector<glm::vec4>()> light = [this] { return maps_->lightNow(); };
    std::optional<LitBalls> balls = balls_->next({.baker = *bake_.baker(),
                                                  .scene = bake_.level().scene,
                                                  .settings = bake_.settings(),
                                                  .version = maps_->lightVersion(),
                                                  .light = light});
    if (!balls) return false;
    const std::lock_guard lock(desk_.mutex);
    // An answer that nobody took yet may have been the traced one: this one takes its place.
    balls->traced = balls->traced || (desk_.balls && desk_.balls->traced);
    desk_.balls = std::move(balls);
    return true;
}

// Ends the maps of a bake, whose patches may go then.
void BakeLoop::endMaps() {
    maps_->end();
    balls_->forget();
}

// Gives up a bake that cannot go on; what is shown stays. An edit that waits keeps its scene, and exports
// wait for what it makes.
void BakeLoop::fail(const std::string& message) {
    spdlog::error("{}", message);
    status_.phase = Phase::Failed;
    status_.doing = message;
    giveUp();
    if (triesWaiting()) return;
    letGo();
    refuseExports("there is no bake: begin one");
}

void BakeLoop::giveUp() {
    if (maps_) endMaps();
    bake_.end();
}

void BakeLoop::report(bool always) {
    if (!always && secondsSince(reported_) < kReportSeconds) return;
    reported_ = Clock::now();
    const bool solves = status_.phase != Phase::Preparing && status_.phase != Phase::Failed;
    if (solves && bake_.baker()) meter_.update(status_, *bake_.baker(), bake_.settings(), *device_);
    {
        const std::lock_guard lock(desk_.mutex);
        desk_.status = status_;
    }
    wake();
}

void BakeLoop::wake() {
    std::function<void()> wake;
    {
        const std::lock_guard lock(desk_.mutex);
        wake = desk_.wake;
    }
    if (wake) wake();
}

} // namespace relume
