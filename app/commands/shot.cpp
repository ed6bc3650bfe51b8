#include "app/commands/command.h"
#include "app/offline/bake_checkpoints.h"
#include "app/offline/command_files.h"
#include "app/offline/lightmap_attributes.h"
#include "app/offline/progress.h"
#include "app/offline/solve.h"
#include "app/pictures/make_frame_writer.h"
#include "app/pictures/picture_studio.h"
#include "app/pictures/turn.h"
#include "app/text/frame_names.h"
#include "app/text/interrupt.h"
#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/images/image_file.h"
#include "shaders/shader_library.h"

#include <memory>
#include <optional>

namespace relume {
namespace {

FloatImage bakeLightmap(const ShotOptions& o, const BakeRequest& request, PictureBake& bake) {
    BakeCheckpoints none(o.bake);
    solve(bake.baker().solver(), request.bake.solver, none);
    bake.logEnd();
    return bake.baker().lightmap(request.lightmap);
}

void shoot(ShotOptions o) {
    const auto start = Clock::now();
    const InterruptGuard guard;
    const ShotRequest shot = resolveShotOptions(o);
    BakeRequest request = resolveBakeOptions(o.bake);
    const bool frames = o.turntable > 0 && !isVideo(o.bake.files.output);
    CommandFiles files;
    files.readsScene("SCENE", o.bake.files.scene).reads("--lightmap", o.lightmap);
    if (frames)
        files.writesFrames("--output", o.bake.files.output);
    else
        files.writes("--output", o.bake.files.output);
    files.check();
    std::unique_ptr<FrameWriter> writer;
    if (o.turntable > 0)
        writer = makeFrameWriter({.path = o.bake.files.output,
                                  .width = shot.width,
                                  .height = shot.height,
                                  .rate = o.rate,
                                  .overwrite = o.overwrite});
    else
        checkWritable(o.bake.files.output);
    if (!o.bake.machine.shaders.empty()) setShaderFolder(o.bake.machine.shaders);
    std::unique_ptr<FloatImage> image;
    if (!o.lightmap.empty()) {
        image = std::make_unique<FloatImage>(readLightmap(o.lightmap, o.bake.files.scene));
        request.prepare.size = image->width; // the gutters of a repacked atlas depend on it
    }
    std::optional<PhaseProgress> phase(std::in_place, true);
    PreparedScene prepared = prepareScene(request.prepare);
    stopIfInterrupted();
    std::unique_ptr<PictureBake> bake; // outlives the studio (picture_studio.h)
    PictureStudio studio(o.bake);
    studio.open(o, shot, prepared);
    if (!image && readsLightmap(shot.draw.view)) {
        bake = std::make_unique<PictureBake>(o.bake, request, prepared);
        image = std::make_unique<FloatImage>(bakeLightmap(o, request, *bake));
    }
    phase.reset();
    std::unique_ptr<LightmapImage> lightmap;
    if (image)
        lightmap = std::make_unique<LightmapImage>(*image, o.lightmap.empty() ? "lightmap" : o.lightmap);

    const LightmapTexture texture =
        lightmap ? lightmap->texture() : LightmapTexture{.size = request.prepare.size};
    if (writer)
        takeTurn(studio, texture, shot.draw, prepared.mesh, o.turntable, *writer);
    else
        writeImage(o.bake.files.output, studio.take(texture, shot.draw));
    if (showsLight(shot.draw.view)) spdlog::info("exposure {:.2f} EV", studio.exposure());
    spdlog::info("wrote {} ({} in all)", o.bake.files.output, formatDuration(secondsSince(start)));
}

} // namespace

void addShotCommand(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("shot", "Make a picture of a scene, lit by its lightmap; needs no display");
    const auto options = std::make_shared<ShotOptions>();
    addShotOptions(*command, *options);
    command->callback([options] { shoot(*options); });
}

} // namespace relume
