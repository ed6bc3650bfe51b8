#include "app/bench/trace_bench.h"

#include "assets/base/clock.h"
#include "bake/gather/radiance_pass.h"
#include "bake/pairs/pair_passes.h"
#include "bake/trace/make_tracer.h"
#include "bake/vk/commands.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace relume {
namespace {

using shader::kChunk;
using shader::kSuper;
using shader::kSuperBlocks;

constexpr uint32_t kLinkSamples = 64;
constexpr double kGolden = 0.618;
// A software device compiles a kernel when it is first run: batches before this many count for nothing.
constexpr uint32_t kWarmUp = 2;

class Bench {
public:
    Bench(const vk::Device& device, Baker& baker, TracerKind kind, const TraceBenchDesc& desc)
        : device_(device), patches_(baker.patches()), light_(baker.light()), desc_(desc),
          tracer_(makeTracer(kind, device, patches_.scene, light_.patches)), commands_(device),
          timestamps_(device, 3), radiancePass_(device),
          gatherPass_(device, SenderKind::Patches, transport_) {}

    void pairs(TraceRates& rates) {
        allocatePairs();
        double trace = 0, gather = 0;
        uint64_t rays = 0, pairs = 0;
        uint32_t batch = 1, next = 0, runs = 0;
        const auto start = Clock::now();
        while (secondsSince(start) < desc_.seconds || runs <= kWarmUp) {
            const uint32_t count =
                std::min({batch, pairs_.capacity, static_cast<uint32_t>(supers_.size()) - next});
            vk::upload(device_, rays_, zero_.data(), zero_.size() * sizeof(uint32_t));
            const auto batchStart = Clock::now();
            const auto [traced, gathered] = pairBatch(next, count);
            const double seconds = secondsSince(batchStart);
            batch = scaled(batch, seconds);
            if (runs++ >= kWarmUp) {
                trace += traced;
                gather += gathered;
                const auto counters = vk::readBuffer<uint32_t>(device_, rays_, shader::kRayCounters);
                rays += std::accumulate(counters.begin(), counters.end(), uint64_t{0});
                for (uint32_t s = next; s < next + count; ++s)
                    pairs += pairsOf(supers_[s]);
            }
            next = next + count < supers_.size() ? next + count : 0;
        }
        rates.occlusion = static_cast<double>(rays) / trace;
        rates.occlusionGather = static_cast<double>(rays) / (trace + gather);
        rates.gather = static_cast<double>(pairs) / gather;
    }

    double closest(Rotation rotation) {
        const uint32_t chunks = patches_.chunkCount();
        const uint32_t most = std::min(chunks, device_.info().software() ? 256u : 4096u);
        const vk::Buffer links(
            device_,
            {.size = VkDeviceSize{most} * kLinkSamples * kChunk * sizeof(uint32_t), .name = "links"});
        double total = 0;
        uint64_t rays = 0;
        // Portions begin at chunks that a golden-ratio stride picks, so that all parts of the scene count.
        const auto stride = std::max(1u, static_cast<uint32_t>(kGolden * chunks));
        uint32_t batch = 4, next = 0, runs = 0;
        const auto start = Clock::now();
        while (secondsSince(start) < desc_.seconds || runs <= kWarmUp) {
            const uint32_t count = std::min({batch, most, chunks - next});
            const auto batchStart = Clock::now();
            const double seconds = closestBatch(links, next, count, rotation);
            batch = scaled(batch, secondsSince(batchStart));
            if (runs++ >= kWarmUp) {
                total += seconds;
                rays += sendingPatches(next, count) * kLinkSamples;
            }
            next = (next + stride) % chunks;
        }
        return static_cast<double>(rays) / total;
    }

private:
    uint32_t scaled(uint32_t batch, double seconds) const {
        const double factor = desc_.batchMs / std::max(0.01, 1000.0 * seconds);
        return static_cast<uint32_t>(std::clamp(batch * std::min(factor, 4.0), 1.0, 1e6));
    }

    // Counts the patches that send, because only these have rays.
    uint64_t sendingPatches(uint32_t firstChunk, uint32_t count) const {
        const auto first = patches_.scene.patches.begin() + firstChunk * kChunk;
        return static_cast<uint64_t>(std::count_if(first, first + count * kChunk, [](const shader::Patch& p) {
            return (p.flags & shader::kPatchSends) != 0;
        }));
    }
    uint64_t patchesOf(uint32_t row) const {
        return uint64_t{std::min(kSuper, patches_.chunkCount() - row * kSuper)} * kChunk;
    }
    uint64_t pairsOf(SuperBlock s) const {
        return (s.row == s.column ? 1 : 2) * patchesOf(s.row) * patchesOf(s.column);
    }

