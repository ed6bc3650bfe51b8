#include "assets/base/write_plan.h"

#include <fcntl.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

namespace relume {
namespace {

namespace fs = std::filesystem;

std::string reasonOf(int error) {
    return std::generic_category().message(error);
}

WritePlan refuse(const std::string& problem) {
    return {WriteWay::Refuse, problem};
}

// Refuses, telling why the look itself failed.
WritePlan refuseUnseen(const WriteTarget& target) {
    if (target.error == ENAMETOOLONG)
        return refuse("cannot write: its name is too long for the file system: choose a shorter one");
    return refuse("cannot write: " + reasonOf(target.error) + ": choose another name");
}

WritePlan refuseFolder(const WriteTarget& target) {
    if (!target.folderExists)
        return refuse("folder '" + target.folder + "' does not exist: create it or choose another one");
    if (!target.folderIsFolder) return refuse("'" + target.folder + "' is not a folder: choose another one");
    if (target.folderError == ENOSPC || target.folderError == EDQUOT)
        return refuse("cannot write: " + reasonOf(target.folderError) +
                      ": free some space or choose another folder");
    return refuse("cannot write: " + reasonOf(target.folderError) + ": choose another folder");
}

WritePlan planNew(const WriteTarget& target) {
    if (!target.folderExists || !target.folderIsFolder || target.folderError != 0)
        return refuseFolder(target);
    if (target.folderKeeps)
        return refuse("cannot write: its folder is append-only: run 'chattr -a' on it or choose another one");
    return {WriteWay::Replace, {}};
}

WritePlan planRegular(const WriteTarget& target) {
    if (target.immutable)
        return refuse("cannot write: is immutable or append-only: run 'chattr -ia' on it or choose another "
                      "name");
    if (target.writeError != 0)
        return refuse("cannot write: " + reasonOf(target.writeError) +
                      ": change its rights or choose another name");
    const bool foreign = target.user != 0 && target.owner != target.user && target.folderOwner != target.user;
    const bool noNewFile = target.folderError == EACCES || target.folderError == EPERM ||
                           target.folderError == EROFS || target.folderKeeps;
    if (target.links > 1 || target.mounted || (target.sticky && foreign) || noNewFile)
        return {WriteWay::InPlace, {}};
    if (target.folderError != 0) return refuseFolder(target);
    return {WriteWay::Replace, {}};
}

std::string parentOf(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path().string() : ".";
}

bool isInProc(const std::string& folder) {
    struct statfs system {};
    return statfs(folder.c_str(), &system) == 0 && system.f_type == PROC_SUPER_MAGIC;
}

// Follows links one by one up to what is there, or would be. Links in /proc name what is open, not a path.
void followLinks(WriteTarget& target) {
    constexpr int kMostLinks = 40; // as the kernel has it
    fs::path path = target.path;
    for (int i = 0;; ++i) {
        std::error_code code;
        if (!fs::is_symlink(path, code)) break;
        if (i == kMostLinks) {
            target.error = ELOOP;
            break;
        }
        const std::string folder = parentOf(path);
        if (isInProc(folder)) {
            target.alreadyOpen = true;
            break;
        }
        const fs::path next = fs::read_symlink(path, code);
        if (code) break;
        path = next.is_absolute() ? next : fs::path(folder) / next;
    }
    target.real = path.string();
    target.folder = parentOf(path);
}

// Returns the attributes of the inode that stat() does not tell, or 0 where none can be told.
uint64_t attributesOf(const std::string& path) {
    struct statx facts {};
    if (statx(AT_FDCWD, path.c_str(), AT_NO_AUTOMOUNT, STATX_TYPE, &facts) != 0) return 0;
    return facts.stx_attributes & facts.stx_attributes_mask;
}

WriteTarget::Kind targetKindOf(mode_t mode) {
    if (S_ISREG(mode)) return WriteTarget::Kind::Regular;
    if (S_ISDIR(mode)) return WriteTarget::Kind::Folder;
    return S_ISSOCK(mode) ? WriteTarget::Kind::Socket : WriteTarget::Kind::Stream;
}

void lookAtFile(WriteTarget& target) {
    struct stat file {};
    if (stat(target.real.c_str(), &file) != 0) {
        if (errno != ENOENT && errno != ENOTDIR) target.error = errno;
        return;
    }
    target.kind =
        target.alreadyOpen && S_ISREG(file.st_mode) ? WriteTarget::Kind::Stream : targetKindOf(file.st_mode);
    target.links = file.st_nlink;
    target.mode = file.st_mode & 07777;
    target.owner = file.st_uid;
    target.group = file.st_gid;
    if (faccessat(AT_FDCWD, target.real.c_str(), W_OK, AT_EACCESS) != 0) target.writeError = errno;
    const uint64_t attributes = attributesOf(target.real);
    target.mounted = (attributes & STATX_ATTR_MOUNT_ROOT) != 0;
    target.immutable = (attributes & (STATX_ATTR_IMMUTABLE | STATX_ATTR_APPEND)) != 0;
}

// Returns why no file can be made in the folder, or 0. Making one tells more than bits of rights do:
// read-only mounts, quotas, /proc.
int errorOfNewFile(const std::string& folder) {
    int descriptor = open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0600);
    if (descriptor < 0 && (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL)) {
        std::string name = folder + "/.relume-XXXXXX";
        descriptor = mkstemp(name.data());
        if (descriptor >= 0) unlink(name.c_str());
    }
    if (descriptor < 0) return errno;
    close(descriptor);
    return 0;
}

void lookAtFolder(WriteTarget& target) {
    struct stat folder {};
    if (stat(target.folder.c_str(), &folder) != 0) {
        target.folderError = errno;
        target.folderExists = errno != ENOENT;
        target.folderIsFolder = errno != ENOTDIR;
        return;
    }
    target.folderIsFolder = S_ISDIR(folder.st_mode);
    if (!target.folderIsFolder) return;
    target.sticky = (folder.st_mode & S_ISVTX) != 0;
    target.folderOwner = folder.st_uid;
    target.folderKeeps = (attributesOf(target.folder) & STATX_ATTR_APPEND) != 0;
    target.folderError = errorOfNewFile(target.folder);
}

} // namespace

