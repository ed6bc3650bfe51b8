#include "bake/output/lightmap.h"

#include "assets/base/error.h"
#include "assets/base/worker_pool.h"
#include "assets/images/finite_image.h"
#include "assets/images/paged_image.h"

#include <algorithm>
#include <array>

namespace relume {
namespace {

constexpr float kPatchCoverage = 1.0f, kFilledCoverage = 0.5f;

struct Planes {
    uint32_t size, page;                       // edges of the sheet, and of a page
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
            if (image.page != image.size && !LightmapPages::together(image.page, {x, y}, {nx, ny}))
                continue; // they are strangers
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

constexpr uint32_t kRows = 16; // that a thread works on at a time

// Each ring is found whole before any of it is filled, so that it is open who finds which part.
void sewSeams(Planes& image, const LightmapDesc& desc) {
    const uint32_t rings = desc.rtrad ? 1 : desc.dilate, portions = (image.size + kRows - 1) / kRows;
    for (uint32_t ring = 0; ring < rings; ++ring) {
        std::vector<std::vector<Fill>> fills(portions);
        runWatched(desc.pool, "seams", portions, [&](uint32_t portion) {
            for (uint32_t y = portion * kRows; y < std::min(image.size, (portion + 1) * kRows); ++y) {
                for (uint32_t x = 0; x < image.size; ++x) {
                    const size_t i = size_t{y} * image.size + x;
                    Fill fill{i, {}};
                    if (image.coverage(i) == 0.0f && fromNeighbours(image, x, y, desc.rtrad, fill.color))
                        fills[portion].push_back(fill);
                }
            }
        });
        if (std::all_of(fills.begin(), fills.end(), [](const auto& part) { return part.empty(); })) return;
        runWatched(desc.pool, "seams", portions, [&](uint32_t portion) {
            for (const Fill& fill : fills[portion])
                image.set(fill.texel, fill.color, kFilledCoverage);
        });
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
                  patches.scene.pageSize(),
                  {&image.planes[0], &image.planes[1], &image.planes[2], &image.planes[3]}};
    const size_t width = patches.scene.size, texels = patches.scene.texelToPatch.size();
    const auto scatter = [&](size_t texel) {
        const uint32_t p = patches.scene.texelToPatch[texel];
        if (p == shader::kNoPatch || (patches.scene.patches[p].flags & shader::kPatchSends) == 0) return;
        glm::vec3 value(light[p]);
        if (desc.quantity == Quantity::Radiance && !desc.rtrad) {
            value = glm::vec3(patches.emission[p]) + desc.reflectivity * glm::vec3(patches.albedo[p]) * value;
        }
        planes.set(texel, value, kPatchCoverage);
    };
    runWatched(desc.pool, "seams", (patches.scene.size + kRows - 1) / kRows, [&](uint32_t portion) {
        const size_t end = std::min(texels, (size_t{portion} + 1) * kRows * width);
        for (size_t texel = size_t{portion} * kRows * width; texel < end; ++texel)
            scatter(texel);
    });
    if (desc.sew) sewSeams(planes, desc);
    requireFiniteTexels(image);
    noteLightmapPages(image, patches.scene.mesh.pages);
    return image;
}

void requireFiniteTexels(const FloatImage& lightmap) {
    requireFinite(lightmap, "the lightmap");
}

} // namespace relume
