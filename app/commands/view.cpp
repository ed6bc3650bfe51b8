#include "app/commands/command.h"
#include "app/commands/command_line.h"
#include "app/viewer/shell/view_options.h"
#include "app/viewer/shell/viewer.h"
#include "assets/base/log.h"
#include "shaders/shader_library.h"

#include <cstdlib>
#include <memory>

namespace relume {

void addViewCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("view", "Open a window that shows a scene while it bakes");
    const auto options = std::make_shared<ViewOptions>();
    addViewOptions(*command, *options);
    command->callback([options] {
        const ViewerDesc desc = resolveViewOptions(*options);
        if (!options->bake.machine.shaders.empty()) setShaderFolder(options->bake.machine.shaders);
        Viewer viewer(desc);
        viewer.run();
    });
}

bool opensStartPage() {
    const auto named = [](const char* variable) {
        const char* value = std::getenv(variable);
        return value != nullptr && value[0] != '\0';
    };
    if (!named("DISPLAY") && !named("WAYLAND_DISPLAY")) return false;
    try {
        Viewer viewer(resolveViewOptions({}));
        viewer.run();
    } catch (const NoWindow& error) {
        spdlog::warn("{}", error.what());
        return false;
    }
    return true;
}

} // namespace relume
