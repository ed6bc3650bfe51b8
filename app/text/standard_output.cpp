#include "app/text/standard_output.h"

#include "assets/base/log.h"

#include <cerrno>
#include <cstdio>
#include <iostream>
#include <system_error>

#include <fcntl.h>
#include <unistd.h>

namespace relume {

void holdStandardStreams() {
    for (int descriptor = 0; descriptor <= 2; ++descriptor) {
        if (fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
        // open() takes the lowest free descriptor, which is this one.
        if (open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY) < 0) return;
    }
}

bool outputFailed() {
    return std::ferror(stdout) != 0 || !std::cout;
}

int finishOutput(int status) {
    std::cout.flush();
    bool failed = outputFailed();
    errno = 0;
    if (std::fflush(stdout) != 0) failed = true;
    int error = errno;
    // Some file systems tell of a full disk when a file is closed; others may still have this one open.
    const int copy = failed ? -1 : dup(STDOUT_FILENO);
    if (copy >= 0 && close(copy) != 0 && errno != EBADF) {
        failed = true;
        error = errno;
    }
    if (!failed) return status;
    spdlog::error("the standard output cannot be written{}: what was printed is not complete",
                  error != 0 ? ": " + std::generic_category().message(error) : "");
    return status == 0 ? 1 : status;
}

} // namespace relume
