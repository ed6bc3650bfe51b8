#include "app/live/bake_loop.h"

#include "app/live/hearer.h"
#include "app/live/layer_remark.h"
#include "app/offline/bake_settings.h"
#include "app/offline/layer_file.h"
#include "app/offline/lightmap_attributes.h"
#include "app/offline/solve.h"
#include "assets/base/log.h"
#include "assets/images/image_file.h"
#include "assets/images/sky_picture.h"
#include "renderer/shader_types.h"
#include "shaders/shader_library.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <tuple>
#include <utility>

#include <sched.h>

namespace relume {
namespace {

// The status is reported so often while baking: no eye follows more.
constexpr double kReportSeconds = 0.05;
// Measuring is slower, because it asks the device about rays and the driver about memory.
constexpr double kMeasureSeconds = 0.25;
// A map waits so long for a slot before the exchange is asked again.
constexpr auto kSlotWait = std::chrono::milliseconds(5);
// The convergence curve keeps so many points; then every other one is dropped.
constexpr size_t kMaxHistory = 4096;

// This exception ends a preparation that nobody waits for any more.
struct Cancelled {};

// The phases stand in the order in which a baker tells them, for the progress bar.
constexpr std::array<std::string_view, 6> kPhases = {"cit",      "patches", "tracer",
                                                     "validity", "voxels",  "solver set-up"};

// Returns the settings that a baker is made of beside its solver. While they stay the same, only the solver
// is made anew.
auto preparation(const BakeSettings& s) {
    const TransportSettings& t = s.solver.transport;
    return std::tuple(s.size, s.conservative, s.tracer, s.voxels.resolution, s.voxels.ratio, t.rtrad,
                      t.reflectivity);
}

bool sameSurfaces(const std::vector<Material>& a, const std::vector<Material>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Material& x, const Material& y) {
        return x.baseColor == y.baseColor && x.emission == y.emission;
    });
}

// Tells whether the difference between the materials can be followed without making patches anew.
bool sameForPatches(const std::vector<Material>& a, const std::vector<Material>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Material& x, const Material& y) {
        const bool shines = x.emission != glm::vec3(0.0f), shone = y.emission != glm::vec3(0.0f);
        return x.baseColor.a == y.baseColor.a && (shines == shone || !x.doubleSided);
    });
}

// Tells whether a bake with these settings can have a layer for each light.
bool canHaveLayers(const SolverSettings& s) {
    return s.method == Method::Hybrid && !s.transport.rtrad && s.links.indirectScale == 1 &&
           !s.links.footprint && s.links.directions == DirectionSet::Sobol;
}

bool sameEdits(const SceneEdits& a, const SceneEdits& b) {
    return sameSurfaces(a.materials, b.materials) && a.lights == b.lights && a.sky == b.sky &&
           a.placements == b.placements;
}

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
        fail(error.what());
        report(true); // there may never be a command
    }
    BakeOrders orders;
    while (takeOrders(orders)) {
        try {
            obey(orders);
            if (waiting_ && (!layered() || layered()->atRest())) prepare(*std::exchange(waiting_, {}));
            if (status_.phase == Phase::Baking) stepSolver();
            publish();
        } catch (const Cancelled&) {
            continue; // the newer command is there
        } catch (const std::bad_alloc&) {
            fail("out of memory: use a smaller lightmap or close other programs");
        } catch (const std::exception& error) {
            fail(error.what());
        }
        report(status_.phase != Phase::Baking);
    }
    if (maps_) maps_->end();
    baker_.reset();
}

void BakeLoop::openDevice() {
    device_ = std::make_unique<vk::Device>(vk::Device::Desc{
        .select = desc_.device, .validation = desc_.validation, .chosen = [](const vk::DeviceInfo& info) {
            if (info.software()) yieldToOthers();
        }});
    const vk::DeviceInfo& info = device_->info();
    status_.device = fmt::format("{} ({})", info.name, info.driver);
    spdlog::info("device: {}", status_.device);
    maps_ = std::make_unique<MapPublisher>(*device_, desk_.exchange,
                                           MapPublisher::Desc{.display = desc_.display, .host = desc_.host});
    status_.display = maps_->choice();
    spdlog::info("display: {}", status_.display);
    report(true);
}

