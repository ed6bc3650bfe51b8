#include "app/live/session.h"

#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/base/watch.h"
#include "assets/model/scene_limits.h"
#include "bake/trace/make_tracer.h"
#include "renderer/good_view.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <utility>

namespace relume {
namespace {

// Pictures are wider than high; only the camera's distance depends on it.
constexpr float kAspect = 16.0f / 9.0f;
// A file is looked at so often, and must have stayed the same for so long: its writer may not be done yet.
constexpr double kPollSeconds = 0.5;
// Undo keeps so many steps.
constexpr size_t kMaxSteps = 200;

struct LoadUnwanted {};

/// Ends a load that nobody waits for any more.
class LoadWatch final : public Watch {
public:
    explicit LoadWatch(const std::atomic<bool>& unwanted) : unwanted_(unwanted), scope_(*this) {}
    void hear(const char*, double) override {
        if (unwanted_) throw LoadUnwanted();
    }

private:
    const std::atomic<bool>& unwanted_;
    WatchScope scope_;
};

std::unique_ptr<LoadedScene> load(const PrepareDesc& desc, uint64_t number,
                                  const std::atomic<bool>& unwanted) {
    const LoadWatch watch(unwanted);
    auto scene = std::make_unique<LoadedScene>();
    scene->prepared = prepareScene(desc);
    const Scene& file = scene->prepared.scene;
    scene->geometry = makeGeometry(file, scene->prepared.mesh);
    scene->view = file.cameras.empty() ? goodView(scene->prepared.mesh, kAspect)
                                       : cameraOfFile(file.cameras.front(), scene->geometry.bounds);
    scene->size = desc.size;
    scene->number = number;
    return scene;
}

template<typename Named>
bool haveSameNames(const std::vector<Named>& a, const std::vector<Named>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const Named& x, const Named& y) { return x.name == y.name; });
}

// Tells whether both scenes have the same objects in the same order. Placements go by that order, which a
// save may change where an object left its node.
bool sameObjects(const Scene& a, const Scene& b) {
    return std::equal(
        a.instances.begin(), a.instances.end(), b.instances.begin(), b.instances.end(),
        [](const Instance& x, const Instance& y) { return x.name == y.name && x.mesh == y.mesh; });
}

} // namespace

Session::FileTime Session::fileTime(const std::string& path) {
    std::error_code error;
    const auto time = std::filesystem::last_write_time(path, error);
    return error ? FileTime() : FileTime(time);
}

Session::Session(LiveBake& bake, const BakeRequest& request) : bake_(bake), prepare_(request.prepare) {
    document_.bake = request.bake;
    document_.lightmap = request.lightmap;
}

Session::~Session() {
    unwanted_ = true;
    if (loading_.valid()) loading_.wait();
}

void Session::open(const std::string& path, bool keep) {
    if (loading_.valid()) { // one at a time: the newest request is followed when the present load has ended
        if (path != loadingPath_) unwanted_ = true;
        nextPath_ = path;
        keepNext_ = keep;
        return;
    }
    keepLoading_ = keep;
    loadingPath_ = path;
    PrepareDesc desc = prepare_;
    desc.path = path;
    desc.size = document_.bake.size;
    spdlog::info("opening {}", path);
    finishSaving(); // so that the load reads what was saved
    loadingTime_ = fileTime(path);
    sameFile_ = keep && path == prepare_.path && loadingTime_ && loadingTime_ == watched_;
    unwanted_ = false;
    loading_ = std::async(std::launch::async,
                          [this, desc, number = ++loads_] { return load(desc, number, unwanted_); });
}

bool Session::update() {
    dropFormer();
    takeSaved();
    if (nextSave_ && !file_.saving() && !loading_.valid()) save(*std::exchange(nextSave_, std::nullopt));
    const bool changed = finishLoading();
    if (watch_) pollFile();
    return changed;
}

