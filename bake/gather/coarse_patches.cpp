#include "bake/gather/coarse_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace relume {
namespace {

using shader::kChunk;
using shader::kNoPatch;
using shader::Patch;

constexpr uint32_t kTileWindows = 8; // windows
constexpr uint32_t kTaps = 4;
// Members of a part that count for less than this with its receiver get another one: their normals are 40
// degrees apart, or they are half a window off the plane.
constexpr float kLeastLikeness = 0.1f;
// Patches say nothing about each other that are further apart in the world than so many times what the
// distance in the chart says: a chart may come close to itself in the atlas.
constexpr float kMaxStretch = 3.0f;

// The place of a receiver.
struct ReceiverPlace {
    uint32_t patch = kNoPatch, chart = kNoChart;
    glm::ivec2 texel{0};
};

// The patches of a window that belong to one chart.
struct Part {
    std::array<uint32_t, 16> patches{};
    uint32_t count = 0, chart = kNoChart;
};

class CoarseBuilder {
public:
    CoarseBuilder(const PatchSet& set, uint32_t scale)
        : set_(set), scale_(static_cast<int>(scale)), size_(static_cast<int>(set.scene.size)),
          windows_((size_ + scale_ - 1) / scale_), own_(set.scene.patches.size(), kNoPatch),
          begin_(static_cast<size_t>(windows_) * static_cast<size_t>(windows_)), count_(begin_.size()) {}

    CoarsePatches build() {
        const int tiles = (windows_ + static_cast<int>(kTileWindows) - 1) / static_cast<int>(kTileWindows);
        for (int tile = 0; tile < tiles * tiles; ++tile)
            addTile(glm::ivec2(tile % tiles, tile / tiles) * static_cast<int>(kTileWindows));
        for (uint32_t i = 0; i < set_.count; ++i) {
            if (own_[i] == kNoPatch && receives(i)) addReceiver(i, texelOf(i) / scale_);
        }
        result_.count = static_cast<uint32_t>(places_.size());
        while (result_.receivers.size() % kChunk != 0)
            result_.receivers.push_back({});
        result_.taps.resize(set_.scene.patches.size());
        for (uint32_t i = 0; i < set_.count; ++i) {
            if (own_[i] != kNoPatch) result_.taps[i] = tapsOf(i);
        }
        addNeighbours();
        return std::move(result_);
    }

private:
    bool receives(uint32_t i) const {
        const uint32_t flags = set_.scene.patches[i].flags;
        return (flags & shader::kPatchSends) != 0 && (flags & shader::kPatchBackSide) == 0;
    }
    glm::ivec2 texelOf(uint32_t i) const {
        const int key = static_cast<int>(shader::patchTexel(set_.scene.patches[i].flags));
        return {key % size_, key / size_};
    }
    bool placed(uint32_t i) const {
        return set_.scene.texelToPatch[shader::patchTexel(set_.scene.patches[i].flags)] == i;
    }
    size_t windowIndex(glm::ivec2 window) const {
        return static_cast<size_t>(window.y) * static_cast<size_t>(windows_) + static_cast<size_t>(window.x);
    }
    bool inGrid(glm::ivec2 window) const {
        return window.x >= 0 && window.y >= 0 && window.x < windows_ && window.y < windows_;
    }
    // Returns the patch of a texel, if there is one of this chart that receives.
    uint32_t patchAt(glm::ivec2 texel, uint32_t chart) const {
        if (texel.x < 0 || texel.y < 0 || texel.x >= size_ || texel.y >= size_) return kNoPatch;
        const uint32_t i = set_.scene.texelToPatch[static_cast<size_t>(texel.y) * static_cast<size_t>(size_) +
                                                   static_cast<size_t>(texel.x)];
        return i != kNoPatch && receives(i) && set_.scene.patchChart[i] == chart ? i : kNoPatch;
    }

