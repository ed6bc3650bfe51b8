#include "bake/layers/layer_carry.h"

#include "assets/base/worker_pool.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;

// A thread takes so many chunks in one go.
constexpr uint32_t kChunksOfTask = 64;

bool isEmpty(const ObjectMove& move) {
    return move.boxes.empty() && std::all_of(move.changed.begin(), move.changed.end(),
                                             [](const glm::uvec2& bits) { return (bits.x | bits.y) == 0; });
}

LightCacheKey withoutState(LightCacheKey cacheKey) {
    cacheKey.surfaces = cacheKey.objects = 0;
    return cacheKey;
}

// Does what the other one does, on all cores.
void carryValues(const PatchCarry& carry, const glm::vec4* from, glm::vec4* to, WorkerPool& pool) {
    constexpr size_t kPatches = size_t{kChunksOfTask} * kChunk;
    const size_t count = carry.former.size();
    pool.run(static_cast<uint32_t>((count + kPatches - 1) / kPatches), [&](uint32_t task) {
        for (size_t i = task * kPatches; i < std::min(count, (task + 1) * kPatches); ++i)
            to[i] = carry.former[i] == kNoPatch ? glm::vec4(0.0f) : from[carry.former[i]];
    });
}

// Tells whether all patches that stay are where they were. What is kept of the others is repaired there.
bool isInPlace(const PatchCarry& carry) {
    bool inPlace = carry.former.size() == carry.now.size();
    for (uint32_t i = 0; inPlace && i < carry.former.size(); ++i)
        inPlace = carry.former[i] == i || carry.former[i] == kNoPatch;
    return inPlace;
}

/// Gives the layers of one solver what the one before it has left.
class Carrier {
public:
    Carrier(LinkKit& kit, LayerStore& store, const MoveReach& reach, const LayerCarry& carry)
        : kit_(kit), store_(store), reach_(reach), carry_(carry), inPlace_(isInPlace(carry.patches)) {}

    // Tells whether there was such a layer; `whole` says whether it shows what it did.
    bool layer(Layer& to, bool& whole) {
        const std::unique_ptr<Layer> from = take(to.cacheKey);
        whole = false;
        if (!from || from->directSamplePasses == 0) return false;
        direct(*from, to);
        whole = carry_.patches.same && isEmpty(carry_.move) && carry_.sameColours && from->has() &&
                from->cacheKey.surfaces == carry_.former.state.surfaces;
        whole ? result(*from, to) : redo(*from, to);
        return true;
    }

    // Fills the cache; tells whether there are any links.
    bool links(LinkCache& cache) {
        std::deque<LinkCache::SamplePass> samplePasses = std::exchange(carry_.former.links, {});
        if (carry_.former.linksOfSamplePass != kit_.linksOfSamplePass) return false;
        if (inPlace_) { // a link to what is no more is traced again wherever it leads to
            cache.takeOver(std::move(samplePasses));
            return cache.samplePasses() > 0;
        }
        for (uint32_t samplePass = 0; !samplePasses.empty(); ++samplePass, samplePasses.pop_front())
            if (!linksOf(samplePass, samplePasses.front(), cache)) break;
        return cache.samplePasses() > 0;
    }

private:
    // Takes the former layer of the light, nullptr where there is none. A group that was dark while objects
    // moved has not followed them.
    std::unique_ptr<Layer> take(const LightCacheKey& cacheKey) {
        const std::optional<LightCacheKey> then = formerCacheKey(cacheKey, carry_);
        std::vector<std::unique_ptr<Layer>>& all = carry_.former.layers;
        const auto found = std::find_if(all.begin(), all.end(), [&](const std::unique_ptr<Layer>& layer) {
            return then && layer->cacheKey.objects == carry_.former.state.objects &&
                   withoutState(layer->cacheKey) == *then;
        });
        if (found == all.end()) return nullptr;
        std::unique_ptr<Layer> layer = std::move(*found);
        all.erase(found);
        return layer;
    }

    void direct(const Layer& from, Layer& to) {
        const PatchCarry& patches = carry_.patches;
        to.directSamplePasses = from.directSamplePasses;
        to.directSteps = from.directSteps;
        if (inPlace_) to.direct = from.direct; // what is other there is made anew
        if (patches.same) {
            to.penumbra = from.penumbra;
            to.dirty = from.dirty;
            to.begun = from.begun;
        } else {
            if (!inPlace_) values(from, to);
            marks(from, to);
        }
        if (!isEmpty(carry_.move) || reach_.farther) markDirty(reach_, to);
    }

