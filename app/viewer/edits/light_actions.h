#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/viewer/edits/light_edits.h"
#include "app/viewer/state/shortcuts.h"

namespace relume {

/// The lights of a document as an action changes them.
struct LightChange {
    std::string name; // of the edit, as undo shows it
    Document next;
    std::optional<LightKey> selected; // the light that is selected afterwards
};

/// Returns what an action from DuplicateLight to LightStrength makes of a light, or a line that says why it
/// cannot be done. `argument` is as Action says.
std::variant<LightChange, std::string> changedLight(const Document& document, const LightSource& source,
                                                    Action action, int argument);

/// Returns the document with another light, which is a LightType or kAddSky; nothing where the scene has a
/// sky already.
std::optional<LightChange> addedLight(const Document& document, int what, const LightSpot& spot);

/// Returns the document with a picture of the sky. A radiance [cd/m^2] becomes the picture's factor.
LightChange skyWithPicture(const Document& document, const std::string& file);
/// Returns the document without its picture of the sky; nothing where it has none.
std::optional<LightChange> skyWithoutPicture(const Document& document, const LightSpot& spot);

/// Returns the light that is `step` further on the board than the selected one, or nothing where there are no
/// lights. Without a selected one it begins at an end.
std::optional<LightKey> lightBeside(const std::vector<LightSource>& sources,
                                    const std::optional<LightKey>& selected, int step);

/// The part of a scene that shines in its picture.
struct ShiningScene {
    std::vector<Material> materials; // without the emission of lights that are dark
    SkySettings sky;
};
/// Returns what shines: a muted light is dark, and so are all but the light that is looked at alone. A light
/// of a group is looked at with its whole group.
ShiningScene shiningScene(const Document& document, const std::vector<LightSource>& sources,
                          const std::optional<LightKey>& alone, const std::vector<LightGroup>& groups);

} // namespace relume
