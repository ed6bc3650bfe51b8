#pragma once

#include <functional>
#include <string>

#include "app/export/export_folder.h"
#include "app/export/web/web_page.h"
#include "app/live/session.h"
#include "app/viewer/shell/editing.h"
#include "app/viewer/shell/file_dialog.h"
#include "app/viewer/shell/question.h"
#include "app/viewer/state/departure.h"
#include "app/viewer/state/kept_preferences.h"
#include "app/viewer/state/middle.h"
#include "app/viewer/state/shortcuts.h"
#include "app/viewer/window/window.h"

namespace relume {

/// Opens and saves scenes, exports lightmaps and ends the viewer, with the dialogs that this takes. No edits
/// are lost without a question.
class SceneFiles {
public:
    /// Names what it works on, which must outlive it.
    struct Desc {
        Session& session;
        Editing& editing;
        Window& window;
        FileDialog& dialog;
        Question& question;
        KeptPreferences& preferences;
        Feedback& feedback;
        std::function<float()> exposure; // of the picture [EV]
    };
    explicit SceneFiles(const Desc& desc) : desc_(desc) {}

    /// Returns the scene's absolute path, by which bookmarks are kept; "" without a scene.
    std::string path() const;
    /// Returns the scene's folder with a slash behind it, where dialogs begin; "" without a scene.
    std::string folder() const;
    /// Does an action from Open to Quit.
    void perform(Action action, int argument);
    void open(const std::string& path);
    /// Reads the scene's file anew, by another choice of what it offers.
    void choose(const GltfChoice& choice);
    /// Forgets one of the recent files.
    void forget(const std::string& path);
    /// Returns what was opened and what came of it, for the middle of the window.
    Opening& opening() { return opening_; }
    const Opening& opening() const { return opening_; }

    /// Says that another scene came.
    void sceneCame();
    /// Follows the scene's file: the title tells what is not saved, and what waited for a save goes on.
    void follow();
    /// Tells whether the viewer ends. A window that the user closed asks first.
    bool ends();

private:
    void askToSaveAs();
    void askToExport();
    void askToExportFor(Engine engine);
    void askToExportPage();
    void save(const std::string& path);
    void exportLightmap(const std::string& path);
    void exportForEngine(const ExportDesc& desc);
    void exportPage(const WebDesc& desc);
    void write(const std::vector<std::string>& paths, BakeOrders::EngineExport wanted);
    void leave(const Departure::Goal& goal);
    void go(const std::optional<Departure::Goal>& goal);
    void followArrival();
    void followOpening();
    void followSaves();
    void followTitle();
    void remember(const std::string& path);

    Desc desc_;
    Departure departure_;
    Opening opening_;
    uint64_t saves_ = 0;       // how many saves were told
    std::string title_, path_; // of the window, and of the scene when it was loaded or saved
};

} // namespace relume
