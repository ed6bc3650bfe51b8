#pragma once

#include <span>

namespace relume {

/// A part of the page as it is in the source tree: a file of app/export/web/page, or one of shaders/lib.
struct PageText {
    const char* path; // "page/mix.js", "lib/tone.glsl"
    const char* text;
};

/// Returns all of them, by path.
std::span<const PageText> pageTexts();

} // namespace relume
