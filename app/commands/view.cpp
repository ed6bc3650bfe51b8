#include "app/commands/command.h"
#include "app/viewer/shell/view_options.h"
#include "app/viewer/shell/viewer.h"
#include "shaders/shader_library.h"

#include <memory>

namespace relume {

void addViewCommand(CLI::App& app) {
    CLI::App* command = app.add_subcommand("view", "Open a window that shows a scene while it bakes");
    const auto options = std::make_shared<ViewOptions>();
    addViewOptions(*command, *options);
    command->callback([options, command] {
        options->sizeTyped = command->get_option("--size")->count() > 0;
        const ViewerDesc desc = resolveViewOptions(*options);
        if (!options->bake.machine.shaders.empty()) setShaderFolder(options->bake.machine.shaders);
        Viewer viewer(desc);
        viewer.run();
    });
}

} // namespace relume
