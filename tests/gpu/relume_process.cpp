#include "tests/gpu/relume_process.h"

#include "assets/base/clock.h"
#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relume {
namespace {

// Reads what is there. Returns false at the end of the stream.
bool readMore(int fd, std::string& text) {
    std::array<char, 4096> bytes;
    const ssize_t count = read(fd, bytes.data(), bytes.size());
    if (count <= 0) return false;
    text.append(bytes.data(), static_cast<size_t>(count));
    return true;
}

[[noreturn]] void becomeProgram(const std::string& program, const std::vector<std::string>& arguments,
                                int out, int err) {
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments)
        argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const int nothing = open("/dev/null", O_RDONLY);
    dup2(nothing, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    execv(program.c_str(), argv.data());
    _exit(127);
}

} // namespace

ProcessResult runProgram(const std::string& program, const std::vector<std::string>& arguments,
                         const std::function<int(const std::string& err)>& onErr, double killAfter) {
    const auto start = Clock::now();
    std::array<int, 2> out{}, err{};
    if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0) throw Error("pipe failed");
    const pid_t child = fork();
    if (child < 0) throw Error("fork failed");
    if (child == 0) becomeProgram(program, arguments, out[1], err[1]);
    close(out[1]);
    close(err[1]);

    ProcessResult result;
    bool outOpen = true, errOpen = true;
    while (outOpen || errOpen) {
        std::array<pollfd, 2> streams = {
            {{outOpen ? out[0] : -1, POLLIN, 0}, {errOpen ? err[0] : -1, POLLIN, 0}}};
        const double left = killAfter - std::chrono::duration<double>(Clock::now() - start).count();
        const bool wait = killAfter <= 0 || left > 0;
        if (!wait) kill(child, SIGKILL);
        const int milliseconds = killAfter > 0 && wait ? static_cast<int>(1000.0 * left) + 1 : -1;
        if (poll(streams.data(), streams.size(), milliseconds) == 0) continue;
        if (streams[0].revents != 0) outOpen = readMore(out[0], result.out);
        if (streams[1].revents == 0) continue;
        errOpen = readMore(err[0], result.err);
        const int signal = onErr ? onErr(result.err) : 0;
        if (signal != 0) kill(child, signal);
    }
    close(out[0]);
    close(err[0]);
    int status = 0;
    waitpid(child, &status, 0);
    result.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return result;
}

ProcessResult runRelume(const std::vector<std::string>& arguments,
                        const std::function<int(const std::string& err)>& onErr, double killAfter) {
    return runProgram(RELUME_BINARY, arguments, onErr, killAfter);
}

} // namespace relume
