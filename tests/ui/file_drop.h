#pragma once

#include <string>

namespace relume {

/// Drops a file on a window as a file manager does, by the XDND protocol (version 5). False when the window
/// did not take it within some seconds.
[[nodiscard]] bool dropFile(const std::string& display, unsigned long window, const std::string& path);

} // namespace relume
