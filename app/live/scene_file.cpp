#include "app/live/scene_file.h"

#include "assets/base/error.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <set>
#include <utility>

namespace relume {

SceneFile::Place SceneFile::placeOf(const Light& light) {
    return {light.node, light.type == LightType::Rectangle || light.type == LightType::Disc};
}

void SceneFile::loaded(const Scene& scene) {
    if (saving_.valid()) saving_.wait();
    saving_ = {};
    file_ = partsOfEdits(scene);
    held_ = editsOf(scene);
    nodes_.clear();
    for (const Light& light : scene.lights)
        nodes_[placeOf(light)] = light.node;
}

void SceneFile::number(std::vector<Light>& lights) {
    for (Light& light : lights)
        if (light.node == -1) light.node = --lastNumber_;
}

namespace {

// Preview light is in no file.
std::vector<Light> ownLights(const std::vector<Light>& lights) {
    std::vector<Light> own;
    std::copy_if(lights.begin(), lights.end(), std::back_inserter(own),
                 [](const Light& light) { return !light.preview; });
    return own;
}

SkySettings ownSky(const SkySettings& sky) {
    return sky.preview ? SkySettings{} : sky;
}

void dropPreview(Scene& scene) {
    scene.lights = ownLights(scene.lights);
    if (scene.sky.preview) scene.sky = {};
}

} // namespace

bool SceneFile::differs(const SceneEdits& edits) const {
    const auto sameMaterial = [](const Material& a, const Material& b) {
        return a.emission == b.emission && a.baseColor == b.baseColor;
    };
    return ownLights(edits.lights) != ownLights(held_.lights) || ownSky(edits.sky) != ownSky(held_.sky) ||
           !std::equal(edits.materials.begin(), edits.materials.end(), held_.materials.begin(),
                       held_.materials.end(), sameMaterial) ||
           edits.placements != held_.placements;
}

// Returns the file's node of a light, or -1. A light that became one of another kind stays in the node it
// had.
int SceneFile::fileNode(const Light& light) const {
    const Place place = placeOf(light);
    for (const bool area : {place.second, !place.second})
        if (const auto found = nodes_.find({place.first, area}); found != nodes_.end()) return found->second;
    return -1;
}

void SceneFile::save(const std::string& path, const SceneEdits& edits) {
    ASSERT(!saving());
    pending_ = edits;
    Scene after = file_; // its instances have their nodes
    applyEdits(after, edits);
    for (Light& light : after.lights)
        light.node = fileNode(light);
    dropPreview(after);
    Scene before = file_;
    dropPreview(before);
    saving_ = std::async(std::launch::async, [before = std::move(before), after = std::move(after), path] {
        Result result;
        result.nodes = saveEditedGltf(before.path, before, after, path);
        std::error_code code;
        const auto time = std::filesystem::last_write_time(path, code);
        result.saved.path = path;
        if (!code) result.saved.time = time;
        return result;
    });
}

std::optional<SceneFile::Saved> SceneFile::update() {
    if (!saving_.valid() || saving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return std::nullopt;
    const Result result = saving_.get();
    keep(result);
    return result.saved;
}

void SceneFile::wait() const {
    if (saving_.valid()) saving_.wait();
}

void SceneFile::keep(const Result& result) {
    file_.path = result.saved.path;
    applyEdits(file_, pending_);
    for (size_t i = 0; i < file_.instances.size(); ++i)
        file_.instances[i].node = result.nodes.instances[i];
    std::set<int> taken(result.nodes.lights.begin(), result.nodes.lights.end());
    // A deleted light may come back to its node, unless another light has that now.
    std::erase_if(nodes_, [&](const auto& entry) { return taken.contains(entry.second); });
    size_t saved = 0; // of the lights that the file has
    for (size_t i = 0; i < file_.lights.size(); ++i) {
        if (file_.lights[i].preview) continue;
        const int node = result.nodes.lights[saved++];
        nodes_[placeOf(pending_.lights[i])] = node;
        file_.lights[i].node = node;
    }
    held_ = std::move(pending_);
}

} // namespace relume
