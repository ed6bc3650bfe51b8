#pragma once

#include <string>

#include "app/offline/bake_options.h"

namespace relume {

/// What the user typed after `relume export` for a page with the mix board.
struct WebOptions {
    std::string path;      // "": no page is wanted
    bool single = false;   // one file
    std::string timelapse; // folder of frames, "": none
};

/// Writes the page. SCENE may be the file of the layers (.exr): then its scene lies beside it, under the name
/// that the file says. Throws UsageError and Error.
void exportWeb(const WebOptions& options, const BakeOptions& bake, const std::string& layers,
               const std::string& exposure);

} // namespace relume
