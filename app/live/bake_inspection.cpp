#include "app/live/bake_inspection.h"

#include "bake/base/local_error.h"
#include "bake/layers/layer_solver.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace relume {
namespace {

// The ends of so many directions are shown as paths.
constexpr uint32_t kPaths = 64;

} // namespace

bool follows(MapContent content) {
    return content == MapContent::LigIn || content == MapContent::LigOut || content == MapContent::Leaves ||
           content == MapContent::Error || content == MapContent::Layer;
}

bool isPlain(MapContent content) {
    return content == MapContent::Normal || content == MapContent::Material ||
           content == MapContent::Leaves || content == MapContent::Seen;
}

ValueRange rangeOf(const PatchValues& values, const PatchSet& patches) {
    ValueRange range;
    for (uint32_t i = 0; i < patches.count; ++i) {
        const glm::vec4& v = values[i];
        range.low = i == 0 ? v.r : std::min(range.low, v.r);
        range.high = i == 0 ? v.r : std::max(range.high, v.r);
        range.largest = std::max({range.largest, std::abs(v.r), std::abs(v.g), std::abs(v.b)});
    }
    return range;
}

BakeInspection::BakeInspection(const vk::Device& device, Baker& baker, const SolverSettings& settings)
    : baker_(baker), settings_(settings), inspector_({.device = device,
                                                      .patches = baker.patches(),
                                                      .light = baker.light(),
                                                      .tracer = baker.tracer(),
                                                      .transport = settings.transport,
                                                      .links = settings.links}) {}

PatchValues BakeInspection::values(const InspectRequest& request) {
    switch (request.content) {
    case MapContent::LigIn:
        return inspector_.mip(inspector_.ligIn(), request.mip);
    case MapContent::LigOut:
        return inspector_.mip(inspector_.ligOut(), request.mip);
    case MapContent::Position:
        return inspector_.quantity(PatchQuantity::Position);
    case MapContent::Normal:
        return inspector_.quantity(PatchQuantity::Normal);
    case MapContent::Material:
        return inspector_.quantity(PatchQuantity::Albedo);
    case MapContent::Area:
        return inspector_.quantity(PatchQuantity::Area);
    case MapContent::Leaves:
        return leafColors(request.preview);
    case MapContent::Error:
        return errors();
    case MapContent::Seen:
        return seenFrom(request.texel);
    case MapContent::Layer:
        return layerOf(request);
    case MapContent::Light:
        break;
    }
    return nothing();
}

PatchValues BakeInspection::nothing() const {
    return PatchValues(baker_.patches().scene.patches.size(), glm::vec4(0.0f));
}

// Returns the local error of each patch: one standard deviation.
PatchValues BakeInspection::errors() const {
    std::vector<float> errors = baker_.solver().errors();
    if (errors.empty()) return nothing();
    const std::vector<glm::vec4>& light = baker_.solver().light();
    const std::vector<shader::Patch>& patches = baker_.patches().scene.patches;
    const auto brightness = [&](size_t i) { return (light[i].r + light[i].g + light[i].b) / 3.0f; };
    std::vector<float> shown;
    for (size_t i = 0; i < patches.size(); ++i)
        if (shader::patchIsShown(patches[i].flags)) shown.push_back(brightness(i));
    if (shown.empty()) return nothing();
    const auto middle = shown.begin() + static_cast<std::ptrdiff_t>(shown.size() / 2);
    std::nth_element(shown.begin(), middle, shown.end());
    const float floor = static_cast<float>(kLocalFloor) * *middle;
    for (size_t i = 0; i < errors.size(); ++i) {
        const float relativeTo = std::max(brightness(i), floor);
        errors[i] = relativeTo > 0.0f ? errors[i] / relativeTo : 0.0f;
    }
    return PatchInspector::grey(errors);
}

PatchValues BakeInspection::seenFrom(uint32_t texel) {
    const uint32_t patch = patchAt(texel);
    return patch == shader::kNoPatch ? nothing() : inspector_.seenFrom(patch);
}

// Returns one light's layer times its weight, for which no ray is traced. It is dark where the light has
// none.
PatchValues BakeInspection::layerOf(const InspectRequest& request) const {
    PatchValues values = nothing();
    const LayerSolver* solver = baker_.layers();
    if (solver == nullptr) return values;
    for (const std::unique_ptr<Layer>& layer : solver->layers()) {
        const Layer* shown = layer->source.key == request.light ? layer->shown() : nullptr;
        if (shown != nullptr) values = solver->layerLight(*shown);
    }
    for (glm::vec4& value : values)
        value = glm::vec4(glm::vec3(value) * request.weight, 0.0f);
    return values;
}

PatchValues BakeInspection::leafColors(const PairSettings& preview) {
    const PairSettings& own = settings_.method == Method::Adaptive ? settings_.pairs : preview;
    PatchValues leaves = inspector_.leaves(
        inspector_.ligIn(), {.node = own.node, .threshold = static_cast<float>(own.threshold)});
    for (glm::vec4& leaf : leaves)
        leaf.r = 0.5f * std::log2(std::max(leaf.r, 1.0f));
    return leaves;
}

uint32_t BakeInspection::patchAt(uint32_t texel) const {
    const uint32_t size = baker_.patches().scene.size;
    return texel < size * size ? inspector_.patchAt(texel % size, texel / size) : shader::kNoPatch;
}

std::optional<InspectPaths> BakeInspection::paths(uint32_t texel) {
    const uint32_t patch = patchAt(texel);
    if (patch == shader::kNoPatch) return std::nullopt;
    InspectPaths paths{.from = glm::vec3(baker_.patches().scene.patches[patch].position), .ends = {}};
    for (const PatchInspector::Link& link : inspector_.links(patch, kPaths))
        paths.ends.push_back(link.end);
    return paths;
}

InspectVoxels BakeInspection::voxels(uint32_t resolution) const {
    PatchInspector::Voxels voxels = inspector_.voxels(resolution);
    return {.edge = voxels.edge, .centres = std::move(voxels.centres)};
}

} // namespace relume
