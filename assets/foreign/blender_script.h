#pragma once

namespace relume {

/// Returns assets/blender/relume_link.py, which is inside of the program.
const char* blenderScript();

} // namespace relume
