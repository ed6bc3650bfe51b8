#include "bake/layers/bounce_job.h"

#include "assets/base/clock.h"
#include "bake/base/bounce_convergence.h"
#include "bake/layers/layer_bounces.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

// The first level is in haste: this iteration error is small enough for it.
constexpr double kFirstIterationError = 0.01;
// That level may be the last one where no more than this is left of each patch's own light. Changes whose
// ratio is 0.5 to 0.6 tell three to two times what is left, as BounceSeries takes a larger one.
constexpr double kMostLocalHaste = 0.05;
// The CPU looks for the first time after so many bounces, and then after so many more at most. A look waits
// for the device, which takes longer than a bounce.
constexpr uint32_t kFirstLook = 2, kMostUnseen = 8;
constexpr uint32_t kToldBounces = 2; // the last ones before a look: both changes make a ratio
constexpr uint32_t kMostPasses = Solver::kMaxPasses;

} // namespace

// Hybrid's first pass is the direct light: with a number of passes the others are gathered over all links.
// Else bounces converge over the links of the first sample pass.
BounceJob::BounceJob(Tools& tools, Desc desc) : tools_(&tools), desc_(std::move(desc)) {
    std::vector<LayerGather::LaneLight> light;
    for (Lane& lane : desc_.lanes) {
        lane.look = kFirstLook;
        light.push_back({lane.layer->direct.get(), lane.sky});
    }
    tools.gather.begin(light);
    beginPass(tools.kit.settings.passes > 0 ? Stage::Gather : Stage::Bounces);
}

bool BounceJob::needs(const Layer* layer) const {
    return std::any_of(desc_.lanes.begin(), desc_.lanes.end(), [&](const Lane& lane) {
        return lane.layer == layer && (lane.live || stage_ == Stage::Bounces);
    });
}

bool BounceJob::leaderHasLevel() const {
    const Lane& leader = desc_.lanes.front();
    const bool ended = stage_ == Stage::Gather && !leader.live;
    return ended || leader.layer->has();
}

void BounceJob::beginPass(Stage stage) {
    stage_ = stage;
    begun_ = false;
    tools_->kit.beginPass();
}

std::vector<uint32_t> BounceJob::batch() {
    Portion portion = tools_->batches.next(samplePass_);
    const bool alone = portion.trace || tools_->gather.onCpu();
    const bool seen = alone ? onePortion(portion) : knownPortions(std::move(portion));
    return seen ? look() : std::vector<uint32_t>();
}

// Returns what the first bounce sends: the direct light or, for the sum, what is shown, as an edit changes
// part of it.
const vk::Buffer& BounceJob::firstLight(const Lane& lane) const {
    return desc_.first ? *desc_.first : *lane.layer->direct;
}

void BounceJob::startAtOnce() {
    if (!lit_) tools_->gather.startAtOnce(firstLight(desc_.lanes.front()));
    begun_ = lit_ = true;
}

// Begins a pass; a gather begins with empty sums.
void BounceJob::recordPassBegin(VkCommandBuffer cmd) {
    if (begun_) return;
    if (!lit_) {
        if (bounce_ == 0 && gathers_ == 0) {
            std::vector<const vk::Buffer*> first;
            for (const Lane& lane : desc_.lanes)
                first.push_back(&firstLight(lane));
            tools_->gather.recordStart(cmd, first);
        }
        tools_->gather.recordSend(cmd);
    }
    if (stage_ == Stage::Gather && samplePass_ == 0) tools_->gather.recordNewSums(cmd);
    vk::barrier(cmd);
    lit_ = begun_ = true;
}

