#include "bake/output/lightmap.h"

#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "assets/images/finite_image.h"

#include <array>

namespace relume {
namespace {

constexpr float kPatchCoverage = 1.0f, kFilledCoverage = 0.5f;

struct Planes {
    uint32_t size;
    std::array<std::vector<float>*, 4> planes; // R, G, B, coverage

    glm::vec3 color(size_t i) const { return {(*planes[0])[i], (*planes[1])[i], (*planes[2])[i]}; }
    float coverage(size_t i) const { return (*planes[3])[i]; }
    void set(size_t i, glm::vec3 c, float coverage) {
        for (int k = 0; k < 3; ++k)
            (*planes[static_cast<size_t>(k)])[i] = c[k];
        (*planes[3])[i] = coverage;
    }
};

struct Fill {
    size_t texel;
    glm::vec3 color;
};

// Takes the colour that the covered ones of a texel's 8 neighbours give: their mean, or RTRad's choice, the
// darkest. Returns false without any.
bool fromNeighbours(const Planes& image, uint32_t x, uint32_t y, bool darkest, glm::vec3& color) {
    glm::vec3 sum(0.0f), low(0.0f);
    int count = 0;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const int nx = static_cast<int>(x) + dx, ny = static_cast<int>(y) + dy,
                      n = static_cast<int>(image.size);
            if ((dx == 0 && dy == 0) || nx < 0 || ny < 0 || nx >= n || ny >= n) continue;
            const size_t i = static_cast<size_t>(ny) * image.size + static_cast<size_t>(nx);
            if (image.coverage(i) == 0.0f) continue;
            const glm::vec3 c = image.color(i);
            sum += c;
            if (count == 0 || glm::length(c) < glm::length(low)) low = c;
            ++count;
        }
    }
    if (count == 0) return false;
    color = darkest ? low : sum / static_cast<float>(count);
    return true;
}

void sewSeams(Planes& image, uint32_t rings, bool darkest) {
    for (uint32_t ring = 0; ring < rings; ++ring) {
        std::vector<Fill> fills;
        WatchedLoop loop("seams", image.size, 16);
        for (uint32_t y = 0; y < image.size; ++y, loop.step()) {
            for (uint32_t x = 0; x < image.size; ++x) {
                const size_t i = size_t{y} * image.size + x;
                Fill fill{i, {}};
                if (image.coverage(i) == 0.0f && fromNeighbours(image, x, y, darkest, fill.color))
                    fills.push_back(fill);
            }
        }
        if (fills.empty()) return;
        for (const Fill& fill : fills)
            image.set(fill.texel, fill.color, kFilledCoverage);
    }
}

} // namespace

FloatImage makeLightmap(const PatchSet& patches, const std::vector<glm::vec4>& light,
                        const LightmapDesc& desc) {
    ASSERT(light.size() == patches.scene.patches.size());
    ASSERT(!desc.rtrad || desc.quantity == Quantity::Radiance);
    FloatImage image;
    image.width = image.height = patches.scene.size;
    for (const char* channel : {"R", "G", "B", "coverage"})
        image.add(channel);
    Planes planes{patches.scene.size,
                  {&image.planes[0], &image.planes[1], &image.planes[2], &image.planes[3]}};
    for (size_t texel = 0; texel < patches.scene.texelToPatch.size(); ++texel) {
        const uint32_t p = patches.scene.texelToPatch[texel];
        if (p == shader::kNoPatch || (patches.scene.patches[p].flags & shader::kPatchSends) == 0) continue;
        glm::vec3 value(light[p]);
        if (desc.quantity == Quantity::Radiance && !desc.rtrad) {
            value = glm::vec3(patches.emission[p]) + desc.reflectivity * glm::vec3(patches.albedo[p]) * value;
        }
        planes.set(texel, value, kPatchCoverage);
    }
    if (desc.sew) sewSeams(planes, desc.rtrad ? 1 : desc.dilate, desc.rtrad);
    requireFinite(image, "the lightmap");
    return image;
}

} // namespace relume
