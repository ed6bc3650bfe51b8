#pragma once

#include <string>

#include "app/offline/bake_options.h"
#include "renderer/camera.h"
#include "renderer/draw_settings.h"

namespace relume {

/// The options that the user typed after `relume shot`.
struct ShotOptions {
    BakeOptions bake;     // scene, output and how the lightmap is made; its size is the lightmap's
    std::string lightmap; // an image to take instead, "": bake
    std::string camera, eye, target;
    double fov = 0; // [degrees], 0: not given
    std::string size = "1440x810", exposure = "auto";
    std::string view = "lit", filter = "bilinear", tone = "agx";
    uint32_t turntable = 0; // pictures of a turn, 0: one picture
    double rate = 25;       // of a video [frames/s]
    bool overwrite = false; // the frames that the folder holds
};

void addShotOptions(CLI::App& command, ShotOptions& options);
/// Adds those of them that say what a picture looks like, for other verbs that make pictures.
void addPictureOptions(CLI::App& command, ShotOptions& options);

/// The picture that the options ask for. resolveShotOptions() throws UsageError when they are wrong or
/// contradict each other.
struct ShotRequest {
    uint32_t width = 0, height = 0; // [pixels]
    DrawSettings draw;
};
ShotRequest resolveShotOptions(const ShotOptions& options);
/// Does the same for the options of addPictureOptions().
ShotRequest resolvePictureOptions(const ShotOptions& options);

/// Returns the camera asked for: by name, by place, else the file's first one, else one that goodView()
/// finds. Throws Error when the scene has none of that name.
ViewCamera chooseCamera(const ShotOptions& options, const Scene& scene, const WorldMesh& mesh, float aspect);

} // namespace relume
