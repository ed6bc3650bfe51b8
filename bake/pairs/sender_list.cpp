#include "bake/pairs/sender_list.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;

constexpr uint32_t kTile = 8; // windows, as tiles of texels: a full tile is one chunk

glm::uvec2 texelPlace(const PatchSet& set, uint32_t patch) {
    const uint32_t texel = shader::patchTexel(set.scene.patches[patch].flags);
    return {texel % set.scene.size, texel / set.scene.size};
}

// The windows of a lightmap in the order of tiles of 8 x 8.
struct WindowOrder {
    uint32_t tiles; // in a row

    WindowOrder(uint32_t size, uint32_t edge) : tiles(((size + edge - 1) / edge + kTile - 1) / kTile) {}
    uint32_t count() const { return tiles * tiles * kTile * kTile; }
    uint32_t operator()(glm::uvec2 window) const {
        const glm::uvec2 tile = window / kTile, in = window % kTile;
        return (tile.y * tiles + tile.x) * kTile * kTile + in.y * kTile + in.x;
    }
    glm::uvec2 windowAt(uint32_t order) const {
        const uint32_t tile = order / (kTile * kTile), in = order % (kTile * kTile);
        return glm::uvec2(tile % tiles, tile / tiles) * kTile + glm::uvec2(in % kTile, in / kTile);
    }
};

// This is RTRad's integer hash; its jitter within a window follows.
uint32_t rtradHash(uint32_t x) {
    x = (x ^ 61) ^ (x >> 16);
    x *= 9;
    x ^= x >> 4;
    x *= 0x27d4eb2d;
    x ^= x >> 15;
    return x;
}
glm::uvec2 rtradJitter(glm::uvec2 corner, uint32_t edge) {
    const uint32_t k = (corner.x + 1) * (corner.y + 1);
    return {rtradHash(rtradHash(k) % 7864128) % edge, rtradHash(rtradHash(k) % 5490141) % edge};
}

} // namespace

void SenderListBuilder::addShape(const shader::Patch& patch, const shader::PatchEdges& edges) {
    list_.patches.push_back(patch);
    list_.edges.push_back(edges);
}

void SenderListBuilder::addWeighted(uint32_t patch, float weight) {
    list_.senders.push_back({static_cast<uint32_t>(list_.members.size()), 1, 0});
    list_.members.push_back(patch);
    list_.weights.push_back(weight);
    addShape(patches_.scene.patches[patch], patches_.edges[patch]);
}

// Adds a parallelogram that is that of the rectangle of texels that the members lie in, scaled to their area,
// about their mean position: it is exact for whole windows on a plane.
void SenderListBuilder::add(const std::vector<uint32_t>& members, size_t first, uint32_t key) {
    const uint32_t face = members[first];
    const auto begin = static_cast<uint32_t>(list_.members.size());
    list_.senders.push_back({begin, static_cast<uint32_t>(members.size()), key});
    list_.members.insert(list_.members.end(), members.begin(), members.end());
    std::swap(list_.members[begin], list_.members[begin + first]);
    if (members.size() == 1) return addShape(patches_.scene.patches[face], patches_.edges[face]);
    shader::Patch patch = patches_.scene.patches[face];
    shader::PatchEdges edges = patches_.edges[face];
    glm::dvec3 position(0.0), normal(0.0);
    double area = 0.0;
    glm::uvec2 lo(std::numeric_limits<uint32_t>::max()), hi(0);
    for (uint32_t m : members) {
        const shader::Patch& p = patches_.scene.patches[m];
        position += double{p.area} * glm::dvec3(p.position);
        normal += double{p.area} * glm::dvec3(p.normal);
        area += p.area;
        lo = glm::min(lo, texelPlace(patches_, m));
        hi = glm::max(hi, texelPlace(patches_, m));
    }
    const glm::uvec2 extent = hi - lo + 1u;
    if (area > 0.0 && patch.area > 0.0f) {
        const double scale = std::sqrt(area / (double{patch.area} * extent.x * extent.y));
        edges.du *= static_cast<float>(extent.x * scale);
        edges.dv *= static_cast<float>(extent.y * scale);
        patch.position = glm::vec3(position / area);
        if (glm::length(normal) > 0.0) patch.normal = glm::vec3(glm::normalize(normal));
    }
    patch.area = static_cast<float>(area);
    addShape(patch, edges);
}

SenderList SenderListBuilder::finish() {
    list_.count = static_cast<uint32_t>(list_.senders.size());
    while (list_.senders.empty() || list_.senders.size() % kChunk != 0) {
        list_.senders.push_back({0, 0, 0});
        addShape({}, {});
    }
    for (size_t first = 0; first < list_.senders.size(); first += kChunk) {
        shader::ChunkBounds b{glm::vec3(std::numeric_limits<float>::max()),
                              glm::vec3(std::numeric_limits<float>::lowest()), 0.0f};
        for (size_t i = first; i < std::min<size_t>(first + kChunk, list_.count); ++i) {
            const shader::Sender& sender = list_.senders[i];
            for (uint32_t m = sender.first; m < sender.first + sender.count; ++m) {
                b.lo = glm::min(b.lo, patches_.scene.patches[list_.members[m]].position);
                b.hi = glm::max(b.hi, patches_.scene.patches[list_.members[m]].position);
            }
            b.size = std::max(b.size, std::sqrt(list_.patches[i].area));
        }
        list_.bounds.push_back(b);
    }
    return std::move(list_);
}

