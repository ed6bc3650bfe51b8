#include "bake/pairs/quad_tree.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace relume {
namespace {

using shader::kNoPatch;

bool isDark(const glm::vec4& radiance) {
    return radiance.r == 0.0f && radiance.g == 0.0f && radiance.b == 0.0f;
}

float gradient(glm::vec3 light, glm::vec3 light0, glm::vec3 normal, glm::vec3 normal0) {
    return 0.5f * glm::distance(light, light0) + 0.5f * glm::distance(normal, normal0);
}

class QuadTreeBuilder {
public:
    QuadTreeBuilder(const PatchSet& patches, const std::vector<uint32_t>& parts,
                    const std::vector<glm::vec4>& radiance, const QuadTreeDesc& desc)
        : set_(patches), parts_(parts), radiance_(radiance), desc_(desc), list_(patches) {
        double sum = 0.0;
        for (uint32_t i = 0; i < set_.count; ++i)
            sum += glm::length(glm::vec3(radiance[i]));
        scale_ = sum > 0.0 ? static_cast<float>(set_.count / sum) : 0.0f;
    }

    SenderList build() {
        std::vector<uint32_t> all;
        for (uint32_t i = 0; i < set_.count; ++i)
            if ((set_.scene.patches[i].flags & shader::kPatchSends) != 0) all.push_back(i);
        uint32_t edge = desc_.node;
        while (edge < set_.scene.size)
            edge *= 2;
        divide(all, edge);
        return list_.finish();
    }

private:
    using Members = std::vector<uint32_t>;
    struct Node {
        std::vector<Members> leaves; // one: all of it is merged
        glm::vec3 light{0.0f};       // mean by area
        glm::vec3 normal{0.0f};
        float area = 0.0f;
    };

    // Divides into quarters in Z-order down to the nodes: neighbours in the list lie close together.
    void divide(const Members& members, uint32_t edge) {
        if (members.empty()) return;
        if (edge == desc_.node) return addNodes(members);
        for (const Members& quarter : quarters(members, edge))
            divide(quarter, edge / 2);
    }

    std::array<Members, 4> quarters(const Members& members, uint32_t edge) const {
        std::array<Members, 4> result;
        for (uint32_t m : members) {
            const uint32_t texel = shader::patchTexel(set_.scene.patches[m].flags);
            const uint32_t x = texel % set_.scene.size, y = texel / set_.scene.size;
            result[(x & edge / 2 ? 1 : 0) + (y & edge / 2 ? 2 : 0)].push_back(m);
        }
        return result;
    }

    void addNodes(Members members) {
        std::stable_sort(members.begin(), members.end(),
                         [&](uint32_t a, uint32_t b) { return parts_[a] < parts_[b]; });
        for (auto run = members.begin(); run != members.end();) {
            const auto end =
                std::find_if(run, members.end(), [&](uint32_t p) { return parts_[p] != parts_[*run]; });
            for (const Members& leaf : node(Members(run, end), desc_.node).leaves)
                addLeaf(leaf);
            run = end;
        }
    }

    void addLeaf(const Members& leaf) {
        const bool dark =
            std::all_of(leaf.begin(), leaf.end(), [&](uint32_t m) { return isDark(radiance_[m]); });
        if (!dark) list_.add(leaf, nearestToMiddle(set_, leaf), senderKey(set_.scene.patches[leaf[0]]));
    }

    Node node(Members members, uint32_t edge) const {
        Node result;
        if (edge == 1) {
            for (uint32_t m : members) // more than one where a chart without texels has its patch
                addTo(result, glm::vec3(radiance_[m]), set_.scene.patches[m].normal,
                      set_.scene.patches[m].area);
            result.leaves.push_back(std::move(members));
            return result;
        }
        std::vector<Node> children;
        for (Members& quarter : quarters(members, edge))
            if (!quarter.empty()) children.push_back(node(std::move(quarter), edge / 2));
        bool whole = true;
        for (Node& child : children) {
            whole = whole && child.leaves.size() == 1;
            addTo(result, child.light, child.normal, child.area);
        }
        const Node& first = children.front();
        if (whole && gradient(scale_ * result.light, scale_ * first.light, result.normal, first.normal) <
                         desc_.threshold) {
            result.leaves.push_back(std::move(members));
            return result;
        }
        for (Node& child : children)
            std::move(child.leaves.begin(), child.leaves.end(), std::back_inserter(result.leaves));
        return result;
    }

    // Adds to a mean that is kept up to date.
    static void addTo(Node& node, glm::vec3 light, glm::vec3 normal, float area) {
        node.area += area;
        const float share = node.area > 0.0f ? area / node.area : 1.0f;
        node.light += share * (light - node.light);
        node.normal += share * (normal - node.normal);
    }

    const PatchSet& set_;
    const std::vector<uint32_t>& parts_;
    const std::vector<glm::vec4>& radiance_;
    const QuadTreeDesc desc_;
    SenderListBuilder list_;
    float scale_ = 0.0f; // 1 / mean light
};

// Returns what RTRad has in ligIn.a, made level by level: c0 takes what the four hold.
std::vector<float> rtradWeights(const PatchSet& set, const std::vector<glm::vec4>& radiance,
                                const QuadTreeDesc& desc) {
    const uint32_t size = set.scene.size;
    std::vector<float> a(size_t{size} * size);
    for (size_t t = 0; t < a.size(); ++t)
        a[t] = set.scene.texelToPatch[t] == kNoPatch ? 0.0f : 1.0f;
    for (uint32_t step = 2; step < desc.node; step *= 2) {
        const uint32_t half = step / 2;
        for (uint32_t y = 0; y + half < size; y += step) {
            for (uint32_t x = 0; x + half < size; x += step) {
                const size_t t = size_t{y} * size + x;
                const std::array<size_t, 4> c = {t, t + half, t + size_t{half} * size,
                                                 t + size_t{half} * size + half};
                const auto full = static_cast<float>(half * half);
                if (!std::all_of(c.begin(), c.end(), [&](size_t i) { return a[i] >= full; })) continue;
                glm::vec3 light(0.0f), normal(0.0f);
                float sum = 0.0f;
                for (size_t i : c) {
                    const uint32_t p = set.scene.texelToPatch[i];
                    light += 0.25f * glm::vec3(radiance[p]);
                    normal += 0.25f * set.scene.patches[p].shading;
                    sum += a[i];
                }
                const uint32_t p0 = set.scene.texelToPatch[t];
                if (gradient(light, glm::vec3(radiance[p0]), normal, set.scene.patches[p0].shading) >=
                    desc.threshold)
                    continue;
                a[c[1]] = a[c[2]] = a[c[3]] = 0.0f;
                a[t] = sum;
            }
        }
    }
    return a;
}

} // namespace

SenderList quadTreeSenders(const PatchSet& patches, const std::vector<uint32_t>& parts,
                           const std::vector<glm::vec4>& radiance, const QuadTreeDesc& desc) {
    if (!desc.rtrad) return QuadTreeBuilder(patches, parts, radiance, desc).build();
    const std::vector<float> weights = rtradWeights(patches, radiance, desc);
    SenderListBuilder builder(patches);
    for (uint32_t i = 0; i < patches.count; ++i) {
        const float weight = weights[shader::patchTexel(patches.scene.patches[i].flags)];
        if (weight > 0.0f && !isDark(radiance[i])) builder.addWeighted(i, weight);
    }
    return builder.finish();
}

} // namespace relume
