#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bake/ranks/launch.h"

namespace CLI {
class App;
}

namespace relume {

/// Adds all verbs, and makes one line of each error of the parser.
void addCommands(CLI::App& app);

/// Turns what was typed into what `app` can parse: with "view" in front of a scene that stands where a verb
/// belongs, and with an empty value as a word of its own, which CLI11 would skip for the next one. Throws
/// UsageError for an unknown verb and for a value that is given to a flag.
std::vector<std::string> parserArguments(const std::vector<std::string>& typed, const CLI::App& app);

/// Throws UsageError where several processes were launched for a verb that was parsed and that is no work for
/// them: each would do all of it.
void requireSharedVerb(const CLI::App& app, const Launch& launch);

/// Opens the viewer with its start page, which is what `relume` alone does where there is a display. Returns
/// false where none is named, and, with a warning, where no window can be made.
bool opensStartPage();
/// Does what this program started itself for as a child process, where that is so, and returns the exit
/// status then. It is for no user, and comes before anything else.
std::optional<int> runChildTask(int count, const char* const* arguments);

/// Tells what helps when memory runs out, by what the verb that was parsed makes.
std::string outOfMemoryMessage(const CLI::App& app);

} // namespace relume
