#include "bake/layers/layer_lights.h"

#include "assets/base/clock.h"
#include "bake/gather/sky_links.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

using Kind = LightKey::Kind;

} // namespace

LayerLights::LayerLights(LinkKit& kit)
    : kit_(kit), emitters_(kit.input.device, kit.input.patches,
                           {.links = kPoints, .allOver = kit.settings.links.allOver, .lightByLight = true}),
      lamps_(kit.input.device, kit.input.scene, kit.input.patches,
             {.samples = kPoints, .chosen = true, .allOver = kit.settings.links.allOver}) {}

bool LayerLights::follow() {
    emitterGroups_.clear();
    return lamps_.updateReach(kit_.input.patches.scene.mesh);
}

size_t LayerLights::emitterCount() const {
    size_t count = 0;
    for (const EmitterGroup& group : emitterGroups_)
        count += group.choices.size();
    return count;
}

void LayerLights::assign(const std::vector<std::unique_ptr<Layer>>& layers) {
    assignEmitters(layers);
    const Scene& scene = kit_.input.scene;
    std::vector<LampChoice> lamps;
    const auto choose = [&](const LightKey& key, const glm::vec3& color, uint32_t layer) {
        if (key.kind == Kind::Lamp) lamps.push_back({key.index, color, layer});
        if (key.kind == Kind::Sky && !linksMaySeeSky(scene.sky, kit_.settings))
            lamps.push_back({static_cast<uint32_t>(scene.lights.size()), color, layer});
    };
    uint32_t emitters = 0; // groups of layers before
    for (uint32_t i = 0; i < layers.size(); ++i) {
        Layer& layer = *layers[i];
        layer.parts.clear();
        bool shines = layer.source.key.kind == Kind::Emitter;
        choose(layer.source.key, glm::vec3(1.0f), i);
        for (const LightSource& member : layer.members) {
            if (member.weight == glm::vec3(0.0f)) continue;
            choose(member.key, member.weight, i);
            shines = shines || member.key.kind == Kind::Emitter;
        }
        if (!shines) continue;
        layer.parts.push_back({.emitters = true,
                               .group = emitters,
                               .rays = emitters_.rays(emitters),
                               .picks = emitters_.picks(emitters)});
        ++emitters;
    }
    lamps_.update(scene, lamps);
    for (uint32_t i = 0; i < layers.size(); ++i)
        for (const uint32_t group : lamps_.groupsOf(i))
            layers[i]->parts.push_back({.emitters = false, .group = group, .rays = lamps_.rays(group)});
}

glm::vec3 LayerLights::skyOfLinks(const Layer& layer) const {
    glm::vec3 sky(0.0f);
    if (!linksMaySeeSky(kit_.input.scene.sky, kit_.settings)) return sky;
    if (layer.source.key.kind == Kind::Sky) sky = glm::vec3(1.0f);
    for (const LightSource& member : layer.members)
        if (member.key.kind == Kind::Sky) sky += member.weight;
    return sky;
}

// Makes one group for each layer with mesh lights, in the layers' order.
void LayerLights::assignEmitters(const std::vector<std::unique_ptr<Layer>>& layers) {
    std::vector<EmitterGroup> groups;
    for (const std::unique_ptr<Layer>& layer : layers) {
        std::vector<EmitterChoice> choices;
        if (layer->source.key.kind == Kind::Emitter) choices.push_back({layer->source.key});
        for (const LightSource& member : layer->members)
            if (member.key.kind == Kind::Emitter && member.weight != glm::vec3(0.0f))
                choices.push_back({member.key, member.weight});
        if (!choices.empty()) groups.push_back({std::move(choices), {}});
    }
    const auto same = [](const EmitterGroup& a, const EmitterGroup& b) { return a.choices == b.choices; };
    if (std::equal(groups.begin(), groups.end(), emitterGroups_.begin(), emitterGroups_.end(), same)) return;
    const TraceScene& scene = kit_.input.patches.scene;
    std::vector<EmitterSet> sets;
    for (EmitterGroup& group : groups) {
        const auto known = std::find_if(emitterGroups_.begin(), emitterGroups_.end(),
                                        [&](const EmitterGroup& other) { return same(group, other); });
        group.set =
            known != emitterGroups_.end()
                ? std::move(known->set)
                : buildEmitters(kit_.input.scene, scene.mesh, {.size = scene.size, .only = group.choices});
        sets.push_back(group.set);
    }
    emitters_.setGroups(sets);
    emitterGroups_ = std::move(groups);
}

bool LayerLights::onCpu(const DirectPart& part) const {
    return kit_.tracesOnCpu() && (part.emitters ? emitters_.onCpu(part.group) : lamps_.onCpu(part.group));
}

void LayerLights::traceOnCpu(const Portion& portion) {
    portion.part.emitters ? traceOnCpuWith(emitters_, portion) : traceOnCpuWith(lamps_, portion);
}

template<typename Lights>
typename Lights::Work LayerLights::workOf(const Portion& portion) {
    return {.group = portion.part.group,
            .samplePass = portion.samplePass / portion.together,
            .together = portion.together,
            .range = portion.range,
            .penumbra = portion.penumbra};
}

template<typename Lights>
void LayerLights::traceOnCpuWith(const Lights& lights, const Portion& portion) {
    note(lights.traceOnCpu(kit_.input.light, workOf<Lights>(portion),
                           {.pool = kit_.gatherPass.pool(),
                            .tracer = kit_.input.tracer,
                            .rays = kit_.buffers.rays,
                            .sums = kit_.buffers.directSums,
                            .direct = kit_.buffers.direct,
                            .newSums = portion.newSums}));
}

void LayerLights::note(const PointTimes& times) {
    kit_.progress.traceSeconds += times.trace;
    kit_.progress.gatherSeconds += times.gather;
}

void LayerLights::trace(VkCommandBuffer cmd, const Portion& portion,
                        const std::function<void(VkCommandBuffer)>& before) {
    portion.part.emitters ? traceWith(emitters_, cmd, portion, before)
                          : traceWith(lamps_, cmd, portion, before);
}

template<typename Lights>
void LayerLights::traceWith(Lights& lights, VkCommandBuffer cmd, const Portion& portion,
                            const std::function<void(VkCommandBuffer)>& before) {
    const typename Lights::Work work = workOf<Lights>(portion);
    const LightBuffers& light = kit_.input.light;
    const PointTracer on{kit_.commands, kit_.timestamps, kit_.input.tracer};
    const SegmentWork segments = lights.segments(light, work, kit_.buffers.rays);
    const auto samples = [&](VkCommandBuffer to) {
        before(to);
        lights.recordSamples(to, light, work);
    };
    const auto gather = [&](VkCommandBuffer to) {
        lights.recordGather(to, light, work, kit_.buffers.directSums, kit_.buffers.direct);
    };
    if (cmd != VK_NULL_HANDLE) return recordPoints(cmd, on, segments, samples, gather, portion.mark);
    note(tracePoints(on, segments, samples, gather));
}

} // namespace relume
