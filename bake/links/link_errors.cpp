#include "bake/links/link_errors.h"

#include "assets/base/portions.h"
#include "bake/gather/host_resolve.h"

#include <algorithm>

namespace relume {
namespace {

constexpr size_t kPortion = 1024; // chunks that a thread looks at, at a time

// A receiver left out is missed over twice the gap, at its worst place. The share is the square of what
// texels are off, over the mean square of that: 1/32 where light is smooth, 1/4 across a step (at scale 2);
// 0.12 to 0.24 at scale 2 and 0.27 to 0.51 at scale 4 in the Cornell rooms at 128 x 128, where boxes touch
// the floor.
constexpr double kGapShare2 = 0.18, kGapShare4 = 0.36;

} // namespace

LinkErrors::LinkErrors(LinkKit& kit)
    : kit_(kit), pass_(kit.input.device, !kit.gatherPass.onCpu()), shown_(kit.chunkCount(), 0) {
    if (!kit.rankChunks.alone()) own_ = kit.rankChunks.ownOf(std::vector<uint8_t>(kit.chunkCount(), 1));
    const std::vector<shader::Patch>& patches = kit.input.patches.scene.patches;
    runPortions(kit.input.device.workers(), shown_.size(), kPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin * shader::kChunk; i < end * shader::kChunk; ++i)
            if (shader::patchIsShown(patches[i].flags)) ++shown_[i / shader::kChunk];
    });
}

template<typename T>
std::vector<T> LinkErrors::chunkSums() const {
    auto sums = vk::readBuffer<T>(kit_.input.device, kit_.buffers.chunkSums, kit_.chunkCount());
    kit_.rankChunks.share(sums);
    return sums;
}

shader::ResolveSums LinkErrors::resolve(const LinkState& state, double sigma) const {
    if (kit_.gatherPass.onCpu()) {
        resolveOnHost(state, sigma);
    } else {
        VkCommandBuffer cmd = kit_.commands.begin();
        pass_.record(cmd, kit_.input.light, kit_.buffers,
                     {.samples = state.linkSamplePasses * kit_.linksOfSamplePass,
                      .directSamplePasses = state.directSamplePasses,
                      .sigma = static_cast<float>(sigma),
                      .scaled = state.hasScales(),
                      .local = bool(kit_.buffers.local),
                      .floor = static_cast<float>(kLocalFloor * state.median),
                      .rows = kit_.rankChunks.rows(),
                      .chunks = kit_.rankChunks.own()});
        kit_.run(cmd);
    }
    return sumsOf(chunkSums<shader::ResolveSums>());
}

void LinkErrors::resolveOnHost(const LinkState& state, double sigma) const {
    const LinkBuffers& buffers = kit_.buffers;
    const auto scale = [](float samples) { return samples > 0.0f ? 1.0f / samples : 0.0f; };
    const auto links = static_cast<float>(state.linkSamplePasses * kit_.linksOfSamplePass);
    auto* const local = buffers.local.as<std::byte>();
    auto* const bins = reinterpret_cast<uint32_t*>(local); // of the first copy
    HostSmoothing smoothing = kit_.smoothing(sigma, bool(buffers.rows));
    if (state.hasScales()) smoothing.scales = buffers.scales.as<glm::vec2>();
    smoothing.rowChunks = kit_.rankChunks.rowMarks();
    smoothing.chunks = own_;
    resolveLinks(kit_.gatherPass.pool(), {.smoothing = smoothing,
                                          .directSums = state.directSamplePasses > 0 && buffers.directSums
                                                            ? buffers.directSums.as<glm::vec4>()
                                                            : nullptr,
                                          .result = buffers.result.as<glm::vec4>(),
                                          .scale = scale(links / static_cast<float>(shader::kReplicates)),
                                          .directScale = scale(static_cast<float>(state.directSamplePasses)),
                                          .floor = static_cast<float>(kLocalFloor * state.median),
                                          .sums = buffers.chunkSums.as<shader::ResolveSums>(),
                                          .local = reinterpret_cast<shader::LocalSums*>(local + kLocalSumsAt),
                                          .lightBins = bins,
                                          .errorBins = bins + shader::kLightBins});
}

