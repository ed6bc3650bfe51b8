#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "bake/layers/layer_schedule.h"

namespace relume {

/// A bake that a viewer looks at, on a GPU. Sample passes have 4 points and 16 links, so that the sum of all
/// lights takes four of the links'. Each layer is to have an error by itself, so that what others are does
/// not matter.
inline ScheduleRules viewerRules() {
    return {.error = 0, .layerError = 0.01, .live = true, .together = true};
}

/// A bake without a viewer, on a GPU.
inline ScheduleRules offlineRules() {
    return {.error = 0, .layerError = 0.01, .together = true};
}

/// Says in plain words what a schedule knows of a layer. There are no buffers behind it.
class LayerFacts {
public:
    LayerFacts() {
        layer_->source.weight = glm::vec3(1.0f);
        layer_->light = 1;
    }

    LayerFacts& switchedOff() { return weighing(0); }
    LayerFacts& weighing(float weight) { return weighing(glm::vec3(weight)); }
    LayerFacts& weighing(const glm::vec3& weight) {
        layer_->source.weight = weight;
        return *this;
    }
    LayerFacts& lit(uint32_t samplePasses) {
        layer_->directSamplePasses = samplePasses;
        layer_->directSteps = {samplePasses};
        return *this;
    }
    LayerFacts& at(LayerLevel level) {
        layer_->level = level;
        layer_->directVariance = layer_->indirectVariance = 1;
        layer_->iterationError = 0;
        return lit(level.directSamplePasses).off(0.02);
    }
    /// Takes how far the level is off, and which share of that later bounces would still bring.
    LayerFacts& off(double error, double iteration = 0) {
        layer_->error = error;
        layer_->iterationError = iteration;
        return *this;
    }
    LayerFacts& noise(double direct, double indirect) {
        layer_->directVariance = direct;
        layer_->indirectVariance = indirect;
        return *this;
    }
    LayerFacts& sketch(std::vector<glm::vec3> entries) {
        layer_->sketch.entries = std::move(entries);
        return *this;
    }
    LayerFacts& shedding(double light) {
        layer_->light = light;
        return *this;
    }
    LayerFacts& redo(LayerLevel level, std::vector<uint32_t> steps = {}) {
        layer_->redo = level;
        layer_->redoSteps = std::move(steps);
        return *this;
    }
    LayerFacts& converged() {
        layer_->plan.converged = true;
        return *this;
    }
    /// Its bounces would have gone on, had nobody waited for them.
    LayerFacts& hasty() {
        layer_->plan.hasty = true;
        return *this;
    }
    /// Direct light is somewhere of where objects were.
    LayerFacts& outdated() {
        layer_->dirty = {0, Layer::kDirty};
        return *this;
    }
    /// It is of where objects were only beside what is anew.
    LayerFacts& beside() {
        layer_->dirty = {0, Layer::kBeside};
        return *this;
    }
    /// Its first step has been made anew everywhere.
    LayerFacts& begun() {
        layer_->dirty = {0, Layer::kBegun};
        layer_->begun = true;
        return *this;
    }
    LayerFacts& rays(std::vector<uint32_t> ofParts) {
        for (const uint32_t rays : ofParts)
            layer_->parts.push_back({.rays = rays});
        return *this;
    }
    LayerFacts& penumbra(std::vector<uint8_t> parts) {
        layer_->penumbra = std::move(parts);
        return *this;
    }
    LayerFacts& lamp(LightType type) {
        layer_->cacheKey.kind = LightKey::Kind::Lamp;
        layer_->cacheKey.light.type = type;
        return *this;
    }
    LayerFacts& group() {
        layer_->source.key.kind = LightKey::Kind::Group;
        return *this;
    }

    std::unique_ptr<Layer> make() { return std::move(layer_); }

private:
    std::unique_ptr<Layer> layer_ = std::make_unique<Layer>();
};

/// Layers that have nothing, that have direct light, that have a level.
inline LayerFacts fresh() {
    return {};
}
inline LayerFacts lit(uint32_t samplePasses) {
    return std::move(LayerFacts().lit(samplePasses));
}
inline LayerFacts at(uint32_t directSamplePasses, uint32_t linkSamplePasses) {
    return std::move(LayerFacts().at({directSamplePasses, linkSamplePasses}));
}

template<typename... Facts>
LayerSchedule::Layers layersOf(Facts&&... facts) {
    LayerSchedule::Layers layers;
    (layers.push_back(facts.make()), ...);
    return layers;
}

/// Holds what is under way, in plain words.
struct Now : ScheduleState {
    Now& sumDue() {
        sum.due = true;
        return *this;
    }
    Now& sumShown() {
        sum.shown = true;
        return *this;
    }
    Now& notSeen() {
        unseen = true;
        return *this;
    }
    Now& relinking(uint32_t samplePass) {
        relinkSamplePass = samplePass;
        return *this;
    }
    Now& makingSum() {
        job = SumJob();
        return *this;
    }
    Now& makingFirstLevel() {
        job = LayerJob{false};
        return *this;
    }
    Now& makingLaterLevel() {
        job = LayerJob{true};
        return *this;
    }
};

/// Tells a level as "8+4": sample passes of direct light and of links.
inline std::string textOf(LayerLevel level) {
    return std::to_string(level.directSamplePasses) + "+" + std::to_string(level.linkSamplePasses);
}

/// Tells a step as "layer 1 to 8+4" or "direct light of 1 to 8+4".
inline std::string textOf(const LayerSchedule::Step& step) {
    if (std::holds_alternative<LayerSchedule::Done>(step)) return "done";
    if (std::holds_alternative<LayerSchedule::Relink>(step)) return "relink";
    if (std::holds_alternative<LayerSchedule::Continue>(step)) return "continue";
    if (std::holds_alternative<LayerSchedule::BeginSum>(step)) return "sum";
    const auto& begin = std::get<LayerSchedule::BeginLayer>(step);
    return (begin.directAlone ? "direct light of " : "layer ") + std::to_string(begin.layer) + " to " +
           textOf(begin.target);
}

/// Has the schedule decide how far layers go, but leaves those alone of which a test says whether they go on.
inline void apportion(const ScheduleRules& rules, const LayerSchedule::Layers& layers) {
    std::vector<bool> converged;
    for (const std::unique_ptr<Layer>& layer : layers)
        converged.push_back(layer->plan.converged);
    LayerSchedule(rules).apportion(layers);
    for (size_t i = 0; i < layers.size(); ++i)
        layers[i]->plan.converged = converged[i];
}

inline std::string stepOf(const ScheduleRules& rules, const LayerSchedule::Layers& layers,
                          const ScheduleState& state = Now()) {
    apportion(rules, layers);
    return textOf(LayerSchedule(rules).next(layers, state));
}

/// Names a case of a table after its first field.
struct CaseName {
    template<typename Info>
    std::string operator()(const Info& info) const {
        return info.param.name;
    }
};

} // namespace relume
