#include "bake/pairs/sender_light.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace relume {
namespace {

using shader::kNoPatch;

constexpr uint32_t kRtradLevels = 4; // of its textures

struct Level {
    uint32_t size = 0;
    std::vector<glm::vec4> texels;

    glm::vec4 wrapped(int64_t x, int64_t y) const {
        const int64_t n = size;
        return texels[size_t(((y % n) + n) % n) * size + size_t(((x % n) + n) % n)];
    }
    // Returns a bilinear, wrapped sample; `at` is in texels of this level.
    glm::vec4 sample(glm::dvec2 at) const {
        const glm::dvec2 corner = glm::floor(at - 0.5);
        const glm::vec2 f(at - 0.5 - corner);
        const auto x = static_cast<int64_t>(corner.x), y = static_cast<int64_t>(corner.y);
        return glm::mix(glm::mix(wrapped(x, y), wrapped(x + 1, y), f.x),
                        glm::mix(wrapped(x, y + 1), wrapped(x + 1, y + 1), f.x), f.y);
    }
};

// Makes levels as a graphics card does: each by bilinear lookups in the one before.
std::vector<Level> mipLevels(const PatchSet& set, const std::vector<glm::vec4>& radiance) {
    std::vector<Level> levels(1);
    levels[0].size = set.scene.size;
    for (uint32_t patch : set.scene.texelToPatch)
        levels[0].texels.push_back(patch == kNoPatch ? glm::vec4(0.0f) : radiance[patch]);
    while (levels.size() < kRtradLevels && levels.back().size > 1) {
        const Level& above = levels.back();
        Level level{above.size / 2, {}};
        const double scale = double(above.size) / level.size;
        for (uint32_t y = 0; y < level.size; ++y)
            for (uint32_t x = 0; x < level.size; ++x)
                level.texels.push_back(above.sample(glm::dvec2(x + 0.5, y + 0.5) * scale));
        levels.push_back(std::move(level));
    }
    return levels;
}

std::vector<glm::vec4> mipRadiance(const PatchSet& set, const SenderList& list,
                                   const std::vector<glm::vec4>& radiance, uint32_t window) {
    const std::vector<Level> levels = mipLevels(set, radiance);
    const size_t wanted = static_cast<size_t>(std::bit_width(window) - 1);
    const Level& level = levels[std::min(wanted, levels.size() - 1)];
    const double scale = double(level.size) / set.scene.size;
    std::vector<glm::vec4> result(list.senders.size(), glm::vec4(0.0f));
    for (uint32_t i = 0; i < list.count; ++i) {
        const uint32_t texel = shader::patchTexel(list.patches[i].flags);
        const glm::dvec2 corner(texel % set.scene.size, texel / set.scene.size);
        result[i] = list.weights[i] * level.sample((corner + 0.5 * window) * scale);
    }
    return result;
}

// Returns the mean by area.
glm::vec4 meanRadiance(const PatchSet& set, const SenderList& list, const std::vector<glm::vec4>& radiance,
                       const shader::Sender& sender) {
    const uint32_t* members = &list.members[sender.first];
    if (sender.count == 1) return radiance[*members];
    glm::vec4 sum(0.0f);
    float area = 0.0f;
    for (uint32_t m = 0; m < sender.count; ++m) {
        sum += set.scene.patches[members[m]].area * radiance[members[m]];
        area += set.scene.patches[members[m]].area;
    }
    return area > 0.0f ? sum / area : glm::vec4(0.0f);
}

} // namespace

std::vector<glm::vec4> patchRadiance(const PatchSet& patches, const std::vector<glm::vec4>& light,
                                     const TransportSettings& transport) {
    std::vector<glm::vec4> result(light.size(), glm::vec4(0.0f));
    for (uint32_t i = 0; i < patches.count; ++i) {
        if ((patches.scene.patches[i].flags & shader::kPatchSends) == 0) continue;
        result[i] = light[i];
        if (transport.rtrad) continue;
        const glm::vec3 reflected =
            transport.reflectivity * glm::vec3(patches.albedo[i]) * glm::vec3(light[i]);
        result[i] = glm::vec4(glm::vec3(patches.emission[i]) + reflected, 0.0f);
    }
    return result;
}

std::vector<glm::vec4> senderRadiance(const PatchSet& patches, const SenderList& list,
                                      const std::vector<glm::vec4>& radiance, SenderLight kind,
                                      uint32_t window) {
    if (kind == SenderLight::RtradMips) return mipRadiance(patches, list, radiance, window);
    std::vector<glm::vec4> result(list.senders.size(), glm::vec4(0.0f));
    for (uint32_t i = 0; i < list.count; ++i) {
        const glm::vec4& first = radiance[list.members[list.senders[i].first]];
        const float weight = list.weights.empty() ? 1.0f : list.weights[i];
        if (kind == SenderLight::Mean)
            result[i] = meanRadiance(patches, list, radiance, list.senders[i]);
        else if (kind == SenderLight::First)
            result[i] = weight * first;
        else
            result[i] = weight * glm::vec4(glm::vec3(first), weight);
    }
    return result;
}

} // namespace relume
