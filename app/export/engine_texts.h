#pragma once

#include <span>

namespace relume {

/// A file of app/export/engines as it is in the source tree.
struct EngineText {
    const char* path; // "three/loader.js"
    const char* text;
};

/// Returns all of them, by path.
std::span<const EngineText> engineTexts();

} // namespace relume
