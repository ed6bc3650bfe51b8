// Memory that processes of one machine share.
#include "bake/ranks/shared_block.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <string>

namespace relume {
namespace {

constexpr uint64_t kBytes = 1 << 16;

std::string nameOf(const char* what) {
    return "/relume-test-" + std::string(what) + "-" + std::to_string(getpid());
}

TEST(SharedBlock, anotherProcessSeesWhatIsWritten) {
    const std::string name = nameOf("seen");
    const SharedBlock block = createSharedBlock(name, kBytes);
    ASSERT_TRUE(block);
    ASSERT_EQ(block.bytes.size(), kBytes);
    EXPECT_EQ(block.bytes[kBytes - 1], std::byte{0});
    block.bytes[7] = std::byte{42};
    const pid_t child = fork();
    if (child == 0) { // no assertion of gtest: this process only answers by its status
        const SharedBlock same = openSharedBlock(name, kBytes);
        if (!same || same.bytes[7] != std::byte{42}) _exit(1);
        same.bytes[kBytes - 1] = std::byte{43};
        _exit(0);
    }
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    EXPECT_EQ(block.bytes[kBytes - 1], std::byte{43});
    forgetSharedBlock(name);
    EXPECT_FALSE(openSharedBlock(name, kBytes)) << "its name is gone";
    block.bytes[8] = std::byte{1}; // the block is not
}

TEST(SharedBlock, aNameThatIsUsedAndOneThatIsNotMakeNone) {
    const std::string name = nameOf("twice");
    EXPECT_FALSE(openSharedBlock(name, kBytes));
    const SharedBlock block = createSharedBlock(name, kBytes);
    ASSERT_TRUE(block);
    EXPECT_FALSE(createSharedBlock(name, kBytes));
    EXPECT_TRUE(openSharedBlock(name, kBytes)) << "the first one is still there";
    forgetSharedBlock(name);
}

TEST(SharedBlock, moreThanThereIsMakesNoneAndLeavesNoName) {
    const std::string name = nameOf("large");
    EXPECT_FALSE(createSharedBlock(name, uint64_t{1} << 50));
    EXPECT_FALSE(openSharedBlock(name, kBytes));
}

} // namespace
} // namespace relume
