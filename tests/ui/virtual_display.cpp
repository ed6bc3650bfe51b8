#include "tests/ui/virtual_display.h"

#include "assets/base/error.h"

#include <array>
#include <csignal>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relume {

VirtualDisplay::VirtualDisplay(int width, int height) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0) throw Error("pipe failed");
    const std::string screen = std::to_string(width) + "x" + std::to_string(height) + "x24";
    server_ = fork();
    if (server_ < 0) throw Error("fork failed");
    if (server_ == 0) {
        const int nothing = open("/dev/null", O_RDWR);
        dup2(nothing, STDOUT_FILENO);
        dup2(nothing, STDERR_FILENO);
        close(ends[0]);
        const std::string fd = std::to_string(ends[1]);
        execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", screen.c_str(), "-nolisten", "tcp",
               "-noreset", nullptr);
        _exit(127);
    }
    close(ends[1]);
    // It writes the number of the display once it is ready.
    std::string number;
    char c = 0;
    while (read(ends[0], &c, 1) == 1 && c != '\n')
        number += c;
    close(ends[0]);
    if (number.empty()) throw Error("Xvfb does not start: install xvfb");
    name_ = ":" + number;
}

VirtualDisplay::~VirtualDisplay() {
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
}

} // namespace relume
