#include "app/viewer/picture/light_previews.h"

#include "app/viewer/edits/light_edits.h"
#include "assets/base/error.h"
#include "renderer/shader_types.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace relume {
namespace {

// Most of what a light reaches gets no brighter than this [1]: a spot's cone shows, and so does the room
// around it.
constexpr float kBright = 0.5f;
// This share of what a light lights is brighter, so that lamps seen from near do not decide.
constexpr float kBrighter = 0.1f;
constexpr float kGlow = 4.0f;                      // of a surface that shines itself, times kBright
constexpr glm::vec3 kNothing(0.11f, 0.12f, 0.13f); // where there is no surface, as displayed
constexpr glm::vec3 kDefaultAlbedo(1.0f);          // of glTF's default material

glm::vec3 albedoOf(const std::vector<Material>& materials, uint32_t material) {
    return material < materials.size() ? glm::vec3(materials[material].baseColor) : kDefaultAlbedo;
}

// Returns the exposure for all that is lit, or 0 where nothing is.
float exposureFor(const std::vector<glm::vec3>& seen) {
    std::vector<float> lit;
    for (const glm::vec3& value : seen)
        if (const float brightness = shader::luminance(value); brightness > 0.0f) lit.push_back(brightness);
    if (lit.empty()) return 0.0f;
    const auto rank =
        static_cast<std::ptrdiff_t>(std::ceil((1.0f - kBrighter) * static_cast<float>(lit.size() - 1)));
    std::nth_element(lit.begin(), lit.begin() + rank, lit.end());
    return kBright / lit[static_cast<size_t>(rank)];
}

} // namespace

std::vector<uint8_t> previewPixels(const PreviewDesc& desc) {
    ASSERT(desc.surfaces.size() == desc.light.size());
    std::vector<glm::vec3> seen(desc.light.size(), glm::vec3(0.0f));
    for (size_t i = 0; i < seen.size(); ++i)
        if (desc.surfaces[i].any)
            seen[i] = albedoOf(desc.materials, desc.surfaces[i].material) * desc.light[i] * desc.colour;
    const float exposure = exposureFor(seen);
    std::vector<uint8_t> pixels;
    pixels.reserve(4 * seen.size());
    for (size_t i = 0; i < seen.size(); ++i) {
        const SurfaceIds::Surface& surface = desc.surfaces[i];
        glm::vec3 shown = kNothing;
        if (surface.any) {
            glm::vec3 light = exposure * seen[i];
            const bool itself = desc.key.kind == LightKey::Kind::Emitter &&
                                surface.instance == desc.key.index && surface.material == desc.key.material;
            if (itself) light += kGlow * kBright * desc.colour;
            shown = shader::srgbEncode(shader::toneAgx(light));
        }
        const glm::vec3 bytes = glm::round(255.0f * glm::clamp(shown, 0.0f, 1.0f));
        for (int channel = 0; channel < 3; ++channel)
            pixels.push_back(static_cast<uint8_t>(bytes[channel]));
        pixels.push_back(255);
    }
    return pixels;
}

ProbeRequest LightPreviews::see(Surfaces surfaces, uint32_t edge) {
    surfaces_ = std::move(surfaces);
    for (auto& [key, preview] : previews_)
        preview.light.clear(); // it was of other surfaces; the picture stays until there is a newer one
    ProbeRequest request{.number = ++requests_, .texels = {}};
    request.texels.reserve(surfaces_.size());
    const auto last = static_cast<float>(edge) - 1.0f;
    for (const SurfaceIds::Surface& surface : surfaces_) {
        if (!surface.lightmapUv) {
            request.texels.push_back(shader::kNoPatch);
            continue;
        }
        const glm::uvec2 texel(glm::clamp(*surface.lightmapUv * static_cast<float>(edge), 0.0f, last));
        request.texels.push_back(texel.y * edge + texel.x);
    }
    return request;
}

void LightPreviews::take(LayerProbe probe) {
    if (probe.request != requests_ || probe.light.size() != surfaces_.size()) return;
    Preview& preview = previews_[probe.key];
    preview.light = std::move(probe.light);
    preview.fresh = false;
}

bool LightPreviews::update(const SceneEdits& edits, const std::vector<LightSource>& sources) {
    for (const LightSource& source : sources) {
        const auto found = previews_.find(source.key);
        if (found == previews_.end() || found->second.light.empty()) continue;
        Preview& preview = found->second;
        const glm::vec3 colour = powerOf(edits, source.key).color;
        if (preview.fresh && preview.colour == colour) continue;
        const std::vector<uint8_t> pixels = previewPixels({.surfaces = surfaces_,
                                                           .light = preview.light,
                                                           .materials = edits.materials,
                                                           .key = source.key,
                                                           .colour = colour});
        if (preview.texture.get() == 0)
            preview.texture = gl::Texture(
                {.width = SurfaceIds::kWidth, .height = SurfaceIds::kHeight, .name = "light preview"});
        preview.texture.upload(GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
        preview.colour = colour;
        preview.fresh = true;
        return true;
    }
    return false;
}

uint32_t LightPreviews::texture(const LightKey& key) const {
    const auto found = previews_.find(key);
    return found == previews_.end() ? 0 : found->second.texture.get();
}

void LightPreviews::clear() {
    previews_.clear();
    surfaces_.clear();
    ++requests_;
}

} // namespace relume
