#include "bake/output/lightmap.h"

#include "assets/base/error.h"
#include "assets/base/worker_pool.h"
#include "assets/images/finite_image.h"
#include "assets/images/paged_image.h"
#include "bake/surface/seam_sources.h"

#include <algorithm>
#include <array>

namespace relume {
namespace {

constexpr float kPatchCoverage = 1.0f, kFilledCoverage = 0.5f;
constexpr uint32_t kNeighbours = 8;

struct Planes {
    uint32_t size, page;                       // edges of the sheet, and of a page
    std::array<std::vector<float>*, 4> planes; // R, G, B, coverage

    size_t at(glm::ivec2 texel) const {
        return static_cast<size_t>(texel.y) * size + static_cast<size_t>(texel.x);
    }
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

// Returns which of a texel's 8 neighbours are covered, as bits of shader::seamOffset.
uint32_t coveredAround(const Planes& image, uint32_t x, uint32_t y) {
    uint32_t covered = 0;
    for (uint32_t n = 0; n < kNeighbours; ++n) {
        const glm::ivec2 to = glm::ivec2(x, y) + shader::seamOffset(n);
        const auto last = static_cast<int>(image.size) - 1;
        if (to.x < 0 || to.y < 0 || to.x > last || to.y > last) continue;
        if (image.page != image.size && !LightmapPages::together(image.page, {x, y}, to))
            continue; // they are strangers
        if (image.coverage(image.at(to)) != 0.0f) covered |= 1u << n;
    }
    return covered;
}

// Returns the colour that some of a texel's neighbours give: their mean, or RTRad's choice, the darkest.
glm::vec3 colorOf(const Planes& image, uint32_t x, uint32_t y, uint32_t neighbours, bool darkest) {
    glm::vec3 sum(0.0f), low(0.0f);
    int count = 0;
    for (uint32_t n = 0; n < kNeighbours; ++n) {
        if ((neighbours >> n & 1u) == 0) continue;
        const glm::vec3 c = image.color(image.at(glm::ivec2(x, y) + shader::seamOffset(n)));
        sum += c;
        if (count == 0 || glm::length(c) < glm::length(low)) low = c;
        ++count;
    }
    return darkest ? low : sum / static_cast<float>(count);
}

constexpr uint32_t kRows = 16; // that a thread works on at a time

// Each ring is found whole before any of it is filled, so that it is open who finds which part.
void sewSeams(Planes& image, const PatchSet& patches, const LightmapDesc& desc) {
    const SeamSources sources(patches);
    const uint32_t rings = desc.rtrad ? 1 : desc.dilate, portions = (image.size + kRows - 1) / kRows;
    for (uint32_t ring = 0; ring < rings; ++ring) {
        std::vector<std::vector<Fill>> fills(portions);
        runWatched(desc.pool, "seams", portions, [&](uint32_t portion) {
            for (uint32_t y = portion * kRows; y < std::min(image.size, (portion + 1) * kRows); ++y) {
                for (uint32_t x = 0; x < image.size; ++x) {
                    const size_t i = size_t{y} * image.size + x;
                    if (image.coverage(i) != 0.0f) continue;
                    uint32_t from = coveredAround(image, x, y);
                    if (from == 0) continue;
                    if (ring == 0) from = sources.choose(static_cast<uint32_t>(i), from);
                    fills[portion].push_back({i, colorOf(image, x, y, from, desc.rtrad)});
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
    if (desc.sew) sewSeams(planes, patches, desc);
    requireFiniteTexels(image);
    noteLightmapPages(image, patches.scene.mesh.pages);
    return image;
}

void requireFiniteTexels(const FloatImage& lightmap) {
    requireFinite(lightmap, "the lightmap");
}

} // namespace relume
