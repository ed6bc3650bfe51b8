// This part of LayerSolver follows objects that move. Links and direct light are made anew where they may
// meet what moved, with the samples that they were made of; bounces are gathered again.
#include "bake/layers/layer_solver.h"

#include "assets/base/error.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

using Kind = LightKey::Kind;
using shader::kChunk;

// A light's box grows by more than rounding moves its points by, as a share of where it is.
constexpr float kRounding = 1e-5f;

LightPlace grown(LightPlace place) {
    const glm::vec3 reach = glm::max(glm::abs(place.lo), glm::abs(place.hi));
    const glm::vec3 margin(kRounding * std::max({reach.x, reach.y, reach.z}));
    place.lo -= margin;
    place.hi += margin;
    return place;
}

LightPlace placeOfLamp(const Light& light, float reach) {
    const glm::vec3 at(light.transform[3]);
    glm::vec3 extent(light.radius);
    if (light.type == LightType::Directional) {
        // This is where it comes from; chords across the disc are shorter than the angle.
        const glm::vec3 from = glm::normalize(glm::vec3(light.transform[2]));
        extent = glm::vec3(0.5f * light.angle);
        return grown({LightPlace::Kind::Directions, reach * (from - extent), reach * (from + extent)});
    }
    if (light.type == LightType::Rectangle)
        extent = 0.5f * (light.size.x * glm::abs(glm::normalize(glm::vec3(light.transform[0]))) +
                         light.size.y * glm::abs(glm::normalize(glm::vec3(light.transform[1]))));
    return grown({LightPlace::Kind::Box, at - extent, at + extent});
}

LightPlace placeOfEmitter(const WorldMesh& mesh, const LightPattern& pattern) {
    LightPlace place{LightPlace::Kind::Box, glm::vec3(1e30f), glm::vec3(-1e30f)};
    for (size_t corner = 0; corner < mesh.positions.size(); ++corner) {
        if (mesh.instance[corner / 3] != pattern.instance || mesh.material[corner / 3] != pattern.material)
            continue;
        place.lo = glm::min(place.lo, mesh.positions[corner]);
        place.hi = glm::max(place.hi, mesh.positions[corner]);
    }
    return grown(place);
}

} // namespace

void LayerSolver::moveObjects(const ObjectMove& move) {
    ASSERT(atRest());
    if (move.instances.empty()) return;
    if (!moved_) moved_.emplace();
    moved_->add(move);
}

// Renews everything that was made of the former scene; layers come after.
void LayerSolver::adoptMove() {
    if (!gatherPass_.onCpu() && !pool_) pool_ = std::make_unique<WorkerPool>(0);
    countSenders();
    reachMoved_ = lamps_.updateReach(input_.patches.scene.mesh);
    emitterGroups_.clear();
    distancesKnown_ = false;
    if (moved_->texels) {
        const std::vector<uint32_t>& map = input_.patches.scene.texelToPatch;
        vk::upload(input_.device, buffers_.texelToPatch, map.data(), map.size() * sizeof(map[0]));
    }
    Relink relink;
    // Where an object moved on, links of early sample passes have followed the moves before, or some of them.
    ObjectMove early = *moved_, late = *moved_;
    if (relink_) {
        relink.earlyRounds = std::max(relink_->round, relink_->earlyRounds);
        if (relink_->round < relink_->earlyRounds) early.add(relink_->early.move);
        late.add(relink_->late.move);
    }
    const auto path = [&](const ObjectMove& move) {
        return Path{move, vk::makeBuffer(input_.device, move.boxes, "boxes"),
                    vk::makeBuffer(input_.device, move.changed, "changed patches")};
    };
    if (relink.earlyRounds > 0) relink.early = path(early);
    relink.late = path(late);
    const uint64_t most = uint64_t{buffers_.batchChunks} * linksOfRound_ * kChunk;
    if (!input_.tracer.onCpu())
        relink.list =
            vk::Buffer(input_.device, {.size = (most + 1) * sizeof(uint32_t), .name = "links to trace"});
    relink_ = std::move(relink);
}

