#include "app/text/interrupt.h"

#include "assets/base/error.h"

#include <csignal>
#include <string_view>

#include <sys/time.h>
#include <unistd.h>

namespace relume {
namespace {

volatile std::sig_atomic_t interrupted = 0, abandonable = 0;

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGUSR1};
constexpr long kGraceMicroseconds = 350000; // [us], of the half second in which a job has to end
constexpr std::string_view kInterruptMessage = "interrupted: nothing was written";

void startAlarm() {
    const itimerval once{{0, 0}, {0, kGraceMicroseconds}};
    setitimer(ITIMER_REAL, &once, nullptr);
}

extern "C" void onInterrupt(int number) {
    interrupted = 1;
    std::signal(number, SIG_DFL);
    if (abandonable != 0) startAlarm();
}

// Ends the program, and calls only what a signal handler may.
extern "C" void onAlarm(int) {
    if (abandonable == 0) return; // it has ended by itself, or work has begun that is worth being saved
    for (const std::string_view part :
         {std::string_view("error: "), kInterruptMessage, std::string_view("\n")})
        if (write(STDERR_FILENO, part.data(), part.size()) < 0) break;
    _exit(1);
}

// Sets a signal's handler so that system calls that the signal interrupts go on.
void handleSignal(int number, void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigaction(number, &action, nullptr);
}

} // namespace

InterruptGuard::InterruptGuard() {
    interrupted = 0;
    handleSignal(SIGALRM, onAlarm);
    for (const int number : kSignals)
        handleSignal(number, onInterrupt);
}

InterruptGuard::~InterruptGuard() {
    for (const int number : kSignals)
        std::signal(number, SIG_DFL);
    std::signal(SIGALRM, SIG_IGN); // one may be on its way
}

bool InterruptGuard::requested() {
    return interrupted != 0;
}

void stopIfInterrupted() {
    if (InterruptGuard::requested()) throw Error(std::string(kInterruptMessage));
}

Abandonable::Abandonable() {
    abandonable = 1;
    if (InterruptGuard::requested()) startAlarm();
}

Abandonable::~Abandonable() {
    abandonable = 0;
}

} // namespace relume
