#include "app/viewer/shell/scene_files.h"

#include "app/offline/command_files.h"
#include "app/viewer/edits/light_actions.h"
#include "assets/base/warnings.h"
#include "assets/foreign/foreign_files.h"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace relume {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> sceneEndings() {
    std::vector<std::string> endings = {".glb", ".gltf"};
    endings.insert(endings.end(), foreignEndings().begin(), foreignEndings().end());
    return endings;
}

std::string fileName(const std::string& path) {
    return fs::path(path).filename().string();
}

} // namespace

std::string SceneFiles::path() const {
    const std::string path = desc_.session.path();
    return path.empty() ? "" : absolutePath(path);
}

std::string SceneFiles::folder() const {
    const std::string scene = path();
    return scene.empty() ? "" : fs::path(scene).parent_path().string() + "/";
}

void SceneFiles::perform(Action action, int argument) {
    switch (action) {
    case Action::StartPage:
        return opening_.wantStart();
    case Action::Watch:
        return desc_.session.watchFile(!desc_.session.watchesFile());
    case Action::Quit:
        return leave({});
    case Action::Open:
        return desc_.dialog.open({.title = "Open scene",
                                  .path = folder(),
                                  .endings = sceneEndings(),
                                  .recent = desc_.preferences.values().recent,
                                  .done = [this](const std::string& chosen) { open(chosen); }});
    default:
        break;
    }
    if (path().empty()) return desc_.feedback.note("there is no scene to write anything of", true);
    if (action == Action::Save && !isForeign(path())) return save("");
    if (action == Action::Save) return askToSaveAs(); // a file that was converted is not written
    if (action == Action::SaveAs) return askToSaveAs();
    if (action == Action::ExportFor) return askToExportFor(static_cast<Engine>(argument));
    if (action == Action::ExportPage) return askToExportPage();
    askToExport();
}

void SceneFiles::askToSaveAs() {
    const fs::path scene(path());
    const std::string ending = isForeign(path()) ? ".glb" : scene.extension().string();
    std::string name = (scene.parent_path() / scene.stem()).string();
    if (!name.ends_with("_edited")) name += "_edited";
    desc_.dialog.open({.title = "Save scene",
                       .path = freePath(name + ending),
                       .endings = {ending},
                       .recent = {},
                       .saves = true,
                       .done = [this](const std::string& chosen) { save(chosen); }});
}

void SceneFiles::askToExport() {
    const fs::path scene(path());
    const std::string name = (scene.parent_path() / scene.stem()).string() + "_lightmap.exr";
    desc_.dialog.open({.title = "Export lightmap",
                       .path = freePath(name),
                       .endings = {".exr", ".png"},
                       .recent = {},
                       .saves = true,
                       .done = [this](const std::string& chosen) { exportLightmap(chosen); }});
}

void SceneFiles::askToExportFor(Engine engine) {
    const fs::path scene(path());
    const std::string name = engineNames()[static_cast<size_t>(engine)];
    desc_.dialog.open({.title = "Export for " + name + " into a folder",
                       .path = freePath((scene.parent_path() / scene.stem()).string() + "_" + name),
                       .endings = {},
                       .recent = {},
                       .saves = true,
                       .folder = true,
                       .done = [this, engine](const std::string& chosen) {
                           exportForEngine(
                               {.engine = engine, .folder = chosen, .exposure = desc_.exposure()});
                       }});
}

void SceneFiles::askToExportPage() {
    const fs::path scene(path());
    desc_.dialog.open({.title = "Export a web page into a folder",
                       .path = freePath((scene.parent_path() / scene.stem()).string() + "_page"),
                       .endings = {},
                       .recent = {},
                       .saves = true,
                       .folder = true,
                       .done = [this](const std::string& chosen) {
                           exportPage(
                               {.path = chosen, .single = false, .exposure = desc_.exposure(), .frames = {}});
                       }});
}

void SceneFiles::open(const std::string& path) {
    desc_.feedback.pacer().input();
    leave({.scene = path});
}

