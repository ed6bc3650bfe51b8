#include "app/offline/progress.h"

#include "assets/base/error.h"

#include <gtest/gtest.h>

#include <csignal>

#include <unistd.h>

namespace relume {

TEST(PhaseProgress, SaysHowAPhaseStands) {
    EXPECT_EQ(phaseText("patches", 0.454), "patches  45 %");
    EXPECT_EQ(phaseText("tracer", -1.0), "tracer");
}

TEST(PhaseProgress, EndsAJobThatTellsAfterCtrlC) {
    const InterruptGuard guard;
    const PhaseProgress progress(false);
    EXPECT_NO_THROW(tellWatch("patches", 0.5));
    std::raise(SIGINT);
    EXPECT_THROW(tellWatch("patches", 0.6), Error);
}

// Only the alarm ends a library that does not come back.
TEST(PhaseProgressDeathTest, EndsAJobThatTellsNothing) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    const auto hang = [] {
        const InterruptGuard guard;
        const PhaseProgress progress(true);
        std::raise(SIGTERM);
        while (true)
            pause();
    };
    EXPECT_EXIT(hang(), testing::ExitedWithCode(1), "error: interrupted: nothing was written");
}

// Once work has begun that is worth being saved, the alarm does nothing; the job sees the flag by itself.
TEST(PhaseProgress, DoesNotEndWhatIsWorthBeingSaved) {
    sigset_t alarm, before;
    sigemptyset(&alarm);
    sigaddset(&alarm, SIGALRM);
    pthread_sigmask(SIG_BLOCK, &alarm, &before);
    const InterruptGuard guard;
    {
        const PhaseProgress progress(true);
        std::raise(SIGTERM);
    }
    sigdelset(&before, SIGALRM);
    sigsuspend(&before); // until it comes
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    EXPECT_TRUE(InterruptGuard::requested());
}

} // namespace relume