size_t nearestToMiddle(const PatchSet& set, const std::vector<uint32_t>& members) {
    glm::dvec2 middle(0.0);
    for (uint32_t m : members)
        middle += glm::dvec2(texelPlace(set, m));
    middle /= static_cast<double>(members.size());
    size_t best = 0;
    double bestDistance = std::numeric_limits<double>::max();
    for (size_t i = 0; i < members.size(); ++i) {
        const glm::dvec2 d = glm::dvec2(texelPlace(set, members[i])) - middle;
        if (glm::dot(d, d) >= bestDistance) continue;
        bestDistance = glm::dot(d, d);
        best = i;
    }
    return best;
}

// A back side has no chart of its own: it goes by its front's. Where the front is not to be found (in charts
// that cover no texel centre) it stays alone.
uint32_t senderKey(const shader::Patch& first) {
    // Draws of earlier versions stay: a texel's number took 24 bits then. Above, two senders may share a key,
    // which receivers mix with their own.
    constexpr uint32_t kShift = 8;
    return shader::patchTexel(first.flags) << kShift | (first.flags & shader::kFlagBits);
}

std::vector<uint32_t> mergeableParts(const PatchSet& set) {
    const uint32_t charts = set.scene.mesh.chartCount;
    uint32_t alone = 2 * charts;
    std::vector<uint32_t> parts(set.scene.patches.size());
    for (uint32_t i = 0; i < parts.size(); ++i) {
        const shader::Patch& patch = set.scene.patches[i];
        const bool back = (patch.flags & shader::kPatchBackSide) != 0;
        const uint32_t front =
            i < set.count ? set.scene.texelToPatch[shader::patchTexel(patch.flags)] : kNoPatch;
        if (front != kNoPatch && set.scene.patches[front].position == patch.position)
            parts[i] = 2 * set.scene.patchChart[front] + (back ? 1 : 0);
        else
            parts[i] = alone++;
    }
    return parts;
}

SenderList windowSenders(const PatchSet& set, uint32_t edge) {
    const WindowOrder order(set.scene.size, edge);
    std::vector<uint32_t> start(size_t{order.count()} + 1, 0);
    const auto sends = [&](uint32_t i) { return (set.scene.patches[i].flags & shader::kPatchSends) != 0; };
    for (uint32_t i = 0; i < set.count; ++i)
        start[order(texelPlace(set, i) / edge) + 1] += sends(i);
    for (size_t w = 1; w < start.size(); ++w)
        start[w] += start[w - 1];
    std::vector<uint32_t> sorted(start.back()), next(start);
    for (uint32_t i = 0; i < set.count; ++i)
        if (sends(i)) sorted[next[order(texelPlace(set, i) / edge)]++] = i;

    const std::vector<uint32_t> parts = mergeableParts(set);
    SenderListBuilder builder(set);
    std::vector<uint32_t> members;
    for (uint32_t w = 0; w < order.count(); ++w) {
        const auto first = sorted.begin() + start[w], last = sorted.begin() + start[w + 1];
        std::stable_sort(first, last, [&](uint32_t a, uint32_t b) { return parts[a] < parts[b]; });
        for (auto run = first; run != last;) {
            const auto end = std::find_if(run, last, [&](uint32_t p) { return parts[p] != parts[*run]; });
            members.assign(run, end);
            builder.add(members, nearestToMiddle(set, members), senderKey(set.scene.patches[members[0]]));
            run = end;
        }
    }
    return builder.finish();
}

SenderList rtradSenders(const PatchSet& set, uint32_t edge, bool jittered) {
    const WindowOrder order(set.scene.size, edge);
    const uint32_t size = set.scene.size;
    SenderListBuilder builder(set);
    for (uint32_t w = 0; w < order.count(); ++w) {
        const glm::uvec2 corner = order.windowAt(w) * edge;
        if (corner.x >= size || corner.y >= size) continue;
        const uint32_t atCorner = set.scene.texelToPatch[size_t{corner.y} * size + corner.x];
        if (atCorner == kNoPatch) continue;
        const glm::uvec2 texel = corner + (jittered ? rtradJitter(corner, edge) : glm::uvec2(0));
        if (texel.x >= size || texel.y >= size) continue;
        const uint32_t patch = set.scene.texelToPatch[size_t{texel.y} * size + texel.x];
        if (patch != kNoPatch) builder.addWeighted(patch, static_cast<float>(edge * edge));
    }
    return builder.finish();
}

} // namespace relume