void SceneFiles::choose(const GltfChoice& choice) {
    if (choice == desc_.session.choice()) return;
    desc_.feedback.tell("choose", choice.scene + ", " + choice.variant);
    leave({.scene = desc_.session.path(), .choice = choice});
}

void SceneFiles::forget(const std::string& path) {
    std::erase(desc_.preferences.values().recent, path);
    desc_.preferences.save();
    desc_.feedback.tell("forgot", path);
    desc_.feedback.pacer().input();
}

void SceneFiles::exportLightmap(const std::string& path) {
    Session& session = desc_.session;
    desc_.feedback.tell("export", path);
    if (!path.ends_with(".exr") && !path.ends_with(".png"))
        return desc_.feedback.note(path + ": a lightmap ends in .exr or .png", true);
    const std::string problem =
        CommandFiles().readsScene("the scene", session.path()).writes("the lightmap", path).clash();
    if (!problem.empty()) return desc_.feedback.note(problem, true);
    session.bake().exportLightmap({.path = path,
                                   .lightmap = session.document().lightmap,
                                   .scene = session.path(),
                                   .surfaces = session.surfaces()});
    desc_.feedback.note("writing " + path);
}

void SceneFiles::exportForEngine(const ExportDesc& desc) {
    BakeOrders::EngineExport wanted;
    wanted.desc = desc;
    write(exportedFiles(desc), std::move(wanted));
}

void SceneFiles::exportPage(const WebDesc& desc) {
    BakeOrders::EngineExport wanted;
    wanted.web = desc;
    write(webFiles(desc), std::move(wanted));
}

// Orders what is written of the level as it is shown.
void SceneFiles::write(const std::vector<std::string>& paths, BakeOrders::EngineExport wanted) {
    Session& session = desc_.session;
    const std::string folder = wanted.path();
    desc_.feedback.tell("export", folder);
    CommandFiles files;
    files.readsScene("the scene", session.path());
    for (const std::string& path : paths)
        files.writes("the export", path);
    if (const std::string problem = files.clash(); !problem.empty())
        return desc_.feedback.note(problem, true);
    LightList lights;
    lights.update(session.scene(), session);
    ShiningScene shown = shiningScene(session.document(), lights.sources(), {}, {});
    wanted.scene = session.path();
    wanted.surfaces = session.surfaces();
    wanted.materials = std::move(shown.materials);
    wanted.sky = shown.sky.radiance;
    session.bake().exportForEngine(std::move(wanted));
    desc_.feedback.note("writing " + folder);
}

void SceneFiles::save(const std::string& path) {
    desc_.editing.end();
    desc_.feedback.tell("save", path.empty() ? desc_.session.path() : path);
    const std::string problem = CommandFiles()
                                    .readsScene("the scene", desc_.session.path())
                                    .writes("the saved scene", path)
                                    .mayBe("the saved scene", "the scene")
                                    .clash();
    if (!problem.empty()) return desc_.feedback.note(problem, true);
    desc_.session.save(path);
    desc_.feedback.pacer().input();
}

// Goes where the user wants to, and asks first where edits would be lost.
void SceneFiles::leave(const Departure::Goal& goal) {
    const bool unsaved = desc_.session.dirty();
    go(departure_.want(goal, unsaved));
    if (!unsaved) return;
    using Answer = Departure::Answer;
    const std::string text = fmt::format("{} has edits that are not saved.", fileName(desc_.session.path()));
    const std::string what = goal.choice ? "read anew" : goal.scene ? "open" : "quit";
    const auto saveFirst = [this] {
        if (isForeign(path())) { // its new name is asked for first
            go(departure_.answer(Answer::Cancel));
            return askToSaveAs();
        }
        save("");
        go(departure_.answer(Answer::Save));
    };
    desc_.feedback.tell("ask", text);
    desc_.question.ask(
        text, {{"Save and " + what + " (Enter)", GLFW_KEY_ENTER, saveFirst},
               {"Do not save (D)", GLFW_KEY_D, [this] { go(departure_.answer(Answer::Discard)); }},
               {"Cancel (Esc)", GLFW_KEY_ESCAPE, [this] { go(departure_.answer(Answer::Cancel)); }}});
    desc_.feedback.pacer().input();
}

