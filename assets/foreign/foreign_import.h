#pragma once

#include <string>
#include <vector>

#include "assets/base/spool.h"
#include "assets/foreign/foreign_types.h"
#include "assets/foreign/import_limits.h"

namespace relume {

/// Says what importForeign() is to do.
struct ImportDesc {
    std::string path; // of the file
    ForeignChoice choice;
    ImportLimits limits;
    std::string program = "/proc/self/exe"; // calls runImportChild() first in its main()
};

/// A file that was converted to a GLB, which no folder shows.
class ImportedFile {
public:
    ImportedFile(Spool spool, std::vector<std::string> warnings)
        : spool_(std::move(spool)), warnings_(std::move(warnings)) {}

    /// Returns a path under which this process can open the GLB while this object exists.
    std::string path() const { return "/proc/self/fd/" + std::to_string(spool_.descriptor()); }
    /// Returns what could not be used of the file, one line each.
    const std::vector<std::string>& warnings() const { return warnings_; }
    /// Writes the GLB as a file, whole or not at all. Throws Error.
    void save(const std::string& path) const;

private:
    Spool spool_;
    std::vector<std::string> warnings_;
};

/// Converts a file in a process of its own (see convertForeign), which a bad file can neither crash together
/// with this one nor let take more than the limits. Tells this thread's watch how far it is; what the watch
/// throws ends the process. Throws Error naming the file, what is wrong with it and what helps: the
/// converter's own, and where that crashed, took too long or too much memory.
ImportedFile importForeign(const ImportDesc& desc);
/// The same with all as usual.
ImportedFile importForeign(const std::string& path);

} // namespace relume
