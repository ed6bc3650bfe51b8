#pragma once

#include <filesystem>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assets/gltf/gltf_edit.h"
#include "assets/model/scene_edits.h"

namespace relume {

/// The file that a scene is edited in. It knows which of the edits the file has, and in which nodes. It saves
/// on a thread of its own; its functions are for a single thread.
class SceneFile {
public:
    /// A finished save.
    struct Saved {
        std::string path;
        std::optional<std::filesystem::file_time_type> time; // of the file, as it was written
    };

    /// Says that the file is as this scene was loaded from it. Waits for a save under way, and forgets it.
    void loaded(const Scene& scene);
    /// Returns the scene as it was loaded or saved last.
    const Scene& scene() const { return file_; }
    /// Gives each light that is not in the file, and that has no number yet, a number of its own in
    /// Light::node (below -1). The light is known by it from then on, through undo too.
    void number(std::vector<Light>& lights);
    /// Tells whether a save would change the file.
    bool differs(const SceneEdits& edits) const;

    /// Saves edits of that scene into the file `path`, which is the scene's file from then on. Must not be
    /// called while saving().
    void save(const std::string& path, const SceneEdits& edits);
    bool saving() const { return saving_.valid(); }
    /// Returns what was saved since the last call, which comes once per frame. Throws the save's Error.
    std::optional<Saved> update();
    /// Waits for the save that is under way, if there is one.
    void wait() const;

private:
    using Place = std::pair<int, bool>; // Light::node, of an area light: a node may carry both kinds
    struct Result {
        Saved saved;
        EditedNodes nodes;
    };
    static Place placeOf(const Light& light);
    int fileNode(const Light& light) const;
    void keep(const Result& result);

    Scene file_;                 // what the file holds, with its nodes; see partsOfEdits
    SceneEdits held_;            // the same as the document had it
    std::map<Place, int> nodes_; // the file's node of each light that has been in it
    int lastNumber_ = -1;
    std::future<Result> saving_;
    SceneEdits pending_; // of the save under way
};

} // namespace relume
