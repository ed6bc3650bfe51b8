#include "bake/surface/seam_plan.h"

#include "assets/base/error.h"
#include "bake/surface/seam_sources.h"

#include <algorithm>
#include <span>

namespace relume {
namespace {

using shader::kNoTexel;

constexpr uint8_t kEmpty = 0xff; // ring of what is not filled
constexpr uint32_t kNeighbours = 8;

class SeamPlanBuilder {
public:
    SeamPlanBuilder(const PatchSet& set, uint32_t rings)
        : sources_(set), size_(set.scene.size), page_(set.scene.pageSize()),
          ring_(size_t{size_} * size_, kEmpty), place_(ring_.size(), 0) {
        ASSERT(rings < kEmpty);
        plan_.rings = rings;
        plan_.chunkCount = set.chunkCount();
        const std::vector<uint32_t> texels = shownTexels(set);
        for (uint32_t patch = 0; patch < texels.size(); ++patch) {
            if (texels[patch] == kNoTexel) continue;
            ring_[texels[patch]] = 0;
            place_[texels[patch]] = patch / shader::kChunk;
            frontier_.push_back(texels[patch]);
        }
    }

    SeamPlan build() {
        for (uint32_t ring = 1; ring <= plan_.rings; ++ring)
            addRing(static_cast<uint8_t>(ring));
        plan_.starts.push_back(static_cast<uint32_t>(plan_.fills.size()));
        return std::move(plan_);
    }

private:
    // Calls f(index of the neighbour, its texel) for those within its page.
    template<typename F>
    void forNeighbours(uint32_t texel, const F& f) const {
        const auto x = static_cast<int>(texel % size_), y = static_cast<int>(texel / size_);
        for (uint32_t n = 0; n < kNeighbours; ++n) {
            const glm::ivec2 to = glm::ivec2(x, y) + shader::seamOffset(n);
            const auto last = static_cast<int>(size_) - 1;
            if (to.x < 0 || to.y < 0 || to.x > last || to.y > last) continue;
            if (page_ != size_ && !LightmapPages::together(page_, {x, y}, to)) continue; // strangers
            f(n, static_cast<uint32_t>(to.y) * size_ + static_cast<uint32_t>(to.x));
        }
    }

    void addRing(uint8_t ring) {
        std::vector<uint32_t> texels;
        for (uint32_t from : frontier_) {
            forNeighbours(from, [&](uint32_t, uint32_t to) {
                if (ring_[to] != kEmpty) return;
                ring_[to] = ring;
                texels.push_back(to);
            });
        }
        std::sort(texels.begin(), texels.end()); // neighbouring lanes then write neighbouring texels
        std::vector<glm::uvec2> fills;
        std::vector<uint32_t> counts(size_t{plan_.chunkCount} + 1, 0);
        for (uint32_t texel : texels) {
            fills.push_back(fillOf(texel, ring));
            for (uint32_t chunk : chunksOf(texel))
                ++counts[chunk + 1];
        }
        for (size_t c = 1; c < counts.size(); ++c)
            counts[c] += counts[c - 1];
        const auto base = static_cast<uint32_t>(plan_.fills.size());
        for (uint32_t c = 0; c < plan_.chunkCount; ++c)
            plan_.starts.push_back(base + counts[c]);
        plan_.fills.resize(base + counts.back());
        for (size_t i = 0; i < texels.size(); ++i)
            for (uint32_t chunk : chunksOf(texels[i]))
                plan_.fills[base + counts[chunk]++] = fills[i];
        frontier_ = std::move(texels);
    }

    // Notes which chunks the texel depends on and returns its entry.
    glm::uvec2 fillOf(uint32_t texel, uint8_t ring) {
        std::vector<uint32_t> chunks;
        uint32_t mask = 0;
        forNeighbours(texel, [&](uint32_t n, uint32_t from) {
            if (ring_[from] < ring) mask |= 1u << n;
        });
        if (ring == 1) mask = sources_.choose(texel, mask);
        forNeighbours(texel, [&](uint32_t n, uint32_t from) {
            if ((mask >> n & 1u) == 0) return;
            if (ring_[from] == 0)
                chunks.push_back(place_[from]);
            else {
                const auto all = chunksOf(from);
                chunks.insert(chunks.end(), all.begin(), all.end());
            }
        });
        std::sort(chunks.begin(), chunks.end());
        chunks.erase(std::unique(chunks.begin(), chunks.end()), chunks.end());
        place_[texel] = static_cast<uint32_t>(chunkLists_.size());
        chunkLists_.push_back(static_cast<uint32_t>(chunks.size()));
        chunkLists_.insert(chunkLists_.end(), chunks.begin(), chunks.end());
        return {texel, mask};
    }

    std::span<const uint32_t> chunksOf(uint32_t filled) const {
        const uint32_t at = place_[filled];
        return std::span(chunkLists_).subspan(size_t{at} + 1, chunkLists_[at]);
    }

    const SeamSources sources_;
    const uint32_t size_, page_;
    SeamPlan plan_;
    std::vector<uint8_t> ring_;        // per texel: 0 shows a patch, kEmpty nothing
    std::vector<uint32_t> place_;      // per texel: its chunk; of a filled one where its list begins
    std::vector<uint32_t> chunkLists_; // of filled texels: how many chunks, and these
    std::vector<uint32_t> frontier_;   // texels of the ring before
};

} // namespace

SeamPlan buildSeamPlan(const PatchSet& patches, uint32_t rings) {
    return SeamPlanBuilder(patches, rings).build();
}

std::vector<uint32_t> shownTexels(const PatchSet& set) {
    std::vector<uint32_t> texels(set.scene.patches.size(), kNoTexel);
    for (uint32_t texel = 0; texel < set.scene.texelToPatch.size(); ++texel) {
        const uint32_t patch = set.scene.texelToPatch[texel];
        if (patch != shader::kNoPatch && (set.scene.patches[patch].flags & shader::kPatchSends) != 0)
            texels[patch] = texel;
    }
    return texels;
}

} // namespace relume