// Retraces a batch of the links that are kept.
void LayerSolver::relinkBatch() {
    Relink& relink = *relink_;
    const uint32_t chunks = input_.patches.chunkCount();
    if (relink.round < links_.rounds()) {
        const LinkCache::Place place = links_.find(relink.round, relink.chunk, chunks - relink.chunk);
        const double wanted = std::max(1.0, relink.rate.wanted(batchMs_));
        uint32_t count = place.count;
        if (place.known) {
            count = static_cast<uint32_t>(
                std::min<double>({wanted, double(count), double(buffers_.batchChunks)}));
            const auto start = Clock::now();
            const Path& path = relink.round < relink.earlyRounds ? relink.early : relink.late;
            const RetraceWork work{.closest = {.firstChunk = relink.chunk,
                                               .chunkCount = count,
                                               .firstSample = relink.round * linksOfRound_,
                                               .sampleCount = linksOfRound_,
                                               .rotation = settings_.links.rotation,
                                               .links = place.links,
                                               .linksOffset = place.offset},
                                   .boxes = &path.boxes,
                                   .boxCount = static_cast<uint32_t>(path.move.boxes.size()),
                                   .changed = &path.changed,
                                   .list = &relink.list,
                                   .rays = &buffers_.rays};
            VkCommandBuffer cmd = input_.tracer.records() ? commands_.begin() : VK_NULL_HANDLE;
            input_.tracer.retrace(cmd, work);
            if (input_.tracer.records()) run(cmd);
            relink.rate.note(count, batchMs_, secondsSince(start));
            progress_.traceSeconds += secondsSince(start);
        }
        relink.chunk += count;
        if (relink.chunk < chunks) return;
        relink.chunk = 0;
        if (++relink.round < links_.rounds()) return;
    }
    VkCommandBuffer cmd = commands_.begin();
    recordRayCount(cmd);
    run(cmd);
    countRays();
    relink_.reset();
}

LightPlace LayerSolver::placeOf(const LightPattern& pattern) const {
    if (pattern.kind == Kind::Lamp) return placeOfLamp(pattern.light, lamps_.reach());
    if (pattern.kind == Kind::Emitter) return placeOfEmitter(input_.patches.scene.mesh, pattern);
    return {};
}

// Returns 1 for those chunks whose direct light of one light may change with what moved.
std::vector<uint8_t> LayerSolver::chunksOf(const LightPattern& pattern) const {
    const std::vector<uint32_t>& moved = moved_->instances;
    const bool far = pattern.kind == Kind::Sky ||
                     (pattern.kind == Kind::Lamp && pattern.light.type == LightType::Directional);
    const bool itself = pattern.kind == Kind::Emitter &&
                        std::find(moved.begin(), moved.end(), pattern.instance) != moved.end();
    if (itself || (far && reachMoved_)) return std::vector<uint8_t>(input_.patches.chunkCount(), 1);
    return chunksReached(gatherPass_.onCpu() ? gatherPass_.pool() : *pool_, input_.patches, placeOf(pattern),
                         *moved_);
}

// Takes over what is dirty along with direct light from another layer of this light.
void LayerSolver::keepStale(const Layer& from, Layer& to) const {
    to.stale = from.stale;
    to.begun = from.begun;
    if (!moved_) return;
    to.stale.resize(input_.patches.chunkCount(), 0);
    const auto add = [&](const LightPattern& pattern) {
        const std::vector<uint8_t> reached = chunksOf(pattern);
        for (size_t i = 0; i < reached.size(); ++i)
            if (reached[i] != 0) to.stale[i] = Layer::kStale;
    };
    if (to.pattern.kind != Kind::Group) add(to.pattern);
    for (const LightPattern& member : to.pattern.members)
        add(member);
    growToParts(to.stale);
    to.begun = to.begun && std::find(to.stale.begin(), to.stale.end(), Layer::kStale) == to.stale.end();
    if (std::count(to.stale.begin(), to.stale.end(), 0) == std::ssize(to.stale)) to.stale.clear();
}

// Marks neighbours of what is dirty, too, as it decides on their sample passes.
void LayerSolver::growToParts(std::vector<uint8_t>& stale) const {
    std::vector<uint8_t> parts(parts_.count, 0);
    for (uint32_t i = 0; i < stale.size(); ++i)
        if (stale[i] == Layer::kStale) parts_.mark(i, parts);
    for (uint32_t i = 0; i < stale.size(); ++i) {
        if (stale[i] == 0 && parts_.any(i, parts)) stale[i] = Layer::kBeside;
        if (stale[i] == Layer::kBegun && parts_.any(i, parts)) stale[i] = Layer::kBesideBegun;
    }
}

