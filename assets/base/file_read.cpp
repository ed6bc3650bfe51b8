#include "assets/base/file_read.h"

#include "assets/base/error.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace relume {
namespace {

const char* kindOf(mode_t mode) {
    if (S_ISREG(mode)) return "";
    return S_ISDIR(mode) ? "is a folder" : "is no regular file";
}

std::string messageOf(int error) {
    return std::generic_category().message(error);
}

} // namespace

std::string oddKindOf(const std::string& path) {
    struct stat info {};
    return stat(path.c_str(), &info) == 0 ? kindOf(info.st_mode) : "";
}

void refuseOddKind(const std::string& path, const std::string& mend) {
    if (const std::string kind = oddKindOf(path); !kind.empty())
        throw Error(path + ": " + kind + ": " + mend);
}

RegularFile::RegularFile(const std::string& path, const std::string& mend) : path_(path) {
    refuseOddKind(path, mend);
    do { // not blocking: what the name leads to may have become a pipe since
        descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    } while (descriptor_ < 0 && errno == EINTR);
    if (descriptor_ < 0) throw Error(path + ": cannot be opened (" + messageOf(errno) + "): check the path");
    struct stat info {};
    const bool known = fstat(descriptor_, &info) == 0;
    if (!known || !S_ISREG(info.st_mode)) {
        close(descriptor_);
        throw Error(path + ": is no regular file: " + mend);
    }
    size_ = static_cast<uint64_t>(info.st_size);
}

RegularFile::~RegularFile() {
    close(descriptor_);
}

void RegularFile::read(void* to, uint64_t bytes) {
    constexpr uint64_t kMost = 1u << 30; // [bytes]; no system call reads 2 GiB at a time
    for (char* at = static_cast<char*>(to); bytes > 0;) {
        const ssize_t done = ::read(descriptor_, at, std::min(bytes, kMost));
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0)
            throw Error(path_ + ": cannot be read to its end (" +
                        (done < 0 ? messageOf(errno) : std::string("it became shorter")) + "): try again");
        at += done;
        bytes -= static_cast<uint64_t>(done);
    }
}

} // namespace relume
