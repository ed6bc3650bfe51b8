#pragma once

#include <string>
#include <vector>

namespace relume::gl {

/// Holds GLSL as OpenGL takes it: one text with all its includes, and the files it came from.
struct GlslSource {
    std::string text;
    std::vector<std::string> files; // by the number that #line gives them
};

/// Returns the source at `path` in shaders/ (embedded, or of --shaders' folder) behind #version 450 and the
/// definitions; every `#include "path"` is replaced by that file, each file once. Throws Error.
GlslSource loadGlsl(const std::string& path, const std::vector<std::string>& definitions);

/// Returns the first error of a compiler's log (Mesa's or NVIDIA's form) as one line that names file and
/// line.
std::string describeLog(const GlslSource& source, const std::string& log);

} // namespace relume::gl
