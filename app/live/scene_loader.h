#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <memory>
#include <mutex>
#include <string>

#include "app/edit/prepare.h"
#include "app/live/watch/file_watch.h"
#include "renderer/camera.h"
#include "renderer/scene_geometry.h"

namespace relume {

/// A scene as it was loaded. It is never changed afterwards.
struct LoadedScene {
    PreparedScene prepared;
    SceneGeometry geometry; // for the renderer, made beside the main thread
    ViewCamera view;        // the file's first camera, else one that goodView() finds
    uint32_t size = 0;      // lightmap edge that the atlas is made for [texels]
    uint64_t number = 0;    // counts loads from 1
};

/// Tells how far a load is.
struct LoadProgress {
    std::string phase;  // what is being done: "unwrapping"
    double done = -1.0; // share of this phase, negative where it is not known
};

/// Loads one scene at a time beside the main thread.
class SceneLoader {
public:
    SceneLoader() = default;
    ~SceneLoader(); // ends a load that is under way
    SceneLoader(const SceneLoader&) = delete;
    SceneLoader& operator=(const SceneLoader&) = delete;

    bool loading() const { return loading_.valid(); }
    /// Returns the path of the scene that is loading, "" for none.
    const std::string& path() const { return path_; }
    LoadProgress progress() const;
    /// Begins to load; nothing may be loading.
    /// `early`: takeEarly() is asked, and lightmap UVs are made as if the file had never been read; else
    /// charts stay where they were in the file's last load, as far as they fit.
    void start(const PrepareDesc& desc, bool early);
    /// Returns the scene under way as far as it can be drawn, where the rest takes a while: its geometry
    /// without lightmap UVs, its materials and its view. Each is returned once; nullptr: none, or none yet.
    std::unique_ptr<LoadedScene> takeEarly();
    /// Lets the load under way end early: nobody wants its scene any more.
    void drop() { unwanted_ = true; }
    bool dropped() const { return unwanted_; }
    /// Returns the files of the scene as they were when the load began. It must be ready.
    const FileSet& files() const { return files_; }
    /// Tells whether finish() would not wait.
    bool ready() const;
    /// Returns the scene, nullptr where the load was dropped. Throws what went wrong. Afterwards nothing is
    /// loading.
    std::unique_ptr<LoadedScene> finish();

private:
    std::unique_ptr<LoadedScene> load(const PrepareDesc& desc, uint64_t number, bool early);
    void handOut(std::unique_ptr<LoadedScene> early);

    std::future<std::unique_ptr<LoadedScene>> loading_;
    std::atomic<bool> unwanted_ = false;
    mutable std::mutex mutex_; // guards the next two
    std::unique_ptr<LoadedScene> early_;
    LoadProgress progress_;
    std::string path_;
    FileSet files_;         // for the thread that loads, until it is ready
    std::string unwrapped_; // the path whose unwrap is remembered
    UnwrapMemory memory_;   // for the thread that loads
    RectMemory rects_;      // likewise
    uint64_t loads_ = 0;
};

} // namespace relume
