#pragma once

#include <string>
#include <vector>

#include "app/live/session.h"

namespace relume {

/// One line of a menu of what a scene's file offers.
struct FileChoice {
    std::string label;
    GltfChoice choice;   // by which the file is read where it is chosen
    bool chosen = false; // it is what is shown
};

/// Returns the scenes of a file, of which the one of number `shown` was read. Empty where there is nothing to
/// choose. `now` is how it was read.
std::vector<FileChoice> sceneChoices(const std::vector<std::string>& names, int shown, const GltfChoice& now);
/// Returns the variants of a file's materials, behind a line for its own materials. Empty where it has none.
std::vector<FileChoice> variantChoices(const std::vector<std::string>& names, const GltfChoice& now);

} // namespace relume
