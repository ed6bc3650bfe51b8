#pragma once

#include <string>

#include "app/export/export_folder.h"

namespace CLI {
class App;
}

namespace relume {

/// The options of `relume export` that say what is written.
struct ExportOptions {
    std::string folder, engine, exposure = "auto", format = "half";
    bool gloss = false;
    uint32_t textureSize = 0; // 0: not given
};

void addExportOptions(CLI::App& command, ExportOptions& options);

/// Returns what the options ask for. Throws UsageError where they are wrong.
ExportDesc resolveExportOptions(const ExportOptions& options);

} // namespace relume
