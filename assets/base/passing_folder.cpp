#include "assets/base/passing_folder.h"

#include "assets/base/error.h"

#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

constexpr size_t kRandom = 6; // characters that mkdtemp sets
constexpr int kTries = 16;

int openFolder(const std::string& path) {
    return open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
}

/// Removes a folder that nobody holds; one of another user stays.
void removeLeft(const std::string& path) {
    const int folder = openFolder(path);
    if (folder < 0) return;
    struct stat facts {};
    if (fstat(folder, &facts) == 0 && facts.st_uid == geteuid() && flock(folder, LOCK_EX | LOCK_NB) == 0) {
        std::error_code code;
        fs::remove_all(path, code);
    }
    close(folder);
}

void removeAllLeft(const fs::path& parent, const std::string& prefix) {
    std::error_code code;
    for (fs::directory_iterator it(parent, code), end; !code && it != end; it.increment(code)) {
        const std::string name = it->path().filename().string();
        if (name.size() == prefix.size() + kRandom && name.starts_with(prefix))
            removeLeft(it->path().string());
    }
}

} // namespace

PassingFolder::PassingFolder(const fs::path& parent, const std::string& prefix) {
    removeAllLeft(parent, prefix);
    for (int i = 0; i < kTries; ++i) {
        path_ = (parent / (prefix + std::string(kRandom, 'X'))).string();
        if (mkdtemp(path_.data()) == nullptr) break;
        lock_ = openFolder(path_);
        // Before the lock is taken, another process may take the folder for one that was left.
        struct stat facts {};
        if (lock_ >= 0 && flock(lock_, LOCK_EX) == 0 && fstat(lock_, &facts) == 0 && facts.st_nlink > 0)
            return;
        if (lock_ >= 0) close(lock_);
    }
    throw Error(fmt::format("{}: cannot be made ({}): make room in the system's temporary folder", path_,
                            std::strerror(errno)));
}

PassingFolder::~PassingFolder() {
    std::error_code code;
    fs::remove_all(path_, code);
    close(lock_);
}

} // namespace relume
