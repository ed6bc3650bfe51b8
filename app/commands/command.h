#pragma once

#include <CLI/CLI.hpp>

namespace relume {

// There is one function per verb, in app/commands/<verb>.cpp. Each adds its subcommand with its options to
// `app`; its callback does the work and throws Error (exit status 1) or UsageError (2).
void addViewCommand(CLI::App& app);
void addBakeCommand(CLI::App& app);
void addShotCommand(CLI::App& app);
void addTimelapseCommand(CLI::App& app);
void addExportCommand(CLI::App& app);
void addEditCommand(CLI::App& app);
void addInfoCommand(CLI::App& app);
void addUnwrapCommand(CLI::App& app);
void addImportCommand(CLI::App& app);
void addSceneCommand(CLI::App& app);
void addDevicesCommand(CLI::App& app);
void addCompareCommand(CLI::App& app);
void addBenchCommand(CLI::App& app);
void addMixCommand(CLI::App& app);
void addSamplesCommand(CLI::App& app);
// These add the subcommands of `relume bench`.
void addBenchMethodsCommand(CLI::App& bench);
void addBenchFramesCommand(CLI::App& bench);
void addBenchEditsCommand(CLI::App& bench);
void addBenchQualityCommand(CLI::App& bench);
void addBenchReloadCommand(CLI::App& bench);

} // namespace relume
