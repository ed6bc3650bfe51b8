#include "app/viewer/shell/view_options.h"

#include "app/edit/choice_options.h"
#include "app/text/option_checks.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <system_error>

#include <CLI/CLI.hpp>

namespace relume {
namespace {

uint32_t parseEdge(const std::string& all, std::string_view part) {
    uint32_t value = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    if (error == std::errc() && end == part.data() + part.size() && value >= kLeastWindowEdge &&
        value <= kMostWindowEdge)
        return value;
    throw UsageError("--window-size: '" + all + "' is no size: write WIDTHxHEIGHT, each from " +
                     std::to_string(kLeastWindowEdge) + " to " + std::to_string(kMostWindowEdge));
}

constexpr double kViewDensity = 4; // [texels/m]: a shadow's edge is within 25 cm of where it belongs

bool isScene(std::string name) {
    std::error_code code;
    if (std::filesystem::is_regular_file(name, code)) return true;
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name.ends_with(".glb") || name.ends_with(".gltf");
}

} // namespace

void addDisplayOption(CLI::App& command, std::string& display) {
    command
        .add_option("--display", display,
                    "How the lightmap comes to OpenGL: shared (no copy), copied, or auto")
        ->capture_default_str()
        ->check(oneOf({"auto", "shared", "copied"}));
}

DisplayMode displayModeOf(const std::string& display) {
    if (display == "shared") return DisplayMode::Shared;
    return display == "copied" ? DisplayMode::Copied : DisplayMode::Auto;
}

void addViewOptions(CLI::App& command, ViewOptions& o) {
    command
        .add_option("SCENE", o.bake.files.scene,
                    "Scene: .glb, .gltf, .obj, .fbx, .dae, ... (default: none yet)")
        ->type_name("");
    addChoiceOptions(command, o.bake.files.choice);
    addSizeOption(command, "--size", o.bake);
    command.get_option("--size")->description(
        fmt::format("Lightmap edge in texels (default: what gives {} texels per metre, from 512 on as far as "
                    "half of the free memory goes)",
                    kViewDensity));
    addSolverOptions(command, o.bake);
    command.add_option("--preset", o.bake.solve.preset, "rtrad: the reference implementation to the letter")
        ->check(oneOf({"rtrad"}));
    command.add_option("--budget", o.budget, "Aim of one batch in milliseconds while the camera is still")
        ->capture_default_str()
        ->check(numberFrom(1.0, 45.0));
    command
        .add_option(
            "--bake-device", o.bakeDevice,
            fmt::format("Vulkan device that bakes while another one draws: as --device, or '{}' for a "
                        "GPU that is not the one that draws",
                        kSecondGpu))
        ->excludes(command.get_option("--device"));
    addDisplayOption(command, o.display);
    command.add_flag("--no-layers", o.noLayers,
                     "Bake all lights as one: takes less memory, but each edit of a light bakes all anew");
    addLayerMemory(command, o.bake);
    command.add_flag("--watch,!--no-watch", o.watch,
                     "Follow the scene's file, and those that belong to it, when another program writes them "
                     "(default: on)");
    command
        .add_option("--window-size", o.window,
                    "Size of the window, times the monitor's scale (default: as last time)")
        ->type_name("WxH");
    command.add_option("--camera", o.camera, "The scene's camera of this name (default: its first one)");
    command.add_flag("--log-actions", o.logActions,
                     "Print each action on the standard error as it is done, for bug reports");
}

ViewerDesc resolveViewOptions(const ViewOptions& o) {
    ViewerDesc desc{.scene = o.bake.files.scene,
                    .request = resolveBakeOptions(o.bake),
                    .device = o.bakeDevice.empty() ? o.bake.machine.device : o.bakeDevice,
                    .deviceMemory = o.bake.machine.memory,
                    .validation = o.bake.machine.validate,
                    .display = displayModeOf(o.display),
                    .budgetMs = o.budget,
                    .watch = o.watch,
                    .camera = o.camera,
                    .logActions = o.logActions};
    const double density = o.bake.patches.furnishing.density;
    if (!o.bake.patches.sizeTyped) desc.request.prepare.leastDensity = density > 0 ? density : kViewDensity;
    desc.request.bake.solver.layers.on = !o.noLayers;
    if (!o.window.empty()) {
        const size_t cross = o.window.find('x');
        const std::string_view all = o.window;
        desc.width = parseEdge(o.window, all.substr(0, cross));
        desc.height = parseEdge(o.window, cross == std::string::npos ? "" : all.substr(cross + 1));
    }
    return desc;
}

std::vector<std::string> withViewVerb(std::vector<std::string> arguments,
                                      const std::vector<std::string>& verbs) {
    const auto first = std::find_if(arguments.begin(), arguments.end(), [](const std::string& argument) {
        return argument.empty() || argument.front() != '-';
    });
    if (first == arguments.end() || std::find(verbs.begin(), verbs.end(), *first) != verbs.end())
        return arguments;
    if (isScene(*first)) arguments.insert(first, "view");
    return arguments;
}

} // namespace relume