    // Puts all super-blocks in an order that visits every part of the scene early: a stride by the golden
    // ratio.
    void allocatePairs() {
        const uint32_t rows = (patches_.chunkCount() + kSuper - 1) / kSuper;
        std::vector<SuperBlock> ordered;
        for (uint32_t row = 0; row < rows; ++row) {
            for (uint32_t column = row; column < rows; ++column)
                ordered.push_back({row, column, 0, {}, {}, 0});
        }
        const auto n = static_cast<uint32_t>(ordered.size());
        auto stride = std::max(1u, static_cast<uint32_t>(kGolden * n));
        while (std::gcd(stride, n) != 1)
            ++stride;
        for (uint64_t i = 0; i < n; ++i)
            supers_.push_back(ordered[i * stride % n]);

        pairs_ = PairBuffers(device_, n, SenderKind::Patches);
        ring_ = BitsRing(device_, pairs_.capacity, superBytes(false));
        zero_.assign(size_t{2} * shader::kRayCounters, 0u);
        rays_ = vk::makeBuffer(device_, zero_, "ray counters");
        VkCommandBuffer cmd = commands_.begin();
        radiancePass_.record(cmd, light_, transport_);
        vk::barrier(cmd);
        vk::hostBarrier(cmd);
        commands_.run();
    }

    // Returns the seconds of tracing and of gathering.
    std::pair<double, double> pairBatch(uint32_t first, uint32_t count) {
        const std::span<SuperBlock> supers(&supers_[first], count);
        std::vector<uint32_t*> bits;
        for (uint32_t slot = 0; slot < count; ++slot) {
            supers[slot].bits = ring_.address(slot);
            bits.push_back(ring_.host(slot));
        }
        vk::upload(device_, pairs_.supers, supers.data(), supers.size_bytes());
        const OcclusionWork work{.supers = supers,
                                 .superBuffer = &pairs_.supers,
                                 .bits = bits,
                                 .firstUnit = 0,
                                 .unitCount = count * kSuperBlocks,
                                 .sends = &light_.chunkSends,
                                 .rays = &rays_};
        VkCommandBuffer cmd = commands_.begin();
        timestamps_.reset(cmd);
        timestamps_.mark(cmd, 0);
        const auto start = Clock::now();
        tracer_->occlusion(cmd, work);
        const double cpu = secondsSince(start);
        vk::barrier(cmd);
        timestamps_.mark(cmd, 1);
        if (gatherPass_.onCpu()) {
            vk::hostBarrier(cmd);
            commands_.run();
            cmd = commands_.begin();
        }
        gatherPass_.record(cmd, {.light = light_,
                                 .pairs = pairs_,
                                 .supers = supers,
                                 .bits = bits,
                                 .size = patches_.scene.size,
                                 .transport = transport_});
        timestamps_.mark(cmd, 2);
        vk::hostBarrier(cmd);
        commands_.run();
        return {tracer_->onCpu() ? cpu : 1e-3 * timestamps_.milliseconds(0, 1),
                1e-3 * timestamps_.milliseconds(1, 2)};
    }

    double closestBatch(const vk::Buffer& links, uint32_t first, uint32_t count, Rotation rotation) {
        VkCommandBuffer cmd = commands_.begin();
        timestamps_.reset(cmd);
        timestamps_.mark(cmd, 0);
        const auto start = Clock::now();
        tracer_->closest(cmd, {.firstChunk = first,
                               .chunkCount = count,
                               .firstSample = 0,
                               .sampleCount = kLinkSamples,
                               .rotation = rotation,
                               .links = &links,
                               .covers = light_.coversIf(true)});
        const double cpu = secondsSince(start);
        timestamps_.mark(cmd, 1);
        vk::hostBarrier(cmd);
        commands_.run();
        return tracer_->onCpu() ? cpu : 1e-3 * timestamps_.milliseconds(0, 1);
    }

    const vk::Device& device_;
    const PatchSet& patches_;
    LightBuffers& light_;
    const TraceBenchDesc desc_;
    const TransportSettings transport_{.allSend = true};
    std::unique_ptr<Tracer> tracer_;
    vk::Commands commands_;
    vk::Timestamps timestamps_;
    RadiancePass radiancePass_;
    GatherPass gatherPass_;
    std::vector<SuperBlock> supers_;
    std::vector<uint32_t> zero_;
    PairBuffers pairs_;
    BitsRing ring_;
    vk::Buffer rays_;
};

} // namespace

TraceRates measureTracer(const vk::Device& device, Baker& baker, TracerKind kind,
                         const TraceBenchDesc& desc) {
    TraceRates rates;
    rates.tracer = tracerName(kind);
    rates.size = baker.patches().scene.size;
    rates.patches = baker.patches().count;
    rates.triangles = baker.patches().scene.mesh.triangleCount();
    Bench bench(device, baker, kind, desc);
    bench.pairs(rates);
    rates.closestPatch = bench.closest(Rotation::Patch);
    rates.closestTile = bench.closest(Rotation::Tile);
    return rates;
}

} // namespace relume
