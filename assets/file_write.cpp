#include "assets/file_write.h"

#include "assets/error.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

namespace relume {
namespace {

namespace fs = std::filesystem;

fs::path folderOf(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Where a symbolic link leads, so that the link stays one.
fs::path followLink(const std::string& path) {
    std::error_code code;
    if (fs::is_symlink(path, code)) {
        const fs::path target = fs::weakly_canonical(path, code);
        if (!code && !fs::is_symlink(target, code)) return target;
    }
    return path;
}

[[noreturn]] void failWrite(const std::string& path, int error) {
    std::string mend = "choose another folder";
    if (error == ENOSPC || error == EDQUOT || error == EFBIG)
        mend = "free some space or choose another folder";
    throw Error(path + ": cannot write: " + std::generic_category().message(error) + ": " + mend);
}

std::string temporaryName(const std::string& folder) {
    static std::atomic<unsigned> counter = 0;
    return folder + "/.relume-" + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp";
}

// A new file in the folder without a name; -1 where it could not be given one later.
int openUnnamed([[maybe_unused]] const std::string& folder) {
#ifdef O_TMPFILE
    if (access("/proc/self/fd", F_OK) == 0)
        return open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
#endif
    return -1;
}

std::string megabytes(uint64_t bytes) {
    return std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB";
}

} // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
    const fs::path target = followLink(path);
    target_ = target.string();
    folder_ = folderOf(target).string();
    descriptor_ = openUnnamed(folder_);
    if (descriptor_ >= 0) return;
    // Not mkstemp: it makes the file private, while a result is to get the usual permissions.
    do {
        temporary_ = temporaryName(folder_);
        descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    } while (descriptor_ < 0 && (errno == EEXIST || errno == EINTR));
    if (descriptor_ < 0) failWrite(path_, errno);
}

AtomicFile::~AtomicFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (!temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) failWrite(path_, written < 0 ? errno : EIO);
        bytes.remove_prefix(size_t(written));
    }
}

// A link cannot replace the target, a rename can.
void AtomicFile::giveTemporaryName() {
    const std::string unnamed = "/proc/self/fd/" + std::to_string(descriptor_);
    std::string name;
    int failed = 0;
    do {
        name = temporaryName(folder_);
        failed = linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW);
    } while (failed != 0 && errno == EEXIST);
    if (failed != 0) failWrite(path_, errno);
    temporary_ = name;
}

void AtomicFile::commit() {
    // EINVAL: a file system that cannot flush has nothing to wait for.
    if (fsync(descriptor_) != 0 && errno != EINVAL) failWrite(path_, errno);
    if (temporary_.empty()) giveTemporaryName();
    const int descriptor = descriptor_;
    descriptor_ = -1;
    if (close(descriptor) != 0 && errno != EINTR) failWrite(path_, errno);
    if (rename(temporary_.c_str(), target_.c_str()) != 0) failWrite(path_, errno);
    temporary_.clear();
    // Makes the new name last; the data is safe already, so a folder that cannot be flushed is no error.
    const int folder = open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
        fsync(folder);
        close(folder);
    }
}

void writeFileAtomically(const std::string& path, std::string_view bytes) {
    AtomicFile file(path);
    file.write(bytes);
    file.commit();
}

void checkFileWritable(const std::string& path, uint64_t bytes) {
    std::error_code code;
    const fs::path target = followLink(path), folder = folderOf(target);
    if (fs::is_directory(target, code)) throw Error(path + ": is a folder: name a file in it");
    if (!fs::exists(folder, code))
        throw Error(path + ": folder '" + folder.string() +
                    "' does not exist: create it or choose another one");
    if (!fs::is_directory(folder, code))
        throw Error(path + ": '" + folder.string() + "' is not a folder: choose another one");
    const AtomicFile probe(path); // tells more than permission bits: read-only mounts, quotas, /proc
    const fs::space_info space = fs::space(folder, code);
    if (!code && space.available < bytes)
        throw Error(path + ": needs " + megabytes(bytes) + ", its disk has " + megabytes(space.available) +
                    " left: free some space or choose another folder");
}

} // namespace relume
