#include "assets/base/passing_folder.h"

#include "assets/base/error.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <sys/wait.h>
#include <unistd.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

class PassingFolders : public testing::Test {
protected:
    PassingFolders() {
        std::string path = testing::TempDir() + "passing_XXXXXX";
        EXPECT_NE(mkdtemp(path.data()), nullptr);
        parent_ = path;
    }
    ~PassingFolders() override { fs::remove_all(parent_); }
    size_t count() const {
        return static_cast<size_t>(std::distance(fs::directory_iterator(parent_), fs::directory_iterator()));
    }

    fs::path parent_;
};

TEST_F(PassingFolders, AFolderGoesWithWhatIsInIt) {
    {
        const PassingFolder folder(parent_, "level_");
        std::ofstream(folder.file("a.glb")) << "a";
        EXPECT_TRUE(fs::exists(folder.file("a.glb")));
    }
    EXPECT_EQ(count(), 0u);
}

TEST_F(PassingFolders, WhatAKilledProcessLeftGoesWithTheNextOne) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        const PassingFolder folder(parent_, "level_");
        std::ofstream(folder.file("a.glb")) << "a";
        raise(SIGKILL);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    ASSERT_EQ(count(), 1u);
    const PassingFolder folder(parent_, "level_");
    EXPECT_EQ(count(), 1u);
    EXPECT_TRUE(fs::is_directory(folder.path()));
    EXPECT_FALSE(fs::exists(folder.file("a.glb")));
}

TEST_F(PassingFolders, WhatIsInUseOrOfAnotherNameStays) {
    fs::create_directory(parent_ / "level_of_mine");
    fs::create_directory(parent_ / "other_abcdef");
    std::ofstream(parent_ / "level_abcdef") << "a file";
    const PassingFolder first(parent_, "level_");
    const PassingFolder second(parent_, "level_");
    EXPECT_TRUE(fs::is_directory(first.path()));
    EXPECT_EQ(count(), 5u);
}

TEST_F(PassingFolders, ALinkIsNotFollowed) {
    const fs::path mine = parent_ / "mine";
    fs::create_directory(mine);
    std::ofstream(mine / "precious") << "a";
    fs::create_directory_symlink(mine, parent_ / "level_abcdef");
    const PassingFolder folder(parent_, "level_");
    EXPECT_TRUE(fs::exists(mine / "precious"));
}

TEST_F(PassingFolders, AFolderThatCannotBeMadeIsTold) {
    try {
        const PassingFolder folder(parent_ / "missing", "level_");
        FAIL();
    } catch (const Error& error) {
        EXPECT_TRUE(contains(error.what(), "level_"));
        EXPECT_TRUE(contains(error.what(), "make room"));
    }
}

} // namespace
} // namespace relume
