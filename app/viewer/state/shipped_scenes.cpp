#include "app/viewer/state/shipped_scenes.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace relume {
namespace {

namespace fs = std::filesystem;

// Returns where a scene's small picture is: it may be nowhere.
std::string pictureOf(const fs::path& scene) {
    std::error_code code;
    const fs::path beside = fs::path(scene).replace_extension(".png");
    if (fs::is_regular_file(beside, code)) return beside.string();
    return (scene.parent_path().parent_path() / "pictures/scenes" / beside.filename()).string();
}

bool isFolderOfScenes(const fs::path& path) {
    std::error_code code;
    return fs::is_directory(path, code);
}

} // namespace

std::string programPath() {
    std::error_code code;
    const fs::path path = fs::read_symlink("/proc/self/exe", code);
    return code ? "" : path.string();
}

std::string shippedFolder(const std::string& program, const std::string& source) {
    const fs::path bin = fs::path(program).parent_path();
    if (!bin.empty()) {
        const fs::path installed = bin.parent_path() / "share/relume/scenes";
        if (isFolderOfScenes(installed)) return installed.string();
        // Far more than build folders lie below their sources.
        constexpr int kMostAbove = 5;
        fs::path above = bin;
        for (int i = 0; i < kMostAbove && above.has_relative_path(); ++i) {
            above = above.parent_path();
            if (isFolderOfScenes(above / "assets/scenes")) return (above / "assets/scenes").string();
        }
    }
    const fs::path built = fs::path(source) / "assets/scenes";
    return !source.empty() && isFolderOfScenes(built) ? built.string() : "";
}

std::vector<ShippedScene> shippedScenes(const std::string& folder) {
    std::vector<ShippedScene> scenes;
    if (folder.empty()) return scenes;
    std::error_code code;
    for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code)) {
        const fs::path& path = at->path();
        if (path.extension() == ".glb")
            scenes.push_back({path.stem().string(), path.string(), pictureOf(path)});
    }
    std::sort(scenes.begin(), scenes.end(),
              [](const ShippedScene& a, const ShippedScene& b) { return a.name < b.name; });
    return scenes;
}

} // namespace relume
