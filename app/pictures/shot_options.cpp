#include "app/pictures/shot_options.h"

#include "app/edit/choice_options.h"
#include "app/pictures/make_frame_writer.h"
#include "app/text/frame_names.h"
#include "app/text/option_checks.h"
#include "app/text/typed_numbers.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "renderer/good_view.h"
#include "renderer/scene_geometry.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

namespace relume {
namespace {

constexpr uint32_t kMinEdge = 16, kMaxEdge = 16384; // of a picture [pixels]
constexpr float kMostMetres = 1e9f; // squares and products of such places are far from what floats can hold

glm::vec3 parsePoint(const std::string& option, const std::string& text) {
    const std::vector<float> numbers = typedNumbers(text, 3);
    const auto isNear = [](float number) { return std::abs(number) <= kMostMetres; };
    if (numbers.empty() || !std::all_of(numbers.begin(), numbers.end(), isNear))
        throw UsageError(option + ": " + inQuotes(text) +
                         " is no point: write x,y,z in metres, each from -1e9 to 1e9");
    return {numbers[0], numbers[1], numbers[2]};
}

void parseSize(const std::string& text, ShotRequest& request) {
    const size_t cross = text.find('x');
    const auto edge = [&](std::string_view part) {
        const std::optional<float> value = typedNumber(part);
        const bool good = value && *value == std::floor(*value) && *value >= kMinEdge && *value <= kMaxEdge;
        if (!good) {
            throw UsageError("--size: '" + text + "' is no size: write WIDTHxHEIGHT in pixels, each from " +
                             std::to_string(kMinEdge) + " to " + std::to_string(kMaxEdge));
        }
        return static_cast<uint32_t>(*value);
    };
    const std::string_view all = text;
    request.width = edge(all.substr(0, std::min(cross, all.size())));
    request.height = edge(cross == std::string::npos ? "" : all.substr(cross + 1));
}

uint32_t indexOf(const std::vector<std::string>& names, const std::string& name) {
    return static_cast<uint32_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

std::string cameraNames(const Scene& scene) {
    if (scene.cameras.empty()) return "it has none, use --eye and --target";
    std::string names = "it has ";
    for (size_t i = 0; i < scene.cameras.size(); ++i)
        names += (i > 0 ? ", " : "") + inQuotes(scene.cameras[i].name);
    return names;
}

} // namespace

std::vector<std::string> shotPaths() {
    return {kAnimationPath, kBookmarksPath, kCamerasPath};
}

void addPictureOptions(CLI::App& command, ShotOptions& o) {
    command.add_option("--size", o.size, "Of the picture in pixels")->capture_default_str()->type_name("WxH");
    command.add_option("--camera", o.camera, "The scene's camera of this name (default: its first one)");
    command.add_option("--eye", o.eye, "Look from this point [m]; with --target")->type_name("X,Y,Z");
    command.add_option("--target", o.target, "Look at this point [m]; with --eye")->type_name("X,Y,Z");
    command.add_option("--fov", o.fov, "Angle of the picture's height in degrees")
        ->check(numberFrom(1.0, 170.0));
    command
        .add_option(
            "--view", o.view,
            "lit, lighting, albedo, emission, normal, material, instance, checker (lightmap texels), density "
            "(texels per metre) or coverage")
        ->capture_default_str()
        ->check(oneOf(viewNames()));
    command.add_option("--exposure", o.exposure, "Of light, in EV, or auto")->capture_default_str();
    command.add_option("--tone", o.tone, "Tone mapping: agx, aces or none")
        ->capture_default_str()
        ->check(oneOf(toneNames()));
    command.add_flag("--no-dither", o.noDither,
                     "Round light to 8 bits without dithering: contours in dark places, but a smaller file");
    command.add_option("--filter", o.filter, "Of the lightmap: bilinear, bicubic or nearest")
        ->capture_default_str()
        ->check(oneOf(filterNames()));
}

void addShotOptions(CLI::App& command, ShotOptions& o) {
    command.add_option("SCENE", o.bake.files.scene, "Scene: .glb, .gltf, .obj, .fbx, .dae, ...")
        ->required()
        ->type_name("");
    addChoiceOptions(command, o.bake.files.choice);
    command
        .add_option("-o,--output", o.bake.files.output,
                    "Picture to write, .png; with --turntable or --path a folder for its frames, or FILE.mp4 "
                    "(by ffmpeg)")
        ->required();
    CLI::Option* turn =
        command
            .add_option(
                "--turntable", o.turntable,
                "Make so many pictures of a turn: about the scene, or in place where the camera is inside")
            ->check(wholeFrom(2, kMostFrames));
    command
        .add_option("--path", o.path,
                    "Make pictures of a way: of the camera in the file's first animation, or through all of "
                    "the viewer's bookmarks of this scene, or through all cameras of the file")
        ->check(oneOf(shotPaths()))
        ->excludes(turn);
    command
        .add_option("--seconds", o.seconds,
                    "With --path: how long it takes (default: the animation's own time; 3 s from one stop to "
                    "the next)")
        ->check(numberFrom(0.01, 36000.0))
        ->needs("--path");
    command.add_option("--fps", o.fps, "With --turntable or --path: pictures per second (default: 25)")
        ->check(numberFrom(FrameWriter::kLeastRate, FrameWriter::kMostRate));
    command.add_flag(
        "--mp4", o.mp4,
        "With --turntable or --path: make a video (by ffmpeg); OUTPUT gets the ending .mp4 if it lacks it");
    command.add_flag("--no-caption", o.noCaption,
                     "With --turntable or --path: leave out scene, light and where the camera is on its way");
    command.add_flag("--overwrite", o.overwrite,
                     "With --turntable or --path: remove the frames that the folder holds");
    addPictureOptions(command, o);
    command.add_option("--lightmap", o.lightmap, "Take this lightmap, .exr or .png, and do not bake");
    CLI::Option* lightmap = command.get_option("--lightmap");
    addSizeOption(command, "--lightmap-size", o.bake);
    addSolverOptionsBeside(command, o.bake, {lightmap});
    for (const char* size : {"--lightmap-size", "--pages"})
        command.get_option(size)->excludes(lightmap);
}

ShotRequest resolveShotOptions(const ShotOptions& o) {
    const std::string& output = o.bake.files.output;
    if (!o.isSeries() && !output.ends_with(".png"))
        throw UsageError("--output: '" + output + "' does not end in .png");
    for (const auto& [given, option] : {std::pair(o.fps > 0, "--fps"),
                                        {o.mp4, "--mp4"},
                                        {o.noCaption, "--no-caption"},
                                        {o.overwrite, "--overwrite"}})
        if (given && !o.isSeries())
            throw UsageError(std::string(option) + ": is about a series: give --turntable or --path, too");
    if (!o.path.empty() && !o.eye.empty())
        throw UsageError("--path: not with --eye and --target, which are one place");
    if ((o.path == kBookmarksPath || o.path == kCamerasPath) && !o.camera.empty())
        throw UsageError("--camera: not with --path " + o.path + ", which goes through all of them");
    ShotRequest request = resolvePictureOptions(o);
    if (o.fps > 0) request.rate = o.fps;
    if (o.isSeries())
        checkSeries({.path = shotOutput(o),
                     .width = request.width,
                     .height = request.height,
                     .overwrite = o.overwrite});
    return request;
}

std::string shotOutput(const ShotOptions& o) {
    std::string output = o.bake.files.output;
    if (!o.mp4 || output.empty() || isVideo(output)) return output;
    while (output.size() > 1 && output.ends_with('/'))
        output.pop_back();
    return output + ".mp4";
}

ShotRequest resolvePictureOptions(const ShotOptions& o) {
    if (o.eye.empty() != o.target.empty())
        throw UsageError("--eye and --target: one says nothing without the other");
    if (!o.eye.empty() && !o.camera.empty())
        throw UsageError("--camera: not with --eye and --target, which are a camera themselves");
    if (!o.eye.empty() && parsePoint("--eye", o.eye) == parsePoint("--target", o.target))
        throw UsageError("--eye and --target: are the same point, there is no direction to look in");
    ShotRequest request;
    parseSize(o.size, request);
    request.draw.view = static_cast<View>(indexOf(viewNames(), o.view));
    request.draw.filter = static_cast<LightmapFilter>(indexOf(filterNames(), o.filter));
    request.draw.tone = static_cast<ToneMap>(indexOf(toneNames(), o.tone));
    request.draw.exposure = typedExposure(o.exposure);
    request.draw.dither = !o.noDither;
    return request;
}

ViewCamera chooseCamera(const ShotOptions& o, const Scene& scene, const WorldMesh& mesh, float aspect) {
    const Box bounds = boundsOf(mesh);
    ViewCamera camera;
    const auto named = std::find_if(scene.cameras.begin(), scene.cameras.end(),
                                    [&](const Camera& candidate) { return candidate.name == o.camera; });
    if (!o.eye.empty())
        camera = cameraAt(parsePoint("--eye", o.eye), parsePoint("--target", o.target), bounds);
    else if (!o.camera.empty() && named == scene.cameras.end())
        throw Error(o.bake.files.scene + ": has no camera " + inQuotes(o.camera) + ": " + cameraNames(scene));
    else if (!o.camera.empty())
        camera = cameraOfFile(*named, bounds);
    else if (!scene.cameras.empty())
        camera = cameraOfFile(scene.cameras.front(), bounds);
    else
        camera = goodView(mesh, aspect);
    if (o.fov > 0) {
        camera.yfov = static_cast<float>(glm::radians(o.fov));
        camera.halfHeight = 0.0f;
    }
    return camera;
}

} // namespace relume
