#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace relume {

/// Which file a path names, whatever way leads there: links, "./" and a second name are the same.
struct FileIdentity {
    bool device = false;           // a character device, as /dev/null: it takes what comes from everyone
    uint64_t disk = 0, number = 0; // st_dev and st_ino: of the file, of what does not exist yet of its folder
    std::string name;              // of what does not exist yet, else ""
    bool operator==(const FileIdentity&) const = default;
};

/// Nothing where not even the folder is there.
std::optional<FileIdentity> identityOf(const std::string& path);

/// The files that a command reads and writes, told before it does either.
class CommandFiles {
public:
    /// `option`: as users type it, or what the help calls an argument: "--json", "SCENE". A path that is ""
    /// or "-" is none.
    CommandFiles& reads(const std::string& option, const std::string& path);
    /// A scene, with the files that belong to it.
    CommandFiles& readsScene(const std::string& option, const std::string& path);
    CommandFiles& writes(const std::string& option, const std::string& path);
    /// A folder in which frames are replaced.
    CommandFiles& writesFrames(const std::string& option, const std::string& folder);
    /// The one may be the file that the other reads.
    CommandFiles& mayBe(const std::string& output, const std::string& input);

    /// Tells what is written twice, or read and overwritten: one line, "" when there is nothing.
    std::string clash() const;
    /// Throws UsageError when there is something.
    void check() const;

private:
    enum class Use { Read, Linked, Written, Frames };
    struct File {
        Use use{};
        std::string option, path;
        std::optional<FileIdentity> identity;
        std::optional<FileIdentity> folder; // of Read and Linked: that it is in
    };
    CommandFiles& add(Use use, const std::string& option, const std::string& path);
    bool clashes(const File& written, const File& other) const;

    std::vector<File> files_;
    std::vector<std::pair<std::string, std::string>> allowed_;
};

} // namespace relume
