#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace relume {

/// Tells whether JSON and other text may hold `text` as it is. Names of files need not be UTF-8.
bool isUtf8(std::string_view text);

/// Returns the URI with each %XX replaced by the byte that it stands for.
std::string decodedUri(std::string_view uri);
/// Returns a path as a URI has it: what is not plain becomes %XX. Letters beyond ASCII stay, unless they are
/// no UTF-8.
std::string encodedUri(std::string_view path);
/// Tells whether a URI is relative to the file that has it: not data, a web address or a path from the root.
bool isRelativeUri(std::string_view uri);
/// Returns a URI that holds these bytes itself ("data:application/octet-stream;base64,...").
std::string dataUriOf(std::string_view bytes);

/// Returns the bytes that a URI holds itself ("data:image/png;base64,...", RFC 2397), up to the first
/// character that is none of base64. Returns nothing for another URI and for data in another form.
std::optional<std::vector<uint8_t>> bytesOfDataUri(std::string_view uri);

} // namespace relume
