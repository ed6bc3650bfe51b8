#include "app/live/lightmap_export.h"

#include "app/offline/layer_file.h"
#include "app/offline/lightmap_attributes.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/image_file.h"

namespace relume {

void exportLightmap(const BakeOrders::Export& wanted, Baker& baker, const BakeSettings& settings,
                    const std::function<std::vector<glm::vec4>()>& lightNow) {
    try {
        LightmapDesc desc = wanted.lightmap;
        desc.rtrad = settings.solver.transport.rtrad;
        desc.reflectivity = settings.solver.transport.reflectivity;
        if (desc.rtrad) desc.quantity = Quantity::Radiance;
        FloatImage image =
            baker.solver().done() ? baker.lightmap(desc) : makeLightmap(baker.patches(), lightNow(), desc);
        addLightmapAttributes(image, wanted.scene, settings, wanted.lightmap, baker.solver().progress());
        const std::string stale = baker.layers() ? staleLayers(*baker.layers()) : "";
        if (!stale.empty()) image.attributes[layer_attribute::kStale] = stale;
        writeImage(wanted.path, image);
        spdlog::info("wrote {}", wanted.path);
    } catch (const Error& error) {
        spdlog::error("{}", error.what());
    }
}

} // namespace relume