// Makes a batch of one portion. Returns whether the CPU is to look, as does the one below.
bool BounceJob::onePortion(const Portion& portion) {
    LinkKit& kit = tools_->kit;
    bool seen = false;
    const auto recordDistances = [&](VkCommandBuffer cmd) {
        if (wantsDistances())
            kit.gatherPass.recordDistances(cmd, kit.input.light, kit.buffers, portion.gather);
    };
    const bool atOnce = tools_->gather.onCpu() && tools_->batches.onCpu();
    const LinkBatches::Steps steps{
        .begin = [&](VkCommandBuffer cmd) { atOnce ? startAtOnce() : recordPassBegin(cmd); },
        .traced = {},
        .gather =
            [&](VkCommandBuffer cmd) {
                recordGather(cmd, portion, {});
                if (!atOnce) recordDistances(cmd);
                noteLinks(portion, 0);
            },
        .endRecords = [&] { return wantsDistances() || (kit.order.left() == 0 && recordsPassEnd()); },
        .end =
            [&](VkCommandBuffer cmd) {
                if (atOnce) recordDistances(cmd);
                seen = kit.order.left() == 0 && recordPassEnd(cmd);
            },
        .meanwhile =
            [&cache = tools_->batches.cache(), next = samplePass_ + 1,
             isNext = stage_ == Stage::Gather && samplePass_ + 1 < linkSamplePasses()] {
                if (isNext) cache.prepare(next);
            },
    };
    tools_->batches.run(std::span(&portion, 1), steps, atOnce);
    return seen;
}

// Records pass after pass, until the time is up, links are not there or the CPU is to look: a GPU's submit
// takes longer than a bounce.
bool BounceJob::knownPortions(Portion portion) {
    LinkKit& kit = tools_->kit;
    LinkBatches& batches = tools_->batches;
    const auto start = Clock::now();
    const double most = batches.wanted();
    VkCommandBuffer cmd = kit.commands.begin();
    kit.timestamps.reset(cmd);
    uint32_t chunks = 0, portions = 0;
    bool seen = false;
    while (true) {
        const std::vector<VkDeviceAddress> more = following(portion, most - chunks);
        recordPassBegin(cmd);
        kit.timestamps.mark(cmd, 2 * portions);
        recordGather(cmd, portion, more);
        if (wantsDistances())
            kit.gatherPass.recordDistances(cmd, kit.input.light, kit.buffers, portion.gather);
        kit.timestamps.mark(cmd, 2 * portions + 1);
        noteLinks(portion, more.size());
        chunks += portion.range.count * static_cast<uint32_t>(1 + more.size());
        ++portions;
        seen = kit.order.left() == 0 && recordPassEnd(cmd);
        if (seen || chunks >= most || portions == LinkKit::kMostPortions) break;
        portion = batches.next(samplePass_, chunks);
        if (portion.trace) break;
        vk::barrier(cmd); // the next one adds to the same sums
    }
    kit.run(cmd);
    for (uint32_t i = 0; i < portions; ++i)
        kit.progress.gatherSeconds += 1e-3 * kit.timestamps.milliseconds(2 * i, 2 * i + 1);
    batches.note(chunks, secondsSince(start));
    return seen;
}

// Returns the links of later sample passes that are there as a whole and come along: sums are read and
// written once for all of them.
std::vector<VkDeviceAddress> BounceJob::following(const Portion& portion, double most) const {
    std::vector<VkDeviceAddress> links;
    const uint32_t chunks = tools_->kit.chunkCount();
    if (stage_ != Stage::Gather || portion.range.count < chunks) return links;
    for (uint32_t next = samplePass_ + 1; next < linkSamplePasses(); ++next) {
        const size_t samplePasses = 1 + links.size();
        if (samplePasses == LayerBounces::kMostRounds ||
            static_cast<double>((samplePasses + 1) * chunks) > most)
            break;
        const LinkCache::Place place = tools_->batches.cache().find(next, 0, chunks);
        if (!place.known || place.count < chunks) break;
        links.push_back(place.links->address() + place.offset * sizeof(uint32_t));
    }
    return links;
}

