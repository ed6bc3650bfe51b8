#include "app/viewer/shell/viewer.h"

#include "app/viewer/state/views.h"
#include "assets/base/error.h"
#include "renderer/gl/debug.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace relume {
namespace {

using Phase = BakeStatus::Phase;

// Without anything to draw, the viewer looks at what runs beside it after so long [s].
constexpr double kIdle = 1.0, kIdleBaking = 0.1, kIdleLoading = 0.03, kIdleWatching = 0.25, kIdleFence = 0.01;
constexpr double kRestsAfter = 0.25;  // [s] without a move until the camera counts as still
constexpr double kMovingShare = 0.25; // of the budget: what a batch has while the camera moves
constexpr double kLeastBatchMs = 1;
constexpr uint64_t kNoMapVersion = ~uint64_t{0}; // of the lightmap before there is one: always the same
// Frames are drawn hardly faster than the monitor shows them: just so much that vsync decides, where it
// works.
constexpr double kLimiterSlack = 1.05;

constexpr double kTilesEvery = 0.2; // [s] while the camera moves

const char* contentName(MapContent content) {
    for (const ViewEntry& entry : viewEntries())
        if (entry.readsMap && entry.content == content && content != MapContent::Light) return entry.name;
    return "light";
}

Window::Desc windowDesc(const ViewerDesc& desc, const Preferences& preferences) {
    return {.width = desc.width > 0 ? desc.width : preferences.width,
            .height = desc.height > 0 ? desc.height : preferences.height,
            .title = "Relume",
            .debug = desc.validation};
}

void clearWindow(Window& window) {
    const DrawSettings settings;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glClearColor(settings.background.r, settings.background.g, settings.background.b, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT);
    window.swap();
}

bool sameFactors(const std::vector<Material>& a, const std::vector<Material>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Material& x, const Material& y) {
        return x.baseColor == y.baseColor && x.emission == y.emission;
    });
}

} // namespace

Viewer::Viewer(const ViewerDesc& desc)
    : desc_(desc), start_(Clock::now()), preferencesPath_(preferencesPath()),
      preferences_(preferencesPath_.empty() ? Preferences{} : readPreferences(preferencesPath_)),
      window_(windowDesc(desc, preferences_)), gui_(window_), software_(gl::isSoftware()), pane_(software_),
      items_(desc.logActions) {
    clearWindow(window_); // there at once, whatever takes its time below
    spdlog::info("window: {}", gl::describeContext());
    view_.filter = preferences_.filter;
    view_.tone = preferences_.tone;
    // Four samples per pixel would cost a CPU most of a frame.
    constexpr uint32_t kSamples = 4;
    view_.samples = preferences_.samples.value_or(software_ ? 0 : kSamples);
    vsync_ = preferences_.vsync;
    window_.setVsync(vsync_);
    startBake();
    if (!desc_.scene.empty()) open(desc_.scene);
    session_->watchFile(desc_.watch);
}

void Viewer::startBake() {
    const gl::GlSharing sharing = gl::querySharing();
    bake_ = std::make_unique<LiveBake>(
        LiveBake::Desc{.device = desc_.device,
                       .validation = desc_.validation,
                       .display = desc_.display,
                       .host = {.memoryObjects = sharing.memoryObject, .deviceUuids = sharing.deviceUuids},
                       .batchMs = desc_.budgetMs});
    batchMs_ = desc_.budgetMs;
    bake_->setWake([] { Window::wake(); });
    session_ = std::make_unique<Session>(*bake_, desc_.request);
    bridge_ = std::make_unique<LightmapBridge>(bake_->exchange());
}

Viewer::~Viewer() {
    bake_->setWake({});
    bake_->stop(); // before what it reads and writes goes
    const glm::uvec2 extent = window_.extent();
    if (extent.x > 0 && extent.y > 0 && desc_.width == 0) {
        preferences_.width = extent.x;
        preferences_.height = extent.y;
    }
    savePreferences();
}

void Viewer::savePreferences() {
    preferences_.filter = view_.filter;
    preferences_.tone = view_.tone;
    try {
        if (!preferencesPath_.empty()) writePreferences(preferencesPath_, preferences_);
    } catch (const Error& error) {
        spdlog::warn("{}", error.what());
    }
}

double Viewer::now() const {
    return secondsSince(start_);
}