LinkErrors::Local LinkErrors::local() const {
    const size_t copies = kit_.gatherPass.onCpu() ? 1 : shader::kBinCopies;
    const auto own =
        vk::readBuffer<uint32_t>(kit_.input.device, kit_.buffers.local, copies * shader::kBinsOfCopy);
    std::vector<uint64_t> counts(shader::kBinsOfCopy, 0);
    for (size_t i = 0; i < own.size(); ++i)
        counts[i % shader::kBinsOfCopy] += own[i];
    kit_.input.ranks.sum(counts);
    const std::vector<uint32_t> bins(counts.begin(), counts.end());
    const std::span<const uint32_t> all = bins;
    Local local{.median = medianLight(all.first(shader::kLightBins)),
                .error = localErrorOf(all.subspan(shader::kLightBins))};
    const std::vector<shader::LocalSums> sums = localSums();
    std::vector<ChunkSquares> chunks(sums.size());
    WorkerPool& pool = kit_.input.device.workers();
    runPortions(pool, sums.size(), kPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            chunks[i] = {.texels = double(shown_[i]),
                         .noise = double(sums[i].direct) + sums[i].indirect,
                         .bias = sums[i].bias,
                         .fourth = sums[i].fourth};
    });
    local.direct = sumOverAll(pool, sums.size(), [&](size_t i) { return double(sums[i].direct); });
    local.links = sumOverAll(
        pool, sums.size(), [&](size_t i) { return double(sums[i].indirect) + std::max(0.0f, sums[i].bias); });
    if (kit_.buffers.rows) // else nothing is smoothed
        local.error = withBias(pool, local.error, chunks);
    return local;
}

std::vector<shader::LocalSums> LinkErrors::localSums() const {
    std::vector<shader::LocalSums> sums(kit_.chunkCount());
    vk::download(kit_.input.device, kit_.buffers.local, sums.data(), sums.size() * sizeof(shader::LocalSums),
                 kLocalSumsAt);
    kit_.rankChunks.share(sums);
    return sums;
}

std::vector<ChunkVariance> LinkErrors::chunks() const {
    const size_t count = kit_.chunkCount();
    const std::vector<shader::ResolveSums> sums = chunkSums<shader::ResolveSums>();
    const std::vector<shader::LocalSums> local = localSums();
    std::vector<ChunkVariance> chunks(count);
    runPortions(kit_.input.device.workers(), count, kPortion, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            chunks[i] = {.patches = sums[i].count,
                         .direct = sums[i].direct,
                         .indirect = sums[i].indirect,
                         .localDirect = local[i].direct,
                         .localIndirect = local[i].indirect};
    });
    return chunks;
}

double LinkErrors::coarseVariance(const LinkState& state, double patches) const {
    if (kit_.buffers.receiverCount == 0 || state.linkSamplePasses == 0) return 0.0;
    VkCommandBuffer cmd = kit_.commands.begin();
    pass_.recordCoarse(cmd, kit_.input.light, kit_.buffers, state.linkSamplePasses * kit_.linksOfSamplePass);
    kit_.run(cmd);
    const glm::dvec4 total = sumsOf(vk::readBuffer<glm::vec4>(kit_.input.device, kit_.buffers.chunkSums,
                                                              kit_.buffers.receiverCount / shader::kChunk));
    const double rows = std::max(0.0, total.x) / std::max(1.0, total.y);
    const double columns = std::max(0.0, total.z) / std::max(1.0, total.w);
    const bool half = kit_.settings.links.indirectScale == 2;
    return patches * (half ? kGapShare2 : kGapShare4) * (rows + columns);
}

glm::dvec4 LinkErrors::change(bool isFirst) const {
    VkCommandBuffer cmd = kit_.commands.begin();
    pass_.recordChange(cmd, kit_.input.light, kit_.buffers, kit_.rankChunks.own(), isFirst);
    kit_.run(cmd);
    return sumsOf(chunkSums<glm::vec4>());
}

glm::dvec4 LinkErrors::sendOnHost(const std::vector<uint8_t>& full, bool isFirst) const {
    kit_.gatherPass.sendOnCpu(kit_.input.light, kit_.settings.transport.reflectivity, full,
                              kit_.buffers.chunkSums.as<glm::vec4>(), isFirst);
    return sumsOf(chunkSums<glm::vec4>());
}

} // namespace relume