void BounceJob::recordGather(VkCommandBuffer cmd, const Portion& portion,
                             const std::vector<VkDeviceAddress>& following) {
    const bool bounces = stage_ == Stage::Bounces;
    const uint32_t samplePasses = bounces ? 1 : linkSamplePasses();
    const bool lastSamplePass = samplePass_ + 1 + following.size() == samplePasses;
    LayerGather::Work work{.links = portion.gather,
                           .following = following,
                           .keeps = !bounces || bounce_ + 1 + kToldBounces >= nextLook(),
                           .ends = bounces || (lastSamplePass && !isLastGather()),
                           .scale = 1.0f / static_cast<float>(samplePasses * tools_->kit.linksOfSamplePass),
                           .changes = {}};
    work.links.output = bounces;
    work.links.accumulate = !bounces;
    work.links.newSums = samplePass_ == 0;
    if (tellsChange()) work.changes = (bounces ? bounce_ : gathers_) % 2;
    tools_->gather.recordGather(cmd, work);
}

// Counts these links for each layer that bounces along, as it has gathered them.
void BounceJob::noteLinks(const Portion& portion, size_t following) {
    SolverProgress& progress = tools_->kit.progress;
    const uint64_t samples = uint64_t{tools_->kit.linksOfSamplePass} * (1 + following);
    const uint64_t count = tools_->senders.count(portion.range) * samples;
    uint64_t layers = 0;
    for (Lane& lane : desc_.lanes) {
        if (!lane.live) continue;
        lane.gathered += count;
        ++layers;
    }
    progress.rays += portion.trace ? count : 0;
    progress.raysSaved += count * (layers - (portion.trace ? 1 : 0));
    progress.linksRead += count;
    tools_->batches.finish(samplePass_, portion);
    samplePass_ += static_cast<uint32_t>(following);
}

// Tells whether the end of the pass under way records commands. The end of a bounce that the CPU gathered
// does not, as the CPU sends, too.
bool BounceJob::recordsPassEnd() const {
    return stage_ == Stage::Gather && samplePass_ + 1 == linkSamplePasses() && !isLastGather();
}

// Ends a pass: what was gathered is what the next pass, of whichever stage, begins with. Returns whether the
// CPU is to look what became of it; else the next pass has begun.
bool BounceJob::recordPassEnd(VkCommandBuffer cmd) {
    if (stage_ == Stage::Gather) {
        if (++samplePass_ == linkSamplePasses()) return recordGatherEnd(cmd);
        tools_->kit.beginPass();
        return false;
    }
    recordPassLight(cmd);
    ++bounce_;
    if (bounce_ < nextLook()) {
        beginPass(Stage::Bounces);
        return false;
    }
    tools_->gather.recordChanges(cmd);
    return true;
}

// Ends a gather. What has converged over few links has their noise, which all links see then: it is gathered
// again until the light has converged over all of them, unless that is for a look only.
bool BounceJob::recordGatherEnd(VkCommandBuffer cmd) {
    const bool last = isLastGather();
    if (!last) recordPassLight(cmd);
    samplePass_ = 0;
    ++gathers_;
    if (last) return true;
    lit_ = true;
    if (tools_->kit.settings.passes > 0 || gathers_ == 1) {
        beginPass(Stage::Gather);
        return false;
    }
    tools_->gather.recordChanges(cmd);
    return true;
}

// Tells whether this gather is known to be the last one before it is made.
bool BounceJob::isLastGather() const {
    const uint32_t passes = tools_->kit.settings.passes;
    return passes > 0 ? gathers_ + 2 >= passes : linkSamplePasses() == 1 || desc_.hasty;
}

// Tells whether the change of the pass under way is told, while its end is recorded.
bool BounceJob::tellsChange() const {
    if (stage_ == Stage::Gather) return tools_->kit.settings.passes == 0;
    return bounce_ + kToldBounces >= nextLook();
}

// Makes the light that was gathered what is sent next.
void BounceJob::recordPassLight(VkCommandBuffer cmd) {
    const bool bounces = stage_ == Stage::Bounces;
    LayerGather::PassEnd end{
        .bounce = bounces, .samples = linkSamplePasses() * tools_->kit.linksOfSamplePass, .changes = {}};
    if (tellsChange()) end.changes = (bounces ? bounce_ : gathers_) % 2;
    tools_->gather.recordPassEnd(cmd, end);
}

