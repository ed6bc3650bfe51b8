#include "app/viewer/shell/viewer.h"

#include "app/offline/progress.h"
#include "app/viewer/picture/picture_labels.h"
#include "app/viewer/state/views.h"
#include "renderer/gl/debug.h"

#include <algorithm>

#include <fmt/format.h>

namespace relume {
namespace {

// Without anything to draw, the viewer looks at what runs beside it after so long [s].
constexpr double kIdle = 1.0, kIdleBaking = 0.1, kIdleLoading = 0.03, kIdleFence = 0.01;
// Frames are drawn hardly faster than the monitor shows them: just so much that vsync decides, where it
// works.
constexpr double kLimiterSlack = 1.05;

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

} // namespace

Viewer::Viewer(const ViewerDesc& desc)
    : desc_(desc), feedback_(desc.logActions), preferences_(preferencesPath()),
      window_(windowDesc(desc, preferences_.values())), gui_(window_), session_(startBake(), desc.request),
      picture_(session_, bake_->exchange(), feedback_, gl::isSoftware()),
      baking_(session_, *bake_, feedback_, desc.budgetMs),
      lights_(session_, baking_.status(), picture_, feedback_), comparison_(picture_, feedback_),
      editing_(session_, comparison_, progress_, feedback_), inspection_(*bake_, picture_),
      previews_(session_, *bake_, picture_),
      shots_(picture_, preferences_.values(), feedback_,
             {.caption = [this] { return captionLines(); },
              .path = [this] { return files_.path(); },
              .motion = [this](double rate) { return cameraMotion(rate); }}),
      ui_(desc.logActions), lightKeys_(session_, picture_, lights_, editing_, feedback_),
      skyKeys_(session_, picture_, lights_, editing_, feedback_),
      mover_(session_, picture_, lights_, editing_, feedback_),
      files_({.session = session_,
              .editing = editing_,
              .window = window_,
              .dialog = ui_.files(),
              .question = ui_.question(),
              .preferences = preferences_,
              .feedback = feedback_,
              .exposure = [this] { return picture_.pane().exposure(); }}),
      screenLog_(feedback_) {
    ViewState& view = picture_.state();
    view.filter = preferences_.values().filter;
    view.tone = preferences_.values().tone;
    // Four samples per pixel would cost a CPU most of a frame.
    constexpr uint32_t kSamples = 4;
    view.samples = preferences_.values().samples.value_or(picture_.pane().software() ? 0 : kSamples);
    if (!desc_.scene.empty()) files_.open(desc_.scene);
    session_.watchFile(desc_.watch);
}

// Shows an empty window at once, whatever takes its time afterwards, and starts the thread that bakes.
LiveBake& Viewer::startBake() {
    clearWindow(window_);
    spdlog::info("window: {}", gl::describeContext());
    window_.setVsync(preferences_.values().vsync);
    const gl::GlSharing sharing = gl::querySharing();
    bake_ = std::make_unique<LiveBake>(
        LiveBake::Desc{.device = desc_.device,
                       .deviceMemory = desc_.deviceMemory,
                       .validation = desc_.validation,
                       .display = desc_.display,
                       .host = {.memoryObjects = sharing.memoryObject, .deviceUuids = sharing.deviceUuids},
                       .batchMs = desc_.budgetMs});
    bake_->setWake([] { Window::wake(); });
    return *bake_;
}

Viewer::~Viewer() {
    bake_->setWake({});
    bake_->stop(); // before what it reads and writes goes
    const glm::uvec2 pixels = window_.size();
    if (pixels.x > 0 && pixels.y > 0 && desc_.width == 0) {
        const glm::uvec2 kept = rememberedWindow(pixels, window_.contentScale());
        preferences_.values().width = kept.x;
        preferences_.values().height = kept.y;
    }
    savePreferences();
}

void Viewer::savePreferences() {
    preferences_.values().filter = picture_.state().filter;
    preferences_.values().tone = picture_.state().tone;
    preferences_.save();
}

float Viewer::pixelsPerPoint() const {
    const glm::uvec2 extent = window_.extent();
    return extent.x > 0 ? static_cast<float>(window_.size().x) / static_cast<float>(extent.x) : 1.0f;
}

double Viewer::idleSeconds(double time) const {
    double idle = baking_.busy() ? kIdleBaking : kIdle;
    if (session_.watchesFile()) idle = std::min(idle, FileWatch::kPeriod);
    if (session_.loading() || skyKeys_.reading() || ui_.start().looking())
        idle = std::min(idle, kIdleLoading);
    if (picture_.waitsForMaps() || picture_.pane().tilesPending() || previews_.underWay())
        idle = std::min(idle, kIdleFence);
    // Once the camera rests, the bake gets its budget back.
    if (!picture_.rests(time)) idle = std::min(idle, SceneView::kRestsAfter);
    const double message = feedback_.messages().nextExpiry(time + idle);
    return std::clamp(message - time, 0.0, idle);
}

void Viewer::run() {
    double begun = 0; // when the last frame began
    while (!files_.ends()) {
        const double limit = 1.0 / (kLimiterSlack * window_.refreshRate());
        const double before = feedback_.now();
        const double idle = idleSeconds(before);
        const double wait = window_.minimised()
                                ? idle
                                : std::max(feedback_.pacer().wait(before, idle), begun + limit - before);
        handle(window_.wait(std::max(wait, 0.0)));
        const double time = feedback_.now();
        follow(time);
        const Redraw redraw = feedback_.pacer().due(time);
        screenLog_.tellSettled(settled());
        if (!redraw.any || time < begun + limit || window_.minimised()) continue;
        begun = time;
        frame(redraw);
    }
    feedback_.tell("window", "closed");
}

void Viewer::follow(double time) {
    followScene();
    followBake(time);
    if (ui_.question().isOpen()) input_.releaseKeys(); // their releases go to the question
    picture_.fly(input_.flight(), time);
    if (previews_.follow(lights_.list().sources(), baking_.status().groups, mover_.held(), time)) {
        feedback_.tell("preview", "drawn");
        feedback_.pacer().smallPictureChanged();
    }
    followMiddle();
    const std::optional<OpenFailure>& failure = files_.opening().failure();
    const std::optional<PictureNotice> said = notice();
    feedback_.followLog(log_, failure ? failure->message : said ? said->text : "");
    feedback_.expireMessages(time);
    window_.setVsync(preferences_.values().vsync);
    if (feedback_.sceneIsChanged()) feedback_.pacer().sceneChanged();
    screenLog_.tellWindow(window_.size(), window_.minimised());
}

void Viewer::followScene() {
    if (session_.update()) takeScene();
    const auto view = [this](const LoadedScene& scene) { return firstCamera(scene); };
    if (picture_.followEarly(view)) {
        if (session_.early() != nullptr) feedback_.tell("geometry", session_.early()->prepared.scene.path);
        feedback_.sceneChanged();
    }
    if (!session_.lastError().empty()) {
        feedback_.showError(session_.lastError()); // the log has told it, too
        session_.clearError();
    }
    lights_.follow();
    skyKeys_.follow();
    files_.follow();
}

void Viewer::takeScene() {
    const LoadedScene& scene = *session_.scene();
    const std::string undrawn = picture_.setScene(scene);
    picture_.state().selected = -1;
    picture_.state().seenTexel.reset();
    lights_.sceneCame();
    mover_.sceneCame();
    previews_.sceneCame();
    skyKeys_.sceneCame(session_.sceneWasKept());
    progress_.sceneCame(feedback_.now());
    comparison_.sceneCame();
    if (!session_.sceneWasKept()) {
        shots_.sceneCame();
        const ViewCamera camera = firstCamera(scene);
        if (!picture_.wasEarly(scene)) picture_.camera().set(camera, scene.geometry.bounds);
        picture_.camera().setHome(camera);
    }
    files_.sceneCame();
    if (!undrawn.empty()) files_.opening().fail({scene.prepared.scene.path, undrawn, true});
    inspection_.sceneCame(session_.sceneWasKept());
    feedback_.tell("scene", scene.prepared.scene.path);
    for (const std::string& note : session_.takeReloadNotes())
        feedback_.note(note);
    if (const std::string furnished = furnishedLine(); !furnished.empty())
        feedback_.tell("furnished", furnished);
    feedback_.sceneChanged();
}

// Returns the camera that a scene is seen by at first: the one that was asked for, else its own.
ViewCamera Viewer::firstCamera(const LoadedScene& scene) {
    const std::vector<Camera>& cameras = scene.prepared.scene.cameras;
    const auto named = std::find_if(cameras.begin(), cameras.end(),
                                    [&](const Camera& camera) { return camera.name == desc_.camera; });
    if (named != cameras.end()) return cameraOfFile(*named, scene.geometry.bounds);
    if (!desc_.camera.empty())
        feedback_.note(scene.prepared.scene.path + ": has no camera '" + desc_.camera + "'", true);
    return scene.view;
}

void Viewer::followBake(double time) {
    baking_.follow();
    if (picture_.takeMap()) screenLog_.tellMap(*picture_.newestMap());
    if (progress_.update(baking_.status(), picture_.map(), session_.newestBake(), time)) {
        feedback_.tell("badge", badgeName(progress_.badge().state));
        feedback_.pacer().input();
    }
    if (inspection_.follow(baking_.status(), lights_.list(), time)) feedback_.sceneChanged();
    if (const std::optional<size_t> seen = inspection_.takeSeen())
        feedback_.tell("seen", fmt::format("{} tiles", *seen));
    if (const std::string told = inspection_.balls().takeTold(); !told.empty()) feedback_.tell("balls", told);
    if (const std::string told = inspection_.readout().takeTold(); !told.empty())
        feedback_.tell("texel", told);
    if (const std::string why = inspection_.balls().takeRemark(); !why.empty()) feedback_.note(why, true);
    feedback_.followExposure(picture_.pane().adapting());
    baking_.setBudget(desc_.budgetMs, !picture_.rests(time));
}

// Returns why the picture shows nothing, or no light.
std::optional<PictureNotice> Viewer::notice() const {
    if (session_.scene() == nullptr || session_.early() != nullptr) return std::nullopt;
    const std::vector<Placement>& placements = session_.document().edits.placements;
    const auto hidden =
        std::count_if(placements.begin(), placements.end(), [](const Placement& p) { return p.hidden; });
    return pictureNotice({.phase = baking_.status().phase,
                          .doing = baking_.status().doing,
                          .objects = placements.size(),
                          .hidden = static_cast<size_t>(hidden),
                          .flat = picture_.state().uv,
                          .map = picture_.map() != nullptr});
}

Opening::Facts Viewer::openingFacts() const {
    const std::optional<PictureNotice> said = notice();
    const bool early = session_.early() != nullptr; // its geometry is seen while the rest is made
    return {.scene = session_.scene() != nullptr || early,
            .loading = session_.loading() && !early,
            .time = feedback_.now(),
            .notice = said ? said->title + ": " + said->text : ""};
}

MiddleView Viewer::middleView() {
    return {.middle = files_.opening().middle(openingFacts()),
            .tabs = gui_.takeTabs(),
            .scene = openingFacts().scene,
            .opening = files_.opening().path(),
            .progress = session_.loader().progress(),
            .failure = files_.opening().failure(),
            .notice = notice(),
            .copy = [this](const std::string& text) {
                window_.copyText(text);
                feedback_.tell("copied", text);
                feedback_.note("the message is copied");
            }};
}

// Follows what stands in the middle of the window.
void Viewer::followMiddle() {
    const Middle middle = files_.opening().middle(openingFacts());
    ui_.start().show(middle.startPage, preferences_.values());
    const bool looked = ui_.start().looking();
    if (const std::optional<size_t> gone = ui_.start().follow())
        feedback_.tell("recent", fmt::format("{} files, {} gone", preferences_.values().recent.size(),
                                             gone.value_or(0)));
    const bool found = looked && !ui_.start().looking();
    if (screenLog_.tellMiddle(middleName(middle)) || found) feedback_.pacer().input();
    gui_.navigate(ui_.takesKeys(middle));
}

// Tells whether what was asked for is on the screen: nothing is left to be drawn, and the map is the one that
// the view shows.
bool Viewer::settled() const {
    const PublishedMap* shown = picture_.newestMap();
    const bool asked = shown == nullptr || inspection_.asksFor(*shown);
    return asked && feedback_.pacer().settled() && !picture_.pane().adapting() && !picture_.waitsForMaps() &&
           !session_.loading() && !ui_.start().looking();
}

PanelContext Viewer::context() {
    return {.session = session_,
            .status = baking_.status(),
            .view = picture_.state(),
            .preferences = preferences_.values(),
            .figures = figures_,
            .log = log_,
            .messages = feedback_.messages(),
            .lights = lights_.list(),
            .previews = previews_.previews(),
            .map = picture_.map(),
            .exposure = picture_.pane().exposure(),
            .budgetMs = desc_.budgetMs,
            .recording = shots_.recording(),
            .perform = [this](Action action, int argument) { perform(action, argument); },
            .seeFrom = [this](const ViewCamera& camera) { picture_.seeFrom(camera); },
            .sceneChanged = [this] { feedback_.sceneChanged(); },
            .edit = [this](const std::string& name, const Document& next) { editing_.edit(name, next); },
            .endEdit = [this] { editing_.end(); },
            .open = [this](const std::string& path) { files_.open(path); },
            .forget = [this](const std::string& path) { files_.forget(path); },
            .choose = [this](const GltfChoice& choice) { files_.choose(choice); },
            .selectLight = [this](const LightKey& key) { lights_.select(key); },
            .items = ui_.items()};
}

std::vector<ViewCamera> Viewer::cameraMotion(double rate) const {
    constexpr uint32_t kMostPictures = 100000; // about an hour of a video
    std::vector<ViewCamera> cameras;
    for (const Camera& camera : relume::cameraMotion(session_, rate, kMostPictures))
        cameras.push_back(cameraOfFile(camera, picture_.camera().bounds()));
    return cameras;
}

std::vector<std::string> Viewer::captionLines() const {
    const std::string path = files_.path();
    const BakeStatus& status = baking_.status();
    std::vector<std::string> lines = {path.substr(path.find_last_of('/') + 1), statusLine(status)};
    if (lights_.alone()) lines.push_back(viewTitle(picture_.state(), lights_.list(), status.groups));
    lines.push_back(fmt::format("{} of solving", formatDuration(status.progress.seconds)));
    return lines;
}

// Returns what the scene on screen has that its file lacks.
std::string Viewer::furnishedLine() const {
    return furnishedText(!session_.scene()->prepared.madeUvs.empty(), hasPreview(session_.document().edits));
}

// Draws what lies over the picture of the scene.
void Viewer::drawOverlay() {
    const bool mayHold = !input_.pressed() && overScene(input_.cursor());
    mover_.draw(mayHold ? std::optional(input_.cursor()) : std::nullopt, ui_.items());
    if (session_.scene() == nullptr) return;
    if (comparison_.shown()) {
        const ui::ItemLog::Scope scope(ui_.items(), "Wipe");
        ui_.items().add("Line", glm::ivec2(glm::round(comparison_.grip())));
        comparison_.draw();
    }
    if (picture_.state().bare || session_.early() != nullptr) return;
    inspection_.readout().draw();
    drawBadge(progress_.badge(), furnishedLine(), picture_.area());
}

void Viewer::frame(const Redraw& redraw) {
    const double begin = feedback_.now();
    shots_.moveCamera();
    const float pixels = pixelsPerPoint();
    const float scale =
        gui_.animates() ? picture_.scale() : window_.contentScale() / pixels * preferences_.values().uiScale;
    gui_.begin(scale);
    previews_.previews().wanted = false; // the panel says
    picture_.place(ui_.draw(context(), middleView(), scale), scale, pixels);
    drawOverlay();
    const double drawnUi = feedback_.now();
    const bool anew = redraw.scene || feedback_.sceneIsChanged();
    const bool drew = picture_.draw(anew, window_.size());
    ++(drew ? figures_.drawn : figures_.repeated);
    if (drew) shots_.pictureDrawn();
    const double drawnScene = feedback_.now();
    gui_.end();
    if (gui_.hasInputLeft()) feedback_.pacer().input();
    shots_.takeFrame(begin, window_.size());
    const double beforeSwap = feedback_.now();
    window_.swap();
    const double end = feedback_.now();
    figures_.span("panels").cpu = 1e3 * (drawnUi - begin);
    figures_.span("scene").cpu = 1e3 * (drawnScene - drawnUi);
    figures_.span("swap").cpu = 1e3 * (end - beforeSwap);
    figures_.addFrame(1e3 * (end - begin));
    for (const gl::Timer::Pass& pass : picture_.pane().endFrame()) {
        FrameFigures::Span& span = figures_.span("drawing: " + pass.name);
        span.cpu = pass.cpuMs;
        span.gpu = pass.gpuMs;
    }
    figures_.drawCalls = picture_.pane().counts().drawn;
    figures_.culled = picture_.pane().counts().culled;
    // A GPU's swap waits for the monitor, while the CPU's draws.
    feedback_.pacer().drawn({anew, true}, end, picture_.pane().software() ? end - begin : beforeSwap - begin);
}

} // namespace relume
