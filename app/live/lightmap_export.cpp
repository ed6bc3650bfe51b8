#include "app/live/lightmap_export.h"

#include "app/export/export_folder.h"
#include "app/offline/layer_file.h"
#include "app/offline/lightmap_attributes.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/paged_image.h"

#include <new>

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
}

// Tells how an export went. Whatever goes wrong with it, the bake and other exports go on.
void tell(const std::string& path, const std::function<void()>& write) {
    try {
        write();
        spdlog::info("wrote {}", path);
    } catch (const Error& error) {
        spdlog::error("{}", error.what());
    } catch (const std::bad_alloc&) { // the bake itself has what it needs
        spdlog::error("{}: not written, as the memory is full: close other programs", path);
    } catch (const std::exception& error) {
        spdlog::error("{}: not written: {}", path, error.what());
    }
}

void checkScene(const SceneBake& bake, uint64_t surfaces, const std::string& scene) {
    if (!bake.isOf(surfaces)) throw Error(scene + ": another scene was opened: export again");
}

} // namespace

void exportLightmap(const BakeOrders::Export& wanted, const SceneBake& bake, const LightNow& lightNow) {
    tell(wanted.path, [&] {
        checkScene(bake, wanted.surfaces, wanted.scene);
        const TransportSettings& transport = bake.settings().solver.transport;
        LightmapDesc desc = wanted.lightmap;
        desc.rtrad = transport.rtrad;
        desc.reflectivity = transport.reflectivity;
        if (desc.rtrad) desc.quantity = Quantity::Radiance;
        writeLightmap(wanted.path, lightmapNow(desc, wanted.scene, *bake.baker(), bake.settings(), lightNow));
    });
}

void exportForEngine(const BakeOrders::EngineExport& wanted, const vk::Device& device, const SceneBake& bake,
                     const LightNow& lightNow) {
    tell(wanted.path(), [&] {
        if (bake.settings().solver.transport.rtrad)
            throw Error("RTRad's units are no light that an engine shows: bake without that preset");
        checkScene(bake, wanted.surfaces, wanted.scene);
        const AtlasLevel level = bake.level();
        Scene scene = level.scene;
        scene.materials = wanted.materials;
        scene.sky.radiance = wanted.sky;
        if (wanted.web) return exportPage(*wanted.web, wanted.scene, scene, level.mesh, bake);
        const FloatImage lightmap = lightmapNow({}, wanted.scene, *bake.baker(), bake.settings(), lightNow);
        exportLevel(wanted.desc, device, {scene, level.atlas, level.mesh}, lightmap);
    });
}

} // namespace relume
