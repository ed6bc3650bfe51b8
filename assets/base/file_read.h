#pragma once

#include <cstdint>
#include <string>

namespace relume {

/// Tells what a path names that is there but no regular file: "is a folder", "is no regular file". Returns ""
/// for a regular file, for a link to one, and where there is nothing. Opens nothing.
std::string oddKindOf(const std::string& path);

/// Throws Error where the path names something other than a regular file: reading a pipe would wait for its
/// writer, and a device may never end. `mend` is what the user should do.
void refuseOddKind(const std::string& path, const std::string& mend);

/// Holds a regular file open to be read from its beginning to its end.
class RegularFile {
public:
    /// Throws Error where the path names nothing, something else (see refuseOddKind) or what may not be read.
    RegularFile(const std::string& path, const std::string& mend);
    ~RegularFile();
    RegularFile(const RegularFile&) = delete;
    RegularFile& operator=(const RegularFile&) = delete;

    uint64_t size() const { return size_; } // [bytes], as it was when it was opened
    /// Reads the next bytes. Throws Error where there are fewer.
    void read(void* to, uint64_t bytes);

private:
    std::string path_;
    int descriptor_ = -1;
    uint64_t size_ = 0;
};

} // namespace relume
