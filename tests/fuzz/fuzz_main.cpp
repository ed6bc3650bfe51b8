// This is a plain mutation loop: inputs depend on seed and number alone, so that each of them can be made
// again.
#include "tests/fuzz/fuzz.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fcntl.h>
#include <sanitizer/common_interface_defs.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <unistd.h>

// GCC has no header for these.
extern "C" {
int __sanitizer_install_malloc_and_free_hooks(void (*onMalloc)(const volatile void*, size_t),
                                              void (*onFree)(const volatile void*));
size_t __sanitizer_get_allocated_size(const volatile void* memory);
const char* __asan_default_options();
const char* __ubsan_default_options();
}

// Freed memory is kept to find uses of it; more than this would hide what inputs take.
const char* __asan_default_options() {
    return "quarantine_size_mb=16:detect_stack_use_after_return=0:allocator_release_to_os_interval_ms=-1";
}

// GCC's runtime of this sanitizer is one of its own, which calls no one before it ends the process.
const char* __ubsan_default_options() {
    return "abort_on_error=1:print_stacktrace=1";
}

namespace relume::fuzz {
namespace {

constexpr int64_t kMostAsked = int64_t(4) << 30; // [bytes] of memory asked for, used or not
constexpr long kMostUsed = 1500 << 10;           // [KiB] of memory in use, the sanitizers' own included
constexpr int kMostCpuSeconds = 20;              // of one input; a good machine takes milliseconds

struct Options {
    uint64_t seed = 1, first = 0;
    uint64_t runs = ~uint64_t{0};
    double seconds = 10;
    std::vector<std::string> files; // to be read instead
};

/// Tells what runs to handlers of signals, which may call next to nothing.
struct Current {
    const char* program = "";
    char keptAs[200] = "";
    std::string input;
    bool isMade = false, isReported = false;
    uint64_t seed = 0, run = 0;
};
Current current;
std::atomic<int64_t> asked = 0;

void say(const char* text) {
    const ssize_t ignored = write(STDERR_FILENO, text, std::strlen(text));
    static_cast<void>(ignored);
}

void report() {
    if (current.isReported) return;
    current.isReported = true;
    char text[1000];
    if (current.isMade) {
        const int file = open(current.keptAs, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
        const ssize_t written = write(file, current.input.data(), current.input.size());
        static_cast<void>(written);
        close(file);
        std::snprintf(text, sizeof(text), "fuzz: input %llu of seed %llu is a finding.\n",
                      static_cast<unsigned long long>(current.run),
                      static_cast<unsigned long long>(current.seed));
        say(text);
    }
    std::snprintf(text, sizeof(text), "fuzz: to see it again: %s %s\n", current.program, current.keptAs);
    say(text);
}

[[noreturn]] void endWith(const char* why) {
    say(why);
    __sanitizer_print_stack_trace();
    report();
    _exit(1);
}

void onSignal(int signal) {
    endWith(signal == SIGPROF ? "fuzz: an input takes too long\n" : "fuzz: an input ends in abort()\n");
}

void onMalloc(const volatile void*, size_t size) {
    const auto bytes = static_cast<int64_t>(size);
    if (asked.fetch_add(bytes) + bytes > kMostAsked && !current.isReported)
        endWith("fuzz: an input asks for too much memory\n");
}

void onFree(const volatile void* memory) {
    if (memory) asked.fetch_sub(static_cast<int64_t>(__sanitizer_get_allocated_size(memory)));
}

void watch() {
    std::signal(SIGPROF, onSignal);
    std::signal(SIGABRT, onSignal);
    __sanitizer_set_death_callback(report);
    __sanitizer_install_malloc_and_free_hooks(onMalloc, onFree);
}

void runOne(std::string input) {
    current.input = std::move(input);
    const itimerval limit = {{0, 0}, {kMostCpuSeconds, 0}};
    setitimer(ITIMER_PROF, &limit, nullptr);
    LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(current.input.data()), current.input.size());
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    if (usage.ru_maxrss > kMostUsed) endWith("fuzz: an input uses too much memory\n");
}

void keepAs(const std::string& path) {
    std::snprintf(current.keptAs, sizeof(current.keptAs), "%s", path.c_str());
}

int usage() {
    std::fprintf(stderr, "usage: [--seed N] [--seconds S] [--first N] [--runs N], or files to be read\n");
    return 2;
}

bool parse(int count, char** arguments, Options& options) {
    for (int i = 1; i < count; ++i) {
        const std::string name = arguments[i];
        if (!name.starts_with("--")) {
            options.files.push_back(name);
            continue;
        }
        if (++i == count) return false;
        if (name == "--seconds")
            options.seconds = std::atof(arguments[i]);
        else if (name == "--seed")
            options.seed = std::strtoull(arguments[i], nullptr, 10);
        else if (name == "--first")
            options.first = std::strtoull(arguments[i], nullptr, 10);
        else if (name == "--runs")
            options.runs = std::strtoull(arguments[i], nullptr, 10);
        else
            return false;
    }
    return true;
}

void readFiles(const std::vector<std::string>& files) {
    for (const std::string& path : files) {
        std::ifstream file(path, std::ios::binary);
        check(file.good(), path + " cannot be read");
        keepAs(path);
        runOne({std::istreambuf_iterator<char>(file), {}});
        std::printf("%s: no finding\n", path.c_str());
    }
}

void loop(const Options& options) {
    using Clock = std::chrono::steady_clock;
    const std::vector<std::string> begin = corpus();
    const auto start = Clock::now();
    const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    const std::string name = std::string(current.program).substr(std::string(current.program).rfind('/') + 1);
    current.isMade = true;
    current.seed = options.seed;
    uint64_t run = options.first;
    for (; run - options.first < options.runs && (seconds() < options.seconds || run < begin.size()); ++run) {
        keepAs(name + "_seed" + std::to_string(options.seed) + "_" + std::to_string(run));
        current.run = run;
        runOne(inputOf(begin, options.seed, run));
    }
    std::printf("%s: no finding in inputs %llu to %llu of seed %llu, %.1f s\n", name.c_str(),
                static_cast<unsigned long long>(options.first), static_cast<unsigned long long>(run),
                static_cast<unsigned long long>(options.seed), seconds());
}

} // namespace
} // namespace relume::fuzz

int main(int count, char** arguments) {
    using namespace relume::fuzz;
    Options options;
    if (!parse(count, arguments, options)) return usage();
    current.program = arguments[0];
    // Log messages are made, and thrown away.
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("none", std::make_shared<spdlog::sinks::null_sink_mt>()));
    watch();
    if (options.files.empty())
        loop(options);
    else
        readFiles(options.files);
    return 0;
}
