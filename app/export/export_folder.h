#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/export/engine_files.h"
#include "app/export/surface_light.h"
#include "assets/base/file_write.h"
#include "assets/images/float_image.h"
#include "assets/images/ktx2.h"
#include "assets/model/lightmap_pages.h"
#include "bake/vk/device.h"

namespace relume {

/// A file that comes along with a level.
struct ExportExtra {
    std::string name;       // in the folder
    std::string bytes = {}; // of the file
    std::string line = {};  // what README.txt says of it
};

/// Says what is exported, for whom and where.
struct ExportDesc {
    Engine engine = Engine::Three;
    std::string folder;                    // is made where it is missing
    std::optional<float> exposure = {};    // [EV]; none: what the surfaces ask for
    Ktx2Format format = Ktx2Format::Half;  // of lightmap.ktx2
    bool gloss = false;                    // highlights stay, which take from the diffuse light
    uint32_t textureSize = 0;              // Engine::Any: edge of the light's texture [texels]; 0: it follows
                                           // from the lightmap's
    std::vector<ExportExtra> extras = {};  // what else is written, such as light probes
    LightmapPages pages = {};              // of the lightmap, as far as they are known
    OnFailure onFailure = OnFailure::Drop; // of files that cannot be written: Keep where they took a bake
};

/// Tells what was written.
struct ExportResult {
    std::vector<std::string> files; // by path
    float exposure = 0.0f;          // [EV]
};

/// Returns the paths of the files that exportLevel() writes for desc.pages.
std::vector<std::string> exportedFiles(const ExportDesc& desc);

/// Throws Error where the folder cannot be written to: call before long work.
void checkExport(const ExportDesc& desc);

/// Throws Error where an image called `name` is no lightmap: it lacks a channel, or is no square.
void checkLightmap(const FloatImage& lightmap, const std::string& name);

/// Writes a level with its lightmap (lighting, R, G and B) as an engine reads it: scene.glb, lightmap.ktx2,
/// lightmap.exr, README.txt and what else the engine needs. Files of the same names are replaced, all of them
/// or none; others in the folder stay. The scene's first camera comes first; one without a camera gets the
/// view that the viewer begins with. A lightmap of several pages becomes lightmap.0.ktx2 and so on where the
/// engine's files load them (knowsPages), whose materials say which page they take; for others all pages are
/// side by side in one texture. Throws Error where that would be too large.
ExportResult exportLevel(const ExportDesc& desc, const vk::Device& device, const AtlasLevel& level,
                         const FloatImage& lightmap);

} // namespace relume
