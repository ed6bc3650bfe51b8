#include "app/commands/command.h"
#include "app/offline/bake_checkpoints.h"
#include "app/offline/command_files.h"
#include "app/offline/lightmap_attributes.h"
#include "app/offline/progress.h"
#include "app/offline/solve.h"
#include "app/pictures/make_frame_writer.h"
#include "app/pictures/picture_studio.h"
#include "app/pictures/series.h"
#include "app/text/frame_names.h"
#include "app/text/interrupt.h"
#include "app/viewer/state/preferences.h"
#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "assets/gltf/gltf_camera_motion.h"
#include "assets/images/paged_image.h"
#include "renderer/scene_geometry.h"
#include "shaders/shader_library.h"

#include <cmath>
#include <filesystem>
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

constexpr double kSecondsOfLeg = 3; // from one stop of a path to the next

// Returns the stops of a path, bookmarks or the file's cameras.
std::vector<ViewCamera> stopsOf(const ShotOptions& o, const Scene& scene, const Box& bounds) {
    std::vector<ViewCamera> stops;
    const bool ofFile = o.path == kCamerasPath;
    if (ofFile)
        for (const Camera& camera : scene.cameras)
            stops.push_back(cameraOfFile(camera, bounds));
    else
        for (const Bookmark& mark :
             readPreferences(preferencesPath()).bookmarks[absolutePath(o.bake.files.scene)])
            stops.push_back(mark.camera);
    if (stops.size() < 2)
        throw Error(fmt::format(
            "{}: has {} {}, and a path needs two: {}", o.bake.files.scene, stops.empty() ? "no" : "one",
            std::string(ofFile ? "camera" : "bookmark") + (stops.empty() ? "s" : ""),
            ofFile ? "add cameras to the file" : "store them in the viewer (F1 shows how)"));
    return stops;
}

// Returns where the camera goes, without a title. Reads the file's animation, but not its light.
CameraSeries seriesOf(const ShotOptions& o, const ShotRequest& shot, const PreparedScene& prepared,
                      const ViewCamera& camera) {
    const Box bounds = boundsOf(prepared.mesh);
    if (o.turntable > 0) return turnSeries(camera, bounds, o.turntable);
    if (o.path == kAnimationPath) {
        const std::string& file = o.bake.files.scene;
        double rate = shot.rate;
        CameraMotion motion = readCameraMotion(file, o.bake.files.choice, o.camera, rate, kMostFrames);
        if (o.seconds > 0) { // faster or slower than it is
            rate *= o.seconds / std::max(motion.seconds, 1.0 / rate);
            motion = readCameraMotion(file, o.bake.files.choice, o.camera, rate, kMostFrames);
        }
        CameraSeries series;
        for (const Camera& moved : motion.cameras)
            series.cameras.push_back(cameraOfFile(moved, bounds));
        captionByTime(series, o.seconds > 0 ? o.seconds : motion.seconds);
        return series;
    }
    const std::vector<ViewCamera> stops = stopsOf(o, prepared.scene, bounds);
    const double seconds = o.seconds > 0 ? o.seconds : kSecondsOfLeg * static_cast<double>(stops.size() - 1);
    if (seconds * shot.rate + 1 > kMostFrames)
        throw Error(fmt::format("--seconds {:g}: takes {:.0f} pictures, more than {}: lower --fps", seconds,
                                seconds * shot.rate + 1, kMostFrames));
    return pathSeries(stops, seconds, shot.rate);
}

std::string titleOf(const ShotOptions& o, const BakeRequest& request) {
    const std::string scene = std::filesystem::path(o.bake.files.scene).stem().string();
    if (!o.lightmap.empty()) return scene + ", " + std::filesystem::path(o.lightmap).filename().string();
    return fmt::format("{}, {}, {} x {} texels", scene, methodName(request.bake.solver.method),
                       request.prepare.size, request.prepare.size);
}

void shoot(ShotOptions o) {
    const auto start = Clock::now();
    const InterruptGuard guard;
    const ShotRequest shot = resolveShotOptions(o);
    o.bake.files.output = shotOutput(o);
    BakeRequest request = resolveBakeOptions(o.bake);
    const bool frames = o.isSeries() && !isVideo(o.bake.files.output);
    CommandFiles files;
    files.readsScene("SCENE", o.bake.files.scene).readsLightmap("--lightmap", o.lightmap);
    if (frames)
        files.writesFrames("--output", o.bake.files.output);
    else
        files.writes("--output", o.bake.files.output);
    files.check();
    std::unique_ptr<FrameWriter> writer;
    if (o.isSeries())
        writer = makeFrameWriter({.path = o.bake.files.output,
                                  .width = shot.width,
                                  .height = shot.height,
                                  .rate = shot.rate,
                                  .overwrite = o.overwrite});
    else
        checkWritable(o.bake.files.output);
    if (!o.bake.machine.shaders.empty()) setShaderFolder(o.bake.machine.shaders);
    std::unique_ptr<FloatImage> image;
    if (!o.lightmap.empty()) {
        image = std::make_unique<FloatImage>(readLightmap(o.lightmap, o.bake.files.scene));
        matchLightmap(request.prepare, *image);
    }
    std::optional<PhaseProgress> phase(std::in_place, true);
    PreparedScene prepared = prepareFor(request);
    stopIfInterrupted();
    std::unique_ptr<PictureBake> bake; // outlives the studio (picture_studio.h)
    PictureStudio studio(o.bake);
    studio.open(o, shot, prepared);
    CameraSeries series; // known before a bake, which would be in vain where there is no way
    if (writer) series = seriesOf(o, shot, prepared, studio.camera());
    if (writer && !o.noCaption) series.title = titleOf(o, request);
    if (!image && readsLightmap(shot.draw.view)) {
        bake = std::make_unique<PictureBake>(o.bake, request, prepared);
        image = std::make_unique<FloatImage>(bakeLightmap(o, request, *bake));
    }
    phase.reset();
    std::unique_ptr<LightmapImage> lightmap;
    if (image)
        lightmap = std::make_unique<LightmapImage>(*image, o.lightmap.empty() ? "lightmap" : o.lightmap);

    const LightmapTexture texture =
        lightmap ? lightmap->texture()
                 : LightmapTexture{.size = prepared.atlas.pages.sheetOf(request.prepare.size)};
    if (writer)
        takeSeries(studio, texture, shot.draw, series, *writer);
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
