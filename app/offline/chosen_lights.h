#pragma once

#include <string>
#include <vector>

#include "assets/model/scene.h"

namespace relume {

/// Returns the names of the lights of a scene, as its layers are called: mesh lights, analytic lights, the
/// sky.
std::vector<std::string> lightNames(const Scene& scene);

/// Returns those of `names` that were typed, in the order of `names`. Each text is a name or several,
/// separated by commas; a name may hold commas itself, and the longest one counts. Throws UsageError,
/// naming `option` and the lights that there are, for an unknown name, for one that is there twice, and
/// where nothing is named.
std::vector<std::string> chosenLights(const std::string& option, const std::vector<std::string>& typed,
                                      const std::vector<std::string>& names);

} // namespace relume
