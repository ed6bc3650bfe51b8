#include "app/live/session.h"

#include "app/live/reload.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/gltf/gltf_camera_motion.h"
#include "assets/model/scene_limits.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

namespace relume {
namespace {

// Tells whether both scenes have the same objects in the same order. Placements go by that order, which a
// save may change where an object left its node.
bool sameObjects(const Scene& a, const Scene& b) {
    return std::equal(
        a.instances.begin(), a.instances.end(), b.instances.begin(), b.instances.end(),
        [](const Instance& x, const Instance& y) { return x.name == y.name && x.mesh == y.mesh; });
}

// Tells whether another program wrote the file since it was read or saved, and nobody has read it yet. It may
// have done so while nobody watches, too.
bool isNewer(const FileWatch& watch) {
    const FileSet now{watch.files().paths, watch.files().timesNow()};
    return !now.times.empty() && now.times.front() && !watch.isKnown(now);
}

} // namespace

Session::Session(LiveBake& bake, const BakeRequest& request)
    : bake_(bake), prepare_(request.prepare), news_([&bake] { bake.wake(); }) {
    document_.bake = request.bake;
    document_.lightmap = request.lightmap;
    prepare_.size = request.bake.size; // from which sizes are found
}

void Session::open(const std::string& path, bool keep) {
    const Next next{path, keep, path == prepare_.path ? prepare_.choice : GltfChoice{}, false};
    if (!keep) arrival_.ask(changes_);
    if (!loader_.loading()) return load(next);
    // One at a time: the newest request is followed when the present load has ended.
    if (path != loader_.path() || keep != loading_.keep) loader_.drop();
    next_ = next;
}

void Session::choose(const GltfChoice& choice) {
    const Next next{prepare_.path, false, choice, false};
    arrival_.ask(changes_);
    if (!loader_.loading()) return load(next);
    loader_.drop();
    next_ = next;
}

void Session::load(const Next& next) {
    finishSaving(next.keep); // so that the load reads what was saved
    const auto& [wanted, keep, choice, hasty] = next;
    const std::string path = keep ? prepare_.path : wanted; // the scene may be saved as another file by now
    PrepareDesc desc = prepare_;
    desc.path = path;
    desc.choice = choice;
    if (keep) desc.leastDensity = 0; // its size stays
    // A size that was found for the scene before is none that anybody asked for.
    if (desc.leastDensity <= 0) desc.size = document_.bake.size;
    desc.stride = kSizeStride; // the next power of two may take four times as long
    BakeSettings least = document_.bake;
    least.size = desc.size;
    desc.fitting = [&bake = bake_, settings = least](const Scene& scene, LightmapPages pages, uint32_t edge) {
        const std::optional<BakeRoom> room = bake.room();
        return room ? fittingSize(settings, extentOf(scene, pages), *room, settings.size, edge)
                    : settings.size;
    };
    spdlog::info("opening {}", path);
    loading_ = {.keep = keep, .hasty = hasty, .fits = desc.leastDensity > 0, .choice = choice};
    // The light of a scene that was written anew stays; another scene is shown as soon as it can be.
    loader_.start(desc, !keep);
}

bool Session::update() {
    std::erase_if(former_, [&](const auto& scene) { return !bake_.holds(scene->prepared); });
    takeSaved();
    if (nextSave_ && !file_.saving() && (!loader_.loading() || arrival_.waits()))
        save(*std::exchange(nextSave_, std::nullopt));
    const bool changed = finishLoading();
    pollFile();
    return changed;
}

bool Session::finishLoading() {
    if (std::unique_ptr<LoadedScene> early = loader_.takeEarly()) early_ = std::move(early);
    if (!loader_.ready()) return false;
    if (!loading_.keep && !loader_.dropped()) {
        const Arrival::Step step = arrival_.decide(changes_, dirty());
        if (step == Arrival::Step::Waits) return false;
        if (step == Arrival::Step::IsRefused) loader_.drop();
    }
    early_.reset();
    bool changed = false;
    const std::string path = loader_.path();
    const FileSet files = loader_.files();
    loading_.sameFile = loading_.keep && path == prepare_.path && watch_.isKnown(files);
    // A file that cannot be read is not tried again until it is another one, or its writer is surely done.
    const bool unread = loading_.hasty || loader_.dropped();
    if (path == prepare_.path && !files.paths.empty() && !unread) watch_.know(files);
    try {
        if (std::unique_ptr<LoadedScene> scene = loader_.finish()) {
            take(std::move(scene), path);
            watch_.know(files);
            changed = true;
        } // else nobody wants it any more
    } catch (const std::bad_alloc&) {
        fail(path + ": does not fit in memory: make it smaller, or close other programs",
             loading_.keep ? "" : path);
    } catch (const std::exception& error) {
        if (loading_.hasty)
            spdlog::info("{} is being written", path);
        else
            fail(error.what(), loading_.keep ? "" : path);
    }
    if (const std::optional<Next> next = std::exchange(next_, std::nullopt))
        load(*next);
    else if (const bool resized = scene_ && scene_->size != document_.bake.size;
             resized && (changed || !loading_.keep))
        open(prepare_.path, true); // the size was edited meanwhile
    else if (resized) {
        scene_->size = document_.bake.size; // its file is gone: the atlas it has must do
        startBake(true);
    }
    return changed;
}

// Tells what went wrong. `opened` is the scene that could not be read by it; "" where it was only to be read
// anew, and for all else.
void Session::fail(const std::string& message, const std::string& opened) {
    spdlog::error("{}", message);
    if (opened.empty())
        lastError_ = message;
    else
        openFailure_ = OpenFailure{opened, message};
}

// Follows a file that was written anew: returns the edits as they stand on it, and notes what changed.
SceneEdits Session::reloaded(const PreparedScene& now, const SceneChanges& changes) {
    Scene before = file_.scene();
    // A colour that was saved, and still is as it was saved, stays, whoever writes the file.
    for (size_t i = 0; i < before.materials.size(); ++i) {
        const Material &own = document_.edits.materials[i], &read = scene_->prepared.scene.materials[i];
        Material& saved = before.materials[i];
        if (own.baseColor == saved.baseColor) saved.baseColor = read.baseColor;
        if (own.emission == saved.emission) saved.emission = read.emission;
    }
    CarriedEdits carried = carryEdits(before, document_.edits, now.scene);
    file_.loaded(now.scene);
    // Its steps hold all that can be edited as the file had it, whole materials with their textures' numbers
    // too.
    if (!carried.sameFile || changes.materials > 0 || changes.surfaces || changes.paint) history_.forget();
    if (!carried.sameNumbers) document_.mix = {};
    const bool anew =
        (changes.surfaces || changes.paint) && !bake_.status().layered; // layers go on with what stays
    reloadNotes_ = {fmt::format("reloaded: {}{}", describe(changes), anew ? " (the bake begins anew)" : "")};
    spdlog::info("{}", reloadNotes_[0]);
    for (const std::string& conflict : carried.conflicts) {
        spdlog::warn("{}", conflict);
        reloadNotes_.push_back(conflict);
    }
    return std::move(carried.edits);
}

void Session::save(const std::string& path) {
    if (!scene_) return;
    const bool loading = loader_.loading() && !arrival_.waits();
    if (loading && loader_.path() != prepare_.path) {
        fail(fmt::format("{}: not saved while {} is opened: save it before, or wait", prepare_.path,
                         loader_.path()));
        return;
    }
    std::error_code code;
    if (!std::filesystem::exists(prepare_.path, code)) { // edits go into a copy of what it has
        fail(prepare_.path + ": is gone, so that its edits cannot be saved: put it back and save again");
        return;
    }
    if (file_.saving() || loading) {
        nextSave_ = path;
    } else if (isNewer(watch_)) { // edits go into its nodes, which may be others now
        arrival_.answer(false);   // no other scene comes before that
        open(prepare_.path, true);
        nextSave_ = path;
    } else {
        file_.save(path.empty() ? prepare_.path : path, document_.edits);
    }
}

void Session::takeSaved() {
    try {
        const std::optional<SceneFile::Saved> saved = file_.update();
        if (!saved) return;
        spdlog::info("saved {}", saved->path);
        prepare_.path = saved->path;
        watch_.knowSaved(saved->path, saved->time); // what we wrote need not be read
        ++saves_;
    } catch (const std::bad_alloc&) {
        fail(prepare_.path + ": cannot be saved: it does not fit in memory");
    } catch (const std::exception& error) {
        fail(error.what());
    }
}

// Ends what is to be saved before the next load. A file that another program wrote meanwhile is not saved
// into before it is read, which that load does where it keeps the scene.
void Session::finishSaving(bool keep) {
    file_.wait();
    takeSaved();
    if (!nextSave_) return;
    if (!isNewer(watch_)) {
        const std::string path = *std::exchange(nextSave_, std::nullopt);
        file_.save(path.empty() ? prepare_.path : path, document_.edits);
        file_.wait();
        takeSaved();
    } else if (!keep) {
        nextSave_.reset();
        fail(prepare_.path + ": not saved, as another program wrote it meanwhile: open it again");
    }
}

void Session::take(std::unique_ptr<LoadedScene> scene, const std::string& path) {
    kept_ = loading_.keep && scene_ != nullptr;
    const Scene& file = scene->prepared.scene;
    SceneEdits edits = document_.edits;
    SceneChanges changes{.surfaces = true};
    if (kept_) changes = changesBetween(file_.scene(), scene_->prepared, scene->prepared);
    if (!kept_) {
        file_.loaded(file);
        history_.forget();
        document_.mix = {};
        edits = editsOf(file);
    } else if (!loading_.sameFile || !sameObjects(scene_->prepared.scene, file)) {
        edits = reloaded(scene->prepared, changes);
    }
    if (changes.surfaces) ++surfaces_;
    if (changes.surfaces || changes.paint) ++paint_;
    document_.edits = std::move(edits);
    if (loading_.fits) document_.bake.size = scene->size;
    ++changes_;
    if (scene_) former_.push_back(std::move(scene_));
    scene_ = std::move(scene);
    prepare_.path = path;
    prepare_.choice = loading_.choice;
    startBake(kept_);
}

void Session::startBake(bool keepLight) {
    if (!scene_ || scene_->size != document_.bake.size) return; // its new atlas is on its way
    const uint64_t bake = bake_.start({.scene = &scene_->prepared,
                                       .edits = document_.edits,
                                       .mix = document_.mix,
                                       .settings = document_.bake,
                                       .keepLight = keepLight,
                                       .rings = document_.lightmap.sew ? document_.lightmap.dilate : 0,
                                       .surfaces = surfaces_,
                                       .paint = paint_});
    if (!keepLight) firstBake_ = bake;
    newestBake_ = bake;
}

void Session::edit(const std::string& name, const Document& wanted) {
    Document next = wanted;
    file_.number(next.edits.lights);
    if (scene_) limitEdits(scene_->prepared.scene, document_.edits, next.edits);
    history_.add(name, document_, next);
    apply(next);
}

void Session::cancelEdit() {
    if (const std::optional<Document> before = history_.cancel()) apply(*before);
}

void Session::apply(const Document& next) {
    const bool resized = next.bake.size != document_.bake.size;
    if (resized) { // the user has chosen
        prepare_.leastDensity = 0;
        loading_.fits = false;
    }
    document_ = next;
    ++changes_;
    // Charts are packed for a size: another size needs another atlas, unless another scene is on its way.
    const bool another = (loader_.loading() && !loading_.keep) || (next_ && !next_->keep);
    if (resized && scene_ && !another)
        open(prepare_.path, true);
    else
        startBake(true);
}

bool Session::undo() {
    const std::optional<Document> before = history_.undo();
    if (before) apply(*before);
    return before.has_value();
}

bool Session::redo() {
    const std::optional<Document> after = history_.redo();
    if (after) apply(*after);
    return after.has_value();
}

// Reads the scene's files again once they seem to be written: their writer may take a while.
void Session::pollFile() {
    const Clock::time_point now = Clock::now();
    if (!scene_ || loader_.loading() || file_.saving()) return; // what we write is no news
    const FileSet& files = watch_.files();
    news_.follow(watch_.on() ? files.paths : std::vector<std::string>());
    const bool finished = news_.take();
    if (!watch_.isDue(now) && !finished) return;
    const FileLook found{.times = files.timesNow(), .whole = files.isWhole(), .finished = finished};
    const FileChange change = watch_.look(found, now);
    if (change != FileChange::None) load({prepare_.path, true, prepare_.choice, change == FileChange::Hasty});
}

uint32_t mapSize(const Session& session) {
    const LoadedScene* scene = session.scene();
    const LightmapPages pages = scene ? scene->prepared.atlas.pages : LightmapPages();
    return pages.sheetOf(session.document().bake.size);
}

std::vector<Camera> cameraMotion(const Session& session, double rate, uint32_t most) {
    if (session.scene() == nullptr) return {};
    for (const Camera& camera : session.scene()->prepared.scene.cameras) {
        try {
            return readCameraMotion(session.path(), session.choice(), camera.name, rate, most).cameras;
        } catch (const Error&) { // another one may be moved
        }
    }
    return {};
}

} // namespace relume
