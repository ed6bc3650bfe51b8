#pragma once

#include <string>

namespace relume {

/// Drops a file on a window as a file manager does, by the XDND protocol (version 5). False when the window
/// did not take it within some seconds.
[[nodiscard]] bool dropFile(const std::string& display, unsigned long window, const std::string& path);

/// Says how many dots per inch a display has, as desktops do: windows that come later have a scale of a 96th
/// of it. False where the display is not there.
[[nodiscard]] bool setDots(const std::string& display, int dots);

} // namespace relume
