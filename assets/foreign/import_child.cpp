#include "assets/foreign/import_child.h"

#include "assets/base/error.h"
#include "assets/base/spool.h"
#include "assets/foreign/blender_export.h"
#include "assets/foreign/foreign_files.h"
#include "assets/foreign/foreign_scene.h"
#include "assets/foreign/import_limits.h"
#include "assets/foreign/import_messages.h"
#include "assets/gltf/gltf.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <new>
#include <stdexcept>
#include <thread>

#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define RELUME_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define RELUME_SANITIZED 1
#endif
#endif

namespace relume {
namespace {

/// Holds what importForeign() says on the command line.
struct ChildTask {
    int output = -1, messages = -1; // descriptors
    pid_t parent = 0;
    ImportLimits limits;
    ForeignChoice choice;
    std::string path;
};

constexpr int kArguments = 10; // the program's name and the word included

ChildTask taskOf(const char* const* arguments) {
    ChildTask task;
    task.output = std::atoi(arguments[2]);
    task.messages = std::atoi(arguments[3]);
    task.parent = std::atoi(arguments[4]);
    task.limits.seconds = std::atof(arguments[5]);
    task.limits.memory = std::strtoull(arguments[6], nullptr, 10);
    task.choice.scale = std::atof(arguments[7]);
    task.choice.up = arguments[8][0];
    task.path = arguments[9];
    return task;
}

void limit(decltype(RLIMIT_AS) what, rlim_t most) {
    struct rlimit now {};
    if (getrlimit(what, &now) != 0) return;
    const rlim_t bound = std::min(most, now.rlim_max); // never above what the system allows
    const struct rlimit wanted { bound, bound };
    setrlimit(what, &wanted);
}

/// Returns what of the address space this process has taken already [bytes].
[[maybe_unused]] uint64_t addressSpace() {
    std::ifstream facts("/proc/self/statm");
    uint64_t pages = 0;
    facts >> pages;
    return pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

/// Gives up what converting a file does not need.
void restrain(const ChildTask& task) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != task.parent) _exit(1); // the parent has ended before that could have killed us
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    limit(RLIMIT_CORE, 0);
    // The clock is watched by the parent. Time on the processor counts all threads, of which the last part of
    // the work has one per core.
    const double cores = std::max(1u, std::thread::hardware_concurrency());
    limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(task.limits.seconds * cores)) + 1);
    constexpr rlim_t kMostOutput = 0xffffffff; // [bytes]; a GLB is no larger
    limit(RLIMIT_FSIZE, kMostOutput);
    std::signal(SIGXFSZ, SIG_IGN); // writing fails instead
    std::signal(SIGPIPE, SIG_IGN);
    // Where the machine runs out of memory, this process is the one to go.
    std::ofstream("/proc/self/oom_score_adj") << 1000;
#ifndef RELUME_SANITIZED // which reserves terabytes
    limit(RLIMIT_AS, addressSpace() + task.limits.memory);
#endif
}

class Teller {
public:
    explicit Teller(int descriptor) : descriptor_(descriptor) {}
    void tell(ImportWord word, const std::string& text = "") const {
        writeAll(descriptor_, importLine(word, text));
    }
    /// Needs no memory.
    void tellMemory() const { writeAll(descriptor_, "m\n"); }

private:
    int descriptor_;
};

void keep(const ChildTask& task, const std::vector<uint8_t>& bytes) {
    const int error = writeAll(task.output, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    if (error != 0)
        throw Error(task.path + ": cannot be kept while it is read (" + std::strerror(error) +
                    "): make room in the system's temporary folder");
}

void convert(const ChildTask& task, const Teller& teller) {
    if (const auto blender = lowerEnding(task.path) == ".blend" ? findBlender() : std::nullopt) {
        keep(task, exportByBlender(*blender, task.path));
        teller.tell(ImportWord::Done);
        return;
    }
    const ForeignScene made = convertForeign(
        task.path, task.choice, [&](float done) { teller.tell(ImportWord::Progress, std::to_string(done)); });
    std::vector<uint8_t> bytes;
    try {
        bytes = glbBytes(made.scene, made.pictures);
    } catch (const Error& error) {
        throw Error(task.path + ": " + error.what());
    }
    keep(task, bytes);
    for (const std::string& warning : made.scene.warnings)
        teller.tell(ImportWord::Warning, warning);
    teller.tell(ImportWord::Done);
}

} // namespace

std::optional<int> runImportChild(int count, const char* const* arguments) {
    if (count != kArguments || std::strcmp(arguments[1], kImportWord) != 0) return {};
    const ChildTask task = taskOf(arguments);
    const Teller teller(task.messages);
    restrain(task);
    try {
        convert(task, teller);
        return 0;
    } catch (const Error& error) {
        teller.tell(ImportWord::Error, error.what());
    } catch (const std::bad_alloc&) {
        teller.tellMemory();
    } catch (const std::length_error&) { // a size that no memory has
        teller.tellMemory();
    } catch (const std::exception& error) {
        teller.tell(ImportWord::Error,
                    task.path + ": cannot be read (" + error.what() + "): " + mendOf(task.path));
    }
    return 1;
}

} // namespace relume
