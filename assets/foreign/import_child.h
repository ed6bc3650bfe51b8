#pragma once

#include <optional>

namespace relume {

/// Names what the program is called with as its first word to convert a file for importForeign(). It is no
/// command for users.
inline constexpr const char* kImportWord = "--relume-import-child";

/// Does what importForeign() started this process for, where `arguments` say so, and returns the exit status
/// then. Call it first in main().
std::optional<int> runImportChild(int count, const char* const* arguments);

} // namespace relume
