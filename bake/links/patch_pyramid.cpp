#include "bake/links/patch_pyramid.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>

namespace relume {
namespace {

using shader::kNoPatch;

// Patches do not count as one where their mean normal is shorter than this: a fold of 52 degrees has it, or
// an arc of 88. What lies around an edge is lit by something else.
constexpr double kLeastEvenness = 0.9;

// A patch or node that stands for some texels of a chart.
struct TexelGroup {
    uint64_t place = 0; // chart, then texel in Morton order
    uint32_t index = 0; // patch or node; kNoPatch: they do not count as one
};

// Sums over the area of a patch or node.
struct Moments {
    double area = 0;          // [m^2]
    glm::dvec3 position{0.0}; // [m]
    double square = 0;        // of the distance from the origin [m^2]
    glm::dvec3 normal{0.0};
    double size = 0; // PyramidNode::size

    void add(const Moments& m) {
        area += m.area;
        position += m.position;
        square += m.square;
        normal += m.normal;
        size = std::max(size, m.size);
    }
};

uint32_t inEvenBits(uint32_t x) {
    x = (x | x << 8) & 0x00ff00ffu;
    x = (x | x << 4) & 0x0f0f0f0fu;
    x = (x | x << 2) & 0x33333333u;
    return (x | x << 1) & 0x55555555u;
}

class PyramidBuilder {
public:
    explicit PyramidBuilder(const PatchSet& set)
        : set_(set), patchCount_(static_cast<uint32_t>(set.scene.patches.size())) {}

    PatchPyramid build() {
        result_.parents.assign(patchCount_, kNoPatch);
        std::vector<TexelGroup> items = patchItems();
        const auto levels = static_cast<uint32_t>(std::bit_width(set_.scene.size - 1));
        for (uint32_t level = 1; level <= levels; ++level) {
            const size_t before = result_.nodes.size();
            mergeItems(items, level);
            if (result_.nodes.size() > before)
                result_.levelEnds.push_back(static_cast<uint32_t>(result_.nodes.size()));
        }
        return std::move(result_);
    }

private:
    // Returns patches in order of their places, so that what belongs together at any level is side by side.
    std::vector<TexelGroup> patchItems() const {
        std::vector<TexelGroup> items;
        items.reserve(set_.count);
        const uint32_t size = set_.scene.size;
        for (uint32_t texel = 0; texel < size * size; ++texel) {
            const uint32_t i = set_.scene.texelToPatch[texel];
            if (i == kNoPatch || (set_.scene.patches[i].flags & shader::kPatchSends) == 0) continue;
            const uint32_t morton = inEvenBits(texel % size) | inEvenBits(texel / size) << 1;
            items.push_back({uint64_t{set_.scene.patchChart[i]} << 32 | morton, i});
        }
        std::sort(items.begin(), items.end(),
                  [](const TexelGroup& a, const TexelGroup& b) { return a.place < b.place; });
        return items;
    }

    // Makes one item of each group of 2^level texels squared.
    void mergeItems(std::vector<TexelGroup>& items, uint32_t level) {
        size_t kept = 0;
        for (size_t first = 0; first < items.size();) {
            size_t end = first + 1;
            while (end < items.size() && items[end].place >> (2 * level) == items[first].place >> (2 * level))
                ++end;
            const uint32_t index = merged(std::span(items).subspan(first, end - first));
            items[kept++] = {items[first].place, index};
            first = end;
        }
        items.resize(kept);
    }

    uint32_t merged(std::span<const TexelGroup> children) {
        if (children.size() == 1) return children[0].index;
        Moments sum;
        for (const TexelGroup& child : children) {
            if (child.index == kNoPatch) return kNoPatch;
            sum.add(momentsOf(child.index));
        }
        if (!(sum.area > 0) || glm::length(sum.normal) < kLeastEvenness * sum.area) return kNoPatch;
        const glm::dvec3 mean = sum.position / sum.area;
        // In a square of area A the mean square distance from the middle is A / 6.
        const double spread = 6.0 * (sum.square / sum.area - glm::dot(mean, mean));
        sum.size = std::max({sum.size, sum.area, spread});
        shader::PyramidNode node{glm::vec3(mean), static_cast<float>(sum.size), glm::uvec4(children[0].index),
                                 glm::vec4(0.0f), kNoPatch};
        const auto index = patchCount_ + static_cast<uint32_t>(result_.nodes.size());
        for (size_t c = 0; c < children.size(); ++c) {
            const auto k = static_cast<glm::length_t>(c);
            node.children[k] = children[c].index;
            node.shares[k] = static_cast<float>(momentsOf(children[c].index).area / sum.area);
            parentOf(children[c].index) = index;
        }
        result_.nodes.push_back(node);
        moments_.push_back(sum);
        return index;
    }

    Moments momentsOf(uint32_t index) const {
        if (index >= patchCount_) return moments_[index - patchCount_];
        const shader::Patch& p = set_.scene.patches[index];
        const glm::dvec3 position(p.position);
        const double area = p.area;
        return {area, area * position, area * (glm::dot(position, position) + area / 6.0),
                area * glm::dvec3(p.normal), area};
    }
    uint32_t& parentOf(uint32_t index) {
        return index < patchCount_ ? result_.parents[index] : result_.nodes[index - patchCount_].parent;
    }

    const PatchSet& set_;
    const uint32_t patchCount_; // padding included
    PatchPyramid result_;
    std::vector<Moments> moments_; // per node
};

} // namespace

PatchPyramid buildPatchPyramid(const PatchSet& patches) {
    return PyramidBuilder(patches).build();
}

} // namespace relume