    // Goes from memory to memory where the host sees what the device has.
    void values(const Layer& from, Layer& to) {
        const PatchCarry& patches = carry_.patches;
        to.direct = std::make_shared<vk::Buffer>(store_.takeBuffer("direct light of a layer"));
        std::vector<glm::vec4> read, write;
        const auto* then = static_cast<const glm::vec4*>(from.direct->mapped());
        if (then == nullptr) {
            read = vk::readBuffer<glm::vec4>(kit_.input.device, *from.direct, patches.now.size());
            then = read.data();
        }
        auto* now = static_cast<glm::vec4*>(to.direct->mapped());
        if (now == nullptr) {
            write.resize(patches.former.size());
            now = write.data();
        }
        carryValues(patches, then, now, kit_.input.device.workers());
        if (!write.empty())
            vk::upload(kit_.input.device, *to.direct, write.data(), write.size() * sizeof(write[0]));
    }

    // Carries over where the penumbra is, and what was to be repaired: all of it begins anew.
    void marks(const Layer& from, Layer& to) {
        const std::vector<uint32_t>& former = carry_.patches.former;
        to.penumbra.assign(reach_.parts.count, 0);
        to.dirty.assign(kit_.chunkCount(), 0);
        for (uint32_t i = 0; i < former.size(); ++i) {
            if (former[i] == kNoPatch) continue;
            if (!from.penumbra.empty())
                to.penumbra[reach_.parts.ofPatch[i]] = from.penumbra[carry_.former.partOfPatch[former[i]]];
            if (!from.dirty.empty() && from.dirty[former[i] / kChunk] != 0)
                to.dirty[i / kChunk] = Layer::kDirty;
        }
        const bool clean = std::all_of(to.dirty.begin(), to.dirty.end(), [](uint8_t s) { return s == 0; });
        if (clean) to.dirty.clear();
    }

    static void redo(const Layer& from, Layer& to) {
        to.redo = from.redo;
        if (!from.redo && from.has())
            to.redo = LayerLevel{from.directSamplePasses, from.level.linkSamplePasses};
        to.redoSteps = from.redoSteps;
    }
    static void result(Layer& from, Layer& to) {
        to.result = std::move(from.result);
        to.level = from.level;
        to.width = from.width;
        to.light = from.light;
        to.count = from.count;
        to.directVariance = from.directVariance;
        to.indirectVariance = from.indirectVariance;
        to.iterationError = from.iterationError;
        to.sketch = std::move(from.sketch);
        to.sketch.bias.clear(); // its chunks are others
        to.sketch.number = newSketchNumber();
        to.error = from.error;
        to.redo = from.redo;
        to.redoSteps = from.redoSteps;
        to.plan = from.plan;
    }

    bool linksOf(uint32_t samplePass, const LinkCache::SamplePass& from, LinkCache& cache) {
        const uint32_t chunks = kit_.chunkCount(), samples = kit_.linksOfSamplePass;
        const LinkCache::Place place = cache.find(samplePass, 0, chunks);
        if (place.count < chunks || cache.samplePasses() <= samplePass) return false; // there is no room
        const std::vector<uint8_t> known = carryKnown(carry_.patches, from.known);
        std::vector<uint32_t> read, write;
        const auto* then = static_cast<const uint32_t*>(from.links.mapped());
        if (then == nullptr) {
            read =
                vk::readBuffer<uint32_t>(kit_.input.device, from.links, from.links.size() / sizeof(uint32_t));
            then = read.data();
        }
        auto* now = static_cast<uint32_t*>(place.links->mapped());
        if (now == nullptr) {
            write.resize(place.links->size() / sizeof(uint32_t));
            now = write.data();
        }
        const std::span all(then, from.links.size() / sizeof(uint32_t));
        kit_.input.device.workers().run((chunks + kChunksOfTask - 1) / kChunksOfTask, [&](uint32_t task) {
            const uint32_t end = std::min(chunks, (task + 1) * kChunksOfTask);
            for (uint32_t chunk = task * kChunksOfTask; chunk < end; ++chunk)
                if (known[chunk]) // else its links' memory may hold anything
                    carryLinks(carry_.patches, chunk, samples, all,
                               now + place.offset + size_t{chunk} * samples * kChunk);
        });
        if (!write.empty())
            vk::upload(kit_.input.device, *place.links, write.data(), write.size() * sizeof(uint32_t));
        for (const ChunkRange& range : rangesOf(known, true))
            cache.note(samplePass, range);
        return true;
    }

    LinkKit& kit_;
    LayerStore& store_;
    const MoveReach& reach_;
    const LayerCarry& carry_;
    const bool inPlace_;
};

} // namespace

uint64_t FormerLayers::bytes() const {
    uint64_t bytes = 0;
    for (const LinkCache::SamplePass& samplePass : links)
        bytes += samplePass.links.size();
    for (const std::unique_ptr<Layer>& layer : layers)
        bytes += (layer->direct ? layer->direct->size() : 0) + layer->result.size();
    return bytes;
}

