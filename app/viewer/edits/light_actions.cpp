#include "app/viewer/edits/light_actions.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

constexpr float kStrengthKeyStep = 1.18920712f; // of a key press, 2^(1/4)
constexpr LightKey kSkyKey{LightKey::Kind::Sky, 0, 0};

} // namespace

std::variant<LightChange, std::string> changedLight(const Document& document, const LightSource& source,
                                                    Action action, int argument) {
    const LightKey& key = source.key;
    LightChange change{.name = "", .next = document, .selected = key};
    const bool power =
        action == Action::SoloLight || action == Action::MuteLight || action == Action::LightStrength;
    if (!power && key.kind != LightKey::Kind::Lamp)
        return source.name + ": only lights without geometry can be copied and deleted";
    switch (action) {
    case Action::SoloLight:
        toggle(change.next.mix.solo, key);
        change.name = "Solo of " + source.name;
        break;
    case Action::MuteLight:
        toggle(change.next.mix.muted, key);
        change.name = "Mute of " + source.name;
        break;
    case Action::LightStrength: {
        LightPower changed = powerOf(change.next.edits, key);
        changed.intensity *= argument > 0 ? kStrengthKeyStep : 1.0f / kStrengthKeyStep;
        setPower(change.next.edits, key, changed);
        change.name = "Intensity of " + source.name;
        break;
    }
    case Action::DuplicateLight:
        change.selected = duplicateLamp(change.next, key.index);
        change.name = "Duplicate " + source.name;
        break;
    default: // DeleteLight
        eraseLamp(change.next, key.index);
        change.selected.reset();
        change.name = "Delete " + source.name;
    }
    return change;
}

std::optional<LightChange> addedLight(const Document& document, int what, const LightSpot& spot) {
    LightChange change{.name = "", .next = document, .selected = kSkyKey};
    if (what != kAddSky) {
        change.selected = addLamp(change.next, makeLight(static_cast<LightType>(what), spot));
        change.name = "Add " + change.next.edits.lights.back().name;
        return change;
    }
    SkySettings& sky = change.next.edits.sky;
    if (sky.radiance != glm::vec3(0.0f)) return std::nullopt;
    sky = makeSky(sky, spot);
    change.name = "Add sky";
    return change;
}

LightChange skyWithPicture(const Document& document, const std::string& file) {
    LightChange change{.name = "Picture of the sky", .next = document, .selected = kSkyKey};
    SkySettings& sky = change.next.edits.sky;
    if (sky.file.empty() || sky.radiance == glm::vec3(0.0f)) sky.radiance = glm::vec3(1.0f);
    sky.file = file;
    return change;
}

std::optional<LightChange> skyWithoutPicture(const Document& document, const LightSpot& spot) {
    LightChange change{.name = "Sky without a picture", .next = document, .selected = kSkyKey};
    SkySettings& sky = change.next.edits.sky;
    if (sky.file.empty()) return std::nullopt;
    sky.file.clear();
    sky.rotation = 0.0f;
    if (sky.radiance != glm::vec3(0.0f)) sky = makeSky(sky, spot); // it was the picture's factor
    return change;
}

std::optional<LightKey> lightBeside(const std::vector<LightSource>& sources,
                                    const std::optional<LightKey>& selected, int step) {
    if (sources.empty()) return std::nullopt;
    const auto count = static_cast<int>(sources.size());
    const auto found = std::find_if(sources.begin(), sources.end(),
                                    [&](const LightSource& source) { return selected == source.key; });
    const int before =
        found == sources.end() ? (step > 0 ? -1 : 0) : static_cast<int>(found - sources.begin());
    return sources[static_cast<size_t>((before + step + count) % count)].key;
}

ShiningScene shiningScene(const Document& document, const std::vector<LightSource>& sources,
                          const std::optional<LightKey>& alone, const std::vector<LightGroup>& groups) {
    const LightGroup* group = alone ? groupWith(groups, *alone) : nullptr;
    const auto shines = [&](const LightKey& key) {
        if (alone && group == nullptr) return key == *alone;
        return (group == nullptr || groupWith(groups, key) == group) && document.mix.shines(key);
    };
    ShiningScene scene{.materials = document.edits.materials, .sky = document.edits.sky};
    std::vector<bool> bright(scene.materials.size(), false), lights(scene.materials.size(), false);
    for (const LightSource& source : sources) {
        if (source.key.kind != LightKey::Kind::Emitter) continue;
        lights[source.key.material] = true;
        if (shines(source.key)) bright[source.key.material] = true;
    }
    for (size_t i = 0; i < scene.materials.size(); ++i)
        if (lights[i] && !bright[i]) scene.materials[i].emission = glm::vec3(0.0f);
    if (!shines(kSkyKey)) scene.sky.radiance = glm::vec3(0.0f);
    return scene;
}

} // namespace relume
