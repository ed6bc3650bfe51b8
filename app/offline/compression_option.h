#pragma once

#include <string>
#include <vector>

#include "assets/images/float_image.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace relume {

/// Adds --compression: how the OpenEXR files that a verb writes are compressed. "": not given.
CLI::Option* addCompressionOption(CLI::App& command, std::string& compression);

/// Returns the compression of a name that the option allows; "": the one where nobody says which.
ExrCompression compressionOf(const std::string& name);

/// Throws UsageError where a compression is given and none of these files ("": none) is OpenEXR.
void checkCompression(const std::string& compression, const std::vector<std::string>& outputs);

} // namespace relume
