#include "app/export/surface_light.h"

#include "assets/base/error.h"
#include "bake/surface/cit_pass.h"
#include "renderer/exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace relume {
namespace {

constexpr uint32_t kRings = 4; // of the lightmap's texels, as a bake fills around charts

template<class Action>
void forNeighbours(uint32_t texel, uint32_t size, const Action& action) {
    const uint32_t x = texel % size, y = texel / size;
    for (uint32_t row = y > 0 ? y - 1 : 0; row <= std::min(y + 1, size - 1); ++row)
        for (uint32_t column = x > 0 ? x - 1 : 0; column <= std::min(x + 1, size - 1); ++column)
            if (row != y || column != x) action(row * size + column);
}

// Returns the texels beside these that have no value, each once.
std::vector<uint32_t> emptyBeside(const std::vector<uint32_t>& texels, const std::vector<bool>& has,
                                  uint32_t size) {
    std::vector<uint32_t> out;
    for (const uint32_t texel : texels)
        forNeighbours(texel, size, [&](uint32_t other) {
            if (!has[other]) out.push_back(other);
        });
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

// Reads a lightmap between its texels, as renderers do.
class LightmapSampler {
public:
    explicit LightmapSampler(const FloatImage& image) : image_(image) {
        for (size_t c = 0; c < 3; ++c) {
            planes_[c] = image.find(std::string(1, "RGB"[c]));
            if (!planes_[c]) throw Error("the lightmap has no channels R, G and B");
        }
    }

    /// Returns the lighting at a place in texels, of which (0.5, 0.5) is the middle of the first one.
    glm::vec3 at(glm::vec2 place) const {
        const glm::vec2 corner = glm::floor(place - 0.5f), f = place - 0.5f - corner;
        const auto x = static_cast<int>(corner.x), y = static_cast<int>(corner.y);
        return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), f.x),
                        glm::mix(texel(x, y + 1), texel(x + 1, y + 1), f.x), f.y);
    }

private:
    glm::vec3 texel(int x, int y) const {
        const auto column = static_cast<size_t>(std::clamp(x, 0, static_cast<int>(image_.width) - 1));
        const auto row = static_cast<size_t>(std::clamp(y, 0, static_cast<int>(image_.height) - 1));
        const size_t i = row * image_.width + column;
        return {(*planes_[0])[i], (*planes_[1])[i], (*planes_[2])[i]};
    }

    const FloatImage& image_;
    std::array<const std::vector<float>*, 3> planes_{};
};

// Gives each of these texels, which have no value, the mean of the 8 neighbours that have one. Returns those
// beside them that have none yet.
std::vector<uint32_t> fillRing(const std::vector<uint32_t>& ring, std::vector<glm::vec3>& texels,
                               std::vector<bool>& has, uint32_t size) {
    std::vector<glm::vec3> means;
    means.reserve(ring.size());
    for (const uint32_t texel : ring) {
        glm::vec3 sum(0.0f);
        float count = 0.0f;
        forNeighbours(texel, size, [&](uint32_t other) {
            if (!has[other]) return;
            sum += texels[other];
            count += 1.0f;
        });
        means.push_back(sum / count);
    }
    for (size_t i = 0; i < ring.size(); ++i) {
        texels[ring[i]] = means[i];
        has[ring[i]] = true;
    }
    return emptyBeside(ring, has, size);
}

// A level of a pyramid: each texel has the sum and the number of those below it that have a value.
struct FillLevel {
    uint32_t size = 0;
    std::vector<glm::vec4> texels; // rgb sum, a number
};

FillLevel coarser(const FillLevel& fine) {
    FillLevel out{(fine.size + 1) / 2, {}};
    out.texels.assign(size_t{out.size} * out.size, glm::vec4(0.0f));
    for (uint32_t y = 0; y < fine.size; ++y)
        for (uint32_t x = 0; x < fine.size; ++x) {
            const glm::vec4& texel = fine.texels[size_t{y} * fine.size + x];
            // A mean counts once, however many texels it is of: what is nearest counts most.
            if (texel.a > 0.0f)
                out.texels[size_t{y / 2} * out.size + x / 2] += glm::vec4(glm::vec3(texel) / texel.a, 1.0f);
        }
    return out;
}

} // namespace