void FormerLayers::keepWithin(uint64_t most) {
    while (!links.empty() && bytes() > most)
        links.pop_back();
    if (bytes() > most) layers.clear();
}

void carryLinks(const PatchCarry& carry, uint32_t chunk, uint32_t samples, std::span<const uint32_t> from,
                uint32_t* to) {
    for (uint32_t i = 0; i < kChunk; ++i) {
        const uint32_t then = carry.former[size_t{chunk} * kChunk + i];
        const size_t place = size_t{then / kChunk} * samples * kChunk + then % kChunk;
        for (uint32_t sample = 0; sample < samples; ++sample) {
            uint32_t link = then == kNoPatch ? shader::kLinkDark : from[place + size_t{sample} * kChunk];
            if (link < shader::kLinkFirstSpecial) {
                link = carry.now[link];
                if (link == kNoPatch) link = shader::kLinkDark;
            }
            to[size_t{sample} * kChunk + i] = link;
        }
    }
}

std::vector<uint8_t> carryKnown(const PatchCarry& carry, std::span<const uint8_t> known) {
    const size_t chunks = carry.former.size() / kChunk;
    std::vector<uint8_t> all(chunks, 1), any(chunks, 0);
    for (size_t i = 0; i < carry.former.size(); ++i) {
        if (carry.former[i] == kNoPatch) continue;
        const uint8_t there = known[carry.former[i] / kChunk];
        all[i / kChunk] &= there;
        any[i / kChunk] |= there;
    }
    for (size_t i = 0; i < chunks; ++i)
        all[i] &= any[i];
    return all;
}

ObjectMove carryMove(const PatchCarry& carry, const ObjectMove& move) {
    ObjectMove now;
    now.boxes = move.boxes;
    now.texels = move.texels;
    now.changed.assign(carry.former.size() / kChunk, glm::uvec2(0));
    for (uint32_t i = 0; i < carry.former.size(); ++i) {
        const uint32_t then = carry.former[i];
        if (then == kNoPatch || move.has(then)) now.change(i);
        if (then != kNoPatch && move.hasEnd(then)) now.addEnd(i);
    }
    return now;
}

std::vector<glm::vec4> carryValues(const PatchCarry& carry, std::span<const glm::vec4> from) {
    std::vector<glm::vec4> values(carry.former.size(), glm::vec4(0.0f));
    for (size_t i = 0; i < values.size(); ++i)
        if (carry.former[i] != kNoPatch) values[i] = from[carry.former[i]];
    return values;
}

std::vector<glm::vec4> carryShown(const LayerCarry& carry, const PatchSet& patches) {
    std::vector<glm::vec4> light = carryValues(carry.patches, carry.former.shown);
    for (uint32_t i = 0; i < patches.count; ++i) {
        const uint32_t texel = shader::patchTexel(patches.scene.patches[i].flags);
        if (carry.patches.former[i] != kNoPatch || texel >= carry.formerTexels.size()) continue;
        const uint32_t then = carry.formerTexels[texel];
        if (then != kNoPatch) light[i] = carry.former.shown[then];
    }
    return light;
}

std::optional<LightCacheKey> formerCacheKey(const LightCacheKey& cacheKey, const LayerCarry& carry) {
    LightCacheKey then = withoutState(cacheKey);
    if (then.kind == LightKey::Kind::Sky && !carry.sameSky) return std::nullopt;
    if (then.kind == LightKey::Kind::Emitter) {
        const auto light = carry.patches.formerLight(then.instance, then.material);
        if (!light) return std::nullopt;
        std::tie(then.instance, then.material) = *light;
    }
    for (LightCacheKey& member : then.members) {
        const std::optional<LightCacheKey> was = formerCacheKey(member, carry);
        if (!was) return std::nullopt;
        member = *was;
    }
    return then;
}

CarriedWork carryLayers(LinkKit& kit, LayerStore& store, LinkCache& cache, const MoveReach& reach,
                        const LayerCarry& carry) {
    Carrier carrier(kit, store, reach, carry);
    CarriedWork work;
    for (const std::unique_ptr<Layer>& layer : store.layers()) {
        bool whole = false;
        work.layers += carrier.layer(*layer, whole);
        work.whole = work.whole && whole;
    }
    carry.former.layers.clear();
    if (!carrier.links(cache)) return work;
    ObjectMove way = carry.move;
    if (carry.former.pending) way.add(carryMove(carry.patches, *carry.former.pending));
    if (!isEmpty(way)) work.relink = std::move(way);
    return work;
}

} // namespace relume
