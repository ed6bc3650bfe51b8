#include "app/edit/prepare.h"

#include "assets/atlas/unwrap.h"
#include "assets/atlas/uv_sets.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/base/watch.h"
#include "assets/foreign/load_scene.h"
#include "assets/images/paged_image.h"
#include "assets/survey/preview_light.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace relume {
namespace {

void warn(const std::vector<std::string>& warnings, size_t first = 0) {
    for (size_t i = first; i < warnings.size(); ++i)
        spdlog::warn("{}", warnings[i]);
}

// Returns the lightmap's edge, and says so where it was chosen.
uint32_t sizeOf(const Scene& scene, const PrepareDesc& desc) {
    if (desc.leastDensity <= 0) return desc.size;
    constexpr double kCovered = 0.85;      // share of an atlas that charts cover
    constexpr uint32_t kUsualLimit = 4096; // of textures in engines [texels]: beyond it, pages are better
    const double area = surfaceArea(scene);
    const uint32_t asked = desc.pages.value_or(scene.pages);
    const LightmapPages pages{std::max(asked, 1u)};
    const uint32_t wanted =
        std::max(desc.size, sizeForDensity(area / pages.count, desc.leastDensity, kCovered,
                                           asked == 0 ? kUsualLimit : kMaxPageSize, desc.stride));
    const uint32_t size = wanted > desc.size && desc.fitting ? desc.fitting(scene, pages, wanted) : wanted;
    spdlog::info("{}: a lightmap of {} x {} texels was chosen for {:.4g} m^2 of surface: room for about "
                 "{:.2g} texels/m{}",
                 desc.path, size, size, area,
                 size * std::sqrt(pages.count * kCovered / std::max(area, 1e-12)),
                 size < wanted ? fmt::format(", as half of the memory that is free does not do for {} x {}",
                                             wanted, wanted)
                               : "");
    return size;
}

void furnishUvs(PreparedScene& prepared, const PrepareDesc& desc) {
    const Furnishing& furnishing = desc.furnishing;
    Scene& scene = prepared.scene;
    if (furnishing.strict) {
        const size_t missing = countUnmapped(scene);
        if (missing == 0) return;
        throw Error(
            fmt::format("{}: {} of {} meshes have no usable lightmap UVs: run 'relume unwrap', or leave "
                        "out --strict to have them made",
                        desc.path, missing, scene.meshes.size()));
    }
    if (!furnishing.unwrap) return;
    const UnwrapResult made = unwrap(
        scene,
        {.density = furnishing.density, .size = prepared.size, .pages = desc.pages.value_or(scene.pages)},
        desc.memory);
    if (made.meshes == 0) return; // they are nothing but triangles without area
    prepared.madeUvs =
        fmt::format("lightmap UVs were made for {} of {} meshes: {} charts{} at {:.3g} texels/m", made.meshes,
                    scene.meshes.size(), made.charts,
                    made.pages > 1 ? fmt::format(" on {} pages", made.pages) : "", made.density);
    if (made.shortened > 0)
        prepared.madeUvs += fmt::format(", {} longer than the lightmap with {:.3g} along themselves",
                                        made.shortened, made.leastDensity);
    if (made.coarser > 0)
        prepared.madeUvs +=
            fmt::format(", {} of {} objects with {:.2g} of that or more, so that the others stay where "
                        "they are: open the file again to make all alike",
                        made.coarser, made.objects, made.leastShare);
    spdlog::warn("{}: {}", desc.path, prepared.madeUvs);
}

} // namespace

void furnishLight(PreparedScene& prepared, const Furnishing& furnishing) {
    Scene& scene = prepared.scene;
    if (!isDark(scene)) return;
    if (furnishing.strict)
        throw Error(scene.path +
                    ": nothing in it shines: add a light (relume edit --add), or leave out --strict "
                    "to have it lit by a preview light");
    if (!furnishing.daylight) return;
    tellWatch("looking for light");
    prepared.madeLight = addPreviewLight(scene, prepared.mesh);
    spdlog::warn("{}: nothing in it shines: {} lights it, which is not in the file", scene.path,
                 prepared.madeLight);
}

void matchLightmap(PrepareDesc& desc, const FloatImage& lightmap) {
    const LightmapPages pages = lightmapPagesOf(lightmap);
    desc.size = pages.edgeOf(lightmap.width);
    desc.pages = pages.count;
    desc.leastDensity = 0;
}

PreparedScene prepareScene(const PrepareDesc& desc, const std::function<void(const Scene&)>& whenRead) {
    PreparedScene result;
    PhaseClock clock(result.phases);
    result.scene = loadScene(desc.path, desc.choice);
    clock.end("load");
    warn(result.scene.warnings);
    requireArea(result.scene);
    if (whenRead && desc.furnishing.unwrap && countUnmapped(result.scene) > 0) whenRead(result.scene);

    clock.restart();
    result.size = sizeOf(result.scene, desc);
    furnishUvs(result, desc);
    clock.end("unwrap");
    // As many as a density needs are those that an unwrap made, or else those of the file.
    const uint32_t asked = desc.pages.value_or(0);
    result.atlas = buildAtlas(result.scene, result.size, desc.furnishing.unwrap,
                              LightmapPages{asked > 0 ? asked : result.scene.pages}, desc.rects);
    warn(result.atlas.warnings);
    const size_t before = result.scene.warnings.size();
    result.mesh = flatten(result.scene, result.atlas);
    warn(result.scene.warnings, before);
    if (!desc.edited) furnishLight(result, desc.furnishing);
    clock.end("atlas");
    return result;
}

} // namespace relume
