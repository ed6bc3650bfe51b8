#include "app/viewer/shell/viewer.h"

#include "app/edit/scene_edit.h"
#include "app/offline/command_files.h"
#include "assets/base/warnings.h"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

std::string absolutePath(const std::string& path) {
    std::error_code code;
    const fs::path whole = fs::absolute(path, code);
    return code ? path : whole.lexically_normal().string();
}

} // namespace

std::string Viewer::scenePath() const {
    const std::string path = session_->path();
    return path.empty() ? "" : absolutePath(path);
}

void Viewer::performFile(Action action) {
    if (action == Action::Watch) return session_->watchFile(!session_->watchesFile());
    const std::string path = scenePath();
    if (action == Action::Open) {
        const std::string folder = path.empty() ? "" : fs::path(path).parent_path().string() + "/";
        ui_.files().open({.title = "Open scene",
                          .path = folder,
                          .endings = {".glb", ".gltf"},
                          .recent = preferences_.recent,
                          .done = [this](const std::string& chosen) { open(chosen); }});
        return;
    }
    if (path.empty()) return note("there is no scene to write anything of", true);
    const fs::path scene(path);
    if (action == Action::Save) return save("");
    if (action == Action::SaveAs) {
        std::string name = (scene.parent_path() / scene.stem()).string();
        if (!name.ends_with("_edited")) name += "_edited";
        ui_.files().open({.title = "Save scene",
                          .path = freePath(name + scene.extension().string()),
                          .endings = {scene.extension().string()},
                          .recent = {},
                          .saves = true,
                          .done = [this](const std::string& chosen) { save(chosen); }});
        return;
    }
    ui_.files().open({.title = "Export lightmap",
                      .path = freePath((scene.parent_path() / scene.stem()).string() + "_lightmap.exr"),
                      .endings = {".exr", ".png"},
                      .recent = {},
                      .saves = true,
                      .done = [this](const std::string& chosen) { exportLightmap(chosen); }});
}

void Viewer::open(const std::string& path) {
    pacer_.input();
    unlessUnsaved("open", [this, path] { session_->open(path); });
}

void Viewer::exportLightmap(const std::string& path) {
    tell("export", path);
    if (!path.ends_with(".exr") && !path.ends_with(".png"))
        return note(path + ": a lightmap ends in .exr or .png", true);
    const std::string problem =
        CommandFiles().readsScene("the scene", session_->path()).writes("the lightmap", path).clash();
    if (!problem.empty()) return note(problem, true);
    bake_->exportLightmap(
        {.path = path, .lightmap = session_->document().lightmap, .scene = session_->path()});
    note("writing " + path);
}

void Viewer::save(const std::string& path) {
    endEdit();
    tell("save", path.empty() ? session_->path() : path);
    const std::string problem = CommandFiles()
                                    .readsScene("the scene", session_->path())
                                    .writes("the saved scene", path)
                                    .mayBe("the saved scene", "the scene")
                                    .clash();
    if (!problem.empty()) return note(problem, true);
    session_->save(path);
    pacer_.input();
}

// Asks before edits are lost.
void Viewer::unlessUnsaved(const std::string& what, const std::function<void()>& go) {
    if (!session_->dirty()) return go();
    const std::string text =
        fmt::format("{} has edits that are not saved.", fs::path(session_->path()).filename().string());
    tell("ask", text);
    const auto saveFirst = [this, go] {
        save("");
        afterSave_ = go;
    };
    ui_.question().ask(text, {{"Save and " + what + " (Enter)", GLFW_KEY_ENTER, saveFirst},
                              {"Do not save (D)", GLFW_KEY_D, go},
                              {"Cancel (Esc)", GLFW_KEY_ESCAPE}});
    keys_.clear(); // their releases go to the question
    pacer_.input();
}

void Viewer::quit() {
    unlessUnsaved("quit", [this] {
        quitting_ = true;
        window_.close();
    });
}

bool Viewer::closes() {
    if (!window_.closing()) return false;
    if (quitting_ || !session_->dirty()) return true;
    window_.keepOpen(); // it was closed by other means than our own, which is a question all the same
    quit();
    return false;
}

// Gives the bookmarks to the file that the scene was saved as.
void Viewer::followSavedPath() {
    const std::string path = scenePath();
    const auto known = preferences_.bookmarks.find(path_);
    if (path != path_ && known != preferences_.bookmarks.end()) {
        const std::vector<Bookmark> marks = known->second;
        preferences_.bookmarks.try_emplace(path, marks);
    }
    path_ = path;
}

// Follows the scene's file: the title tells what is not saved, and what waited for a save goes on.
void Viewer::followFile() {
    if (session_->saves() != saves_) {
        saves_ = session_->saves();
        followSavedPath();
        preferences_.addRecent(session_->path());
        tell("saved", session_->path());
        const std::string unsaved = unsavedPart(session_->document().edits);
        note("saved " + session_->path() + (unsaved.empty() ? "" : ": " + unsaved));
    }
    if (afterSave_ && !session_->saving()) {
        const std::function<void()> go = std::exchange(afterSave_, {});
        if (!session_->dirty()) go(); // else the save went wrong, which a message has told
    }
    if (session_->scene() == nullptr) return;
    const std::string title =
        fs::path(session_->path()).filename().string() + (session_->dirty() ? "*" : "") + " - Relume";
    if (title == title_) return;
    title_ = title;
    window_.setTitle(title);
    tell("title", title);
}

} // namespace relume
