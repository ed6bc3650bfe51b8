#include "assets/base/file_write.h"

#include "assets/base/error.h"
#include "tests/temporary_folder.h"
#include "tests/text.h"

#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <future>
#include <sstream>

namespace relume {
namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

std::string contentOf(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

uint32_t rightsOf(const std::string& path) {
    struct stat facts {};
    return stat(path.c_str(), &facts) == 0 ? facts.st_mode & 07777 : 0;
}

std::string errorOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

class FileWrite : public testing::Test {
protected:
    std::string path(const std::string& name) const { return folder_.path(name); }
    std::string make(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
        return path(name);
    }
    /// Checks and writes, as before and after a long work.
    static void write(const std::string& to, const std::string& text) {
        checkFileWritable(to, 0);
        writeFileAtomically(to, text);
    }

    const TemporaryFolder folder_;
};

TEST_F(FileWrite, KeepsTheRightsOfWhatItReplaces) {
    const std::string file = make("private", "before");
    for (const uint32_t rights : {0600u, 0640u, 0664u, 0755u}) {
        chmod(file.c_str(), rights);
        write(file, "after");
        EXPECT_EQ(rightsOf(file), rights);
    }
    EXPECT_EQ(contentOf(file), "after");
    EXPECT_EQ(folder_.files(), Names{"private"});
}

TEST_F(FileWrite, GivesANewFileTheUsualRights) {
    const mode_t mask = umask(027);
    write(path("new"), "x");
    umask(mask);
    EXPECT_EQ(rightsOf(path("new")), 0640u);
}

TEST_F(FileWrite, KeepsOwnerAndGroup) {
    const std::string file = make("theirs", "before");
    if (chown(file.c_str(), 12345, 23456) != 0) GTEST_SKIP() << "only root gives files away";
    write(file, "after");
    struct stat facts {};
    stat(file.c_str(), &facts);
    EXPECT_EQ(facts.st_uid, 12345u);
    EXPECT_EQ(facts.st_gid, 23456u);
}

TEST_F(FileWrite, KeepsAllNamesOfAFile) {
    const std::string file = make("one", "a text that is longer than the next");
    fs::create_hard_link(file, path("two"));
    write(file, "after");
    EXPECT_EQ(contentOf(path("two")), "after");
    EXPECT_EQ(fs::hard_link_count(file), 2u);
    EXPECT_EQ(folder_.files(), (Names{"one", "two"}));
}

TEST_F(FileWrite, FollowsLinksWhereverTheyLead) {
    make("file", "before");
    fs::create_symlink("file", path("link"));
    fs::create_symlink("link", path("link2"));
    fs::create_symlink("missing", path("dangling"));
    write(path("link2"), "after");
    write(path("dangling"), "new");
    EXPECT_EQ(contentOf(path("file")), "after");
    EXPECT_EQ(contentOf(path("missing")), "new");
    EXPECT_TRUE(fs::is_symlink(path("link2")) && fs::is_symlink(path("link")) &&
                fs::is_symlink(path("dangling")));
    fs::create_symlink("loop", path("loop"));
    EXPECT_NE(errorOf([&] { checkFileWritable(path("loop"), 0); }), "");
}

TEST_F(FileWrite, WritesIntoAFifo) {
    const std::string fifo = path("fifo");
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    checkFileWritable(fifo, 0); // must not wait for a reader
    fs::create_symlink("fifo", path("link"));
    for (const std::string& name : {fifo, path("link")}) {
        auto read = std::async(std::launch::async, [&] { return contentOf(fifo); });
        writeFileAtomically(name, "what is written");
        EXPECT_EQ(read.get(), "what is written");
        EXPECT_TRUE(fs::is_fifo(fifo));
    }
    EXPECT_EQ(folder_.files(), (Names{"fifo", "link"}));
}

TEST_F(FileWrite, AReaderThatGoesAwayIsAnError) {
    const std::string fifo = path("fifo");
    ASSERT_EQ(mkfifo(fifo.c_str(), 0600), 0);
    // This is more than the FIFO holds, so that the reader is gone before all is written.
    const std::string much(1u << 22, 'x');
    auto reader = std::async(std::launch::async, [&] {
        const int descriptor = open(fifo.c_str(), O_RDONLY);
        char byte = 0;
        const ssize_t count = read(descriptor, &byte, 1);
        close(descriptor);
        return count;
    });
    const std::string error = errorOf([&] { writeFileAtomically(fifo, much); });
    EXPECT_EQ(reader.get(), 1);
    EXPECT_NE(error.find("Broken pipe"), std::string::npos) << error;
    const size_t from = error.find('\'') + 1;
    const std::string saved = error.substr(from, error.find('\'', from) - from);
    EXPECT_EQ(contentOf(saved), much);
    fs::remove(saved);
}

TEST_F(FileWrite, WritesIntoADevice) {
    const std::string device = path("null");
    if (mknod(device.c_str(), S_IFCHR | 0666, makedev(1, 3)) != 0 || !std::ofstream(device))
        GTEST_SKIP() << "device nodes cannot be made or opened here";
    fs::create_symlink("null", path("link"));
    write(device, "x");
    write(path("link"), "x");
    EXPECT_TRUE(fs::is_character_file(device));
    EXPECT_TRUE(fs::is_symlink(path("link")));
    EXPECT_EQ(folder_.files(), (Names{"link", "null"}));
}

TEST_F(FileWrite, LeavesTheMachinesOwnDevicesAlone) {
    write("/dev/null", "x");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST_F(FileWrite, WritesIntoWhatAShellHasOpen) {
    const std::string file = make("out", "");
    const int descriptor = open(file.c_str(), O_WRONLY);
    ASSERT_EQ(::write(descriptor, "head\n", 5), 5);
    write("/proc/self/fd/" + std::to_string(descriptor), "rest");
    EXPECT_EQ(contentOf(file), "head\nrest");
    struct stat open_ {
    }, now{};
    fstat(descriptor, &open_);
    stat(file.c_str(), &now);
    EXPECT_EQ(open_.st_ino, now.st_ino);
    close(descriptor);
}

TEST_F(FileWrite, KeepsAMountedFile) {
    const std::string real = make("real", "before and longer"), place = make("place", "");
    if (mount(real.c_str(), place.c_str(), nullptr, MS_BIND, nullptr) != 0)
        GTEST_SKIP() << "files cannot be mounted here";
    const std::string error = errorOf([&] { write(place, "after"); });
    umount(place.c_str());
    EXPECT_EQ(error, "");
    EXPECT_EQ(contentOf(real), "after");
    EXPECT_EQ(contentOf(place), "");
}

TEST_F(FileWrite, RefusesAnImmutableFileBeforehand) {
    const std::string file = make("fixed", "before");
    if (std::system(("chattr +i '" + file + "' 2>/dev/null").c_str()) != 0)
        GTEST_SKIP() << "files cannot be made immutable here";
    const std::string error = errorOf([&] { checkFileWritable(file, 0); });
    std::system(("chattr -i '" + file + "'").c_str());
    EXPECT_NE(error.find("chattr -ia"), std::string::npos) << error;
}

TEST_F(FileWrite, RefusesASocketBeforehand) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path("socket").copy(address.sun_path, sizeof(address.sun_path) - 1);
    const int descriptor = socket(AF_UNIX, SOCK_STREAM, 0);
    ASSERT_EQ(bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
    EXPECT_NE(errorOf([&] { checkFileWritable(path("socket"), 0); }).find("is a socket"), std::string::npos);
    close(descriptor);
}

// Runs something as a user without rights; the exit status is what it returns.
int asNobody(const std::function<bool()>& action) {
    const pid_t child = fork();
    if (child == 0) _exit(setuid(65534) == 0 && action() ? 0 : 1);
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(FileWrite, InAStickyFolderAnothersFileIsFoundBeforehand) {
    if (geteuid() != 0) GTEST_SKIP() << "only root becomes another user";
    chmod(folder_.path().c_str(), 01777);
    const std::string closed = make("closed", "before"), open = make("open", "before");
    chmod(closed.c_str(), 0644);
    chmod(open.c_str(), 0666);
    EXPECT_EQ(asNobody([&] { return !errorOf([&] { checkFileWritable(closed, 0); }).empty(); }), 0);
    EXPECT_EQ(asNobody([&] { return errorOf([&] { write(open, "after"); }).empty(); }), 0);
    EXPECT_EQ(contentOf(closed), "before");
    EXPECT_EQ(contentOf(open), "after");
    struct stat facts {};
    stat(open.c_str(), &facts);
    EXPECT_EQ(facts.st_uid, 0u);
}

TEST_F(FileWrite, WhatCannotTakeItsNameIsSavedBeside) {
    const std::string target = path("o.exr");
    make("o.saved.exr", "of another day");
    AtomicFile file(target);
    file.write("a result");
    fs::create_directory(target); // meanwhile
    const std::string error = errorOf([&] { file.commit(); }), saved = path("o.saved-2.exr");
    EXPECT_NE(error.find("it was saved as '" + saved + "'"), std::string::npos) << error;
    EXPECT_EQ(contentOf(saved), "a result");
    EXPECT_EQ(contentOf(path("o.saved.exr")), "of another day");
}

TEST_F(FileWrite, ANewNameIsTheFirstThatNothingHas) {
    const std::string taken = make("taken", "old"), free = path("free");
    Names names = {free, taken};
    const auto nextName = [&] {
        std::string name = names.back();
        names.pop_back();
        return name;
    };
    AtomicFile file(taken);
    file.write("new");
    EXPECT_EQ(file.commitAnew(nextName), free);
    EXPECT_EQ(contentOf(taken), "old");
    EXPECT_EQ(contentOf(free), "new");
}

TEST_F(FileWrite, WhatIsOfNoUseIsNotSaved) {
    const std::string target = path("o.exr");
    AtomicFile file(target, OnFailure::Drop);
    file.write("a checkpoint");
    fs::create_directory(target);
    EXPECT_NE(errorOf([&] { file.commit(); }).find("choose another folder"), std::string::npos);
    EXPECT_EQ(folder_.files(), Names{"o.exr"});
}

TEST_F(FileWrite, WhatIsRefusedAfterTheWorkIsSavedAllTheSame) {
    fs::create_directory(path("taken.exr"));
    const std::string error = errorOf([&] { writeFileAtomically(path("taken.exr"), "a result"); });
    EXPECT_NE(error.find("is a folder: name a file in it: it was saved as '"), std::string::npos) << error;
    const size_t from = error.find('\'') + 1;
    const std::string saved = error.substr(from, error.find('\'', from) - from);
    EXPECT_EQ(contentOf(saved), "a result");
    fs::remove(saved);
}

TEST_F(FileWrite, AFolderThatIsGoneLosesNothing) {
    fs::create_directory(path("sub"));
    AtomicFile file(path("sub/gone.exr"));
    file.write("a result");
    fs::remove_all(path("sub"));
    const std::string error = errorOf([&] { file.commit(); });
    const size_t from = error.find('\'') + 1;
    const std::string saved = error.substr(from, error.find('\'', from) - from);
    EXPECT_EQ(contentOf(saved), "a result") << error;
    fs::remove(saved);
}

TEST_F(FileWrite, AFullDiskLosesNothing) {
    fs::create_directory(path("small"));
    if (mount("none", path("small").c_str(), "tmpfs", 0, "size=64k") != 0)
        GTEST_SKIP() << "no file system can be mounted here";
    const std::string much(1u << 20, 'x'), file = path("small/full.exr");
    writeFileAtomically(file, "before");
    fs::create_hard_link(file, path("small/second"));
    const std::string told = errorOf([&] { checkFileWritable(file, much.size()); });
    std::vector<std::string> errors;
    for (const std::string& name : {path("small/new.exr"), file}) // replaced, and in place
        errors.push_back(errorOf([&] {
            AtomicFile output(name);
            for (size_t at = 0; at < much.size(); at += 10000)
                output.write(std::string_view(much).substr(at, 10000));
            output.commit();
        }));
    EXPECT_EQ(contentOf(file), "before");
    umount(path("small").c_str());
    EXPECT_NE(told.find("needs 1024 KiB, its disk has "), std::string::npos) << told;
    for (const std::string& error : errors) {
        const size_t from = error.find('\'') + 1;
        const std::string saved = error.substr(from, error.find('\'', from) - from);
        EXPECT_TRUE(contentOf(saved) == much) << error;
        EXPECT_EQ(rightsOf(saved) & 077, 0u);
        fs::remove(saved);
    }
}

TEST_F(FileWrite, FilesThatBelongTogetherTakeTheirNamesTogether) {
    make("a.exr", "before a");
    make("b.exr", "before b");
    AtomicFiles files;
    files.add(path("a.exr"), "after a");
    files.add(path("b.exr"), "after b");
    EXPECT_EQ(contentOf(path("a.exr")), "before a") << "the other was not whole yet";
    files.commit();
    EXPECT_EQ(contentOf(path("a.exr")), "after a");
    EXPECT_EQ(contentOf(path("b.exr")), "after b");
    EXPECT_EQ(folder_.files(), (Names{"a.exr", "b.exr"}));
}

TEST_F(FileWrite, OfFilesThatBelongTogetherTheOthersAreNamedWhereOneCannotBe) {
    AtomicFiles files;
    for (const char* name : {"a.exr", "b.exr", "c.exr"})
        files.add(path(name), name);
    fs::create_directory(path("b.exr")); // meanwhile
    EXPECT_TRUE(contains(errorOf([&] { files.commit(); }), "it was saved as '" + path("b.saved.exr") + "'"));
    EXPECT_EQ(contentOf(path("b.saved.exr")), "b.exr");
    EXPECT_EQ(contentOf(path("c.exr")), "c.exr");
}

TEST_F(FileWrite, AFullDiskKeepsAllFilesThatBelongTogether) {
    fs::create_directory(path("small"));
    if (mount("none", path("small").c_str(), "tmpfs", 0, "size=64k") != 0)
        GTEST_SKIP() << "no file system can be mounted here";
    const std::string little(1000, 'a'), much(1u << 20, 'b');
    for (const char* name : {"small/0.exr", "small/1.exr"})
        make(name, "before");
    AtomicFiles files;
    files.add(path("small/0.exr"), little);
    files.add(path("small/1.exr"), much);
    const std::string error = errorOf([&] { files.commit(); });
    EXPECT_EQ(contentOf(path("small/0.exr")), "before") << "the old pages are a whole lightmap";
    EXPECT_EQ(contentOf(path("small/1.exr")), "before");
    EXPECT_EQ(contentOf(path("small/0.saved.exr")), little);
    umount(path("small").c_str());
    EXPECT_TRUE(contains(error, "small/1.exr: cannot write: No space left on device")) << error;
    const size_t from = error.rfind("', '") + 4;
    const std::string saved = error.substr(from, error.find('\'', from) - from);
    EXPECT_TRUE(contentOf(saved) == much) << error;
    fs::remove(saved);
}

TEST_F(FileWrite, AFullDiskLeavesNothingOfFilesThatCanBeMadeAgain) {
    fs::create_directory(path("small"));
    if (mount("none", path("small").c_str(), "tmpfs", 0, "size=64k") != 0)
        GTEST_SKIP() << "no file system can be mounted here";
    make("small/0.exr", "before");
    std::string error;
    {
        const FolderForFiles place(path("small/new")), old(path("small"));
        AtomicFiles files(OnFailure::Drop);
        files.add(path("small/0.exr"), "after");
        error = errorOf([&] {
            files.add(path("small/new/1.exr"), std::string(1u << 20, 'b'));
            files.commit();
        });
    }
    EXPECT_EQ(contentOf(path("small/0.exr")), "before");
    EXPECT_FALSE(fs::exists(path("small/new")));
    EXPECT_TRUE(fs::exists(path("small")));
    umount(path("small").c_str());
    EXPECT_TRUE(contains(error, "small/new/1.exr: cannot write: No space left on device")) << error;
    EXPECT_FALSE(contains(error, "saved")) << error;
}

TEST_F(FileWrite, AFolderStaysThatIsKeptOrHoldsSomething) {
    for (const bool kept : {false, true}) {
        const std::string folder = path(kept ? "kept" : "full");
        {
            FolderForFiles place(folder);
            if (kept)
                place.keep();
            else
                make("full/file", "content");
        }
        EXPECT_TRUE(fs::exists(folder)) << folder;
    }
    fs::create_directory(path("old"));
    { const FolderForFiles place(path("old")); }
    EXPECT_TRUE(fs::exists(path("old"))) << "it was there before";
}

TEST(SavedName, IsShortEnough) {
    EXPECT_EQ(savedName("f", "a/o.exr", 1), "f/o.saved.exr");
    EXPECT_EQ(savedName("f", "o.exr", 2), "f/o.saved-2.exr");
    EXPECT_LT(savedName("f", std::string(255, 'b') + ".exr", 999).size(), 255u);
    EXPECT_LT(savedName("f", "a." + std::string(255, 'b'), 999).size(), 255u);
}

} // namespace
} // namespace relume
