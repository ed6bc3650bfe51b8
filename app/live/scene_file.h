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

/// The file that a scene is edited in: what of the edits it has, and where. Saves on a thread of its own. For
/// one thread.
class SceneFile {
public:
    /// A finished save.
    struct Saved {
        std::string path;
        std::optional<std::filesystem::file_time_type> time; // of the file, as it was written
    };

    /// The file is as this scene was loaded from it. Waits for a save that is under way, and forgets it.
    void loaded(const Scene& scene);
    /// As it was loaded or saved.
    const Scene& scene() const { return file_; }
    /// Gives each light that the file has not, and that is new to this, a number of its own in Light::node
    /// (below -1), by which it is known from then on, through undo too.
    void number(std::vector<Light>& lights);
    /// Whether a save would change the file. What it cannot hold, as hidden objects, does not count.
    bool differs(const SceneEdits& edits) const;

    /// Saves edits of that scene into the file `path`, which is the scene's file from then on. Not while
    /// saving().
    void save(const std::string& path, const SceneEdits& edits);
    bool saving() const { return saving_.valid(); }
    /// Once per frame. What was saved since; throws the save's Error.
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
