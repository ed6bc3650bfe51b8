#include "bake/layers/direct_job.h"

#include "assets/base/clock.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace relume {
namespace {

// A submit, or what a GPU waits for between two batches, takes as long as rays from about so many chunks:
// chunks in smaller gaps come along with those around them. In sample passes of penumbrae alone these have
// hardly any rays.
constexpr uint32_t kGap = 256, kPenumbraGap = 2048;

} // namespace

DirectJob::End DirectJob::begin(bool pauses) {
    tools_->penumbra.drop(); // what was aborted had set
    if (!layer_->dirty.empty()) return beginRepair(pauses);
    samplePass_ = layer_->directSamplePasses;
    if (samplePass_ >= target_.directSamplePasses) return End::Made;
    const bool dark = layer_->rays() == 0;
    if (dark) {
        layer_->penumbra.assign(tools_->penumbra.parts().count, 0);
        layer_->redoSteps.clear();
    }
    if (samplePass_ > 0 || dark) setPenumbra(); // else the first sample pass finds it
    beginPass();
    return dark || !seekSamplePass() ? endStep(tools_->kit.commands.begin()) : End::NotYet;
}

// Begins to repair direct light of dirty chunks, with the same sample passes in the same steps as that of all
// others. Meanwhile ligOut, which nobody else needs, holds the layer's direct light.
DirectJob::End DirectJob::beginRepair(bool pauses) {
    if (layer_->rays() == 0) return End::Repaired;
    LinkKit& kit = tools_->kit;
    repairStep_ = layer_->begun ? 1 : 0;
    samplePass_ = layer_->begun ? layer_->directSteps.front() : 0;
    if (layer_->begun) {
        VkCommandBuffer cmd = kit.commands.begin();
        recordCopy(cmd, *layer_->direct, kit.input.light.ligOut, rangesOf(repairedMarks(), true));
        kit.run(cmd);
        setPenumbra(); // else the first sample pass finds it
    }
    beginPass();
    return seekSamplePass() ? End::NotYet : endRepairStep(pauses);
}

void DirectJob::beginPass() {
    begun_ = false;
    tools_->kit.beginPass();
}

// A sample pass goes over the parts of the layer one by one. Tracers that record take as much of a step in
// one submit as fits, for what comes next is known but for the first sample pass.
DirectJob::End DirectJob::batch(bool pauses) {
    LinkKit& kit = tools_->kit;
    BatchRate& rate = tools_->rate;
    const bool records = !kit.input.tracer.onCpu();
    const auto start = Clock::now();
    const double most = rate.wanted(kit.batchMs);
    VkCommandBuffer cmd = records ? kit.commands.begin() : VK_NULL_HANDLE;
    if (records) kit.timestamps.reset(cmd);
    double done = 0;
    uint32_t portions = 0;
    bool more = true;
    while (more) {
        const DirectPart& part = layer_->parts[part_];
        if (part.rays > 0) {
            const uint32_t passes = together();
            const double cost = static_cast<double>(part.rays) * passes / LayerLights::kPoints;
            const ChunkRange range =
                kit.nextRange(rate, tools_->lights.batchChunks(part, passes), cost, done);
            trace(cmd, range, 3 * portions);
            ++portions;
            done += range.count * cost;
            kit.order.finish(range);
        } else {
            kit.order.finish({0, kit.order.count()});
        }
        more = (kit.order.left() > 0 || nextPart()) && records && done < most &&
               portions < LinkKit::kMostPortions;
    }
    End end = End::NotYet;
    if (kit.order.left() > 0) {
        if (records) kit.run(cmd);
    } else if (samplePass_ == 0) {
        end = endFirstSamplePass(records ? cmd : kit.commands.begin(), pauses);
    } else if (repairStep_) {
        if (records) kit.run(cmd);
        end = endRepairStep(pauses);
    } else {
        end = endStep(records ? cmd : kit.commands.begin());
    }
    rate.note(done, kit.batchMs, secondsSince(start));
    for (uint32_t i = 0; records && i < portions; ++i) {
        kit.progress.traceSeconds += 1e-3 * kit.timestamps.milliseconds(3 * i, 3 * i + 1);
        kit.progress.gatherSeconds += 1e-3 * kit.timestamps.milliseconds(3 * i + 1, 3 * i + 2);
    }
    return end;
}

uint32_t DirectJob::together() const {
    return samplePassesTogether(samplePass_, endOfStep());
}

