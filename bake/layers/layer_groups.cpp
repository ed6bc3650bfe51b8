// This part of LayerSolver decides which lights have a layer, and what the direct light of each is made of.
#include "bake/layers/layer_solver.h"

#include "assets/base/log.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

using Kind = LightKey::Kind;

constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;

// Returns for how many layers there is room: each has direct light and a result.
uint64_t roomFor(const PatchSet& patches, uint64_t bytes) {
    return bytes / (2 * LightBuffers::lightBytes(patches));
}

bool isGrouped(const std::unique_ptr<Layer>& layer) {
    return layer->source.key.kind == Kind::Group;
}

// Tells whether a light of this cache key is among those that shine in the group.
bool isIn(const LightPattern& group, LightPattern light) {
    light.surfaces = light.objects = 0; // the group has them
    return std::find(group.members.begin(), group.members.end(), light) != group.members.end();
}

} // namespace

std::string LayerSolver::problem(const Scene& scene, const PatchSet& patches, uint64_t bytes) {
    const size_t lights = lightSources(scene).size();
    const uint64_t room = roomFor(patches, bytes);
    if (lights <= room || room >= kLeastRoom) return "";
    const uint64_t needed = std::min<uint64_t>(lights, kLeastRoom) * 2 * LightBuffers::lightBytes(patches);
    return fmt::format(
        "layers of {} lights take {:.1f} GiB{}, {:.1f} may be taken: use a smaller lightmap, or "
        "bake without layers",
        lights, static_cast<double>(needed) / kGiB, lights > kLeastRoom ? " in groups" : "",
        static_cast<double>(bytes) / kGiB);
}

bool LayerSolver::holds(size_t lamps) const {
    size_t others = 1; // the sky
    for (const EmitterGroup& group : emitterGroups_)
        others += group.choices.size();
    return layerRoom() >= kLeastRoom || lamps + others <= layerRoom();
}

uint64_t LayerSolver::layerRoom() const {
    return roomFor(input_.patches, layerBytes_);
}

// Returns the layers that are wanted under the surfaces and objects that are known.
std::vector<LayerSolver::Wanted> LayerSolver::wantedLayers() const {
    std::vector<Wanted> wanted;
    const auto weigh = [&](LightSource& source) {
        if (!mix_.shines(source.key)) source.weight = glm::vec3(0.0f);
    };
    for (LightGroup& group : groupLights(input_.scene, lightSources(input_.scene), layerRoom())) {
        std::vector<LightSource>& members = group.members;
        for (LightSource& member : members)
            weigh(member);
        if (members.empty())
            weigh(group.source);
        else if (std::all_of(members.begin(), members.end(),
                             [](const LightSource& member) { return member.weight == glm::vec3(0.0f); }))
            group.source.weight = glm::vec3(0.0f);
        LightPattern pattern = patternOf(input_.scene, group);
        pattern.surfaces = surfaces_;
        pattern.objects = objects_;
        wanted.push_back({std::move(pattern), std::move(group.source), std::move(members)});
    }
    return wanted;
}

// Members of groups are weighed here; all others shine with 1.
void LayerSolver::updateParts() {
    updateEmitters();
    std::vector<LampChoice> lamps;
    const auto choose = [&](const LightKey& key, const glm::vec3& color, uint32_t layer) {
        if (key.kind == Kind::Lamp) lamps.push_back({key.index, color, layer});
        if (key.kind == Kind::Sky)
            lamps.push_back({static_cast<uint32_t>(input_.scene.lights.size()), color, layer});
    };
    uint32_t emitters = 0; // groups of layers before
    for (uint32_t i = 0; i < layers_.size(); ++i) {
        Layer& layer = *layers_[i];
        layer.parts.clear();
        bool shines = layer.source.key.kind == Kind::Emitter;
        choose(layer.source.key, glm::vec3(1.0f), i);
        for (const LightSource& member : layer.members) {
            if (member.weight == glm::vec3(0.0f)) continue;
            choose(member.key, member.weight, i);
            shines = shines || member.key.kind == Kind::Emitter;
        }
        if (shines) layer.parts.push_back({.emitters = true, .group = emitters++});
    }
    lamps_.update(input_.scene, lamps);
    for (uint32_t i = 0; i < layers_.size(); ++i)
        for (const uint32_t group : lamps_.groupsOf(i))
            layers_[i]->parts.push_back({.emitters = false, .group = group});
}

