#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/edit/scene_edit.h"

namespace CLI {
class App;
}

namespace relume {

/// An edit, with the text that was typed for it.
struct TypedEdit {
    std::string option, text; // "--set", "Lamp.intensity=40"
    SceneEdit edit;
};

/// Adds --set, --move, --rotate, --aim, --add, --duplicate, --delete, --hide and --show.
void addEditOptions(CLI::App& command);

/// Returns what was typed of them, in that order. Throws UsageError, which names option, text and remedy.
std::vector<TypedEdit> typedEdits(CLI::App& command);

/// Returns the edit that one of these options and its text mean. Throws UsageError.
SceneEdit sceneEditOf(std::string_view option, std::string_view text);

/// Makes the edits one after the other; returns what each did. Throws Error, which names option and text.
std::vector<std::string> applyEdits(const Scene& scene, const std::vector<TypedEdit>& typed,
                                    SceneEdits& edits);

} // namespace relume
