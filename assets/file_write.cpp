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

class TemporaryFile { // owns a new file and its descriptor; removed unless renamed
public:
    TemporaryFile(const std::string& wanted, const fs::path& folder) : wanted_(wanted) {
        static std::atomic<unsigned> counter = 0;
        // Not mkstemp: it makes the file private, while a result is to get the usual permissions.
        do {
            name_ =
                folder / (".relume-" + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".tmp");
            descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        } while (descriptor_ < 0 && (errno == EEXIST || errno == EINTR));
        if (descriptor_ < 0) failWrite(wanted_, errno);
    }
    ~TemporaryFile() {
        if (descriptor_ >= 0) close(descriptor_);
        if (!renamed_) unlink(name_.c_str());
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    void write(std::string_view bytes) {
        while (!bytes.empty()) {
            const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) failWrite(wanted_, written < 0 ? errno : EIO);
            bytes.remove_prefix(size_t(written));
        }
    }
    void renameTo(const fs::path& target) {
        // EINVAL: a file system that cannot flush has nothing to wait for.
        if (fsync(descriptor_) != 0 && errno != EINVAL) failWrite(wanted_, errno);
        const int descriptor = descriptor_;
        descriptor_ = -1;
        if (close(descriptor) != 0 && errno != EINTR) failWrite(wanted_, errno);
        if (rename(name_.c_str(), target.c_str()) != 0) failWrite(wanted_, errno);
        renamed_ = true;
    }

private:
    std::string wanted_;
    fs::path name_;
    int descriptor_ = -1;
    bool renamed_ = false;
};

std::string megabytes(uint64_t bytes) {
    return std::to_string((bytes + (1 << 20) - 1) >> 20) + " MiB";
}

} // namespace

void writeFileAtomically(const std::string& path, std::string_view bytes) {
    const fs::path target = followLink(path);
    TemporaryFile file(path, folderOf(target));
    file.write(bytes);
    file.renameTo(target);
    // Makes the new name last; the data is safe already, so a folder that cannot be flushed is no error.
    const int folder = open(folderOf(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
        fsync(folder);
        close(folder);
    }
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
    const TemporaryFile probe(path,
                              folder); // tells more than permission bits: read-only mounts, quotas, /proc
    const fs::space_info space = fs::space(folder, code);
    if (!code && space.available < bytes)
        throw Error(path + ": needs " + megabytes(bytes) + ", its disk has " + megabytes(space.available) +
                    " left: free some space or choose another folder");
}

} // namespace relume
