// Ctrl-C and SIGTERM come before a bake has begun: it ends at once, and nothing is left.
#include "assets/base/clock.h"
#include "tests/gpu/relume_process.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <csignal>
#include <optional>
#include <string>

namespace relume {
namespace {

// A loaded machine adds at most this to the half second.
constexpr double kGenerous = 10.0; // [s]

struct Interrupted {
    ProcessResult process;
    double seconds = 0; // from the signal to the end
};

/// Bakes one of the scenes that ship, with so many texels that each phase takes longer than that, and sends
/// the signal as soon as the text is told.
Interrupted interruptAt(const std::string& text, int number, const TemporaryFolder& folder) {
    std::optional<Clock::time_point> sent;
    Interrupted result;
    result.process = runRelume({"bake", RELUME_SOURCE_DIR "/assets/scenes/cornell_statue.glb", "-o",
                                folder.path("map.exr"), "--size", "3072", "--error", "1e-6"},
                               [&](const std::string& err) {
                                   if (sent || !contains(err, text)) return 0;
                                   sent = Clock::now();
                                   return number;
                               });
    EXPECT_TRUE(sent) << text;
    result.seconds = sent ? secondsSince(*sent) : 0.0;
    return result;
}

} // namespace

TEST(BakeInterrupt, EndsAtOnceInEachPhase) {
    const TemporaryFolder folder;
    // The signal comes before rasterization, patches, tracer and validity; while there is none of these the
    // solver ends the bake.
    for (const char* text : {"device: ", "tracer: "}) {
        for (const int number : {SIGINT, SIGTERM}) {
            const Interrupted r = interruptAt(text, number, folder);
            EXPECT_EQ(r.process.status, 1) << text << r.process.err;
            EXPECT_TRUE(contains(r.process.err, "interrupted: nothing was written")) << r.process.err;
            EXPECT_FALSE(contains(r.process.err, " patches\n")) << "it was prepared to its end";
            EXPECT_LT(r.seconds, kGenerous) << text;
            EXPECT_TRUE(folder.files().empty());
        }
    }
}

} // namespace relume