// Begins to repair direct light of dirty chunks, with the same sample passes in the same steps as that of all
// others. Meanwhile ligOut, which nobody else needs, holds the layer's direct light.
void LayerSolver::beginMending() {
    Layer& layer = *layers_[work_->layer];
    if (raysOf(layer) == 0) return endMending(); // nothing in it shines
    work_->mended = layer.begun ? 1 : 0;
    work_->round = layer.begun ? layer.directSteps.front() : 0;
    if (layer.begun) {
        VkCommandBuffer cmd = commands_.begin();
        recordCopy(cmd, *layer.direct, input_.light.ligOut, mendedRanges(layer));
        run(cmd);
        setPenumbra(layer); // else the first sample pass finds it
    }
    beginPass(Stage::Direct);
    if (!seekRound()) endMendingStep();
}

std::vector<ChunkRange> LayerSolver::mendedRanges(const Layer& layer) {
    std::vector<uint8_t> mends(layer.stale.size());
    for (size_t i = 0; i < mends.size(); ++i)
        mends[i] = layer.mends(i);
    return rangesOf(mends, true);
}

void LayerSolver::endMendingStep() {
    Layer& layer = *layers_[work_->layer];
    const uint32_t step = *work_->mended;
    const uint32_t before = step > 0 ? layer.directSteps[step - 1] : 0;
    VkCommandBuffer cmd = commands_.begin();
    recordPenumbraUpload(cmd);
    vk::barrier(cmd);
    const uint32_t rounds = std::exchange(layer.directRounds, before);
    auto kept = std::exchange(layer.direct, std::make_shared<vk::Buffer>(std::move(input_.light.ligOut)));
    layerPass_.recordDirect(cmd, input_.light, layer, buffers_.directSums, penumbra_, work_->round - before);
    input_.light.ligOut = std::move(*layer.direct);
    layer.direct = std::move(kept); // a second owner would make it a copy
    layer.directRounds = rounds;
    work_->mended = step + 1;
    work_->begun = false;
    const bool last = step + 1 == layer.directSteps.size();
    const bool some = std::find(layer.stale.begin(), layer.stale.end(), Layer::kBegun) != layer.stale.end();
    const bool pauses = !last && step == 0 && (some || wantsSum());
    if (!last && !pauses) {
        run(cmd);
        if (!seekRound()) endMendingStep();
        return;
    }
    vk::barrier(cmd);
    const std::shared_ptr<vk::Buffer> shared = recordOwnDirect(cmd, layer);
    vk::barrier(cmd);
    recordCopy(cmd, input_.light.ligOut, *layer.direct, mendedRanges(layer));
    recordRayCount(cmd);
    run(cmd);
    countRays();
    if (last) return endMending();
    std::replace(layer.stale.begin(), layer.stale.end(), Layer::kStale, Layer::kBegun);
    layer.begun = true;
    sumDue_ = canSum();
    work_.reset();
}

// Ends a repair. A viewer gets the first step of all direct light first, then all of it, and the sum of all
// lights after either.
void LayerSolver::endMending() {
    const Work work = *work_;
    const bool outdated = layers_[work.layer]->isOutdated();
    layers_[work.layer]->stale.clear();
    layers_[work.layer]->begun = false;
    const bool more = staleLayer().has_value();
    sumDue_ = canSum() && (outdated || !more);
    if (more || sumDue_ || sumShown_ || relink_) return work_.reset();
    begin(work.layer, work.target, work.directAlone);
}

// Returns a layer whose direct light is to be repaired before any layer goes on, those whose repair has not
// begun first; nothing where there is none or nobody looks.
std::optional<size_t> LayerSolver::staleLayer() const {
    std::optional<size_t> stale;
    for (size_t i = 0; settings_.live && i < layers_.size(); ++i) {
        const Layer& layer = *layers_[i];
        if (layer.source.weight == glm::vec3(0.0f) || layer.stale.empty()) continue;
        if (layer.isOutdated()) return i;
        if (!stale) stale = i;
    }
    return stale;
}

} // namespace relume