// Waits where there is nothing to do. Returns false when the thread is to quit.
bool BakeLoop::takeOrders(BakeOrders& orders) {
    std::unique_lock lock(desk_.mutex);
    const auto something = [&] {
        const BakeOrders& o = desk_.orders;
        return o.quit || o.start || o.reset || o.abort || o.reload || o.run != BakeOrders::Run::Keep ||
               o.batchMs || o.seenTiles || o.inspect || o.probes || o.voxels || !o.exports.empty();
    };
    if (status_.phase != Phase::Baking) {
        if (maps_ && maps_->owes())
            desk_.news.wait_for(lock, kSlotWait, something);
        else
            desk_.news.wait(lock, something);
    }
    orders = std::exchange(desk_.orders, {});
    if (orders.start) desk_.held = orders.start->scene;
    return !orders.quit;
}

void BakeLoop::obey(BakeOrders& orders) {
    if (!maps_) return; // the phase is Failed and stays so
    if (orders.batchMs) desc_.batchMs = *orders.batchMs;
    if (orders.seenTiles) seenTiles_ = std::move(*orders.seenTiles);
    if (orders.inspect) inspect_ = *orders.inspect;
    if (orders.probes) maps_->setProbes(std::move(*orders.probes));
    if (orders.start) prepare(*orders.start);
    if (!baker_) return;
    if (orders.reload) reloadShaders();
    if (orders.reset) {
        begin();
        restart(true);
        ready();
    }
    steer(orders);
    if (orders.seenTiles) applySeen();
    if (orders.batchMs) baker_->solver().setBatchMs(desc_.batchMs);
    inspectMore(orders);
    exportAll(orders);
}

LayerSolver* BakeLoop::layered() const {
    return baker_ ? dynamic_cast<LayerSolver*>(&baker_->solver()) : nullptr;
}

// Tells whether layers can follow the new start with what they have.
bool BakeLoop::onlyEdits(const BakeOrders::Start& start) const {
    BakeSettings wanted = start.settings;
    wanted.solver.layers = settings_.solver.layers;
    return layered() && start.scene == prepared_ && describeSettings(wanted) == describeSettings(settings_) &&
           wanted.tracer == settings_.tracer && wanted.solver.cache.kind == settings_.solver.cache.kind &&
           wanted.solver.cache.bytes == settings_.solver.cache.bytes && start.rings == rings_ &&
           start.edits.sky.file == scene_.sky.file &&
           sameForPatches(start.edits.materials, scene_.materials) &&
           layered()->holds(start.edits.lights.size());
}

// Edits the bake; the solver keeps what is still right. A bounce under way reads the colours of surfaces and
// the links, so these change between two bounces. Returns false where the objects cannot be followed, and the
// bake must begin anew.
bool BakeLoop::followEdit(const BakeOrders::Start& start) {
    const bool recoloured = !sameSurfaces(start.edits.materials, scene_.materials);
    const bool moved = editsOf(scene_).placements != start.edits.placements;
    if ((recoloured || moved) && !layered()->atRest()) {
        waiting_ = start;
        return true;
    }
    applyEdits(scene_, start.edits);
    if (recoloured) baker_->updateMaterials();
    if (moved && !followObjects(start)) return false;
    layered()->edit(start.mix);
    status_.bake = start.number;
    maps_->edited(start.number);
    if (status_.phase == Phase::Done) status_.phase = Phase::Baking;
    const std::lock_guard lock(desk_.mutex);
    desk_.held = nullptr;
    return true;
}

bool BakeLoop::followObjects(const BakeOrders::Start& start) {
    const std::optional<ObjectMove> move = baker_->moveObjects(start.scene->atlas);
    if (!move) {
        prepared_ = nullptr; // scene_ and patches have gone apart
        return false;
    }
    layered()->moveObjects(*move);
    if (!move->texels) return true;
    maps_->end();
    beginMaps(true);
    return true;
}

