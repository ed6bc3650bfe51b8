#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/edit/scene_edit.h"

namespace CLI {
class App;
}

namespace relume {

/// An edit as it was typed.
struct TypedEdit {
    std::string option, text; // "--set", "Lamp.intensity=40"
    SceneEdit edit;
};

/// Adds --set, --move, --rotate, --aim, --add, --duplicate, --delete, --hide and --show.
void addEditOptions(CLI::App& command);

/// What was typed of them, in that order. Throws UsageError, naming option, text and mend.
std::vector<TypedEdit> typedEdits(CLI::App& command);

/// The edit that an option of these and its text mean. Throws UsageError.
SceneEdit sceneEditOf(std::string_view option, std::string_view text);

/// Makes the edits one after the other; returns what each did. Throws Error, naming option and text.
std::vector<std::string> applyEdits(const Scene& scene, const std::vector<TypedEdit>& typed,
                                    SceneEdits& edits);

} // namespace relume