// Asks before an opened scene takes the place of one that was edited while it was read.
void SceneFiles::followArrival() {
    Session& session = desc_.session;
    if (!session.arrival().waits() || desc_.question.isOpen() || session.saving()) return;
    const std::string text = fmt::format("{} is there, and {} has edits since then that are not saved.",
                                         fileName(session.loader().path()), fileName(session.path()));
    const auto stay = [this] {
        desc_.session.arrival().answer(false);
        opening_.giveUp();
    };
    const auto saveFirst = [this, stay] {
        if (isForeign(path())) { // its new name is asked for first
            stay();
            return askToSaveAs();
        }
        save(""); // which lets it come
        if (!desc_.session.arrival().waits()) opening_.giveUp();
    };
    desc_.feedback.tell("ask", text);
    desc_.question.ask(text,
                       {{"Save and open (Enter)", GLFW_KEY_ENTER, saveFirst},
                        {"Do not save (D)", GLFW_KEY_D, [this] { desc_.session.arrival().answer(true); }},
                        {"Cancel (Esc)", GLFW_KEY_ESCAPE, stay}});
    desc_.feedback.pacer().input();
}

void SceneFiles::go(const std::optional<Departure::Goal>& goal) {
    if (!goal) return;
    if (!goal->scene) return desc_.window.close();
    opening_.begin(*goal->scene, desc_.feedback.now());
    if (goal->choice)
        desc_.session.choose(*goal->choice);
    else
        desc_.session.open(*goal->scene);
}

bool SceneFiles::ends() {
    if (!desc_.window.closing()) return false;
    if (departure_.closing(desc_.session.dirty()) == Departure::Closing::Ends) return true;
    desc_.window.keepOpen();
    leave({});
    return false;
}

void SceneFiles::sceneCame() {
    path_ = path();
    if (desc_.session.sceneWasKept()) return;
    opening_.sceneCame();
    remember(desc_.session.scene()->prepared.scene.path);
}

// Puts a scene at the head of the recent ones, at once: a viewer that is killed later has told of it.
void SceneFiles::remember(const std::string& path) {
    desc_.preferences.values().addRecent(path);
    desc_.preferences.save();
}

void SceneFiles::followSaves() {
    Session& session = desc_.session;
    if (session.saves() == saves_) return;
    saves_ = session.saves();
    // The file that the scene was saved as gets the bookmarks.
    const std::string saved = path();
    auto& bookmarks = desc_.preferences.values().bookmarks;
    const auto known = bookmarks.find(path_);
    if (saved != path_ && known != bookmarks.end()) {
        const std::vector<Bookmark> marks = known->second;
        bookmarks.try_emplace(saved, marks);
    }
    path_ = saved;
    remember(session.path());
    desc_.feedback.tell("saved", session.path());
    desc_.feedback.note("saved " + session.path());
}

void SceneFiles::followTitle() {
    const Session& session = desc_.session;
    if (session.scene() == nullptr) return;
    const std::string title = fileName(session.path()) + (session.dirty() ? "*" : "") + " - Relume";
    if (title == title_) return;
    title_ = title;
    desc_.window.setTitle(title);
    desc_.feedback.tell("title", title);
}

void SceneFiles::followOpening() {
    const std::optional<OpenFailure> failure = desc_.session.takeOpenFailure();
    if (!failure) return;
    desc_.feedback.tell("not opened", failure->path);
    opening_.fail(*failure);
}

void SceneFiles::follow() {
    followOpening();
    followSaves();
    followArrival();
    go(departure_.followSave(desc_.session.saving(), desc_.session.dirty()));
    followTitle();
}

} // namespace relume