// Follows a start. Light of the same scene stays until there is better, that of another one is of no use.
void BakeLoop::prepare(const BakeOrders::Start& start) {
    waiting_.reset();
    if (onlyEdits(start) && followEdit(start)) return;
    const bool sameScene = baker_ && start.scene == prepared_ && sameEdits(start.edits, editsOf(scene_));
    const bool solverOnly = sameScene && preparation(start.settings) == preparation(settings_);
    settings_ = start.settings;
    settings_.solver.batchMs = desc_.batchMs;
    settings_.solver.live = true;
    settings_.solver.layers.on = start.settings.solver.layers.on && canHaveLayers(settings_.solver);
    settings_.solver.layers.optional = true;
    wantsLayers_ = start.settings.solver.layers.on;
    rings_ = start.rings;
    status_.bake = start.number;
    status_.settings = settings_;
    begin();
    const Hearer hearer([this](const char* phase, double done) { onPhase(phase, done); });
    if (solverOnly) {
        onPhase("solver set-up");
        restart(start.keepLight);
    } else {
        maps_->end();
        baker_.reset(); // before the new one takes its memory
        scene_ = start.scene->scene;
        applyEdits(scene_, start.edits);
        readEditedPicture(scene_.sky);
        const bool moved = editsOf(start.scene->scene).placements != start.edits.placements;
        WorldMesh mesh = moved ? flatten(scene_, start.scene->atlas) : start.scene->mesh;
        prepared_ = start.scene;
        makeBaker(std::move(mesh), start.keepLight);
    }
    if (layered()) layered()->edit(start.mix);
    {
        const std::lock_guard lock(desk_.mutex);
        desk_.held = nullptr;
    }
    ready();
}

void BakeLoop::makeBaker(WorldMesh mesh, bool keepLight) {
    baker_ = std::make_unique<Baker>(*device_, scene_, std::move(mesh), settings_);
    spdlog::info("{} patches", baker_->patches().count);
    warnIfDark(scene_, baker_->patches());
    beginMaps(keepLight);
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
    WorldMesh mesh = baker_->patches().scene.mesh;
    maps_->end();
    baker_.reset();
    makeBaker(std::move(mesh), true);
    ready();
}

// Begins again from no light, with the same patches.
void BakeLoop::restart(bool keepLight) {
    maps_->end();
    baker_->resetSolver(settings_.solver);
    beginMaps(keepLight);
}

void BakeLoop::beginMaps(bool keepLight) {
    maps_->begin({.baker = *baker_,
                  .number = status_.bake,
                  .keepLight = keepLight,
                  .rings = rings_,
                  .settings = settings_});
}

void BakeLoop::begin() {
    status_.phase = Phase::Preparing;
    status_.doing.clear();
    status_.fraction = 0;
    status_.progress = {};
    ++status_.beginnings;
    status_.rays = 0;
    status_.history.clear();
    status_.raysPerSecond = 0;
    status_.secondsLeft = -1;
    meter_.clear();
    report(true);
}

void BakeLoop::ready() {
    status_.phase = Phase::Baking;
    status_.doing.clear();
    status_.fraction = 1;
    status_.patches = baker_->patches().count;
    status_.layered = layered() != nullptr;
    status_.remark = status_.layered ? "" : layerRemark(wantsLayers_, settings_.solver, *baker_, scene_);
    status_.tracer = baker_->tracerChoice();
    applySeen();
    report(true);
}

// Follows the phases of a preparation, and ends it where something newer is wanted.
void BakeLoop::onPhase(const char* phase, double done) {
    {
        const std::lock_guard lock(desk_.mutex);
        if (desk_.orders.quit || desk_.orders.start) throw Cancelled();
    }
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
    Solver& solver = baker_->solver();
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
    Solver& solver = baker_->solver();
    solver.step();
    if (solver.done())
        status_.phase = Phase::Done;
    else if (run_ == Run::Step || (run_ == Run::Pass && solver.passBoundary()))
        status_.phase = Phase::Paused;
    if (status_.phase == Phase::Done) logEnd();
}

void BakeLoop::logEnd() {
    const SolverProgress& p = baker_->solver().progress();
    spdlog::info("baked {} x {} in {:.2f} s, remaining error {:.2g}", settings_.size, settings_.size,
                 p.seconds, p.error);
}

// Turns the seen tiles of texels into chunks of patches, and gives these priority.
void BakeLoop::applySeen() {
    if (!baker_ || seenTiles_.empty()) return;
    const TraceScene& scene = baker_->patches().scene;
    const uint32_t tiles = (scene.size + shader::kTileTexels - 1) / shader::kTileTexels;
    std::vector<uint8_t> seen(scene.chunkCount(), 0);
    for (const uint32_t tile : seenTiles_) {
        const uint32_t left = tile % tiles * shader::kTileTexels, top = tile / tiles * shader::kTileTexels;
        for (uint32_t y = top; y < std::min(top + shader::kTileTexels, scene.size); ++y) {
            for (uint32_t x = left; x < std::min(left + shader::kTileTexels, scene.size); ++x) {
                const uint32_t patch = scene.texelToPatch[size_t{y} * scene.size + x];
                if (patch != shader::kNoPatch) seen[patch / shader::kChunk] = 1;
            }
        }
    }
    baker_->solver().setPriority(std::move(seen));
}

