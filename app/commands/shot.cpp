#include "app/command.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/shot_options.h"
#include "app/solve.h"
#include "assets/clock.h"
#include "assets/error.h"
#include "assets/log.h"
#include "renderer/gl/debug.h"
#include "renderer/gl/headless_context.h"
#include "renderer/picture.h"
#include "renderer/scene_renderer.h"
#include "shaders/shader_library.h"

#include <memory>

namespace relume {
namespace {

FloatImage bakeLightmap(const ShotOptions& o, const BakeRequest& request, PreparedScene& prepared) {
    const vk::Device device({.select = o.bake.device, .validation = o.bake.validate});
    spdlog::info("device: {} ({})", device.info().name, device.info().driver);
    Baker baker(device, prepared.scene, prepared.mesh, request.bake);
    spdlog::info("{} patches", baker.patches().count);
    warnIfDark(prepared.scene, baker.patches());
    BakeCheckpoints none(o.bake);
    solve(baker.solver(), request.bake.solver, none);
    const SolverProgress& progress = baker.solver().progress();
    spdlog::info("baked {} x {} in {:.2f} s, remaining error {:.2g}", request.bake.size, request.bake.size,
                 progress.seconds, progress.error);
    return baker.lightmap(request.lightmap);
}

std::string attribute(const FloatImage& image, const std::string& name) {
    const auto found = image.attributes.find(name);
    return found != image.attributes.end() ? found->second : "";
}

// A lightmap that the user made before. Throws Error when it is none of lighting.
FloatImage readLightmap(const std::string& path, const std::string& scene) {
    FloatImage image = readImage(path);
    if (attribute(image, "relume:quantity") == "radiance") {
        throw Error(path +
                    ": holds radiance, which has the albedo in it: bake it with --quantity lighting and "
                    "without --preset");
    }
    const std::string from = attribute(image, "relume:scene");
    if (!from.empty() && from != scene.substr(scene.find_last_of('/') + 1))
        spdlog::warn("{}: is a lightmap of {}, not of {}", path, from, scene);
    return image;
}

void shoot(ShotOptions o) {
    const auto start = Clock::now();
    const InterruptGuard guard;
    const ShotRequest shot = resolveShotOptions(o);
    BakeRequest request = resolveBakeOptions(o.bake);
    checkWritable(o.bake.output);
    if (!o.bake.shaders.empty()) setShaderFolder(o.bake.shaders);
    std::unique_ptr<FloatImage> image;
    if (!o.lightmap.empty()) {
        image = std::make_unique<FloatImage>(readLightmap(o.lightmap, o.bake.scene));
        request.prepare.size = image->width; // the gutters of a repacked atlas depend on it
    }
    // Before the bake: where there is no OpenGL it would be in vain.
    const gl::HeadlessContext context({.debug = o.bake.validate});
    spdlog::info("pictures: {}, by EGL ({})", gl::describeContext(), context.platform());
    SceneRenderer renderer;

    PreparedScene prepared = prepareScene(request.prepare);
    stopIfInterrupted();
    const float aspect = static_cast<float>(shot.width) / static_cast<float>(shot.height);
    const ViewCamera camera = chooseCamera(o, prepared.scene, prepared.mesh, aspect);
    const SceneGpu scene(prepared.scene, prepared.mesh);
    if (!image && readsLightmap(shot.draw.view))
        image = std::make_unique<FloatImage>(bakeLightmap(o, request, prepared));
    std::unique_ptr<LightmapImage> lightmap;
    if (image)
        lightmap = std::make_unique<LightmapImage>(*image, o.lightmap.empty() ? "lightmap" : o.lightmap);

    const gl::Framebuffer target({.width = shot.width, .height = shot.height, .name = "shot"});
    renderer.draw({.scene = scene,
                   .lightmap = lightmap ? lightmap->texture() : LightmapTexture{.size = request.prepare.size},
                   .camera = camera,
                   .settings = shot.draw},
                  {.framebuffer = target.get(), .width = shot.width, .height = shot.height});
    writeImage(o.bake.output, readPicture(target));
    if (showsLight(shot.draw.view)) spdlog::info("exposure {:.2f} EV", renderer.exposure());
    spdlog::info("wrote {} ({} in all)", o.bake.output, formatDuration(secondsSince(start)));
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