WritePlan planWrite(const WriteTarget& target) {
    if (target.error != 0) return refuseUnseen(target);
    switch (target.kind) {
    case WriteTarget::Kind::Missing:
        return planNew(target);
    case WriteTarget::Kind::Folder:
        return refuse("is a folder: name a file in it");
    case WriteTarget::Kind::Socket:
        return refuse("is a socket, which cannot be opened: choose another name");
    case WriteTarget::Kind::Stream:
        if (target.writeError == 0) return {WriteWay::Stream, {}};
        return refuse("cannot write: " + reasonOf(target.writeError) +
                      ": change its rights or choose another name");
    case WriteTarget::Kind::Regular:
        break;
    }
    return planRegular(target);
}

WriteTarget lookAtTarget(const std::string& path) {
    WriteTarget target;
    target.path = path;
    target.user = geteuid();
    followLinks(target);
    if (target.error != 0) return target;
    lookAtFile(target);
    const bool needsFolder =
        target.kind == WriteTarget::Kind::Missing || target.kind == WriteTarget::Kind::Regular;
    if (target.error == 0 && needsFolder) lookAtFolder(target);
    return target;
}

std::string whereLinksLead(const std::string& path) {
    WriteTarget target;
    target.path = path;
    followLinks(target);
    return target.real;
}

std::string lackOfSpace(uint64_t needed, uint64_t left) {
    // What is needed is rounded up and what there is down, so that the figures differ.
    const bool small = needed < (10u << 20);
    const int shift = small ? 10 : 20;
    const uint64_t up = (needed + (uint64_t{1} << shift) - 1) >> shift;
    const std::string unit = small ? " KiB" : " MiB";
    return "needs " + std::to_string(up) + unit + ", its disk has " + std::to_string(left >> shift) + unit +
           " left";
}

} // namespace relume
