#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "assets/images/layered_exr.h"
#include "bake/layers/layer_solver.h"

namespace relume {

/// Names the attributes that a file of some layers has beside those of a whole bake, so that files of jobs
/// can be joined and none of another scene gets among them. A file that has all layers has none of them.
namespace job_attribute {
// This one is of the composite: the scene's lights, in order, one per line (name_lines.h).
constexpr const char* kLights = "relume:all-lights";
constexpr const char* kScene =
    "relume:scene-fingerprint"; // of the composite: all that a bake reads, hexadecimal
// This one is of a layer and tells the error of its sum with others. Its numbers are light, variance of
// direct and of indirect light, error, error of bounces, then the sketch of the error
// (bake/layers/error_sketch.h).
constexpr const char* kEstimate = "relume:estimate";
} // namespace job_attribute

/// The scene that a job bakes layers of.
struct JobScene {
    std::vector<std::string> lights; // names of all that shine, in their order
    uint64_t fingerprint = 0;        // sceneFingerprint
};
/// Notes these attributes in the image of a finished bake, where it does not have all of the scene's lights.
void noteJob(LayeredImage& image, const LayerSolver& solver, const JobScene& scene);

/// A file that is to be joined.
struct LayerFile {
    std::string path; // for messages
    LayeredImage image;
};

/// Puts layers of several files into one, in the order of their scene's lights. Where all are there and each
/// layer went as far as in one bake, the image is that of one process's bake: same layers, attributes,
/// passes, error. Its composite is the sum of the layers and is still to be made (sumLayers). A single file
/// is left as it is. Throws Error, naming both files, where they are of differing size, version, scene,
/// settings or surfaces or have the same layer, and where a file says nothing of its scene.
LayeredImage joinLayers(std::vector<LayerFile> files);

/// Returns the lights of the scene that the image has no layer of; none where it does not say.
std::vector<std::string> missingLights(const LayeredImage& image);

} // namespace relume
