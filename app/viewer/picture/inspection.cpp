#include "app/viewer/picture/inspection.h"

#include "app/viewer/state/views.h"

#include <utility>

namespace relume {
namespace {

constexpr double kTilesEvery = 0.2; // [s] while the camera moves

bool bakes(BakeStatus::Phase phase) {
    return phase == BakeStatus::Phase::Baking || phase == BakeStatus::Phase::Paused ||
           phase == BakeStatus::Phase::Done;
}

} // namespace

std::optional<InspectRequest> inspectionOf(const ViewState& view, const LightList& lights,
                                           const std::vector<LightGroup>& groups) {
    const ViewEntry& entry = viewEntries()[view.view];
    InspectRequest request;
    if (entry.readsMap) request.content = entry.content;
    if (hasMips(request.content)) request.mip = view.mip;
    if (request.content == MapContent::Layer) {
        const LightSource* source = view.light ? lights.find(*view.light) : nullptr;
        if (source == nullptr) return std::nullopt;
        if (const LightGroup* group = groupWith(groups, source->key)) source = &group->source;
        request.light = source->key;
        request.weight = source->weight;
    }
    if (request.content == MapContent::Leaves) request.preview = view.preview;
    if (request.content == MapContent::Seen) {
        if (!view.seenTexel) return std::nullopt;
        request.texel = *view.seenTexel;
    }
    return request;
}

bool Inspection::follow(const BakeStatus& status, const LightList& lights, double time) {
    const std::optional<InspectRequest> wanted = inspectionOf(picture_.state(), lights, status.groups);
    if (wanted && *wanted != asked_) {
        asked_ = *wanted;
        bake_.inspect(asked_);
    }
    const bool ballsChanged = balls_.follow();
    readout_.follow();
    const bool changed = takeAnswers() || ballsChanged;
    if (bakes(status.phase) && picture_.pane().hasScene()) askBesideMaps(status, time);
    return changed;
}

bool Inspection::takeAnswers() {
    const std::optional<InspectPaths> paths = bake_.takePaths();
    if (paths) picture_.pane().setPaths(*paths);
    const std::optional<InspectVoxels> voxels = bake_.takeVoxels();
    if (voxels) picture_.pane().setVoxels(*voxels);
    return paths || voxels;
}

void Inspection::askBesideMaps(const BakeStatus& status, double time) {
    const ViewState& view = picture_.state();
    const bool another = askedBake_ != status.bake;
    if (viewEntries()[view.view].voxels && (another || askedVoxels_ != view.voxels)) {
        askedVoxels_ = view.voxels;
        bake_.askVoxels(askedVoxels_);
    }
    if (std::optional<std::vector<uint32_t>> tiles = picture_.pane().seenTiles()) {
        seen_ = tiles->size();
        bake_.setSeenTiles(std::move(*tiles));
    }
    const bool moved = picture_.movedAt() > tilesAsked_;
    if (another || (moved && (picture_.rests(time) || time - tilesAsked_ > kTilesEvery))) {
        tilesAsked_ = time;
        picture_.pane().askTiles(picture_.look());
    }
    askedBake_ = status.bake;
}

bool Inspection::asksFor(const PublishedMap& map) const {
    return map.content == asked_.content && map.light == asked_.light;
}

} // namespace relume
