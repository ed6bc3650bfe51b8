#pragma once

#include <stdexcept>
#include <string>

namespace relume {

/// Something in the world is wrong: a file, a driver, a shader, what the user typed. Thrown anywhere, caught
/// once in main. The message is one line and names the file, the thing and the mend.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The command line itself is wrong: exit status 2.
class UsageError : public Error {
public:
    using Error::Error;
};

namespace detail {
[[noreturn]] void assertFailed(const char* condition, const char* file, int line);
}

} // namespace relume

/// A bug in Relume when false. Stays on in release builds: a wrong lightmap is worse than an abort.
#define ASSERT(condition)                                                                                    \
    do {                                                                                                     \
        if (!(condition)) ::relume::detail::assertFailed(#condition, __FILE__, __LINE__);                    \
    } while (false)