uint32_t BounceJob::nextLook() const {
    uint32_t next = kMostPasses;
    for (const Lane& lane : desc_.lanes)
        if (lane.live) next = std::min(next, lane.look);
    return next;
}

// Looks what came of a pass and decides what is next, which depends on each layer's light alone, not on how
// batches were cut nor on who bounces along.
std::vector<uint32_t> BounceJob::look() {
    if (stage_ == Stage::Gather) return lookAtGather();
    uint32_t live = 0;
    for (uint32_t i = 0; i < desc_.lanes.size(); ++i) {
        Lane& lane = desc_.lanes[i];
        if (lane.live && lane.look == bounce_) {
            learnChanges(i, lane.look - lane.looked > 1);
            lane.looked = lane.look;
            const uint32_t left = kMostPasses - std::min(bounce_, kMostPasses - 1);
            lane.look +=
                lane.series.bouncesTo(iterationAim(), localIterationAim(), std::min(kMostUnseen, left));
            lane.live = !hasConverged(lane) && bounce_ < kMostPasses;
        }
        if (lane.live) live |= 1u << i;
    }
    tools_->gather.setLive(live);
    if (live != 0) {
        beginPass(Stage::Bounces);
        return {};
    }
    for (Lane& lane : desc_.lanes)
        lane.live = true;
    tools_->gather.setLive((1u << desc_.lanes.size()) - 1u);
    lit_ = desc_.lanes.size() == 1; // of others some have stood by while light bounced on
    beginPass(Stage::Gather);
    return {};
}

std::vector<uint32_t> BounceJob::lookAtGather() {
    const bool told = tools_->kit.settings.passes == 0 && !isLastGather();
    std::vector<uint32_t> ended;
    uint32_t live = 0;
    for (uint32_t i = 0; i < desc_.lanes.size(); ++i) {
        Lane& lane = desc_.lanes[i];
        if (!lane.live) continue;
        if (told) learnChanges(i, gathers_ == 2);
        lane.live = told && !hasConverged(lane) && gathers_ + 1 < kMostPasses;
        if (lane.live)
            live |= 1u << i;
        else
            ended.push_back(i);
    }
    tools_->gather.setLive(live);
    over_ = live == 0;
    if (!over_) beginPass(Stage::Gather);
    return ended;
}

bool BounceJob::endedInHaste(const Lane& lane) const {
    return desc_.hasty && tools_->kit.settings.passes == 0 && lane.series.localError > kMostLocalHaste;
}

bool BounceJob::hasConverged(const Lane& lane) const {
    return lane.series.isWithin(iterationAim(), localIterationAim());
}

double BounceJob::iterationAim() const {
    const SolverSettings& settings = tools_->kit.settings;
    const double own = settings.layers.error, composite = settings.error;
    const double error = own > 0 && composite > 0 ? std::min(own, composite) : std::max(own, composite);
    const double aim = keptIterationAim(error);
    return desc_.hasty ? std::max(aim, kFirstIterationError) : aim;
}

// First looks do not wait for dark corners, and neither does the sum, which shows an edit until its layers
// have followed.
double BounceJob::localIterationAim() const {
    return desc_.hasty || desc_.sum ? 1.0 : kLocalIterationAimOfLayers;
}

// Learns what the last pass changed; `both` says that what the pass before changed has not been seen yet.
void BounceJob::learnChanges(uint32_t lane, bool both) {
    const uint32_t passes = stage_ == Stage::Gather ? gathers_ : bounce_; // this one, too
    BounceSeries& series = desc_.lanes[lane].series;
    if (both) {
        series.forgetChange(); // of another stage, or of a pass long before
        series.learn(tools_->gather.change((passes - 2) % 2, lane));
    }
    series.learn(tools_->gather.change((passes - 1) % 2, lane));
}

// Tells whether distances are made: those of the first sample pass's links are the same for every layer.
bool BounceJob::wantsDistances() const {
    return tools_->kit.buffers.distances && !tools_->distancesKnown && stage_ == Stage::Gather &&
           samplePass_ == 0;
}

} // namespace relume
