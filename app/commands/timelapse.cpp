#include "app/commands/command.h"
#include "app/offline/command_files.h"
#include "app/offline/progress.h"
#include "app/offline/solve.h"
#include "app/pictures/make_frame_writer.h"
#include "app/pictures/timelapse.h"
#include "app/text/frame_names.h"
#include "app/text/interrupt.h"
#include "assets/base/clock.h"
#include "assets/base/log.h"
#include "shaders/shader_library.h"

#include <filesystem>
#include <memory>
#include <optional>

namespace relume {
namespace {

constexpr double kHoldLast = 2.0; // [s]: a video's last frame is to be looked at

void makeTimelapse(const TimelapseOptions& o) {
    const auto start = Clock::now();
    const InterruptGuard guard;
    const TimelapseRequest request = resolveTimelapseOptions(o);
    const BakeOptions& options = o.shot.bake;
    BakeRequest bakeRequest = resolveBakeOptions(options);
    CommandFiles files;
    files.readsScene("SCENE", options.files.scene);
    if (isVideo(options.files.output))
        files.writes("--output", options.files.output);
    else
        files.writesFrames("--output", options.files.output);
    files.check();
    const auto writer = makeFrameWriter({.path = options.files.output,
                                         .width = request.shot.width,
                                         .height = request.shot.height,
                                         .rate = request.rate,
                                         .hold = kHoldLast,
                                         .overwrite = o.overwrite});
    if (!options.machine.shaders.empty()) setShaderFolder(options.machine.shaders);
    std::optional<PhaseProgress> phase(std::in_place, false); // there is a video on its way
    PreparedScene prepared = prepareFor(bakeRequest);
    stopIfInterrupted();
    std::unique_ptr<PictureBake> bake; // outlives the studio (picture_studio.h)
    PictureStudio studio(options);
    studio.open(o.shot, request.shot, prepared);

    bake = std::make_unique<PictureBake>(options, bakeRequest, prepared);
    const SolverSettings& solver = bakeRequest.bake.solver;
    Timelapse timelapse(
        {.studio = studio,
         .baker = bake->baker(),
         .writer = *writer,
         .request = request,
         .lightmap = bakeRequest.lightmap,
         .title =
             fmt::format("{}, {}, {} x {} texels", std::filesystem::path(options.files.scene).stem().string(),
                         methodName(solver.method), bakeRequest.bake.size, bakeRequest.bake.size),
         .pairs = isPairMethod(solver.method)});
    phase.reset();
    solve(bake->baker().solver(), solver, timelapse);
    bake->logEnd();
    timelapse.finish();
    spdlog::info("wrote {}: {} frames ({} in all)", options.files.output, writer->count(),
                 formatDuration(secondsSince(start)));
}

} // namespace

void addTimelapseCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand(
        "timelapse", "Show how a scene's light converges, as pictures or a video; needs no display");
    const auto options = std::make_shared<TimelapseOptions>();
    addTimelapseOptions(*command, *options);
    command->callback([options] { makeTimelapse(*options); });
}

} // namespace relume