    void addTile(glm::ivec2 first) {
        const glm::ivec2 end = glm::min(first + static_cast<int>(kTileWindows), glm::ivec2(windows_));
        for (int y = first.y; y < end.y; ++y) {
            for (int x = first.x; x < end.x; ++x)
                addWindow({x, y});
        }
    }

    void addWindow(glm::ivec2 window) {
        const size_t w = windowIndex(window);
        begin_[w] = static_cast<uint32_t>(places_.size());
        std::array<Part, 16> parts;
        uint32_t partCount = 0;
        const glm::ivec2 end = glm::min((window + 1) * scale_, glm::ivec2(size_));
        for (int y = window.y * scale_; y < end.y; ++y) {
            for (int x = window.x * scale_; x < end.x; ++x) {
                const uint32_t i =
                    set_.scene.texelToPatch[static_cast<size_t>(y) * static_cast<size_t>(size_) +
                                            static_cast<size_t>(x)];
                if (i == kNoPatch || !receives(i)) continue;
                const uint32_t chart = set_.scene.patchChart[i];
                uint32_t p = 0;
                while (p < partCount && parts[p].chart != chart)
                    ++p;
                partCount = std::max(partCount, p + 1);
                parts[p].chart = chart;
                parts[p].patches[parts[p].count++] = i;
            }
        }
        for (uint32_t p = 0; p < partCount; ++p)
            addPart(window, parts[p]);
        count_[w] = static_cast<uint32_t>(places_.size()) - begin_[w];
    }

    // Adds the patch in the middle first, then whoever is too unlike it.
    void addPart(glm::ivec2 window, Part& part) {
        const glm::vec2 wanted = wantedPlace(window, part);
        while (part.count > 0) {
            uint32_t best = part.patches[0];
            float nearest = std::numeric_limits<float>::max();
            for (uint32_t k = 0; k < part.count; ++k) {
                const glm::vec2 d = glm::vec2(texelOf(part.patches[k])) - wanted;
                if (glm::dot(d, d) >= nearest) continue;
                nearest = glm::dot(d, d);
                best = part.patches[k];
            }
            const auto index = static_cast<uint32_t>(places_.size());
            addReceiver(best, window);
            uint32_t left = 0;
            for (uint32_t k = 0; k < part.count; ++k) {
                const uint32_t i = part.patches[k];
                if (i == best || likeness(i, best) >= kLeastLikeness)
                    own_[i] = index;
                else
                    part.patches[left++] = i;
            }
            part.count = left;
        }
    }

    // Returns the part's middle; where the chart ends beside the window it is its edge, so that light need
    // not be guessed beyond the last receiver.
    glm::vec2 wantedPlace(glm::ivec2 window, const Part& part) const {
        glm::ivec2 lo(size_), hi(-1);
        glm::vec2 sum(0.0f);
        for (uint32_t k = 0; k < part.count; ++k) {
            const glm::ivec2 t = texelOf(part.patches[k]);
            lo = glm::min(lo, t), hi = glm::max(hi, t);
            sum += glm::vec2(t);
        }
        glm::vec2 wanted = sum / static_cast<float>(part.count);
        for (int axis = 0; axis < 2; ++axis) {
            const bool before = continues(window, axis, -1, part.chart),
                       after = continues(window, axis, 1, part.chart);
            if (!before && after) wanted[axis] = static_cast<float>(lo[axis]);
            if (before && !after) wanted[axis] = static_cast<float>(hi[axis]);
        }
        return wanted;
    }

    bool continues(glm::ivec2 window, int axis, int side, uint32_t chart) const {
        glm::ivec2 other = window;
        other[axis] += side;
        for (int y = 0; y < scale_; ++y) {
            for (int x = 0; x < scale_; ++x)
                if (patchAt(other * scale_ + glm::ivec2(x, y), chart) != kNoPatch) return true;
        }
        return false;
    }

