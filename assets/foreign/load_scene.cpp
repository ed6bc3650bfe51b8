#include "assets/foreign/load_scene.h"

#include "assets/base/error.h"
#include "assets/foreign/foreign_files.h"
#include "assets/foreign/named_files.h"
#include "assets/gltf/file/gltf_links.h"

#include <fmt/format.h>

namespace relume {
namespace {

/// Puts a file's own name where a message has that of its conversion.
std::string renamed(const std::string& message, const std::string& from, const std::string& to) {
    return message.starts_with(from + ":") ? to + message.substr(from.size()) : message;
}

} // namespace

Scene loadScene(const std::string& path, const GltfChoice& choice) {
    return isForeign(path) ? loadImported(path, importForeign(path), choice) : loadGltf(path, choice);
}

Scene loadImported(const std::string& path, const ImportedFile& file, const GltfChoice& choice) {
    try {
        Scene scene = loadGltf(file.path(), choice);
        scene.path = path;
        for (std::string& warning : scene.warnings)
            warning = renamed(warning, file.path(), path);
        scene.warnings.insert(scene.warnings.begin(), file.warnings().begin(), file.warnings().end());
        return scene;
    } catch (const Error& error) {
        throw Error(renamed(error.what(), file.path(), path));
    }
}

std::vector<std::string> filesOfScene(const std::string& path) {
    return isForeign(path) ? namedFiles(path) : linkedFiles(path);
}

void requireSavable(const std::string& source, const std::string& target) {
    const std::string ending = lowerEnding(target);
    if (!isForeign(source) || ending == ".glb") return;
    throw Error(fmt::format("{}: edits of a {} file cannot be saved into one: name a .glb, or make one with "
                            "'relume import {} -o OUT.glb'",
                            target, lowerEnding(source), source));
}

EditedNodes saveEditedScene(const std::string& source, const Scene& before, const Scene& after,
                            const std::string& target) {
    requireSavable(source, target);
    if (!isForeign(source)) return saveEditedGltf(source, before, after, target);
    const ImportedFile file = importForeign(source);
    try {
        return saveEditedGltf(file.path(), before, after, target);
    } catch (const Error& error) {
        throw Error(renamed(error.what(), file.path(), source));
    }
}

} // namespace relume
