#include "app/interrupt.h"

#include <csignal>

namespace relume {
namespace {

volatile std::sig_atomic_t interrupted = 0;

extern "C" void onInterrupt(int number) {
    interrupted = 1;
    std::signal(number, SIG_DFL);
}

} // namespace

InterruptGuard::InterruptGuard() {
    interrupted = 0;
    std::signal(SIGINT, onInterrupt);
    std::signal(SIGTERM, onInterrupt);
}

InterruptGuard::~InterruptGuard() {
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

bool InterruptGuard::requested() {
    return interrupted != 0;
}

} // namespace relume