float Viewer::pixelsPerPoint() const {
    const glm::uvec2 extent = window_.extent();
    return extent.x > 0 ? static_cast<float>(window_.size().x) / static_cast<float>(extent.x) : 1.0f;
}

double Viewer::idleSeconds(double time) const {
    double idle = kIdle;
    if (status_.phase == Phase::Baking || status_.phase == Phase::Preparing) idle = kIdleBaking;
    if (session_->watchesFile()) idle = std::min(idle, kIdleWatching);
    if (session_->loading()) idle = std::min(idle, kIdleLoading);
    if (!skies_.reading().empty()) idle = std::min(idle, kIdleLoading);
    const bool previews =
        previewsDue_ || pane_.surfacesPending() || (previews_.wanted && bake_->exchange().hasProbe());
    if (bridge_->waiting() || pane_.tilesPending() || previews) idle = std::min(idle, kIdleFence);
    if (time - moved_ < kRestsAfter) idle = std::min(idle, kRestsAfter); // then the bake gets its budget back
    const double message = ui_.messages().nextExpiry(time + idle);
    return std::clamp(message - time, 0.0, idle);
}

void Viewer::run() {
    while (!closes()) {
        const double limit = 1.0 / (kLimiterSlack * window_.refreshRate());
        const double before = now();
        const double idle = idleSeconds(before);
        const double wait =
            window_.minimised() ? idle : std::max(pacer_.wait(before, idle), frameStart_ + limit - before);
        handle(window_.wait(std::max(wait, 0.0)));
        const double time = now();
        follow(time);
        const Redraw redraw = pacer_.due(time);
        tellSettled();
        if (!redraw.any || time < frameStart_ + limit || window_.minimised()) continue;
        frameStart_ = time;
        frame(redraw);
    }
    tell("window", "closed");
}

void Viewer::follow(double time) {
    followScene();
    followBake(time);
    followCamera(time);
    followPreviews(time);
    followLog();
    const bool messages = !ui_.messages().shown().empty();
    ui_.messages().expire(time);
    if (messages && ui_.messages().shown().empty()) pacer_.input();
    if (vsync_ != preferences_.vsync) {
        vsync_ = preferences_.vsync;
        window_.setVsync(vsync_);
    }
    if (sceneDirty_) pacer_.sceneChanged();
    if (window_.minimised() != told_.minimised) {
        told_.minimised = window_.minimised();
        tell("window", told_.minimised ? "minimised" : "shown");
    }
    if (window_.size() != told_.size && !window_.minimised()) {
        told_.size = window_.size();
        tell("window", fmt::format("{} x {}", told_.size.x, told_.size.y));
    }
}

void Viewer::followScene() {
    if (session_->update()) {
        const LoadedScene& scene = *session_->scene();
        pane_.setScene(&scene);
        materials_ = scene.prepared.scene.materials;
        view_.selected = -1;
        view_.seenTexel.reset();
        view_.light.reset();
        drag_.reset();
        previews_.clear();
        previewed_.reset();
        badSky_.clear();
        newestEdit_.clear();
        editedAt_ = now();
        ownReference_ = false;
        if (!session_->sceneWasKept()) {
            ViewCamera camera = scene.view;
            const std::vector<Camera>& cameras = scene.prepared.scene.cameras;
            const auto named = std::find_if(cameras.begin(), cameras.end(), [&](const Camera& candidate) {
                return candidate.name == desc_.camera;
            });
            if (named != cameras.end())
                camera = cameraOfFile(*named, scene.geometry.bounds);
            else if (!desc_.camera.empty())
                note(scene.prepared.scene.path + ": has no camera '" + desc_.camera + "'", true);
            camera_.set(camera, scene.geometry.bounds);
            camera_.setHome(camera);
            preferences_.addRecent(scene.prepared.scene.path);
        }
        path_ = scenePath();
        askedBake_ = 0;
        tell("scene", scene.prepared.scene.path);
        changeScene();
    }
    if (!session_->lastError().empty()) {
        ui_.messages().add(session_->lastError(), true, now()); // the log has told it, too
        session_->clearError();
    }
    followLights();
    followSky();
    followFile();
}

void Viewer::showMaterials(std::vector<Material> materials) {
    if (sameFactors(materials_, materials)) return;
    materials_ = std::move(materials);
    pane_.setMaterials(materials_);
    changeScene();
}

