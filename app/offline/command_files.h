#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace relume {

/// Which file a path names, whatever way leads there: links, "./" and a second name make no difference.
struct FileIdentity {
    bool device = false;           // a character device like /dev/null: it takes what comes from everyone
    uint64_t disk = 0, number = 0; // st_dev and st_ino of the file, or of its folder if it does not exist yet
    std::string name;              // of a file that does not exist yet, else ""
    bool operator==(const FileIdentity&) const = default;
};

/// Returns the identity of a path's file, or nothing where not even the folder is there.
std::optional<FileIdentity> identityOf(const std::string& path);

/// The files that a command reads and writes. They are told before it does either.
class CommandFiles {
public:
    /// Adds a file that is read. `option` is as users type it, or what the help calls an argument: "--json",
    /// "SCENE". A path that is "" or "-" is no file.
    CommandFiles& reads(const std::string& option, const std::string& path);
    /// Adds a scene that is read, with the files that belong to it (filesOfScene()).
    CommandFiles& readsScene(const std::string& option, const std::string& path);
    /// Adds a lightmap that is read, with the files of its pages (filesOfLightmap()).
    CommandFiles& readsLightmap(const std::string& option, const std::string& path);
    CommandFiles& writes(const std::string& option, const std::string& path);
    /// Adds a lightmap that is written: one file, or where `pages` is 0 or more than 1 those of its pages, 0
    /// for a number that is not known yet.
    CommandFiles& writesLightmap(const std::string& option, const std::string& path, uint32_t pages);
    /// Adds a folder in which frames are replaced.
    CommandFiles& writesFrames(const std::string& option, const std::string& folder);
    /// Says that `output` may write the file that `input` reads.
    CommandFiles& mayBe(const std::string& output, const std::string& input);

    /// Tells in one line what is written twice, or read and overwritten; "" when there is nothing.
    std::string clash() const;
    /// Throws UsageError when there is such a clash.
    void check() const;

private:
    enum class Use { Read, Linked, Written, Frames };
    struct File {
        Use use{};
        std::string option, path;
        std::optional<FileIdentity> identity;
        std::optional<FileIdentity> folder; // the one that a Read or Linked file is in
    };
    CommandFiles& add(Use use, const std::string& option, const std::string& path);
    bool clashes(const File& written, const File& other) const;

    std::vector<File> files_;
    std::vector<std::pair<std::string, std::string>> allowed_;
};

} // namespace relume
