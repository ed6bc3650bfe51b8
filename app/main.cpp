#include "app/commands/command_line.h"
#include "app/text/standard_output.h"
#include "assets/base/error.h"
#include "assets/base/log.h"
#include "bake/ranks/launch.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace {

// The first one of several processes that a launcher started speaks for all.
void setupLogOf(const relume::Launch& launch, bool quiet) {
    relume::setupLog(quiet);
    if (!launch.speaks()) spdlog::set_level(spdlog::level::off);
}

// Returns the exit status of one process. Among several one tells what is wrong and gives the status; the
// others' logs are off. If they ended with a status of their own before that, the launcher would end the one
// that tells.
int statusOf(int status, const relume::Launch& launch) {
    return launch.several() && spdlog::get_level() == spdlog::level::off ? 0 : status;
}

int run(int argc, char** argv, const relume::Launch& launch) {
    CLI::App app{"Relume bakes the radiosity lightmap of a glTF scene."};
    app.name("relume");
    app.set_version_flag("--version", "relume " RELUME_VERSION);
    app.require_subcommand(1);
    bool quiet = false;
    app.add_flag("-q,--quiet", quiet, "Print warnings and errors only");
    app.parse_complete_callback([&] {
        setupLogOf(launch, quiet);
        relume::requireSharedVerb(app, launch);
    });
    setupLogOf(launch, false);

    relume::addCommands(app);

    try {
        const std::vector<std::string> typed(argv + 1, argv + argc);
        if (typed.empty() && !launch.several()) {
            if (relume::opensStartPage()) return 0;
            fmt::print("{}", app.help()); // what is wrong follows, as for any other verb that is missing
        }
        std::vector<std::string> arguments = relume::parserArguments(typed, app);
        std::reverse(arguments.begin(), arguments.end()); // this overload takes them so
        app.parse(std::move(arguments));
    } catch (const CLI::ParseError& error) {
        std::ostringstream unheard;
        const int status = launch.speaks() ? app.exit(error) : app.exit(error, unheard, unheard);
        return status == 0 ? 0 : 2;
    } catch (const relume::UsageError& error) {
        spdlog::error("{}", error.what());
        return 2;
    } catch (const relume::Error& error) {
        spdlog::error("{}", error.what());
        return 1;
    } catch (const std::bad_alloc&) {
        spdlog::error("{}", relume::outOfMemoryMessage(app));
        return 1;
    } catch (const std::exception& error) {
        // It may be a library's own message about lost output, of which finishOutput() tells.
        if (!relume::outputFailed()) spdlog::error("unexpected: {}", error.what());
        return 1;
    }
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    relume::holdStandardStreams();
    if (const std::optional<int> status = relume::runChildTask(argc, argv)) return *status;
    const relume::Launch launch = relume::launchOfProcess();
    relume::takeThreadShare(launch);
    return relume::finishOutput(statusOf(run(argc, argv, launch), launch));
}
