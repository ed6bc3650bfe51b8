#pragma once

namespace relume {

/// Fills descriptors 0 to 2 where they are closed; call it at the start. Otherwise they would go to the first
/// files that are opened, into which results would then be printed. Reading or writing what fills them fails.
void holdStandardStreams();

/// Flushes what was printed, at the end, and logs an error where it did not arrive. Returns the exit status
/// for a command that ended with `status`.
int finishOutput(int status);

/// Tells whether something that was printed is known to be lost.
bool outputFailed();

} // namespace relume