// Traces a portion; cmd is that of a tracer that records.
void DirectJob::trace(VkCommandBuffer cmd, ChunkRange range, uint32_t mark) {
    LinkKit& kit = tools_->kit;
    PenumbraMap& penumbra = tools_->penumbra;
    LayerLights::Portion portion{.part = layer_->parts[part_],
                                 .samplePass = samplePass_,
                                 .together = together(),
                                 .range = range,
                                 .penumbra = &penumbra.onDevice(),
                                 .mark = mark};
    if (tools_->lights.onCpu(portion.part)) {
        // The first part of a layer's first sample pass, with all patches, writes all sums; else they are
        // added to.
        portion.newSums = samplePass_ == 0 && part_ == 0 && !repairStep_;
        const vk::Buffer& sums = kit.buffers.directSums;
        if (!begun_ && !portion.newSums) std::memset(sums.as<uint8_t>(), 0, sums.size());
        if (!begun_ && samplePass_ == 0) penumbra.clearOnCpu();
        begun_ = true;
        return tools_->lights.traceOnCpu(portion);
    }
    tools_->lights.trace(cmd, portion, [&](VkCommandBuffer to) {
        penumbra.recordUpload(to);
        if (!begun_) vkCmdFillBuffer(to, kit.buffers.directSums.handle(), 0, VK_WHOLE_SIZE, 0);
        if (!begun_ && samplePass_ == 0) penumbra.recordClear(to);
        vk::barrier(to);
    });
    begun_ = true;
}

// Returns the sample pass before which this step ends.
uint32_t DirectJob::endOfStep() const {
    if (repairStep_) return layer_->directSteps[*repairStep_];
    return std::min(nextDirectStep(layer_->directSamplePasses), target_.directSamplePasses);
}

std::vector<uint8_t> DirectJob::repairedMarks() const {
    std::vector<uint8_t> marks(layer_->dirty.size());
    for (size_t i = 0; i < marks.size(); ++i)
        marks[i] = layer_->repairs(i);
    return marks;
}

// Finds which chunks take part in the sample pass; tells whether any does.
bool DirectJob::orderSamplePass() {
    LinkKit& kit = tools_->kit;
    const TileParts& parts = tools_->penumbra.parts();
    kit.beginPass();
    std::vector<uint8_t> take = repairStep_ ? repairedMarks() : std::vector<uint8_t>(kit.order.count(), 1);
    const bool penumbraAlone = !shader::allTakeSamplePass(samplePass_);
    if (penumbraAlone && penumbra_.empty()) {
        for (uint32_t i = 0; i < take.size(); ++i)
            penumbra_.push_back(static_cast<uint8_t>(parts.any(i, layer_->penumbra)));
    }
    for (size_t i = 0; penumbraAlone && i < take.size(); ++i)
        take[i] &= penumbra_[i];
    if (!kit.input.tracer.onCpu())
        closeGaps(take, penumbraAlone ? kPenumbraGap : kGap);
    else if (!repairStep_) // of all chunks those between have few patches that take part
        closeGaps(take, kGap);
    for (const ChunkRange& range : rangesOf(take, false))
        kit.order.finish(range);
    return kit.order.left() > 0;
}

// Goes on to a sample pass in which any chunk takes part; tells whether the step has one.
bool DirectJob::seekSamplePass() {
    for (; samplePass_ < endOfStep(); samplePass_ += together())
        if (orderSamplePass()) return true;
    return false;
}

// Goes on to the sample pass of the part that comes next, or the next part of a step. Returns false where the
// step is over, or what comes depends on what the first sample pass meets.
bool DirectJob::nextPart() {
    if (++part_ < layer_->parts.size()) {
        orderSamplePass(); // the same chunks as of the part before
        return true;
    }
    part_ = 0;
    if (samplePass_ == 0 && (repairStep_ || endOfStep() > 1)) return false;
    samplePass_ += together();
    return seekSamplePass();
}

DirectJob::End DirectJob::endFirstSamplePass(VkCommandBuffer cmd, bool pauses) {
    tools_->penumbra.recordBack(cmd);
    tools_->kit.run(cmd);
    learnPenumbra();
    ++samplePass_;
    if (seekSamplePass()) return End::NotYet;
    return repairStep_ ? endRepairStep(pauses) : endStep(tools_->kit.commands.begin());
}

DirectJob::End DirectJob::endStep(VkCommandBuffer cmd) {
    LinkKit& kit = tools_->kit;
    const uint32_t end = endOfStep(), samplePasses = end - layer_->directSamplePasses;
    const std::shared_ptr<vk::Buffer> shared = recordOwnDirect(cmd);
    if (!begun_) vkCmdFillBuffer(cmd, kit.buffers.directSums.handle(), 0, VK_WHOLE_SIZE, 0);
    tools_->penumbra.recordUpload(cmd);
    vk::barrier(cmd);
    tools_->layerPass.recordDirect(cmd, kit.input.light,
                                   {.direct = *layer_->direct,
                                    .sums = kit.buffers.directSums,
                                    .before = layer_->directSamplePasses,
                                    .added = samplePasses},
                                   tools_->penumbra.onDevice());
    kit.recordRayCount(cmd);
    tools_->penumbra.recordBack(cmd);
    kit.run(cmd);
    kit.countRays();
    learnPenumbra();
    layer_->directSamplePasses = end;
    layer_->directSteps.push_back(end);
    if (end == target_.directSamplePasses) return End::Made;
    begun_ = false;
    return layer_->rays() > 0 && seekSamplePass() ? End::NotYet : endStep(kit.commands.begin());
}

