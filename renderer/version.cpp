#include "renderer/version.h"

#include <atomic>

namespace relume {

uint64_t newVersion() {
    static std::atomic<uint64_t> last{0};
    return ++last;
}

} // namespace relume
