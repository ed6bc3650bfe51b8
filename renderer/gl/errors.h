#pragma once

#include <string>

namespace relume::gl {

/// Forgets errors that nobody asked about, so that the next question has an answer of its own.
void clearErrors();

/// Throws Error when an allocation of so many bytes for `what` went wrong since clearErrors().
void checkMemory(const std::string& what, double bytes);

} // namespace relume::gl