SurfaceLight surfaceLight(const vk::Device& device, const AtlasLevel& level, const FloatImage& lightmap,
                          uint32_t size) {
    const TextureGroup group = rasterizeTextureGroup(device, level.scene, level.mesh, {.size = size});
    std::vector<Material> materials = level.scene.materials;
    materials.emplace_back(); // glTF's default material
    const LightmapSampler sampler(lightmap);
    const float scale = static_cast<float>(lightmap.width) / static_cast<float>(size);
    SurfaceLight out;
    out.size = size;
    out.rings = std::max(kRings * size / lightmap.width, 1u);
    const size_t count = size_t{size} * size;
    out.reflected.assign(count, glm::vec3(0.0f));
    out.emitted.assign(count, glm::vec3(0.0f));
    out.material.assign(count, 0);
    for (size_t i = 0; i < count; ++i) {
        if (group.triangle[i] == 0) continue;
        const uint32_t number = level.mesh.material[group.triangle[i] - 1];
        const Material& material = materials[number];
        const glm::vec2 place(static_cast<float>(i % size) + 0.5f, static_cast<float>(i / size) + 0.5f);
        out.material[i] = 1 + number;
        out.reflected[i] =
            glm::vec3(group.mat[i]) * glm::vec3(material.baseColor) * sampler.at(scale * place);
        out.emitted[i] = glm::vec3(group.emission[i]) * material.emission;
    }
    return out;
}

void fillBetween(std::vector<glm::vec3>& texels, std::vector<bool> has, uint32_t size, uint32_t rings) {
    ASSERT(texels.size() == size_t{size} * size && has.size() == texels.size());
    std::vector<uint32_t> ring(texels.size());
    std::iota(ring.begin(), ring.end(), 0u);
    std::erase_if(ring, [&](uint32_t texel) { return !has[texel]; });
    ring = emptyBeside(ring, has, size);
    for (uint32_t i = 0; i < rings && !ring.empty(); ++i)
        ring = fillRing(ring, texels, has, size);
    std::vector<FillLevel> levels(1);
    levels[0].size = size;
    levels[0].texels.resize(texels.size());
    for (size_t i = 0; i < texels.size(); ++i)
        levels[0].texels[i] = has[i] ? glm::vec4(texels[i], 1.0f) : glm::vec4(0.0f);
    while (levels.back().size > 1)
        levels.push_back(coarser(levels.back()));
    for (size_t k = levels.size() - 1; k-- > 0;) {
        const FillLevel& above = levels[k + 1];
        FillLevel& level = levels[k];
        for (uint32_t y = 0; y < level.size; ++y)
            for (uint32_t x = 0; x < level.size; ++x) {
                glm::vec4& texel = level.texels[size_t{y} * level.size + x];
                if (texel.a == 0.0f) texel = above.texels[size_t{y / 2} * above.size + x / 2];
            }
    }
    for (size_t i = 0; i < texels.size(); ++i)
        if (const glm::vec4& texel = levels[0].texels[i]; !has[i] && texel.a > 0.0f)
            texels[i] = glm::vec3(texel) / texel.a;
}

float exposureOf(const SurfaceLight& light) {
    glm::vec4 sum(0.0f); // as automaticExposure() takes a cell
    double logs = 0, total = 0, count = 0;
    for (size_t i = 0; i < light.material.size(); ++i) {
        if (light.material[i] == 0) continue;
        const float luminance =
            glm::dot(light.reflected[i] + light.emitted[i], glm::vec3(0.2126f, 0.7152f, 0.0722f)); // Rec. 709
        if (!(luminance > 0.0f)) continue;
        logs += std::log2(static_cast<double>(luminance));
        total += static_cast<double>(luminance);
        count += 1;
    }
    if (count == 0) return 0.0f;
    // One cell of the means: a sum over millions of texels has no room in a float.
    sum = {logs / count, total / count, 1.0, 0.0};
    return automaticExposure(std::span(&sum, 1));
}

} // namespace relume
