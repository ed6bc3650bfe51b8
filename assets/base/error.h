#pragma once

#include <stdexcept>
#include <string>

namespace relume {

/// Tells that something in the world is wrong: a file, a driver, a shader, what the user typed. It is thrown
/// anywhere and caught once, in main. The message is one line and names the file, the thing and the remedy.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Tells that the command line itself is wrong; the exit status is 2.
class UsageError : public Error {
public:
    using Error::Error;
};

namespace detail {
[[noreturn]] void assertFailed(const char* condition, const char* file, int line);
}

} // namespace relume

/// Aborts where the condition is false, which is a bug in Relume. It stays on in release builds: a wrong
/// lightmap is worse than an abort.
#define ASSERT(condition)                                                                                    \
    do {                                                                                                     \
        if (!(condition)) ::relume::detail::assertFailed(#condition, __FILE__, __LINE__);                    \
    } while (false)
