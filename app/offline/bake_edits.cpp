#include "app/offline/bake_edits.h"

#include "app/offline/bake_checkpoints.h"
#include "app/offline/compression_option.h"
#include "app/offline/layer_file.h"
#include "app/offline/lightmap_attributes.h"
#include "app/offline/progress.h"
#include "app/offline/solve.h"
#include "app/text/interrupt.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/paged_image.h"
#include "assets/images/sky_picture.h"
#include "bake/vk/device.h"

#include <optional>

namespace relume {

void bakeEdited(const BakeOptions& options, const SceneEdits& edits) {
    const InterruptGuard guard;
    BakeRequest request = resolveBakeOptions(options);
    request.prepare.edited = true;
    std::optional<PhaseProgress> phase(std::in_place, true);
    PreparedScene prepared = prepareFor(request);
    const bool moved = editsOf(prepared.scene).placements != edits.placements;
    applyEdits(prepared.scene, edits);
    readEditedPicture(prepared.scene.sky);
    if (moved) prepared.mesh = flatten(prepared.scene, prepared.atlas);
    furnishLight(prepared, request.prepare.furnishing);
    const vk::Device device(deviceDesc(options.machine));
    spdlog::info("device: {} ({})", device.info().name, device.info().driver);
    Baker baker(device, prepared.scene, std::move(prepared.mesh), request.bake);
    warnIfDark(prepared.scene, baker.patches());
    BakeCheckpoints none(options);
    phase.reset();
    solve(baker.solver(), request.bake.solver, none);
    phase.emplace(false);
    const SolverProgress& progress = baker.solver().progress();
    const ExrCompression compression = compressionOf(options.files.compression);
    if (options.layers.on) {
        LayeredImage image = layeredImage(baker, prepared.scene, request.lightmap);
        addLightmapAttributes(image.composite, options.files.scene, request.bake, request.lightmap, progress);
        writeLayers(options.files.output, image, ExrType::Float, compression);
    } else {
        FloatImage image = baker.lightmap(request.lightmap);
        addLightmapAttributes(image, options.files.scene, request.bake, request.lightmap, progress);
        writeLightmap(options.files.output, image, ExrType::Float, compression);
    }
    spdlog::info("wrote {}", options.files.output);
    failOnValidation(device.validationMessages());
}

} // namespace relume
