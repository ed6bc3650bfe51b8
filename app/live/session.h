#pragma once

#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/bake_options.h"
#include "app/live/live_bake.h"
#include "renderer/camera.h"
#include "renderer/scene_geometry.h"

namespace relume {

/// A scene as it was loaded, never changed after.
struct LoadedScene {
    PreparedScene prepared;
    SceneGeometry geometry; // for the renderer, made beside the main thread
    ViewCamera view;        // the file's first camera, else a good one
    uint64_t number = 0;    // counts loads from 1
};

/// What a user edits, and what undo restores.
struct Document {
    std::vector<Material> materials; // as the scene's, edited
    BakeSettings bake;
    LightmapDesc lightmap; // of exports
};

/// The scene on screen, its document with undo and redo, and the bake that follows them. Knows no window and
/// no OpenGL. For one thread.
class Session {
public:
    /// `bake` must outlive it. The request gives the first settings, its path is not opened.
    Session(LiveBake& bake, const BakeRequest& request);
    ~Session();

    /// Loads a scene beside the main thread; the present one stays until it is there, or for good when it
    /// cannot be read: then lastError() says why. With `keep` (the file changed) camera and settings are to
    /// stay, and edits of materials by name.
    void open(const std::string& path, bool keep = false);
    bool loading() const { return loading_.valid(); }
    const std::string& loadingPath() const { return loadingPath_; }
    /// Once per frame. True when another scene is there: scene() changed.
    bool update();
    const LoadedScene* scene() const { return scene_.get(); } // nullptr: none yet
    bool sceneWasKept() const { return kept_; } // the newest scene came with `keep`
    /// The newest message of something that could not be done, "" for none; clearError() when it was shown.
    const std::string& lastError() const { return lastError_; }
    void clearError() { lastError_.clear(); }

    const Document& document() const { return document_; }
    /// Sets the document and bakes it. `name` is shown by undo ("Emission of Lamp"). Edits with the same name
    /// one after the other become one step until endEdit(): those of a dragged slider.
    void edit(const std::string& name, const Document& next);
    void endEdit() { open_ = false; }
    bool undo(); // false: nothing left
    bool redo();
    /// Of the edit that undo or redo would take back or make again, "" for none.
    std::string undoName() const;
    std::string redoName() const;

    /// Why these settings cannot be baked, one line; "" when they can.
    static std::string problem(const BakeSettings& settings);

    LiveBake& bake() { return bake_; }
    /// Seconds since the file's time stamp was looked at last matter not: call once per frame; reloads the
    /// scene when its file changed and holds still.
    void watchFile(bool on) { watch_ = on; }
    bool watchesFile() const { return watch_; }

private:
    struct Step {
        std::string name;
        Document before, after;
    };
    void apply(const Document& next);
    void startBake(bool keepLight);
    void pollFile();

    LiveBake& bake_;
    PrepareDesc prepare_;
    Document document_;
    std::unique_ptr<LoadedScene> scene_;
    std::vector<std::unique_ptr<LoadedScene>> former_; // that the bake thread may still read
    std::future<std::unique_ptr<LoadedScene>> loading_;
    std::string loadingPath_, lastError_;
    bool keepNext_ = false, kept_ = false;
    std::vector<Step> steps_;
    size_t done_ = 0; // steps before it are done, the others undone
    bool open_ = false;
    bool watch_ = false;
    uint64_t loads_ = 0;
};

} // namespace relume
