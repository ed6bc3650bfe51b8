#pragma once

#include <filesystem>
#include <string>

namespace relume {

/// A folder that goes with all that is in it. Where its process is killed, it goes when the next one of its
/// kind is made: a lock, which the system drops with the process, tells which of them are still in use.
class PassingFolder {
public:
    /// Makes a folder in `parent` whose name begins with `prefix`, and removes what killed processes of this
    /// user left there under such names. Throws Error where none can be made.
    PassingFolder(const std::filesystem::path& parent, const std::string& prefix);
    ~PassingFolder();
    PassingFolder(const PassingFolder&) = delete;
    PassingFolder& operator=(const PassingFolder&) = delete;
    std::string file(const std::string& name) const { return path_ + "/" + name; }
    const std::string& path() const { return path_; }

private:
    std::string path_;
    int lock_ = -1; // file descriptor of the folder
};

} // namespace relume
