#pragma once

#include <string>

#include "app/offline/bake_options.h"
#include "app/viewer/shell/viewer.h"

namespace relume {

/// The options that the user typed after `relume view`.
struct ViewOptions {
    BakeOptions bake; // scene, and how its lightmap is made
    std::string display = "auto", bakeDevice, window, camera;
    double budget = 8; // [ms]
    bool watch = true, logActions = false, noLayers = false;
};

void addViewOptions(CLI::App& command, ViewOptions& options);
/// Adds --display; displayModeOf() tells what its text means.
void addDisplayOption(CLI::App& command, std::string& display);
DisplayMode displayModeOf(const std::string& display);

/// Returns what the options ask for. Throws UsageError when they are wrong or contradict each other.
ViewerDesc resolveViewOptions(const ViewOptions& options);

/// Returns the arguments with "view" in front of a scene that stands where one of the verbs belongs: `relume
/// room.glb`.
std::vector<std::string> withViewVerb(std::vector<std::string> arguments,
                                      const std::vector<std::string>& verbs);

} // namespace relume