void Viewer::followBake(double time) {
    BakeStatus status = bake_->status();
    // An edit may be answered between two looks: then the bake was done before, and is done again.
    if (status.phase != status_.phase || (status.bake != status_.bake && status.phase == Phase::Done)) {
        pacer_.input();
        tell("bake", phaseName(status.phase));
    }
    if (status.phase == Phase::Baking || status.phase == Phase::Preparing || session_->loading() ||
        status.doing != status_.doing)
        pacer_.statusChanged();
    status_ = std::move(status);
    if (bridge_->update()) followMap();
    followBadge(time);
    inspect();
    followInspected();
    if (!pane_.adapting())
        settling_ = false;
    else if (settling_)
        pacer_.sceneChanged(); // the user waits for it
    else
        pacer_.newMap();
    const bool moves = time - moved_ < kRestsAfter;
    const double wanted = moves ? std::max(kMovingShare * desc_.budgetMs, kLeastBatchMs) : desc_.budgetMs;
    if (wanted == batchMs_) return;
    batchMs_ = wanted;
    bake_->setBatchMs(wanted);
}

void Viewer::followMap() {
    mapVersion_ = newVersion();
    if (view_.uv || viewEntries()[view_.view].readsMap) pacer_.newMap();
    const PublishedMap& map = *bridge_->map();
    const std::string told =
        std::string(contentName(map.content)) + (map.complete ? " complete" : " partial");
    if (told != told_.map) tell("map", told);
    told_.map = told;
}

// Tells whoever listens that what was asked for is on the screen: nothing is left to be drawn, and the map is
// the one that the view shows. The number of inputs says which of them have been taken.
void Viewer::tellSettled() {
    const PublishedMap* shown = bridge_->map();
    const bool asked =
        shown == nullptr || (shown->content == inspected_.content && shown->light == inspected_.light);
    const bool settled =
        asked && pacer_.settled() && !pane_.adapting() && !bridge_->waiting() && !session_->loading();
    if (settled && !told_.settled) tell("settled", std::to_string(told_.inputs));
    told_.settled = settled;
}

// Follows what is seen beside maps: links of a patch, voxels, and the tiles that the camera sees.
void Viewer::followInspected() {
    if (const std::optional<InspectPaths> paths = bake_->takePaths()) {
        pane_.setPaths(*paths);
        changeScene();
    }
    if (const std::optional<InspectVoxels> voxels = bake_->takeVoxels()) {
        pane_.setVoxels(*voxels);
        changeScene();
    }
    const bool bakes =
        status_.phase == Phase::Baking || status_.phase == Phase::Paused || status_.phase == Phase::Done;
    if (!bakes || session_->scene() == nullptr) return;
    const bool another = askedBake_ != status_.bake;
    if (viewEntries()[view_.view].voxels && (another || askedVoxels_ != view_.voxels)) {
        askedVoxels_ = view_.voxels;
        bake_->askVoxels(askedVoxels_);
    }
    if (std::optional<std::vector<uint32_t>> tiles = pane_.seenTiles())
        bake_->setSeenTiles(std::move(*tiles));
    const double time = now();
    const bool moved = moved_ > tilesAsked_;
    if (another || (moved && (time - moved_ > kRestsAfter || time - tilesAsked_ > kTilesEvery))) {
        tilesAsked_ = time;
        pane_.askTiles(look());
    }
    askedBake_ = status_.bake;
}

void Viewer::inspect() {
    const ViewEntry& entry = viewEntries()[view_.view];
    InspectRequest request;
    if (entry.readsMap) request.content = entry.content;
    if (hasMips(request.content)) request.mip = view_.mip;
    if (request.content == MapContent::Layer) {
        const LightSource* source = view_.light ? lights_.find(*view_.light) : nullptr;
        if (source == nullptr) return;
        if (const LightGroup* group = groupWith(status_.groups, source->key)) source = &group->source;
        request.light = source->key;
        request.weight = source->weight;
    }
    if (request.content == MapContent::Leaves) request.preview = view_.preview;
    if (request.content == MapContent::Seen) {
        if (!view_.seenTexel) return; // nothing was chosen yet
        request.texel = *view_.seenTexel;
    }
    if (request == inspected_) return;
    inspected_ = request;
    bake_->inspect(request);
}

void Viewer::followCamera(double time) {
    updateFlight();
    if (camera_.fly(time - flown_)) cameraMoved();
    flown_ = time;
    pacer_.animate(camera_.flying());
}

