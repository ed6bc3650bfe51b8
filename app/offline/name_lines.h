#pragma once

#include <string>
#include <vector>

namespace relume {

/// Returns names as a text of one line each. A name may have line ends of its own: they are written as "\n"
/// (two letters), and a backslash as two.
std::string linesOf(const std::vector<std::string>& names);

/// Does the same without the end of the last line.
std::string joinedLines(const std::vector<std::string>& names);

/// Returns the names that linesOf() or joinedLines() made such a text of.
std::vector<std::string> namesIn(const std::string& lines);

} // namespace relume
