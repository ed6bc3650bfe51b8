#pragma once

#include <string>

namespace relume {

/// A new folder in the system's temporary one, which goes with all that is in it.
class PassingFolder {
public:
    /// The folder's name begins with `name`. Throws Error where it cannot be made.
    explicit PassingFolder(const std::string& name);
    ~PassingFolder();
    PassingFolder(const PassingFolder&) = delete;
    PassingFolder& operator=(const PassingFolder&) = delete;

    /// Returns the path of a file in it.
    std::string file(const std::string& name) const { return path_ + "/" + name; }

private:
    std::string path_;
};

} // namespace relume