// Answers with light paths and voxels, which maps cannot hold.
void BakeLoop::inspectMore(const BakeOrders& orders) {
    std::optional<InspectPaths> paths;
    std::optional<InspectVoxels> voxels;
    if (orders.inspect && inspect_.content == MapContent::Seen) paths = maps_->paths(inspect_.texel);
    if (orders.voxels) voxels = maps_->voxels(*orders.voxels);
    const std::lock_guard lock(desk_.mutex);
    if (paths) desk_.paths = std::move(paths);
    if (voxels) desk_.voxels = std::move(voxels);
}

void BakeLoop::exportAll(const BakeOrders& orders) {
    for (const BakeOrders::Export& wanted : orders.exports) {
        try {
            LightmapDesc desc = wanted.lightmap;
            desc.rtrad = settings_.solver.transport.rtrad;
            desc.reflectivity = settings_.solver.transport.reflectivity;
            if (desc.rtrad) desc.quantity = Quantity::Radiance;
            // At the end the file has the bytes of a bake without a window; before, it has what is on screen.
            const bool done = baker_->solver().done();
            FloatImage image =
                done ? baker_->lightmap(desc) : makeLightmap(baker_->patches(), maps_->lightNow(), desc);
            addLightmapAttributes(image, wanted.scene, settings_, wanted.lightmap,
                                  baker_->solver().progress());
            const std::string stale = layered() ? staleLayers(*layered()) : "";
            if (!stale.empty()) image.attributes[layer_attribute::kStale] = stale;
            writeImage(wanted.path, image);
            spdlog::info("wrote {}", wanted.path);
        } catch (const Error& error) {
            spdlog::error("{}", error.what());
        }
    }
}

void BakeLoop::publish() {
    if (!maps_) return;
    if (maps_->publish(inspect_)) wake();
    status_.display = maps_->choice();
}

// Gives up a bake that cannot go on; what is shown stays.
void BakeLoop::fail(const std::string& message) {
    spdlog::error("{}", message);
    status_.phase = Phase::Failed;
    status_.doing = message;
    if (maps_) maps_->end();
    baker_.reset();
    prepared_ = nullptr;
    const std::lock_guard lock(desk_.mutex);
    desk_.held = nullptr;
}

void BakeLoop::measure() {
    if (secondsSince(measured_) < kMeasureSeconds || !baker_) return;
    measured_ = Clock::now();
    Solver& solver = baker_->solver();
    status_.rays = solver.raysSoFar();
    meter_.add(solver.progress().seconds, status_.rays);
    status_.raysPerSecond = meter_.perSecond();
    status_.deviceBytes =
        device_->info().deviceMemory - std::min(device_->freeMemory(), device_->info().deviceMemory);
    status_.validationMessages = device_->validationMessages();
}

void BakeLoop::follow() {
    if (!baker_) return;
    if (status_.phase != Phase::Baking)
        status_.rays = baker_->solver().raysSoFar(); // because nothing more will be measured
    const SolverProgress& now = baker_->solver().progress();
    status_.progress = now;
    status_.rays = std::max(status_.rays, now.rays);
    status_.stale = layered() ? staleReasons(*layered()) : std::vector<std::string>();
    status_.groups = layered() ? groupsOf(*layered()) : std::vector<LightGroup>();
    std::vector<ConvergencePoint>& history = status_.history;
    if (now.error < 1 && (history.empty() || history.back().error != now.error)) {
        history.push_back({now.seconds, now.error});
        if (history.size() > kMaxHistory) {
            for (size_t i = 0; 2 * i < history.size(); ++i)
                history[i] = history[2 * i];
            history.resize((history.size() + 1) / 2);
        }
    }
    status_.secondsLeft =
        status_.phase == Phase::Baking ? secondsUntil(history, settings_.solver.error) : -1.0;
}

void BakeLoop::report(bool always) {
    if (!always && secondsSince(reported_) < kReportSeconds) return;
    reported_ = Clock::now();
    if (status_.phase != Phase::Preparing && status_.phase != Phase::Failed) {
        follow();
        measure();
    }
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