// Makes one group for each layer with mesh lights, in the layers' order.
void LayerSolver::updateEmitters() {
    std::vector<EmitterGroup> groups;
    for (const std::unique_ptr<Layer>& layer : layers_) {
        std::vector<EmitterChoice> choices;
        if (layer->source.key.kind == Kind::Emitter) choices.push_back({layer->source.key});
        for (const LightSource& member : layer->members)
            if (member.key.kind == Kind::Emitter && member.weight != glm::vec3(0.0f))
                choices.push_back({member.key, member.weight});
        if (!choices.empty()) groups.push_back({std::move(choices), {}});
    }
    const auto same = [](const EmitterGroup& a, const EmitterGroup& b) { return a.choices == b.choices; };
    if (std::equal(groups.begin(), groups.end(), emitterGroups_.begin(), emitterGroups_.end(), same)) return;
    const TraceScene& scene = input_.patches.scene;
    std::vector<EmitterSet> sets;
    for (EmitterGroup& group : groups) {
        const auto known = std::find_if(emitterGroups_.begin(), emitterGroups_.end(),
                                        [&](const EmitterGroup& other) { return same(group, other); });
        group.set =
            known != emitterGroups_.end()
                ? std::move(known->set)
                : buildEmitters(input_.scene, scene.mesh, {.size = scene.size, .only = group.choices});
        sets.push_back(group.set);
    }
    emitters_.setGroups(sets);
    emitterGroups_ = std::move(groups);
}

void LayerSolver::tellGroups() {
    std::string text;
    for (const std::unique_ptr<Layer>& layer : layers_)
        if (isGrouped(layer))
            text += fmt::format("{}'{}' ({} lights)", text.empty() ? "" : ", ", layer->source.name,
                                layer->members.size());
    if (text == std::exchange(toldGroups_, text) || text.empty()) return;
    const auto groups = std::count_if(layers_.begin(), layers_.end(), isGrouped);
    spdlog::info("layers: {} lights have their own, others share {}: there is memory for {} in all",
                 static_cast<long>(layers_.size()) - groups, text, layerRoom());
}

// Tells whether the layer's light is to come from other layers, where nobody wants it as it is.
bool LayerSolver::isRegrouped(const Layer& layer, const std::vector<Wanted>& wanted) {
    return layer.source.key.kind == Kind::Group ||
           std::any_of(wanted.begin(), wanted.end(),
                       [&](const Wanted& group) { return isIn(group.pattern, layer.pattern); });
}

// Tells which wanted layers have their light in groups that nobody took, or are new groups, which have it
// once they are baked.
std::vector<bool> LayerSolver::standsIn(const std::vector<Wanted>& wanted,
                                        const std::vector<std::unique_ptr<Layer>>& taken) const {
    std::vector<bool> covered;
    for (size_t i = 0; i < wanted.size(); ++i) {
        const LightPattern& pattern = wanted[i].pattern;
        const bool group = pattern.kind == Kind::Group;
        const bool among = std::any_of(layers_.begin(), layers_.end(), [&](const auto& layer) {
            const Layer* shown = layer->shown();
            const auto holds = [&](const LightPattern& light) { return isIn(shown->pattern, light); };
            return shown && (group ? std::any_of(pattern.members.begin(), pattern.members.end(), holds)
                                   : holds(pattern));
        });
        covered.push_back(among || (group && !taken[i]));
    }
    return covered;
}

// Keeps, where lights go into a group that had layers or come out of one, what was shown of them all until
// there are all the new layers: it cannot be told apart, nor may it grow dark. layers_ are those that nobody
// took. Returns which of the wanted ones it covers.
std::vector<bool> LayerSolver::beginStandIn(const std::vector<Wanted>& wanted,
                                            const std::vector<std::unique_ptr<Layer>>& taken) {
    std::vector<bool> covered = standsIn(wanted, taken);
    std::vector<shader::LayerWeight> list;
    bool regrouped = false;
    for (size_t i = 0; i < wanted.size(); ++i)
        regrouped = regrouped || (covered[i] && wanted[i].pattern.kind != Kind::Group);
    for (const std::unique_ptr<Layer>& layer : layers_) {
        const Layer* shown = layer->shown();
        if (!shown || layer->covered || layer->source.weight == glm::vec3(0.0f)) continue;
        bool joins = false;
        for (size_t i = 0; i < wanted.size(); ++i)
            joins = joins || (covered[i] && isIn(wanted[i].pattern, layer->pattern));
        regrouped = regrouped || joins;
        if (joins || isGrouped(layer))
            list.push_back({.light = shown->result.address(), .weight = layer->source.weight});
    }
    if (!regrouped) return std::vector<bool>(wanted.size(), false);
    if (standIn_) list.push_back({.light = standIn_.address(), .weight = glm::vec3(1.0f)});
    vk::Buffer sum = takeBuffer("light of lights grouped anew");
    const uint32_t count = writeWeights(list);
    VkCommandBuffer cmd = commands_.begin();
    layerPass_.recordMix(cmd, weights_, count, nullptr, sum);
    run(cmd);
    standIn_ = std::move(sum);
    return covered;
}

void LayerSolver::endStandIn() {
    if (!standIn_) return;
    for (const std::unique_ptr<Layer>& layer : layers_)
        if (layer->covered && !layer->has() && layer->source.weight != glm::vec3(0.0f)) return;
    standIn_ = vk::Buffer();
    restOf_.reset();
    for (size_t i = 0; i < layers_.size(); ++i) {
        layers_[i]->covered = false;
        changed(i);
    }
}

} // namespace relume
