#include "assets/base/file_write.h"

#include "assets/base/error.h"

#include <spdlog/fmt/fmt.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <exception>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

namespace relume {
namespace {

namespace fs = std::filesystem;

bool isLackOfSpace(int error) {
    return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

std::string systemFolder() {
    std::error_code code;
    const fs::path folder = fs::temp_directory_path(code);
    return code ? "/tmp" : folder.string();
}

// Makes the file where content waits: in the folder of what it replaces, else wherever there is room.
Spool spoolFor(const WriteTarget& target, WriteWay way) {
    const bool exists = target.kind != WriteTarget::Kind::Missing;
    const uint32_t mode = exists ? 0600 : 0666; // nobody else reads a private file's content meanwhile
    if (way != WriteWay::Stream) {
        Spool beside(target.folder, mode);
        if (beside.error() == 0 || way == WriteWay::Replace) return beside;
    }
    Spool elsewhere(systemFolder(), 0600);
    return elsewhere.error() == 0 ? std::move(elsewhere) : Spool::inMemory();
}

// Blocks SIGPIPE, which would take a viewer's edits along: a reader of a FIFO that goes away is an error like
// others.
class PipeSignalBlock {
public:
    PipeSignalBlock() {
        sigemptyset(&pipe_);
        sigaddset(&pipe_, SIGPIPE);
        pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
    }
    ~PipeSignalBlock() {
        const timespec now{};
        while (sigtimedwait(&pipe_, nullptr, &now) > 0) {
        }
        pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    PipeSignalBlock(const PipeSignalBlock&) = delete;
    PipeSignalBlock& operator=(const PipeSignalBlock&) = delete;

private:
    sigset_t pipe_{}, before_{};
};

// Copies rights beyond those of owner, group and others. Returns false where there are some that cannot be
// handed down.
bool copyAccessList(const std::string& from, int to) {
    constexpr const char* kName = "system.posix_acl_access";
    const ssize_t size = getxattr(from.c_str(), kName, nullptr, 0);
    if (size <= 0) return true;
    std::vector<char> list(static_cast<size_t>(size));
    const ssize_t read = getxattr(from.c_str(), kName, list.data(), list.size());
    return read > 0 && fsetxattr(to, kName, list.data(), static_cast<size_t>(read), 0) == 0;
}

std::string problemOf(int error) {
    return "cannot write: " + std::generic_category().message(error) +
           (isLackOfSpace(error) ? ": free some space or choose another folder" : ": choose another folder");
}

// Gives a result that is kept its name and returns it, or "" where none could be given.
std::string giveSavedName(Spool& spool, const std::string& path) {
    constexpr uint32_t kMostNames = 1000;
    for (uint32_t number = 1; number <= kMostNames; ++number) {
        const std::string name = savedName(spool.folder(), path, number);
        const int error = spool.take(name);
        if (error == 0) return name;
        if (error != EEXIST) break;
    }
    return "";
}

} // namespace

AtomicFile::AtomicFile(const std::string& path, OnFailure onFailure)
    : target_(lookAtTarget(path)), onFailure_(onFailure) {
    const WritePlan plan = planWrite(target_);
    // The file may have changed since it was checked; the content gets a place all the same.
    if (plan.way == WriteWay::Refuse && onFailure == OnFailure::Drop) throw Error(path + ": " + plan.problem);
    way_ = plan.way;
    problem_ = plan.problem;
    spool_ = spoolFor(target_, way_ == WriteWay::Refuse ? WriteWay::Stream : way_);
    if (spool_.error() != 0) fail(spool_.error());
}

void AtomicFile::write(std::string_view bytes) {
    struct stat before {};
    fstat(spool_.descriptor(), &before);
    const int error = spool_.write(bytes);
    if (error == 0) return;
    struct stat after {};
    fstat(spool_.descriptor(), &after);
    const auto written = static_cast<size_t>(after.st_size - before.st_size);
    if (noRoom_ == 0 && isLackOfSpace(error) && onFailure_ == OnFailure::Keep &&
        takeRefuge(bytes.substr(std::min(written, bytes.size())))) {
        noRoom_ = error;
        return;
    }
    spool_ = Spool(); // half of it is of no use
    fail(noRoom_ != 0 ? noRoom_ : error);
}

// Goes on in the system's temporary folder, which may be on another disk.
bool AtomicFile::takeRefuge(std::string_view rest) {
    Spool refuge(systemFolder(), 0600);
    if (refuge.error() != 0 || spool_.copyTo(refuge.descriptor()) != 0 || refuge.write(rest) != 0)
        return false;
    spool_ = std::move(refuge);
    return true;
}

// Hands down the rights. Those that the former group had are not for another group.
void AtomicFile::keepRights() const {
    if (target_.kind != WriteTarget::Kind::Regular) return;
    const int file = spool_.descriptor();
    const bool grouped = fchown(file, target_.owner, target_.group) == 0 ||
                         fchown(file, static_cast<uid_t>(-1), target_.group) == 0;
    const uint32_t others = target_.mode & 07, rights = target_.mode & 0777;
    const uint32_t narrow = (rights & 0707) | ((rights >> 3 & 07 & others) << 3);
    if (fchmod(file, grouped ? rights : narrow) != 0) return; // it stays private
    if (!copyAccessList(target_.real, file)) fchmod(file, narrow);
}

// Writes the content over that of a file that is there. Room is asked for first, while the old content is
// still whole.
int AtomicFile::overwrite() const {
    const int file = open(target_.real.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (file < 0) return errno;
    struct stat whole {};
    int error = fstat(spool_.descriptor(), &whole) != 0 ? errno : 0;
    if (error == 0 && whole.st_size > 0 && fallocate(file, FALLOC_FL_KEEP_SIZE, 0, whole.st_size) != 0 &&
        isLackOfSpace(errno))
        error = errno;
    if (error == 0) error = spool_.copyTo(file);
    if (error == 0 && ftruncate(file, whole.st_size) != 0) error = errno;
    if (error == 0 && fsync(file) != 0 && errno != EINVAL) error = errno;
    if (close(file) != 0 && errno != EINTR && error == 0) error = errno;
    return error;
}

int AtomicFile::pour() const {
    const PipeSignalBlock block;
    // What a shell has open may have content before ours.
    const int flags = O_WRONLY | O_CLOEXEC | O_NOCTTY | (target_.alreadyOpen ? O_APPEND : 0);
    int file = -1;
    do
        file = open(target_.real.c_str(), flags);
    while (file < 0 && errno == EINTR);
    if (file < 0) return errno;
    const int error = spool_.copyTo(file);
    return close(file) != 0 && errno != EINTR && error == 0 ? errno : error;
}

int AtomicFile::takeName() {
    if (const int error = spool_.flush()) return error;
    keepRights();
    const int error = spool_.replace(target_.real);
    // Something that was not to be seen before keeps the name; the content may still be another.
    if (error != 0 && target_.kind == WriteTarget::Kind::Regular && overwrite() == 0) return 0;
    if (error == 0) flushFolder();
    return error;
}

// Makes a new name last; the data is safe already, so a folder that cannot be flushed is no error.
void AtomicFile::flushFolder() const {
    const int folder = open(target_.folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) return;
    fsync(folder);
    close(folder);
}

int AtomicFile::flush() const {
    if (way_ != WriteWay::Replace) return 0;
    return noRoom_ != 0 ? noRoom_ : spool_.flush();
}

void AtomicFile::commit() {
    int error = 0;
    if (way_ == WriteWay::Replace) error = noRoom_ != 0 ? noRoom_ : takeName();
    if (way_ == WriteWay::InPlace) error = overwrite();
    if (way_ == WriteWay::Stream) error = pour();
    if (error != 0 || way_ == WriteWay::Refuse) fail(error);
    spool_ = Spool();
}

std::string AtomicFile::commitAnew(const std::function<std::string()>& nextName) {
    int error = way_ == WriteWay::Replace ? flush() : 0;
    while (way_ == WriteWay::Replace && error == 0) {
        std::string name = nextName();
        error = spool_.take(name);
        if (error == 0) {
            spool_ = Spool();
            flushFolder();
            return name;
        }
        if (error == EEXIST) error = 0;
    }
    fail(error);
}

// Saves the content beside what could not be written, or where the system keeps such files. Returns "" where
// neither works.
std::string AtomicFile::saveElsewhere() {
    std::string name = giveSavedName(spool_, target_.path);
    if (!name.empty()) return name;
    Spool other(systemFolder(), 0600);
    if (other.error() != 0 || spool_.copyTo(other.descriptor()) != 0) return "";
    return giveSavedName(other, target_.path);
}

void AtomicFile::fail(int error) {
    const bool whole = spool_.descriptor() >= 0 && onFailure_ == OnFailure::Keep;
    const std::string saved = whole ? saveElsewhere() : "";
    spool_ = Spool(); // leaves nothing else behind
    const std::string problem = problem_.empty() ? problemOf(error) : problem_;
    throw Error(target_.path + ": " + problem +
                (saved.empty() ? "" : ": it was saved as '" + saved + "', move it where it belongs"));
}

void writeFileAtomically(const std::string& path, std::string_view bytes, OnFailure onFailure) {
    AtomicFile file(path, onFailure);
    file.write(bytes);
    file.commit();
}

void AtomicFiles::add(const std::string& path, std::string_view bytes) {
    try {
        files_.push_back({path, std::make_unique<AtomicFile>(path, onFailure_)});
        files_.back().content->write(bytes);
    } catch (...) {
        files_.clear(); // some of them without the others are of no use
        throw;
    }
}

void AtomicFiles::commit() {
    std::vector<File> files = std::exchange(files_, {});
    for (const File& file : files) {
        const int error = file.content->flush();
        if (error == 0) continue;
        if (onFailure_ == OnFailure::Drop) throw Error(file.path + ": " + problemOf(error));
        std::string saved;
        for (const File& other : files) {
            const std::string name = other.content->saveElsewhere();
            saved += (saved.empty() ? "'" : ", '") + (name.empty() ? other.path + "' (lost)" : name + "'");
        }
        throw Error(fmt::format("{}: {}: all {} files were saved as {}, move them where they belong",
                                file.path, problemOf(error), files.size(), saved));
    }
    // A failure is one file's own now; the others take their names all the same, for all that is left is
    // to tell which one is missing.
    std::exception_ptr failure;
    for (const File& file : files) {
        try {
            file.content->commit();
        } catch (const Error&) {
            if (!failure) failure = std::current_exception();
        }
    }
    if (failure) std::rethrow_exception(failure);
}

void checkFileWritable(const std::string& path, uint64_t bytes) {
    const WriteTarget target = lookAtTarget(path);
    const WritePlan plan = planWrite(target);
    if (plan.way == WriteWay::Refuse) throw Error(path + ": " + plan.problem);
    if (plan.way == WriteWay::Stream) return;
    std::error_code code;
    const fs::space_info space = fs::space(target.folder, code);
    if (!code && space.available < bytes)
        throw Error(path + ": " + lackOfSpace(bytes, space.available) +
                    ": free some space or choose another folder");
}

bool checkFolderWritable(const std::string& folder) {
    std::error_code code;
    if (fs::is_directory(folder, code)) {
        checkFileWritable((fs::path(folder) / ".relume").string(), 0);
        return true;
    }
    if (fs::exists(folder, code)) throw Error(folder + ": is a file: name a folder");
    if (fs::is_symlink(folder, code))
        throw Error(folder + ": is a link to a folder that does not exist: create that or name another");
    checkFileWritable(folder, 0);
    return false;
}

bool makeFolder(const std::string& folder) {
    std::error_code code;
    const bool wasMissing = fs::create_directory(folder, code);
    if (code) throw Error(folder + ": cannot be made: " + code.message() + ": name another folder");
    return wasMissing;
}

FolderForFiles::FolderForFiles(std::string folder)
    : folder_(std::move(folder)), isNew_(makeFolder(folder_)) {}

FolderForFiles::~FolderForFiles() {
    if (isNew_) rmdir(folder_.c_str());
}

std::string savedName(const std::string& folder, const std::string& path, uint32_t number) {
    constexpr size_t kMostLetters = 100; // a name that was too long may be why
    const fs::path name = fs::path(path).filename();
    const std::string count = number > 1 ? fmt::format("-{}", number) : "";
    return fmt::format("{}/{}.saved{}{}", folder, name.stem().string().substr(0, kMostLetters), count,
                       name.extension().string().substr(0, kMostLetters));
}

} // namespace relume
