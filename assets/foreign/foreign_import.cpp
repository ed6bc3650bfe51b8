#include "assets/foreign/foreign_import.h"

#include "assets/base/clock.h"
#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/file_write.h"
#include "assets/base/watch.h"
#include "assets/foreign/foreign_files.h"
#include "assets/foreign/import_child.h"
#include "assets/foreign/import_messages.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relume {
namespace {

// The two descriptors that the child has beside those of the standard streams.
constexpr int kOutputDescriptor = 3, kMessageDescriptor = 4;
constexpr int kPeriod = 20; // [ms], in which the watch is told and a child that says nothing is looked at

/// A pipe's end that is closed at last.
class Descriptor {
public:
    explicit Descriptor(int number = -1) : number_(number) {}
    ~Descriptor() { reset(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    void reset(int number = -1) {
        if (number_ >= 0) close(number_);
        number_ = number;
    }
    int get() const { return number_; }

private:
    int number_;
};

/// Copies a descriptor above those that the child's get, which would else overwrite it.
int copyAbove(int descriptor) {
    constexpr int kAbove = 16;
    return fcntl(descriptor, F_DUPFD_CLOEXEC, kAbove);
}

Spool makeSpool() {
    std::error_code code;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(code);
    constexpr uint32_t kOwnerOnly = 0600;
    Spool spool(code ? "/tmp" : folder.string(), kOwnerOnly);
    return spool.error() == 0 ? std::move(spool) : Spool::inMemory();
}

/// A process that converts a file. It never outlives this object.
class Converter {
public:
    Converter(const ImportDesc& desc, const Spool& output) : desc_(desc) { start(output); }
    ~Converter() {
        if (child_ <= 0) return;
        kill(-child_, SIGKILL); // with the Blender that it may have started
        reap(0);
    }
    Converter(const Converter&) = delete;
    Converter& operator=(const Converter&) = delete;

    /// Waits for the end. Throws Error where there is no whole GLB then.
    std::vector<std::string> finish();

private:
    void start(const Spool& output);
    void spawn(int output, int messages);
    bool reap(int options);
    bool listen(int wait);
    void hear(ImportWord word, const std::string& text);
    [[noreturn]] void failAfterEnd() const;
    std::string moreBy(const char* option) const;

    const ImportDesc& desc_;
    Descriptor pipe_;
    ImportMessages messages_{[this](ImportWord word, const std::string& text) { hear(word, text); }};
    pid_t child_ = 0;
    int status_ = 0;
    float done_ = -1.0f;
    bool whole_ = false, outOfMemory_ = false;
    std::string error_;
    std::vector<std::string> warnings_;
};

void Converter::start(const Spool& output) {
    int ends[2] = {-1, -1};
    if (output.error() != 0 || pipe2(ends, O_CLOEXEC) != 0)
        throw Error(fmt::format("{}: cannot be converted ({}): close other programs", desc_.path,
                                std::strerror(output.error() != 0 ? output.error() : errno)));
    pipe_.reset(ends[0]);
    const Descriptor write(ends[1]);
    fcntl(pipe_.get(), F_SETFL, O_NONBLOCK);
    const Descriptor outputCopy(copyAbove(output.descriptor())), messageCopy(copyAbove(write.get()));
    spawn(outputCopy.get(), messageCopy.get());
}

void Converter::spawn(int output, int messages) {
    const std::vector<std::string> arguments = {"relume",
                                                kImportWord,
                                                std::to_string(kOutputDescriptor),
                                                std::to_string(kMessageDescriptor),
                                                std::to_string(getpid()),
                                                fmt::format("{}", desc_.limits.seconds),
                                                std::to_string(desc_.limits.memory),
                                                fmt::format("{}", desc_.choice.scale),
                                                std::string(1, desc_.choice.up),
                                                desc_.path};
    std::vector<char*> argv;
    for (const std::string& argument : arguments)
        argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, output, kOutputDescriptor);
    posix_spawn_file_actions_adddup2(&actions, messages, kMessageDescriptor);
    posix_spawn_file_actions_addclosefrom_np(&actions, kMessageDescriptor + 1);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    // A group of its own: Ctrl-C is for us. Signals are as in a new program.
    posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    const int error =
        posix_spawn(&child_, desc_.program.c_str(), &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error == 0) return;
    child_ = 0;
    throw Error(fmt::format("{}: cannot be converted: {} does not start ({}): close other programs",
                            desc_.path, desc_.program, std::strerror(error)));
}

bool Converter::reap(int options) {
    pid_t ended = 0;
    do {
        ended = waitpid(child_, &status_, options);
    } while (ended < 0 && errno == EINTR);
    if (ended == 0) return false;
    child_ = 0;
    return true;
}

void Converter::hear(ImportWord word, const std::string& text) {
    switch (word) {
    case ImportWord::Progress:
        done_ = std::clamp(std::strtof(text.c_str(), nullptr), 0.0f, 1.0f);
        return;
    case ImportWord::Warning:
        warnings_.push_back(text);
        return;
    case ImportWord::Error:
        error_ = text;
        return;
    case ImportWord::Memory:
        outOfMemory_ = true;
        return;
    case ImportWord::Done:
        whole_ = true;
        return;
    }
}

// Reads what the child has said, and waits so long [ms] where that is nothing. Returns false where it will
// say no more.
bool Converter::listen(int wait) {
    pollfd end{pipe_.get(), POLLIN, 0};
    poll(&end, 1, wait);
    std::string all;
    std::array<char, 4096> bytes{};
    ssize_t count = 0;
    while ((count = read(pipe_.get(), bytes.data(), bytes.size())) > 0)
        all.append(bytes.data(), static_cast<size_t>(count));
    messages_.take(all);
    return count != 0;
}

std::string Converter::moreBy(const char* option) const {
    return fmt::format("allow more by 'relume import {} -o OUT.glb {}', or export it as glTF", desc_.path,
                       option);
}

void Converter::failAfterEnd() const {
    if (!error_.empty()) throw Error(error_);
    constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
    if (outOfMemory_)
        throw Error(fmt::format("{}: reading it takes more than {:.3g} GiB of memory: {}", desc_.path,
                                static_cast<double>(desc_.limits.memory) / kGiB,
                                moreBy("--memory-limit GIB")));
    if (WIFSIGNALED(status_) && WTERMSIG(status_) == SIGXCPU)
        throw Error(fmt::format("{}: reading it takes longer than {:.3g} s: {}", desc_.path,
                                desc_.limits.seconds, moreBy("--time-limit SECONDS")));
    const std::string how =
        WIFSIGNALED(status_) ? fmt::format("signal {}, {}", WTERMSIG(status_), strsignal(WTERMSIG(status_)))
                             : fmt::format("exit status {}", WEXITSTATUS(status_));
    throw Error(fmt::format("{}: libassimp failed while it read this {} file ({}): {}", desc_.path,
                            lowerEnding(desc_.path), how, mendOf(desc_.path)));
}

std::vector<std::string> Converter::finish() {
    const Clock::time_point start = Clock::now();
    bool talks = true;
    while (child_ > 0) {
        if (talks)
            talks = listen(kPeriod);
        else
            poll(nullptr, 0, 1); // it is about to end
        if (reap(WNOHANG)) break;
        tellWatch("importing", done_);
        if (secondsSince(start) <= desc_.limits.seconds) continue;
        throw Error(fmt::format("{}: reading it takes longer than {:.3g} s: {}", desc_.path,
                                desc_.limits.seconds, moreBy("--time-limit SECONDS")));
    }
    if (talks) listen(0);
    if (!whole_ || !WIFEXITED(status_) || WEXITSTATUS(status_) != 0) failAfterEnd();
    return std::move(warnings_);
}

} // namespace

void ImportedFile::save(const std::string& path) const {
    AtomicFile file(path);
    if (const int error = spool_.copyTo(file.descriptor()); error != 0)
        throw Error(
            fmt::format("{}: cannot be written ({}): make room on the disk", path, std::strerror(error)));
    file.commit();
}

ImportedFile importForeign(const ImportDesc& desc) {
    RegularFile(desc.path, "name a file with a scene"); // what is not there needs no process
    Spool spool = makeSpool();
    std::vector<std::string> warnings = Converter(desc, spool).finish();
    return {std::move(spool), std::move(warnings)};
}

ImportedFile importForeign(const std::string& path) {
    ImportDesc desc;
    desc.path = path;
    return importForeign(desc);
}

} // namespace relume
