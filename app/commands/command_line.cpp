#include "app/commands/command_line.h"

#include "app/commands/command.h"
#include "app/text/near_names.h"
#include "app/viewer/shell/view_options.h"
#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/foreign/import_child.h"

#include <fmt/format.h>

#include <algorithm>

namespace relume {
namespace {

const CLI::App* verbNamed(const CLI::App& app, const std::string& name) {
    for (const CLI::App* verb : app.get_subcommands({}))
        if (verb->get_name() == name) return verb;
    return nullptr;
}

std::vector<std::string> verbsOf(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* verb : app.get_subcommands({}))
        names.push_back(verb->get_name());
    return names;
}

bool isOption(const std::string& argument) {
    return argument.starts_with('-');
}

void requireVerb(const std::vector<std::string>& arguments, const CLI::App& app) {
    const auto first = std::find_if_not(arguments.begin(), arguments.end(), isOption);
    if (first == arguments.end() || verbNamed(app, *first)) return;
    throw UsageError(fmt::format("{} is no verb and no scene (.glb, .gltf, .obj, .fbx, ...): {}",
                                 inQuotes(*first), nearNamesHint(*first, verbsOf(app))));
}

/// Returns the verb that was parsed last: `bench frames` is one below another.
const CLI::App& parsedVerb(const CLI::App& app) {
    const CLI::App* verb = &app;
    while (!verb->get_subcommands().empty())
        verb = verb->get_subcommands().front();
    return *verb;
}

std::string typedName(const CLI::App& verb) {
    return verb.get_parent() ? typedName(*verb.get_parent()) + " " + verb.get_name() : verb.get_name();
}

// Returns the one line for an error of the parser. A check of ours says itself what is allowed.
std::string parserMessage(const CLI::App* app, const CLI::Error& error) {
    std::string text = fmt::format("error: {}", error.what());
    std::replace(text.begin(), text.end(), '\n', ' ');
    if (error.get_exit_code() != static_cast<int>(CLI::ExitCodes::ValidationError))
        text += fmt::format(": '{} --help' shows what there is", typedName(parsedVerb(*app)));
    return text + "\n";
}

} // namespace

void addCommands(CLI::App& app) {
    addViewCommand(app);
    addBakeCommand(app);
    addShotCommand(app);
    addTimelapseCommand(app);
    addExportCommand(app);
    addEditCommand(app);
    addInfoCommand(app);
    addUnwrapCommand(app);
    addImportCommand(app);
    addSceneCommand(app);
    addDevicesCommand(app);
    addMixCommand(app);
    addCompareCommand(app);
    addBenchCommand(app);
    addSamplesCommand(app);
    app.failure_message(parserMessage);
}

std::vector<std::string> parserArguments(const std::vector<std::string>& typed, const CLI::App& app) {
    const std::vector<std::string> arguments = withViewVerb(typed, verbsOf(app));
    requireVerb(arguments, app);
    std::vector<std::string> ready;
    const CLI::App* verb = &app;
    bool optionsEnded = false;
    for (const std::string& argument : arguments) {
        if (!isOption(argument))
            if (const CLI::App* below = verbNamed(*verb, argument)) verb = below;
        optionsEnded = optionsEnded || argument == "--";
        const size_t equals = argument.find('=');
        const bool hasValue = !optionsEnded && argument.starts_with("--") && equals != std::string::npos;
        const std::string name = argument.substr(0, equals);
        const CLI::Option* option = hasValue ? verb->get_option_no_throw(name) : nullptr;
        if (option && option->get_items_expected_max() == 0)
            throw UsageError(fmt::format("{}: {} takes no value: leave out {}", inQuotes(argument), name,
                                         inQuotes(argument.substr(equals))));
        ready.push_back(option && equals + 1 == argument.size() ? name : argument);
        if (ready.back() != argument) ready.emplace_back();
    }
    return ready;
}

void requireSharedVerb(const CLI::App& app, const Launch& launch) {
    const std::string name = typedName(parsedVerb(app));
    if (launch.several() && name != "relume bake")
        throw UsageError(
            fmt::format("{}: is no work for {} processes, which share 'relume bake' alone: start it "
                        "without mpirun",
                        name, launch.count));
}

std::optional<int> runChildTask(int count, const char* const* arguments) {
    return runImportChild(count, arguments);
}

std::string outOfMemoryMessage(const CLI::App& app) {
    const CLI::App& verb = parsedVerb(app);
    for (const char* size : {"--lightmap-size", "--sizes", "--size"}) // --size may be that of a picture
        if (verb.get_option_no_throw(size))
            return fmt::format("out of memory: use a smaller {} or a smaller scene, or close other programs",
                               size);
    return "out of memory: use smaller files or close other programs";
}

} // namespace relume
