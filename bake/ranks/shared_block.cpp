#include "bake/ranks/shared_block.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace relume {
namespace {

constexpr mode_t kOwnerOnly = 0600;

SharedBlock mapped(int file, uint64_t bytes) {
    void* start = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (start == MAP_FAILED) return {};
    return {std::shared_ptr<void>(start, [bytes](void* place) { munmap(place, bytes); }),
            {static_cast<std::byte*>(start), bytes}};
}

} // namespace

// Memory that is promised only, and then is not there, would end the process by a signal.
SharedBlock createSharedBlock(const std::string& name, uint64_t bytes) {
    const int file = shm_open(name.c_str(), O_RDWR | O_CREAT | O_EXCL, kOwnerOnly);
    if (file < 0) return {};
    SharedBlock block;
    if (posix_fallocate(file, 0, static_cast<off_t>(bytes)) == 0) block = mapped(file, bytes);
    close(file);
    if (!block) forgetSharedBlock(name);
    return block;
}

SharedBlock openSharedBlock(const std::string& name, uint64_t bytes) {
    const int file = shm_open(name.c_str(), O_RDWR, 0);
    if (file < 0) return {};
    SharedBlock block = mapped(file, bytes);
    close(file);
    return block;
}

void forgetSharedBlock(const std::string& name) {
    shm_unlink(name.c_str());
}

} // namespace relume
