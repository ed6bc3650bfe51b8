#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/live/arrival.h"
#include "app/live/document.h"
#include "app/live/edit_history.h"
#include "app/live/watch/file_news.h"
#include "app/live/watch/file_watch.h"
#include "app/live/live_bake.h"
#include "app/live/reload.h"
#include "app/live/scene_file.h"
#include "app/live/scene_loader.h"
#include "app/offline/bake_options.h"

namespace relume {

/// Says which file could not be opened, and why.
struct OpenFailure {
    std::string path, message; // message: one line, which begins with the path where the file is to blame
    bool undrawn = false;      // it was read and is baked, but is not seen
};

/// The scene on screen, its document with undo and redo, and the bake that follows them. It knows neither a
/// window nor OpenGL, and is for a single thread.
class Session {
public:
    /// Takes the first settings from the request, whose path is not opened. `bake` must outlive the session.
    Session(LiveBake& bake, const BakeRequest& request);

    /// Loads a scene beside the main thread. The present one stays until the new one is there, or for good
    /// when that cannot be read: then takeOpenFailure() says why, or with `keep` lastError(). With `keep`
    /// (the file changed) the camera, settings and edits that are not saved stay (carryEdits()), and where
    /// the surfaces are what they were, the bake goes on as after an edit. Another file is read by its own
    /// defaults.
    void open(const std::string& path, bool keep = false);
    /// Loads the present scene's file by another choice of what it offers, as open() does without `keep`.
    void choose(const GltfChoice& choice);
    /// Returns the choice by which the present scene was read.
    const GltfChoice& choice() const { return prepare_.choice; }
    bool loading() const { return loader_.loading(); }
    /// Returns what is loading, and how far that is.
    const SceneLoader& loader() const { return loader_; }
    /// Tells whether an opened scene waits, as edits that are not saved were made since it was asked for, and
    /// takes the answer. A save of these edits lets it come, too.
    Arrival& arrival() { return arrival_; }
    /// Returns once what became of a scene that could not be read.
    std::optional<OpenFailure> takeOpenFailure() { return std::exchange(openFailure_, std::nullopt); }
    /// Follows loads and saves; call it once per frame. Returns whether another scene is there: scene()
    /// changed.
    bool update();
    const LoadedScene* scene() const { return scene_.get(); } // nullptr: none yet
    /// Returns the scene that is loading as far as it can be drawn already, nullptr: not yet, or not at all.
    const LoadedScene* early() const { return early_.get(); }
    /// Returns the number of the scene's first bake: maps of earlier ones show another scene.
    uint64_t firstBake() const { return firstBake_; }
    bool sceneWasKept() const { return kept_; } // the newest scene came with `keep`
    /// Returns the number of the scene's surfaces, as BakeOrders::Start has it.
    uint64_t surfaces() const { return surfaces_; }
    /// Returns once what a file that was written anew has changed, one line each; empty where there is
    /// nothing to tell.
    std::vector<std::string> takeReloadNotes() { return std::exchange(reloadNotes_, {}); }
    /// Returns the newest message of something that could not be done, "" for none. Call clearError() once it
    /// was shown.
    const std::string& lastError() const { return lastError_; }
    void clearError() { lastError_.clear(); }

    const Document& document() const { return document_; }
    /// Returns a number that changes whenever the document does.
    uint64_t changes() const { return changes_; }
    /// Returns the number of the bake that follows the document: maps of earlier ones show what was before.
    uint64_t newestBake() const { return newestBake_; }
    /// Sets the document and bakes it. `name` is shown by undo ("Emission of Lamp"). Edits with the same name
    /// one after the other become one step until endEdit(): those of a dragged slider.
    void edit(const std::string& name, const Document& next);
    void endEdit() { history_.end(); }
    /// Takes back the edit that endEdit() has not ended yet, as if it had not been.
    void cancelEdit();
    bool undo(); // false: nothing left
    bool redo();
    /// Name the edit that undo or redo would take back or make again, "" for none.
    std::string undoName() const { return history_.undoName(); }
    std::string redoName() const { return history_.redoName(); }

    /// Saves the document's edits beside the main thread, into the scene's file or as `path`, which is that
    /// file from then on. The newest request counts. lastError() says what went wrong.
    void save(const std::string& path = "");
    bool saving() const { return file_.saving() || nextSave_.has_value(); }
    /// Tells whether there is something that a save would put into the file.
    bool dirty() const { return scene_ && file_.differs(document_.edits); }
    /// Returns the scene's file, which it was loaded from or saved as; "" for none.
    std::string path() const { return scene_ ? prepare_.path : ""; }
    /// Returns how many saves are done.
    uint64_t saves() const { return saves_; }

    LiveBake& bake() { return bake_; }
    /// Switches watching on or off. While on, update() loads the scene anew whenever its file was written, or
    /// one that belongs to it.
    void watchFile(bool on) { watch_.setOn(on); }
    bool watchesFile() const { return watch_.on(); }

private:
    /// Holds what was said when the load under way began.
    struct Loading {
        bool keep = false;
        bool hasty = false;    // the file's writer may go on
        bool sameFile = false; // its files are as they were read or saved before
        bool fits = false;     // its size is chosen for it
        GltfChoice choice;
    };
    /// Names the scene that is to be loaded next.
    struct Next {
        std::string path;
        bool keep = false;
        GltfChoice choice;
        bool hasty = false;
    };
    void load(const Next& next);
    void apply(const Document& next);
    void startBake(bool keepLight);
    bool finishLoading();
    void take(std::unique_ptr<LoadedScene> scene, const std::string& path);
    SceneEdits reloaded(const PreparedScene& now, const SceneChanges& changes);
    void takeSaved();
    void finishSaving(bool keep);
    void fail(const std::string& message, const std::string& opened = "");
    void pollFile();

    LiveBake& bake_;
    PrepareDesc prepare_; // of the present scene
    Document document_;
    std::unique_ptr<LoadedScene> scene_, early_;
    std::vector<std::unique_ptr<LoadedScene>> former_; // the bake thread may still read them
    SceneLoader loader_;
    Loading loading_;
    Arrival arrival_;          // of the scene that was opened last
    std::optional<Next> next_; // the newest scene that was asked for while one was loading
    bool kept_ = false;
    std::vector<std::string> reloadNotes_;
    std::string lastError_;
    std::optional<OpenFailure> openFailure_;
    SceneFile file_;
    std::optional<std::string> nextSave_; // the path of a save that waits for the one under way
    EditHistory history_;
    FileWatch watch_; // of the scene's files
    FileNews news_;   // of these, where it is on
    uint64_t firstBake_ = 0, newestBake_ = 0, changes_ = 0, saves_ = 0;
    uint64_t surfaces_ = 0, paint_ = 0; // as BakeOrders::Start has them
};

/// Returns the edge of the map of all pages of a session's lightmap [texels].
uint32_t mapSize(const Session& session);

/// Returns where the first animation of a session's file takes the first camera that it moves, `rate` times
/// per second; empty where it moves none, or there would be more than `most`.
std::vector<Camera> cameraMotion(const Session& session, double rate, uint32_t most);

} // namespace relume
