#include "app/live/scene_loader.h"

#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "renderer/good_view.h"

#include <chrono>
#include <functional>
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

std::unique_ptr<LoadedScene> load(const PrepareDesc& desc, uint64_t number) {
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

} // namespace

SceneLoader::~SceneLoader() {
    unwanted_ = true;
    if (loading_.valid()) loading_.wait();
}

void SceneLoader::start(const PrepareDesc& desc) {
    ASSERT(!loading());
    unwanted_ = false;
    path_ = desc.path;
    progress_ = {}; // nobody else has it now
    loading_ = std::async(std::launch::async, [this, desc, number = ++loads_] {
        const LoadWatch watch(unwanted_, [this](const char* phase, double done) {
            const std::lock_guard lock(mutex_);
            progress_ = {phase, done};
        });
        return load(desc, number);
    });
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
    try {
        return loading_.get();
    } catch (const LoadUnwanted&) {
        return nullptr;
    }
}

} // namespace relume
