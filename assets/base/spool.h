#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace relume {

/// Holds a file where content waits, unseen, until it is whole; move-only. Where the file system can have
/// files without a name, not even a killed process leaves one behind. Functions return errno, or 0 for
/// success.
class Spool {
public:
    Spool() = default; // none
    /// Makes a new file in a folder. error() tells whether there is one.
    Spool(const std::string& folder, uint32_t mode);
    /// Makes one in memory, for where no folder can hold it. It cannot be given a name.
    static Spool inMemory();
    ~Spool();
    Spool(Spool&& other) noexcept;
    Spool& operator=(Spool&& other) noexcept;

    int error() const { return error_; }
    int descriptor() const { return descriptor_; }        // to read and write
    const std::string& folder() const { return folder_; } // "" in memory

    int write(std::string_view bytes);
    /// Appends what this one holds to a file that is open.
    int copyTo(int descriptor) const;
    /// Flushes the content to the disk.
    int flush() const;
    /// Takes a name in its folder's file system that nothing has; else returns EEXIST.
    int take(const std::string& name);
    /// Takes a name, also from whatever has it.
    int replace(const std::string& name);

private:
    int giveTemporaryName();

    std::string folder_, temporary_; // temporary_ "": it has no name
    int descriptor_ = -1;
    int error_ = 0;
};

/// Writes all bytes to an open file. Returns errno, or 0 for success.
int writeAll(int descriptor, std::string_view bytes);

} // namespace relume
