#include "app/pictures/timelapse_options.h"

#include "app/edit/choice_options.h"
#include "app/pictures/make_frame_writer.h"
#include "app/text/frame_names.h"
#include "app/text/option_checks.h"
#include "assets/base/error.h"

#include <algorithm>
#include <charconv>

#include <CLI/CLI.hpp>

namespace relume {
namespace {

std::vector<uint32_t> parseCounts(const std::string& text) {
    std::vector<uint32_t> counts;
    std::string_view rest = text;
    for (bool more = true; more;) {
        const size_t comma = rest.find(',');
        const std::string_view part = rest.substr(0, comma);
        uint32_t count = 0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), count);
        const bool good = error == std::errc() && end == part.data() + part.size() && count > 0;
        if (!good || (!counts.empty() && count <= counts.back())) {
            throw UsageError("--at: '" + text +
                             "' is no list of rising whole numbers from 1: write for example 1,2,4,8");
        }
        counts.push_back(count);
        more = comma != std::string_view::npos;
        if (more) rest.remove_prefix(comma + 1);
    }
    return counts;
}

} // namespace

void addTimelapseOptions(CLI::App& command, TimelapseOptions& o) {
    command.add_option("SCENE", o.shot.bake.files.scene, "Scene: .glb, .gltf, .obj, .fbx, .dae, ...")
        ->required()
        ->type_name("");
    addChoiceOptions(command, o.shot.bake.files.choice);
    command
        .add_option(
            "-o,--output", o.shot.bake.files.output,
            "Folder for frame_0001.png and so on, made where there is none; or a video, FILE.mp4, for "
            "which ffmpeg must be installed")
        ->required();
    command
        .add_option(
            "--at", o.at,
            "Frames after so many passes; directional, hybrid: after the first sample pass that brings so "
            "many directions per patch (default: each time there are twice as many). The last frame is "
            "always "
            "the end of the bake")
        ->type_name("N,N,...");
    command
        .add_option(
            "--fps", o.fps,
            "Without --at: a frame every 1/N second of the solver's time, from the first light on. Also "
            "the rate of a video (default with --at: 2)")
        ->check(numberFrom(FrameWriter::kLeastRate, FrameWriter::kMostRate))
        ->type_name("N");
    command.add_flag("--no-caption", o.noCaption,
                     "Leave out scene, method, passes or directions, error and solver time");
    command.add_flag("--overwrite", o.overwrite, "Remove the frames that the folder holds");
    addPictureOptions(command, o.shot);
    addSizeOption(command, "--lightmap-size", o.shot.bake);
    addSolverOptions(command, o.shot.bake);
}

TimelapseRequest resolveTimelapseOptions(const TimelapseOptions& o) {
    const bool video = isVideo(o.shot.bake.files.output);
    TimelapseRequest request;
    request.shot = resolvePictureOptions(o.shot);
    if (request.shot.draw.view != View::Lit && request.shot.draw.view != View::Lighting) {
        throw UsageError("--view " + o.shot.view +
                         ": does not change while light converges: use lit or lighting, or 'relume shot'");
    }
    checkSeries({.path = o.shot.bake.files.output,
                 .width = request.shot.width,
                 .height = request.shot.height,
                 .overwrite = o.overwrite});
    if (!o.at.empty() && o.fps > 0 && !video)
        throw UsageError("--fps: with --at it is the rate of a video, a folder of frames has none");
    if (!o.at.empty()) request.at = parseCounts(o.at);
    if (o.at.empty() && o.fps > 0) request.every = 1.0 / o.fps;
    if (o.fps > 0) request.rate = o.fps;
    request.caption = !o.noCaption;
    return request;
}

} // namespace relume
