#include "assets/base/write_plan.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <tuple>

namespace relume {
namespace {

using Kind = WriteTarget::Kind;

WriteTarget regularFile() {
    WriteTarget target;
    target.path = "out/o.exr";
    target.folder = "out";
    target.kind = Kind::Regular;
    target.user = target.owner = target.folderOwner = 1000;
    return target;
}

WriteWay wayOf(const WriteTarget& target) {
    const WritePlan plan = planWrite(target);
    EXPECT_EQ(plan.way == WriteWay::Refuse, !plan.problem.empty());
    return plan.way;
}

void expectProblem(const WriteTarget& target, const std::string& words) {
    const WritePlan plan = planWrite(target);
    EXPECT_EQ(plan.way, WriteWay::Refuse);
    EXPECT_NE(plan.problem.find(words), std::string::npos) << plan.problem;
}

TEST(WritePlan, ReplacesAPlainFileAndMakesOneThatIsMissing) {
    WriteTarget target = regularFile();
    EXPECT_EQ(wayOf(target), WriteWay::Replace);
    target.kind = Kind::Missing;
    EXPECT_EQ(wayOf(target), WriteWay::Replace);
}

TEST(WritePlan, KeepsAFileThatHasOtherNamesOrIsAMount) {
    WriteTarget target = regularFile();
    target.links = 2;
    EXPECT_EQ(wayOf(target), WriteWay::InPlace);
    target = regularFile();
    target.mounted = true;
    EXPECT_EQ(wayOf(target), WriteWay::InPlace);
}

TEST(WritePlan, KeepsAFileInAFolderThatTakesNoNewOnes) {
    for (const int error : {EACCES, EPERM, EROFS}) {
        WriteTarget target = regularFile();
        target.folderError = error;
        EXPECT_EQ(wayOf(target), WriteWay::InPlace);
        target.kind = Kind::Missing;
        EXPECT_EQ(wayOf(target), WriteWay::Refuse);
    }
    WriteTarget target = regularFile();
    target.folderKeeps = true;
    EXPECT_EQ(wayOf(target), WriteWay::InPlace);
    target.kind = Kind::Missing;
    expectProblem(target, "append-only");
}

TEST(WritePlan, InAStickyFolderOnlyOwnersAndRootReplace) {
    // Each entry has the user, the file's owner, the folder's owner and the way.
    for (const auto& [user, owner, folderOwner, way] :
         {std::tuple{1000u, 1000u, 0u, WriteWay::Replace}, std::tuple{1000u, 1u, 1000u, WriteWay::Replace},
          std::tuple{0u, 1u, 2u, WriteWay::Replace}, std::tuple{1000u, 1u, 0u, WriteWay::InPlace}}) {
        WriteTarget target = regularFile();
        target.sticky = true;
        target.user = user;
        target.owner = owner;
        target.folderOwner = folderOwner;
        EXPECT_EQ(wayOf(target), way) << user << " " << owner << " " << folderOwner;
    }
}

TEST(WritePlan, RefusesWhatMayNotBeWritten) {
    WriteTarget target = regularFile();
    target.immutable = true;
    expectProblem(target, "chattr -ia");
    target = regularFile();
    target.writeError = EACCES;
    expectProblem(target, "Permission denied: change its rights");
    target.kind = Kind::Stream;
    expectProblem(target, "Permission denied: change its rights");
    target = regularFile();
    target.kind = Kind::Folder;
    expectProblem(target, "is a folder: name a file in it");
    target.kind = Kind::Socket;
    expectProblem(target, "is a socket");
}

TEST(WritePlan, OpensDevicesAndFifos) {
    WriteTarget target = regularFile();
    target.kind = Kind::Stream;
    target.folderError = EACCES; // nothing is made beside it
    EXPECT_EQ(wayOf(target), WriteWay::Stream);
}

TEST(WritePlan, NamesWhatIsWrongWithTheFolder) {
    WriteTarget target = regularFile();
    target.kind = Kind::Missing;
    target.folderExists = false;
    expectProblem(target, "folder 'out' does not exist");
    target.folderExists = true;
    target.folderIsFolder = false;
    expectProblem(target, "'out' is not a folder");
    target = regularFile();
    target.folderError = ENOSPC;
    expectProblem(target, "free some space");
}

TEST(WritePlan, NamesANameThatIsTooLong) {
    WriteTarget target = regularFile();
    target.error = ENAMETOOLONG;
    expectProblem(target, "choose a shorter one");
    expectProblem(lookAtTarget("/tmp/" + std::string(256, 'b')), "choose a shorter one");
    expectProblem(lookAtTarget("/tmp" + std::string(5000, '/') + "x"), "choose a shorter one");
    EXPECT_EQ(wayOf(lookAtTarget("/tmp/" + std::string(255, 'b'))), WriteWay::Replace);
}

TEST(WritePlan, TellsLackOfSpaceInFiguresThatDiffer) {
    EXPECT_EQ(lackOfSpace((1u << 20) + 1, 1u << 20), "needs 1025 KiB, its disk has 1024 KiB left");
    EXPECT_EQ(lackOfSpace(1, 0), "needs 1 KiB, its disk has 0 KiB left");
    EXPECT_EQ(lackOfSpace(100u << 20, (100u << 20) - 1), "needs 100 MiB, its disk has 99 MiB left");
    EXPECT_EQ(lackOfSpace((100u << 20) + 1, 100u << 20), "needs 101 MiB, its disk has 100 MiB left");
}

} // namespace
} // namespace relume
