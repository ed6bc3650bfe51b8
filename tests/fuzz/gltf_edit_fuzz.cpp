// What is edited and saved can be read again, with what the edits made.
#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "assets/gltf/edit/gltf_edit.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/gltf_corpus.h"

#include <optional>

namespace relume::fuzz {

std::vector<std::string> corpus() {
    return gltfCorpus();
}

namespace {

std::optional<Scene> loaded(const std::string& path) {
    try {
        return loadGltf(path);
    } catch (const Error&) {
        return std::nullopt; // the other target looks at that
    }
}

Scene edited(const Scene& scene) {
    Scene after = scene;
    for (Instance& instance : after.instances)
        instance.transform[3].x += 1.0f;
    if (after.instances.size() > 1) after.instances.front().hidden = !after.instances.front().hidden;
    for (Material& material : after.materials) {
        material.baseColor = {0.25f, 0.5f, 0.75f, 1.0f};
        material.emission = {3.0f, 2.0f, 1.0f};
    }
    if (!after.lights.empty()) after.lights.pop_back();
    for (Light& light : after.lights) {
        light.intensity = 7.0f;
        light.transform[3].y = 2.0f;
    }
    after.lights.push_back({.name = "New", .intensity = 5.0f});
    after.sky.radiance = {1.0f, 2.0f, 3.0f};
    return after;
}

} // namespace
} // namespace relume::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace relume;
    const std::string ending = fuzz::endingOfGltf(data, size), path = fuzz::asFile(data, size, ending);
    const std::optional<Scene> before = fuzz::loaded(path);
    if (!before) return 0;
    const Scene after = fuzz::edited(*before);
    const std::string target = fuzz::besideInputs("edited" + ending);
    try {
        saveEditedGltf(path, *before, after, target);
    } catch (const Error& error) {
        fuzz::checkMessage(error, path);
        return 0;
    }
    const std::optional<Scene> read = fuzz::loaded(target);
    fuzz::check(read.has_value(), "an edited file cannot be read");
    fuzz::check(read->lights.size() == after.lights.size(), "a light is lost or too many");
    fuzz::check(read->instances.size() == after.instances.size(), "an object is lost or too many");
    fuzz::check(read->lights.back().intensity == 5.0f, "a new light is not as bright as it was made");
    return 0;
}
