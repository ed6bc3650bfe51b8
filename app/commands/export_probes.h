#pragma once

#include <string>
#include <vector>

#include "app/export/export_folder.h"
#include "assets/images/layered_exr.h"

namespace relume {

/// Returns the names of the files of light probes that an engine gets, without their bytes; `path` is the
/// file of probes, "": none.
std::vector<ExportExtra> probeExtras(Engine engine, const std::string& path);

/// Reads the file of probes and makes these files of it. Where the lightmap is the sum of `layers`, probes
/// that have layers are weighed as these are. What the engine's form needs a grid for is left out where there
/// is none. Throws Error.
std::vector<ExportExtra> readProbeExtras(Engine engine, const std::string& path, const LayeredImage* layers);

} // namespace relume
