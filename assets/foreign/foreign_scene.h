#pragma once

#include <string>

#include "assets/foreign/foreign_types.h"

namespace relume {

/// Reads a file by libassimp and makes a scene of it, as README.md says. Files that it names are looked for
/// by NearFiles. What cannot be used goes to Scene::warnings. Throws Error; a damaged file may also crash
/// this process or take its memory, for which there is importForeign().
ForeignScene convertForeign(const std::string& path, const ForeignChoice& choice = {},
                            const ForeignProgress& progress = nullptr);

} // namespace relume