DirectJob::End DirectJob::endRepairStep(bool pauses) {
    LinkKit& kit = tools_->kit;
    const LightBuffers& light = kit.input.light;
    Layer& layer = *layer_;
    const uint32_t step = *repairStep_;
    const uint32_t before = step > 0 ? layer.directSteps[step - 1] : 0;
    VkCommandBuffer cmd = kit.commands.begin();
    tools_->penumbra.recordUpload(cmd);
    vk::barrier(cmd);
    tools_->layerPass.recordDirect(cmd, light,
                                   {.direct = light.ligOut,
                                    .sums = kit.buffers.directSums,
                                    .before = before,
                                    .added = samplePass_ - before},
                                   tools_->penumbra.onDevice());
    repairStep_ = step + 1;
    begun_ = false;
    const bool last = step + 1 == layer.directSteps.size();
    const bool some = std::find(layer.dirty.begin(), layer.dirty.end(), Layer::kBegun) != layer.dirty.end();
    if (!last && !(step == 0 && (some || pauses))) {
        kit.run(cmd);
        return seekSamplePass() ? End::NotYet : endRepairStep(pauses);
    }
    vk::barrier(cmd);
    const std::shared_ptr<vk::Buffer> shared = recordOwnDirect(cmd);
    vk::barrier(cmd);
    recordCopy(cmd, light.ligOut, *layer.direct, rangesOf(repairedMarks(), true));
    kit.recordRayCount(cmd);
    kit.run(cmd);
    kit.countRays();
    if (last) return End::Repaired;
    std::replace(layer.dirty.begin(), layer.dirty.end(), Layer::kDirty, Layer::kBegun);
    layer.begun = true;
    return End::Paused;
}

// Learns where the penumbra is; in a repair only of parts that are repaired as a whole. Chunks beside dirty
// ones are done with where it is what it was.
void DirectJob::learnPenumbra() {
    if (repairStep_) return learnRepairedPenumbra();
    const PenumbraMap& penumbra = tools_->penumbra;
    layer_->penumbra.resize(penumbra.parts().count);
    for (size_t i = 0; i < layer_->penumbra.size(); ++i)
        layer_->penumbra[i] = static_cast<uint8_t>(penumbra.within(i));
    penumbra_.clear();
}

void DirectJob::learnRepairedPenumbra() {
    const PenumbraMap& penumbra = tools_->penumbra;
    const TileParts& parts = penumbra.parts();
    Layer& layer = *layer_;
    std::vector<uint8_t> cut(parts.count, 0), differs(parts.count, 0);
    for (uint32_t i = 0; i < layer.dirty.size(); ++i)
        if (!layer.repairs(i)) parts.mark(i, cut);
    for (size_t i = 0; i < parts.count; ++i) {
        const auto within = static_cast<uint8_t>(penumbra.within(i));
        differs[i] = cut[i] == 0 && layer.penumbra[i] != within;
        if (differs[i] != 0) layer.penumbra[i] = within;
    }
    for (uint32_t i = 0; i < layer.dirty.size(); ++i) {
        uint8_t& dirty = layer.dirty[i];
        if (dirty != Layer::kBeside && dirty != Layer::kBesideBegun) continue;
        const uint8_t as = dirty == Layer::kBeside ? 0 : Layer::kBegun;
        dirty = parts.any(i, differs) ? Layer::kDirty : as;
    }
    setPenumbra();
}

// Sets the penumbra; in a repair only of what takes part in that, as rays are for these alone.
void DirectJob::setPenumbra() {
    const TileParts& parts = tools_->penumbra.parts();
    std::vector<uint8_t> within = layer_->penumbra;
    if (repairStep_) {
        std::vector<uint8_t> repaired(parts.count, 0);
        for (uint32_t i = 0; i < layer_->dirty.size(); ++i)
            if (layer_->repairs(i)) parts.mark(i, repaired);
        for (size_t i = 0; i < within.size(); ++i)
            within[i] &= repaired[i];
    }
    tools_->penumbra.set(within);
    penumbra_.clear();
}

// Copies direct light that a layer shares with one that is to stay as it is. Returns what the copy is made
// of, to be kept until it is there; nullptr where none was needed.
std::shared_ptr<vk::Buffer> DirectJob::recordOwnDirect(VkCommandBuffer cmd) {
    Layer& layer = *layer_;
    if (layer.direct && layer.direct.use_count() == 1) return nullptr;
    const std::shared_ptr<vk::Buffer> shared = std::exchange(
        layer.direct, std::make_shared<vk::Buffer>(tools_->store.takeBuffer("direct light of a layer")));
    if (!shared) return nullptr;
    const VkBufferCopy all{0, 0, shared->size()};
    vkCmdCopyBuffer(cmd, shared->handle(), layer.direct->handle(), 1, &all);
    return shared;
}

} // namespace relume
