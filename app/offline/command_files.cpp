#include "app/offline/command_files.h"

#include "app/text/frame_names.h"
#include "assets/base/error.h"
#include "assets/base/write_plan.h"
#include "assets/foreign/load_scene.h"
#include "assets/images/paged_image.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <sys/stat.h>

namespace relume {
namespace {

std::string folderOfFile(const std::string& path) {
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    return folder.empty() ? "." : folder.string();
}

} // namespace

std::optional<FileIdentity> identityOf(const std::string& path) {
    struct stat facts {};
    if (stat(path.c_str(), &facts) == 0)
        return FileIdentity{S_ISCHR(facts.st_mode), facts.st_dev, facts.st_ino, ""};
    const std::string real = whereLinksLead(path);
    if (stat(folderOfFile(real).c_str(), &facts) != 0) return {};
    return FileIdentity{false, facts.st_dev, facts.st_ino, std::filesystem::path(real).filename().string()};
}

CommandFiles& CommandFiles::add(Use use, const std::string& option, const std::string& path) {
    if (path.empty() || path == "-") return *this;
    File file{use, option, path, identityOf(path), {}};
    if (use == Use::Read || use == Use::Linked) file.folder = identityOf(folderOfFile(path));
    files_.push_back(std::move(file));
    return *this;
}

CommandFiles& CommandFiles::reads(const std::string& option, const std::string& path) {
    return add(Use::Read, option, path);
}

CommandFiles& CommandFiles::readsScene(const std::string& option, const std::string& path) {
    add(Use::Read, option, path);
    for (const std::string& linked : filesOfScene(path))
        add(Use::Linked, option, linked);
    return *this;
}

CommandFiles& CommandFiles::readsLightmap(const std::string& option, const std::string& path) {
    add(Use::Read, option, path);
    for (const std::string& file : filesOfLightmap(path))
        if (file != path) add(Use::Read, option, file);
    return *this;
}

CommandFiles& CommandFiles::writesLightmap(const std::string& option, const std::string& path,
                                           uint32_t pages) {
    add(Use::Written, option, path);
    if (path.empty() || pages == 1) return *this;
    for (const std::string& file : lightmapFiles(path, {pages == 0 ? kMostPages : pages}))
        add(Use::Written, option, file);
    return *this;
}

CommandFiles& CommandFiles::writes(const std::string& option, const std::string& path) {
    return add(Use::Written, option, path);
}

CommandFiles& CommandFiles::writesFrames(const std::string& option, const std::string& folder) {
    return add(Use::Frames, option, folder);
}

CommandFiles& CommandFiles::mayBe(const std::string& output, const std::string& input) {
    allowed_.emplace_back(output, input);
    return *this;
}

bool CommandFiles::clashes(const File& written, const File& other) const {
    if (!written.identity || !other.identity) return false;
    if (written.use == Use::Frames)
        return other.folder && other.folder == written.identity &&
               isFrameName(std::filesystem::path(other.path).filename().string());
    if (written.identity != other.identity || written.identity->device) return false;
    const std::pair pair(written.option, other.option);
    return other.use == Use::Linked || std::find(allowed_.begin(), allowed_.end(), pair) == allowed_.end();
}

std::string CommandFiles::clash() const {
    for (const File& written : files_) {
        if (written.use != Use::Written && written.use != Use::Frames) continue;
        for (const File& other : files_) {
            if (&other == &written || !clashes(written, other)) continue;
            const std::string name = other.path == written.path || written.use == Use::Frames
                                         ? fmt::format("'{}'", other.path)
                                         : fmt::format("'{}', which is '{}'", written.path, other.path);
            if (other.use == Use::Linked)
                return fmt::format("{} would replace {}, a file of {}: give {} another name", written.option,
                                   name, other.option, written.option);
            if (other.use == Use::Read)
                return fmt::format("{} would replace {}, which {} names: give {} another name",
                                   written.option, name, other.option, written.option);
            return fmt::format("{} and {} are one file, {}: give one of them another name", written.option,
                               other.option, name);
        }
    }
    return "";
}

void CommandFiles::check() const {
    if (const std::string problem = clash(); !problem.empty()) throw UsageError(problem);
}

} // namespace relume