// Shows as well what is logged as an error: it went wrong beside the main thread.
void Viewer::followLog() {
    const uint64_t count = log_.count();
    if (count == logSeen_) return;
    const std::vector<LogLine> lines = log_.linesSince(logSeen_);
    logSeen_ = count;
    for (const LogLine& line : lines)
        if (line.level >= spdlog::level::err) ui_.messages().add(line.text, true, now());
    pacer_.input();
}

PanelContext Viewer::context() {
    return {.session = *session_,
            .status = status_,
            .view = view_,
            .camera = camera_,
            .preferences = preferences_,
            .figures = figures_,
            .log = log_,
            .lights = lights_,
            .previews = previews_,
            .map = map(),
            .exposure = pane_.exposure(),
            .budgetMs = desc_.budgetMs,
            .recording = capture_.recording(),
            .perform = [this](Action action, int argument) { perform(action, argument); },
            .sceneChanged = [this] { changeScene(); },
            .edit = [this](const std::string& name, const Document& next) { edit(name, next); },
            .endEdit = [this] { endEdit(); },
            .open = [this](const std::string& path) { open(path); },
            .selectLight = [this](const LightKey& key) { selectLight(key); },
            .items = items_};
}

const PublishedMap* Viewer::map() const {
    const PublishedMap* newest = bridge_->map();
    return newest != nullptr && newest->bake >= session_->firstBake() ? newest : nullptr;
}

LightmapTexture Viewer::lightmap() const {
    LightmapTexture texture{.size = session_->document().bake.size};
    if (map() == nullptr) {
        texture.version = kNoMapVersion;
        return texture;
    }
    texture = bridge_->texture();
    texture.version = mapVersion_;
    return texture;
}

ScenePane::Look Viewer::look() const {
    return {.camera = camera_.camera(), .state = view_, .lightmap = lightmap(), .map = map()};
}

// Draws the picture of the scene, a new one or the last one, behind the panels.
void Viewer::drawScene(bool anew) {
    const float pixels = pixelsPerPoint();
    const glm::uvec2 window = window_.size();
    const auto toPixels = [&](float points) { return static_cast<uint32_t>(std::lround(points * pixels)); };
    const glm::uvec2 corner(toPixels(area_.corner.x),
                            window.y - std::min(window.y, toPixels(area_.corner.y + area_.size.y)));
    const glm::uvec2 size =
        glm::max(glm::uvec2(toPixels(area_.size.x), toPixels(area_.size.y)), glm::uvec2(1));
    const bool resized = pane_.picture().width() != size.x || pane_.picture().height() != size.y;
    if (anew || resized) {
        pane_.draw(look(), size);
        ++figures_.drawn;
        sceneDirty_ = false;
        recordDue_ = true;
    } else {
        ++figures_.repeated;
    }
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glViewport(0, 0, static_cast<GLsizei>(window.x), static_cast<GLsizei>(window.y));
    glDisable(GL_SCISSOR_TEST);
    glClearColor(0, 0, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
    pane_.show(corner);
}

void Viewer::frame(const Redraw& redraw) {
    const double begin = now();
    if (!gui_.animates()) scale_ = window_.contentScale() / pixelsPerPoint() * preferences_.uiScale;
    gui_.begin(scale_);
    previews_.wanted = false; // the panel says
    area_ = ui_.draw(context(), hidden_, scale_);
    drawOverlay();
    drawProgress();
    const double drawnUi = now();
    const bool anew = redraw.scene || sceneDirty_;
    drawScene(anew);
    const double drawnScene = now();
    gui_.end();
    captureFrame(begin);
    const double beforeSwap = now();
    window_.swap();
    const double end = now();
    figures_.span("panels").cpu = 1e3 * (drawnUi - begin);
    figures_.span("scene").cpu = 1e3 * (drawnScene - drawnUi);
    figures_.span("swap").cpu = 1e3 * (end - beforeSwap);
    figures_.addFrame(1e3 * (end - begin));
    for (const gl::Timer::Pass& pass : pane_.endFrame()) {
        FrameFigures::Span& span = figures_.span("drawing: " + pass.name);
        span.cpu = pass.cpuMs;
        span.gpu = pass.gpuMs;
    }
    figures_.drawCalls = pane_.counts().drawn;
    figures_.culled = pane_.counts().culled;
    // A GPU's swap waits for the monitor, while the CPU's draws.
    pacer_.drawn({anew, true}, end, software_ ? end - begin : beforeSwap - begin);
}

} // namespace relume