    void addReceiver(uint32_t i, glm::ivec2 window) {
        own_[i] = static_cast<uint32_t>(places_.size());
        places_.push_back({i, set_.scene.patchChart[i], texelOf(i)});
        Patch receiver = set_.scene.patches[i];
        const auto key = static_cast<uint32_t>(window.y * size_ + window.x);
        receiver.flags = (receiver.flags & shader::kFlagBits) | key << shader::kTexelShift;
        result_.receivers.push_back(receiver);
    }

    // Returns how much patch j says about i, as in shaders/lib/smoothing.glsl but for the distance, which the
    // place in the chart tells. It is 1 on an even surface.
    float likeness(uint32_t i, uint32_t j) const {
        const Patch &a = set_.scene.patches[i], &b = set_.scene.patches[j];
        const glm::vec3 d = b.position - a.position;
        const glm::vec2 texels(texelOf(j) - texelOf(i));
        const shader::PatchEdges& edges = set_.edges[i];
        const float expected = glm::length(texels.x * edges.du) + glm::length(texels.y * edges.dv);
        if (glm::length(d) > kMaxStretch * expected) return 0.0f;
        const float height = std::max(std::abs(glm::dot(d, a.normal)), std::abs(glm::dot(d, b.normal)));
        const float sigma = static_cast<float>(scale_);
        const float off = 16.0f * height * height / (std::max(a.area, 1e-30f) * sigma * sigma);
        const float facing = std::max(glm::dot(a.shading, b.shading), 0.0f);
        const float facing2 = facing * facing, facing4 = facing2 * facing2;
        return std::exp(-0.5f * off) * facing4 * facing4;
    }

    void addNeighbours() {
        for (uint32_t r = 0; r < result_.count; ++r) {
            const uint32_t own = places_[r].patch;
            shader::CoarseNeighbours n{own, own, own, own, own, 0.0f, 0.0f};
            if (placed(own)) {
                n.shareX = between(r, 0, n.left, n.right);
                n.shareY = between(r, 1, n.below, n.above);
            }
            result_.neighbours.push_back(n);
        }
        result_.neighbours.resize(result_.receivers.size());
    }

    // Finds the patches of the receivers on both sides of one, if there are two; returns the share of the
    // first in what a straight line through both says.
    float between(uint32_t receiver, int axis, uint32_t& before, uint32_t& after) const {
        const ReceiverPlace& own = places_[receiver];
        glm::ivec2 step(0);
        step[axis] = 1;
        float like = 0.0f;
        const uint32_t a = receiverIn(own.texel / scale_ - step, own.patch, like);
        if (a == kNoPatch || like < kLeastLikeness) return 0.0f;
        const uint32_t b = receiverIn(own.texel / scale_ + step, own.patch, like);
        if (b == kNoPatch || like < kLeastLikeness) return 0.0f;
        before = places_[a].patch, after = places_[b].patch;
        const int first = places_[a].texel[axis], last = places_[b].texel[axis];
        return static_cast<float>(last - own.texel[axis]) / static_cast<float>(last - first);
    }

    // Returns the one of a window's receivers that suits a patch best.
    uint32_t receiverIn(glm::ivec2 window, uint32_t i, float& like) const {
        like = 0.0f;
        uint32_t best = kNoPatch;
        if (!inGrid(window)) return best;
        const size_t w = windowIndex(window);
        for (uint32_t r = begin_[w]; r < begin_[w] + count_[w]; ++r) {
            if (places_[r].chart != set_.scene.patchChart[i]) continue;
            const float l = likeness(i, places_[r].patch);
            if (l <= like) continue;
            like = l;
            best = r;
        }
        return best;
    }

    shader::CoarseTaps tapsOf(uint32_t i) const {
        std::array<uint32_t, kTaps> receivers = {own_[i], own_[i], own_[i], own_[i]};
        std::array<float, kTaps> weights = {1.0f, 0.0f, 0.0f, 0.0f};
        if (placed(i)) interpolate(i, receivers, weights);
        return {receivers[0], receivers[1], receivers[2], receivers[3],
                glm::vec4(weights[0], weights[1], weights[2], weights[3])};
    }

