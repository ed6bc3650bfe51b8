#include "app/live/lightmap_export.h"

#include "app/export/export_folder.h"
#include "app/offline/layer_file.h"
#include "app/offline/lightmap_attributes.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/paged_image.h"

namespace relume {
namespace {

using LightNow = std::function<std::vector<glm::vec4>()>;

FloatImage lightmapNow(const LightmapDesc& desc, const std::string& scene, Baker& baker,
                       const BakeSettings& settings, const LightNow& lightNow) {
    FloatImage image =
        baker.solver().done() ? baker.lightmap(desc) : makeLightmap(baker.patches(), lightNow(), desc);
    addLightmapAttributes(image, scene, settings, desc, baker.solver().progress());
    const std::string stale = baker.layers() ? staleLayers(*baker.layers()) : "";
    if (!stale.empty()) image.attributes[layer_attribute::kStale] = stale;
    return image;
}

// Writes the page with the mix board of the layers as they stand.
void exportPage(const WebDesc& desc, const std::string& name, const Scene& scene, const WorldMesh& mesh,
                const SceneBake& bake) {
    if (!bake.layers())
        throw Error(desc.path + ": not written, as the page needs a layer for each light: turn on layers");
    const LayeredImage image = layeredImage(*bake.baker(), scene, {});
    writeWebPage(desc, scene, mesh, image, name);
    spdlog::info("wrote {}", desc.path);
}

} // namespace

void exportLightmap(const BakeOrders::Export& wanted, Baker& baker, const BakeSettings& settings,
                    const std::function<std::vector<glm::vec4>()>& lightNow) {
    try {
        LightmapDesc desc = wanted.lightmap;
        desc.rtrad = settings.solver.transport.rtrad;
        desc.reflectivity = settings.solver.transport.reflectivity;
        if (desc.rtrad) desc.quantity = Quantity::Radiance;
        writeLightmap(wanted.path, lightmapNow(desc, wanted.scene, baker, settings, lightNow));
        spdlog::info("wrote {}", wanted.path);
    } catch (const Error& error) {
        spdlog::error("{}", error.what());
    }
}

void exportForEngine(const BakeOrders::EngineExport& wanted, const vk::Device& device, const SceneBake& bake,
                     const std::function<std::vector<glm::vec4>()>& lightNow) {
    try {
        if (bake.settings().solver.transport.rtrad)
            throw Error("RTRad's units are no light that an engine shows: bake without that preset");
        if (!bake.isOf(wanted.surfaces))
            throw Error(wanted.scene + ": another scene was opened: export again");
        const AtlasLevel level = bake.level();
        Scene scene = level.scene;
        scene.materials = wanted.materials;
        scene.sky.radiance = wanted.sky;
        if (wanted.web) return exportPage(*wanted.web, wanted.scene, scene, level.mesh, bake);
        const FloatImage lightmap = lightmapNow({}, wanted.scene, *bake.baker(), bake.settings(), lightNow);
        exportLevel(wanted.desc, device, {scene, level.atlas, level.mesh}, lightmap);
        spdlog::info("wrote {}", wanted.desc.folder);
    } catch (const Error& error) {
        spdlog::error("{}", error.what());
    } catch (const std::bad_alloc&) { // the bake itself has what it needs
        spdlog::error("{}: not written, as the memory is full: close other programs", wanted.path());
    }
}

} // namespace relume
