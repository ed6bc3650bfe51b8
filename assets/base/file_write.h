#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "assets/base/spool.h"
#include "assets/base/write_plan.h"

namespace relume {

/// Says what becomes of content that is whole and cannot get its name, because a disk is full or rights have
/// changed.
enum class OnFailure {
    Drop, // there is more where that came from
    Keep, // it is saved under another name, beside it or in the system's temporary folder, which the Error
          // tells
};

/// Writes a file piece by piece, unseen; it takes its name when it is whole: until then, and if anything
/// fails, `path` holds what it held before. A symbolic link is followed, and what is replaced hands down its
/// rights, and its owner and group where the user may give them.
///
/// A file with several names, one on which another file system's is mounted, and one whose folder the user
/// may not change, stays and gets its new content in place, once that is whole and the disk has room for it:
/// only a machine that fails meanwhile leaves half of it. A device or a FIFO is opened and written at the
/// end.
class AtomicFile {
public:
    explicit AtomicFile(const std::string& path,
                        OnFailure onFailure = OnFailure::Keep); // throws Error, as all
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(std::string_view bytes);
    /// Returns the descriptor of what is written so far, for another program to write to.
    int descriptor() const { return spool_.descriptor(); }
    /// Flushes to the disk and gives the file its name.
    void commit();
    /// Flushes to the disk and gives the file the first name of those that `nextName` tells, one per call,
    /// that nothing has, in the folder of `path`: of two programs that would take one name, both keep their
    /// files. Returns it.
    std::string commitAnew(const std::function<std::string()>& nextName);

    /// Does of commit() what can still fail and changes nothing: flushes to the disk. Returns errno, or 0.
    int flush() const;
    /// Gives what is written another name, as where commit() fails, and returns it, or "" where that fails,
    /// too. There is nothing to commit then.
    std::string saveElsewhere();

private:
    bool takeRefuge(std::string_view rest);
    void keepRights() const;
    int takeName();
    void flushFolder() const;
    int overwrite() const;
    int pour() const;
    [[noreturn]] void fail(int error);

    WriteTarget target_;
    WriteWay way_ = WriteWay::Refuse;
    OnFailure onFailure_;
    std::string problem_; // of Refuse
    Spool spool_;
    int noRoom_ = 0; // errno of the folder in which the content was to wait, when it waits in another one
};

/// Writes a file as AtomicFile does, in one go. Throws Error, leaving no temporary file.
void writeFileAtomically(const std::string& path, std::string_view bytes,
                         OnFailure onFailure = OnFailure::Keep);

/// Writes files that belong together, each as AtomicFile does: none takes its name before all are whole and
/// on the disk. Where one does not fit, all keep what they held, and the new content of all is dropped or
/// kept beside them, as of one file.
class AtomicFiles {
public:
    explicit AtomicFiles(OnFailure onFailure = OnFailure::Keep) : onFailure_(onFailure) {}

    /// Takes the content of one more file. Throws Error, after which there is nothing to commit.
    void add(const std::string& path, std::string_view bytes);
    /// Gives all files their names. Throws Error.
    void commit();

private:
    struct File {
        std::string path;
        std::unique_ptr<AtomicFile> content;
    };
    OnFailure onFailure_;
    std::vector<File> files_;
};

/// Throws Error where writing `path` is sure to fail (see planWrite()), or where there is no space for
/// `bytes`. Changes nothing.
void checkFileWritable(const std::string& path, uint64_t bytes);

/// Throws Error where no files can be written into a folder, or it is missing and cannot be made, its parent
/// being there. Returns whether it is there. Changes nothing.
bool checkFolderWritable(const std::string& folder);

/// Makes a folder where it is missing; its parent is there. Throws Error. Returns whether it was missing.
bool makeFolder(const std::string& folder);

/// Makes a folder for files that are written whole or not at all: unless keep() is called, one that was
/// missing goes again with this, if it is empty.
class FolderForFiles {
public:
    explicit FolderForFiles(std::string folder); // throws Error
    ~FolderForFiles();
    FolderForFiles(const FolderForFiles&) = delete;
    FolderForFiles& operator=(const FolderForFiles&) = delete;
    void keep() { isNew_ = false; }

private:
    std::string folder_;
    bool isNew_;
};

/// Returns the name under which a result that cannot be written to `path` is kept in `folder`: "o.saved.exr",
/// from number 2 on "o.saved-2.exr".
std::string savedName(const std::string& folder, const std::string& path, uint32_t number);

} // namespace relume