    // Interpolates bilinearly between the own window's receiver and those of the windows on the side where
    // the patch lies.
    void interpolate(uint32_t i, std::array<uint32_t, kTaps>& receivers,
                     std::array<float, kTaps>& weights) const {
        const glm::ivec2 texel = texelOf(i), window = texel / scale_;
        const glm::ivec2 offset = texel - places_[own_[i]].texel, side = glm::sign(offset);
        std::array<float, kTaps> like = {std::max(likeness(i, places_[own_[i]].patch), kLeastLikeness)};
        glm::vec2 reach(0.0f); // to the next receivers [texels]
        for (uint32_t t = 1; t < kTaps; ++t) {
            const glm::ivec2 step(t & 1, t >> 1);
            if ((step.x != 0 && side.x == 0) || (step.y != 0 && side.y == 0)) continue;
            const uint32_t r = receiverIn(window + step * side, i, like[t]);
            if (r == kNoPatch) continue;
            receivers[t] = r;
            const glm::vec2 gap = glm::abs(glm::vec2(places_[r].texel - places_[own_[i]].texel));
            for (int axis = 0; axis < 2; ++axis)
                if (step[axis] != 0 && reach[axis] == 0.0f) reach[axis] = gap[axis];
        }
        glm::vec2 share(0.0f);
        for (int axis = 0; axis < 2; ++axis)
            if (reach[axis] > 0.0f)
                share[axis] = std::min(1.0f, std::abs(static_cast<float>(offset[axis])) / reach[axis]);
        weights = {(1 - share.x) * (1 - share.y) * like[0], share.x * (1 - share.y) * like[1],
                   (1 - share.x) * share.y * like[2], share.x * share.y * like[3]};
        straighten(texel, receivers, weights);
        const float sum = weights[0] + weights[1] + weights[2] + weights[3];
        for (float& w : weights)
            w /= sum;
    }

    // Makes the weights reproduce a straight line, which they do by themselves on a regular grid, where they
    // stay positive [Fan and Gijbels 1996].
    void straighten(glm::ivec2 texel, const std::array<uint32_t, kTaps>& receivers,
                    std::array<float, kTaps>& weights) const {
        std::array<glm::vec2, kTaps> d;
        double s0 = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
        for (uint32_t t = 0; t < kTaps; ++t) {
            d[t] = glm::vec2(places_[receivers[t]].texel - texel);
            const double w = weights[t], x = d[t].x, y = d[t].y;
            s0 += w, sx += w * x, sy += w * y, sxx += w * x * x, sxy += w * x * y, syy += w * y * y;
        }
        // This is the first row of the inverse of the moments, up to a factor.
        const double a = sxx * syy - sxy * sxy, b = sxy * sy - sx * syy, c = sx * sxy - sxx * sy;
        const double det = s0 * a + sx * b + sy * c;
        if (det <= 1e-3 * s0 * s0 * s0) return;
        std::array<float, kTaps> straight{};
        for (uint32_t t = 0; t < kTaps; ++t) {
            const double factor = (a + b * d[t].x + c * d[t].y) / det;
            if (weights[t] > 0.0f && factor < 0.0) return;
            straight[t] = static_cast<float>(weights[t] * factor);
        }
        weights = straight;
    }

    const PatchSet& set_;
    const int scale_, size_, windows_;    // windows_: along an edge
    std::vector<uint32_t> own_;           // per patch: the receiver that stands for it
    std::vector<uint32_t> begin_, count_; // per window: its receivers
    std::vector<ReceiverPlace> places_;   // per receiver
    CoarsePatches result_;
};

} // namespace

CoarsePatches buildCoarsePatches(const PatchSet& patches, uint32_t scale) {
    return CoarseBuilder(patches, scale).build();
}

} // namespace relume
