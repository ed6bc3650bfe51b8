#include "assets/base/error.h"

#include <cstdio>
#include <cstdlib>

namespace relume::detail {

void assertFailed(const char* condition, const char* file, int line) {
    std::fprintf(stderr, "%s:%d: bug: '%s' does not hold\n", file, line, condition);
    std::abort();
}

} // namespace relume::detail
