#pragma once

#include <string>

#include "app/offline/bake_options.h"
#include "renderer/camera.h"
#include "renderer/draw_settings.h"

namespace relume {

/// Returns the ways of a camera that users can name.
std::vector<std::string> shotPaths();
constexpr const char *kAnimationPath = "animation", *kBookmarksPath = "bookmarks", *kCamerasPath = "cameras";
constexpr uint32_t kMostFrames = 100000; // of a series: more than an hour of a video
constexpr double kSeriesRate = 25;       // pictures per second, where the user names no other number

/// The options that the user typed after `relume shot`.
struct ShotOptions {
    BakeOptions bake;     // scene, output and how the lightmap is made; its size is the lightmap's
    std::string lightmap; // an image to take instead, "": bake
    std::string camera, eye, target;
    double fov = 0; // [degrees], 0: not given
    std::string size = "1440x810", exposure = "auto";
    std::string view = "lit", filter = "bilinear", tone = "agx";
    bool noDither = false;
    uint32_t turntable = 0; // pictures of a turn, 0: no turn
    std::string path;       // where the camera goes: one of shotPaths(), "": nowhere
    double seconds = 0;     // that this takes; 0: as long as it takes by itself
    double fps = 0;         // pictures per second, 0: kSeriesRate
    bool mp4 = false;       // a series is a video, whatever the output's ending
    bool noCaption = false; // in pictures of a series
    bool overwrite = false; // the frames that the folder holds

    bool isSeries() const { return turntable > 0 || !path.empty(); }
};

void addShotOptions(CLI::App& command, ShotOptions& options);
/// Adds those of them that say what a picture looks like, for other verbs that make pictures.
void addPictureOptions(CLI::App& command, ShotOptions& options);

/// The picture that the options ask for. resolveShotOptions() throws UsageError when they are wrong or
/// contradict each other.
struct ShotRequest {
    uint32_t width = 0, height = 0; // [pixels]
    double rate = kSeriesRate;      // pictures per second
    DrawSettings draw;
};
ShotRequest resolveShotOptions(const ShotOptions& options);
/// Returns where the picture or the series goes: with --mp4 the output has that ending.
std::string shotOutput(const ShotOptions& options);
/// Does the same for the options of addPictureOptions().
ShotRequest resolvePictureOptions(const ShotOptions& options);

/// Returns the camera asked for: by name, by place, else the file's first one, else one that goodView()
/// finds. Throws Error when the scene has none of that name.
ViewCamera chooseCamera(const ShotOptions& options, const Scene& scene, const WorldMesh& mesh, float aspect);

} // namespace relume
