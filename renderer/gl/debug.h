#pragma once

#include <cstdint>
#include <string>

namespace relume::gl {

/// Sends the current context's debug messages to the log: errors and undefined behaviour as errors, the
/// driver's other complaints as warnings, its notes about speed only at debug level.
void listenToDebugMessages();

/// Returns how many errors and warnings were sent so far, by any context of this process.
uint32_t debugMessageCount();

/// Returns the current context's renderer and version: "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5".
std::string describeContext();

/// Tells whether the current context draws on the host: Mesa's llvmpipe or softpipe.
bool isSoftware();

/// Throws Error when the current context is older than OpenGL 4.5; the message names the remedy.
void requireOpenGl45();

} // namespace relume::gl
