#include "assets/base/spool.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <utility>
#include <vector>

namespace relume {
namespace {

std::string temporaryName(const std::string& folder) {
    static std::atomic<unsigned> counter = 0;
    return folder + "/.relume-" + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp";
}

std::string nameOfDescriptor(int descriptor) {
    return "/proc/self/fd/" + std::to_string(descriptor);
}

// Opens a new file without a name in the folder; returns -1 where it could not be given one later.
int openUnnamed(const std::string& folder, uint32_t mode) {
    if (access("/proc/self/fd", F_OK) != 0) return -1;
    return open(folder.c_str(), O_RDWR | O_TMPFILE | O_CLOEXEC, mode);
}

} // namespace

int writeAll(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return written < 0 ? errno : EIO;
        bytes.remove_prefix(static_cast<size_t>(written));
    }
    return 0;
}

Spool::Spool(const std::string& folder, uint32_t mode) : folder_(folder) {
    descriptor_ = openUnnamed(folder, mode);
    if (descriptor_ >= 0) return;
    // This is not mkstemp, which makes the file private, while a result is to get the usual permissions.
    do {
        temporary_ = temporaryName(folder);
        descriptor_ = open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    } while (descriptor_ < 0 && (errno == EEXIST || errno == EINTR));
    if (descriptor_ >= 0) return;
    error_ = errno;
    temporary_.clear();
}

Spool Spool::inMemory() {
    Spool spool;
    spool.descriptor_ = memfd_create("relume", MFD_CLOEXEC);
    if (spool.descriptor_ < 0) spool.error_ = errno;
    return spool;
}

Spool::~Spool() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!temporary_.empty()) unlink(temporary_.c_str());
}

Spool::Spool(Spool&& other) noexcept {
    *this = std::move(other);
}

Spool& Spool::operator=(Spool&& other) noexcept {
    std::swap(folder_, other.folder_);
    std::swap(temporary_, other.temporary_);
    std::swap(descriptor_, other.descriptor_);
    std::swap(error_, other.error_);
    return *this;
}

int Spool::write(std::string_view bytes) {
    return writeAll(descriptor_, bytes);
}

int Spool::copyTo(int descriptor) const {
    std::vector<char> piece(1u << 20);
    for (off_t done = 0;;) {
        const ssize_t count = pread(descriptor_, piece.data(), piece.size(), done);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return count < 0 ? errno : 0;
        if (const int error = writeAll(descriptor, {piece.data(), static_cast<size_t>(count)})) return error;
        done += count;
    }
}

int Spool::flush() const {
    // EINVAL means a file system that cannot flush; there is nothing to wait for.
    return fsync(descriptor_) != 0 && errno != EINVAL ? errno : 0;
}

// Gives the file a temporary name, since a link cannot replace a file while a rename can.
int Spool::giveTemporaryName() {
    std::string name;
    int failed = 0;
    do {
        name = temporaryName(folder_);
        failed = linkat(AT_FDCWD, nameOfDescriptor(descriptor_).c_str(), AT_FDCWD, name.c_str(),
                        AT_SYMLINK_FOLLOW);
    } while (failed != 0 && errno == EEXIST);
    if (failed != 0) return errno;
    temporary_ = name;
    return 0;
}

int Spool::take(const std::string& name) {
    if (folder_.empty()) return EXDEV;
    if (temporary_.empty()) {
        const std::string own = nameOfDescriptor(descriptor_);
        return linkat(AT_FDCWD, own.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0 ? errno : 0;
    }
    // Some file systems have no links: the name is made by creating it.
    const int taken = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (taken < 0) return errno;
    close(taken);
    const int error = replace(name);
    if (error != 0) unlink(name.c_str());
    return error;
}

int Spool::replace(const std::string& name) {
    if (folder_.empty()) return EXDEV;
    if (temporary_.empty())
        if (const int error = giveTemporaryName()) return error;
    if (rename(temporary_.c_str(), name.c_str()) != 0) return errno;
    temporary_.clear();
    return 0;
}

} // namespace relume
