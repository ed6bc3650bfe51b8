#pragma once

#include <string>
#include <string_view>

namespace relume {

/// Whether JSON and other text may hold it as it is. Names of files need not be UTF-8.
bool isUtf8(std::string_view text);

/// With %XX as the bytes they stand for.
std::string decodedUri(std::string_view uri);
/// A path as a URI has it: what is not plain as %XX. Letters beyond ASCII stay, unless they are no UTF-8.
std::string encodedUri(std::string_view path);
/// Relative to the file that has it: not data, a web address or a path from the root.
bool isRelativeUri(std::string_view uri);

} // namespace relume
