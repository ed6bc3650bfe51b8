#pragma once

namespace relume {

/// At the start: descriptors 0 to 2 that are closed would go to the first files that are opened, into which
/// results would be printed then. They become ones at which every read or write fails.
void holdStandardStreams();

/// At the end: what was printed leaves, and is an error where it did not arrive. Returns the exit status for
/// a command that ended with `status`.
int finishOutput(int status);

/// Tells whether something that was printed is known to be lost.
bool outputFailed();

} // namespace relume
