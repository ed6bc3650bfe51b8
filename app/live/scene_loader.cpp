#include "app/live/scene_loader.h"

#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "renderer/good_view.h"

#include <chrono>
#include <functional>
#include <optional>
#include <utility>

namespace relume {
namespace {

// Pictures are wider than high; only the camera's distance depends on it.
constexpr float kAspect = 16.0f / 9.0f;

struct LoadUnwanted {};

/// Tells how far a load is, and ends one that nobody waits for any more.
class LoadWatch final : public Watch {
public:
    using Tell = std::function<void(const char* phase, double done)>;
    LoadWatch(const std::atomic<bool>& unwanted, Tell tell)
        : unwanted_(unwanted), tell_(std::move(tell)), scope_(*this) {}
    void hear(const char* phase, double done) override {
        if (unwanted_) throw LoadUnwanted();
        tell_(phase, done);
    }

private:
    const std::atomic<bool>& unwanted_;
    Tell tell_;
    WatchScope scope_;
};

ViewCamera viewOf(const Scene& file, const WorldMesh& mesh, const Box& bounds) {
    return file.cameras.empty() ? goodView(mesh, kAspect) : cameraOfFile(file.cameras.front(), bounds);
}

// Returns what can be drawn of a scene that has no lightmap UVs yet.
std::unique_ptr<LoadedScene> earlyLook(const Scene& file, uint64_t number) {
    tellWatch("drawing the geometry");
    auto look = std::make_unique<LoadedScene>();
    Scene& scene = look->prepared.scene; // without the meshes, which are most of it
    scene.path = file.path;
    scene.images = file.images;
    scene.textures = file.textures;
    scene.materials = file.materials;
    scene.instances = file.instances;
    scene.cameras = file.cameras;
    scene.sky = file.sky;
    LightmapAtlas none;
    none.instances.resize(file.instances.size());
    const WorldMesh mesh = flatten(file, none);
    look->geometry = makeGeometry(file, mesh);
    look->view = viewOf(file, mesh, look->geometry.bounds);
    look->number = number;
    return look;
}

} // namespace

std::unique_ptr<LoadedScene> SceneLoader::load(const PrepareDesc& desc, uint64_t number, bool early) {
    const LoadWatch watch(unwanted_, [this](const char* phase, double done) {
        const std::lock_guard lock(mutex_);
        progress_ = {phase, done};
    });
    files_ = FileSet::of(desc.path); // before they are read: what is written meanwhile is seen later
    auto scene = std::make_unique<LoadedScene>();
    std::optional<ViewCamera> view;
    const auto whenRead = [&](const Scene& file) {
        std::unique_ptr<LoadedScene> look = earlyLook(file, number);
        view = look->view;
        handOut(std::move(look));
    };
    PrepareDesc remembered = desc;
    remembered.memory = &memory_;
    remembered.rects = &rects_;
    scene->prepared = early ? prepareScene(remembered, whenRead) : prepareScene(remembered);
    const Scene& file = scene->prepared.scene;
    scene->geometry = makeGeometry(file, scene->prepared.mesh);
    scene->view = view ? *view : viewOf(file, scene->prepared.mesh, scene->geometry.bounds);
    scene->size = scene->prepared.size;
    scene->number = number;
    return scene;
}

void SceneLoader::handOut(std::unique_ptr<LoadedScene> early) {
    const std::lock_guard lock(mutex_);
    early_ = std::move(early);
}

std::unique_ptr<LoadedScene> SceneLoader::takeEarly() {
    const std::lock_guard lock(mutex_);
    return std::move(early_);
}

SceneLoader::~SceneLoader() {
    unwanted_ = true;
    if (loading_.valid()) loading_.wait();
}

void SceneLoader::start(const PrepareDesc& desc, bool early) {
    ASSERT(!loading());
    unwanted_ = false;
    path_ = desc.path;
    if (path_ != unwrapped_ || early) { // another file has other charts
        memory_ = {};
        rects_ = {};
    }
    unwrapped_ = path_;
    progress_ = {}; // nobody else has it now
    files_ = {};
    loading_ = std::async(std::launch::async,
                          [this, desc, early, number = ++loads_] { return load(desc, number, early); });
}

LoadProgress SceneLoader::progress() const {
    const std::lock_guard lock(mutex_);
    return progress_;
}

bool SceneLoader::ready() const {
    return loading_.valid() && loading_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

std::unique_ptr<LoadedScene> SceneLoader::finish() {
    path_.clear();
    handOut(nullptr);
    try {
        std::unique_ptr<LoadedScene> scene = loading_.get(); // it may have been there when it was dropped
        return unwanted_ ? nullptr : std::move(scene);
    } catch (...) {
        if (unwanted_) return nullptr;
        throw;
    }
}

} // namespace relume