bool Session::finishLoading() {
    if (!loading_.valid() || loading_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return false;
    bool changed = false;
    // A file that cannot be read is not tried again until it is another one.
    if (loadingPath_ == prepare_.path) watched_ = loadingTime_;
    try {
        take(loading_.get());
        changed = true;
    } catch (const LoadUnwanted&) { // another scene is opened below
    } catch (const std::bad_alloc&) {
        fail(loadingPath_ + ": does not fit in memory");
    } catch (const std::exception& error) {
        fail(error.what());
    }
    loadingPath_.clear();
    if (!nextPath_.empty())
        open(std::exchange(nextPath_, {}), keepNext_);
    else if (changed && scene_->size != document_.bake.size)
        open(prepare_.path, true); // the size was edited meanwhile
    else if (!changed && scene_ && scene_->size != document_.bake.size) {
        scene_->size = document_.bake.size; // its file is gone: the atlas it has must do
        startBake(true);
    }
    return changed;
}

void Session::fail(const std::string& message) {
    spdlog::error("{}", message);
    lastError_ = message;
}

// Carries edits over to a file that was written anew; the rest is as the file has it now. Where the file's
// lights changed, all of them are the file's.
void Session::keepEdits(SceneEdits& edits, const std::vector<Instance>& instances) {
    const Scene& file = file_.scene();
    const SceneEdits own = editsOf(file);
    const bool sameNames = haveSameNames(edits.materials, file.materials);
    const bool sameInstances = haveSameNames(instances, file.instances) && edits.placements == own.placements;
    const bool sameLights = edits.lights == own.lights && edits.sky == own.sky;
    keepMaterials(edits.materials, sameNames);
    if (sameInstances) edits.placements = document_.edits.placements;
    if (sameLights) {
        edits.lights = document_.edits.lights;
        edits.sky = document_.edits.sky;
    }
    if (sameNames && sameInstances && sameLights) return;
    forgetSteps(); // they refer to materials, instances and lights by number
    document_.mix = {};
}

void Session::save(const std::string& path) {
    if (!scene_) return;
    if (loading_.valid() && loadingPath_ != prepare_.path) {
        fail(fmt::format("{}: not saved while {} is opened: save it before, or wait", prepare_.path,
                         loadingPath_));
        return;
    }
    if (file_.saving() || loading_.valid())
        nextSave_ = path;
    else
        file_.save(path.empty() ? prepare_.path : path, document_.edits);
}

void Session::takeSaved() {
    try {
        const std::optional<SceneFile::Saved> saved = file_.update();
        if (!saved) return;
        spdlog::info("saved {}", saved->path);
        prepare_.path = saved->path;
        watched_ = saved->time; // what we wrote need not be read
        ++saves_;
    } catch (const std::bad_alloc&) {
        fail(prepare_.path + ": cannot be saved: it does not fit in memory");
    } catch (const std::exception& error) {
        fail(error.what());
    }
}

void Session::finishSaving() {
    file_.wait();
    takeSaved();
    if (!nextSave_ || loading_.valid()) return;
    save(*std::exchange(nextSave_, std::nullopt));
    file_.wait();
    takeSaved();
}

void Session::keepMaterials(std::vector<Material>& materials, bool sameNames) const {
    const std::vector<Material>& before = scene_->prepared.scene.materials;
    for (size_t i = 0; i < before.size(); ++i) {
        const Material& edited = document_.edits.materials[i];
        if (edited.baseColor == before[i].baseColor && edited.emission == before[i].emission) continue;
        const auto same = sameNames ? materials.begin() + static_cast<std::ptrdiff_t>(i)
                                    : std::find_if(materials.begin(), materials.end(),
                                                   [&](const Material& m) { return m.name == edited.name; });
        if (same == materials.end()) continue;
        same->baseColor = edited.baseColor;
        same->emission = edited.emission;
    }
}

void Session::forgetSteps() {
    steps_.clear();
    done_ = 0;
    open_ = false;
}

void Session::take(std::unique_ptr<LoadedScene> scene) {
    kept_ = keepLoading_ && scene_ != nullptr;
    const Scene& file = scene->prepared.scene;
    SceneEdits edits = editsOf(file);
    if (kept_ && sameFile_ && sameObjects(scene_->prepared.scene, file)) {
        edits = document_.edits;
    } else if (kept_) {
        keepEdits(edits, file.instances);
        file_.loaded(file);
    } else {
        file_.loaded(file);
        forgetSteps();
        document_.mix = {};
    }
    document_.edits = std::move(edits);
    ++changes_;
    if (scene_) former_.push_back(std::move(scene_));
    scene_ = std::move(scene);
    prepare_.path = loadingPath_;
    watched_ = loadingTime_;
    startBake(kept_);
}

void Session::dropFormer() {
    std::erase_if(former_, [&](const auto& scene) { return !bake_.holds(scene->prepared); });
}

void Session::startBake(bool keepLight) {
    if (!scene_ || scene_->size != document_.bake.size) return; // its new atlas is on its way
    const uint64_t bake = bake_.start({.scene = &scene_->prepared,
                                       .edits = document_.edits,
                                       .mix = document_.mix,
                                       .settings = document_.bake,
                                       .keepLight = keepLight,
                                       .rings = document_.lightmap.sew ? document_.lightmap.dilate : 0});
    if (!keepLight) firstBake_ = bake;
    newestBake_ = bake;
}

void Session::edit(const std::string& name, const Document& wanted) {
    Document next = wanted;
    file_.number(next.edits.lights);
    if (scene_) limitEdits(scene_->prepared.scene, document_.edits, next.edits);
    if (open_ && done_ == steps_.size() && done_ > 0 && steps_.back().name == name) {
        steps_.back().after = next;
    } else {
        steps_.resize(done_);
        if (steps_.size() >= kMaxSteps) steps_.erase(steps_.begin());
        steps_.push_back({name, document_, next});
        done_ = steps_.size();
    }
    open_ = true;
    apply(next);
}

void Session::cancelEdit() {
    if (!open_ || done_ == 0 || done_ != steps_.size()) return;
    const Document before = std::move(steps_.back().before);
    steps_.pop_back();
    done_ = steps_.size();
    open_ = false;
    apply(before);
}

void Session::apply(const Document& next) {
    const bool resized = next.bake.size != document_.bake.size;
    document_ = next;
    ++changes_;
    // Charts are packed for a size: another size needs another atlas.
    if (resized && scene_)
        open(prepare_.path, true);
    else
        startBake(true);
}

std::string Session::problem(const BakeSettings& settings) {
    const SolverSettings& solver = settings.solver;
    const auto power = [](uint32_t value, uint32_t most) {
        return value > 0 && value <= most && (value & (value - 1)) == 0;
    };
    if (settings.size < 8 || settings.size > Baker::kMaxSize)
        return fmt::format("a lightmap's edge is from 8 to {} texels", Baker::kMaxSize);
    if (solver.transport.rtrad && !isPairMethod(solver.method))
        return fmt::format("RTRad's preset has no {} method: choose another one", methodName(solver.method));
    if (!solver.transport.rtrad && solver.transport.distanceFactor != 1.0f)
        return "the distance factor has a meaning in RTRad's preset only: set it to 1";
    if (!power(solver.pairs.window, 32)) return "a window is a power of two up to 32 texels wide";
    if (!power(solver.pairs.node, 64) || solver.pairs.node < 2)
        return "a node is a power of two from 2 to 64 texels wide";
    if (settings.tracer == TracerKind::Voxel && settings.voxels.ratio != 1)
        return "a share of senders through voxels needs another tracer beside them";
    if (!(solver.transport.reflectivity >= 0 && solver.transport.reflectivity <= 10))
        return "the reflectivity is from 0 to 10";
    if (solver.passes > Solver::kMaxPasses) return fmt::format("at most {} passes", Solver::kMaxPasses);
    return "";
}

bool Session::undo() {
    open_ = false;
    if (done_ == 0) return false;
    apply(Document(steps_[--done_].before));
    return true;
}

bool Session::redo() {
    open_ = false;
    if (done_ == steps_.size()) return false;
    apply(Document(steps_[done_++].after));
    return true;
}

std::string Session::undoName() const {
    return done_ > 0 ? steps_[done_ - 1].name : "";
}

std::string Session::redoName() const {
    return done_ < steps_.size() ? steps_[done_].name : "";
}

// Reads the scene's file again once its new time stamp stays as it is: its writer may take a while.
void Session::pollFile() {
    if (!scene_ || loading_.valid() || secondsSince(polled_) < kPollSeconds) return;
    polled_ = Clock::now();
    const auto time = fileTime(prepare_.path);
    const bool still = time == seen_;
    seen_ = time;
    if (time && still && time != watched_) open(prepare_.path, true);
}

} // namespace relume
