#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace relume {

/// A file that is written piece by piece, unseen, and takes its name when it is whole: until then, and if
/// anything fails, `path` holds what it held before. A symbolic link is followed. Where the file system can
/// have files without a name, not even a killed process leaves one behind.
class AtomicFile {
public:
    explicit AtomicFile(const std::string& path); // throws Error, as all of these
    ~AtomicFile();                                // drops what was not committed
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    void write(std::string_view bytes);
    /// Flushes to the disk and gives the file its name.
    void commit();

private:
    void giveTemporaryName();

    std::string path_, target_, folder_, temporary_; // temporary_ "": it has no name yet
    int descriptor_ = -1;
};

/// The same in one go. Throws Error, leaving no temporary file.
void writeFileAtomically(const std::string& path, std::string_view bytes);

/// Throws Error where writing `path` is sure to fail: its folder is missing or unwritable, it is a folder
/// itself, or there is no space for `bytes`. Changes nothing.
void checkFileWritable(const std::string& path, uint64_t bytes);

} // namespace relume
