#include "app/edit/prepare.h"

#include "assets/atlas/unwrap.h"
#include "assets/base/clock.h"
#include "assets/base/log.h"
#include "assets/foreign/load_scene.h"

namespace relume {

PreparedScene prepareScene(const PrepareDesc& desc) {
    PreparedScene result;
    const auto start = Clock::now();
    result.scene = loadScene(desc.path, desc.choice);
    result.loadSeconds = secondsSince(start);
    for (const std::string& warning : result.scene.warnings)
        spdlog::warn("{}", warning);

    const auto atlasStart = Clock::now();
    requireArea(result.scene);
    if (desc.unwrap) {
        const UnwrapResult made = unwrap(result.scene, {.density = desc.density, .size = desc.size});
        if (made.meshes == 0)
            spdlog::info("unwrapped nothing: every mesh with an area has valid lightmap UVs");
        else
            spdlog::info("unwrapped {} meshes into {} charts at {:.3g} texels/m", made.meshes, made.charts,
                         made.density);
    }
    result.atlas = buildAtlas(result.scene, desc.size, desc.unwrap);
    for (const std::string& warning : result.atlas.warnings)
        spdlog::warn("{}", warning);
    const size_t before = result.scene.warnings.size();
    result.mesh = flatten(result.scene, result.atlas);
    for (size_t i = before; i < result.scene.warnings.size(); ++i)
        spdlog::warn("{}", result.scene.warnings[i]);
    result.atlasSeconds = secondsSince(atlasStart);
    return result;
}

} // namespace relume
