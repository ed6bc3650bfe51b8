#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/edit/scene_property.h"
#include "assets/model/scene_edits.h"

namespace relume {

// These are edits as values, which are the same for a command line and a viewer. They refer to things by
// name, see scene_names.h.

/// Sets one property of a light, a mesh light (its material's emission), a material or the sky.
struct SetEdit {
    std::string name;
    Setting setting;
};

/// Puts the origin of a light or an object at a place, or shifts it by so much [m].
struct MoveEdit {
    std::string name;
    glm::vec3 place{0.0f};
    bool relative = false;
};

/// Turns a light or an object from its unturned state about the world's X, then Y, then Z through its origin
/// [degrees]. Its scale stays.
struct RotateEdit {
    std::string name;
    glm::vec3 degrees{0.0f};
};

/// Turns a light so that it shines at a point [m], its Y axis as far up as that goes.
struct AimEdit {
    std::string name;
    glm::vec3 target{0.0f};
};

/// Adds a light that is white, has intensity 1 and shines from the origin along -Z: a rectangle of 1 m by 1
/// m, a disc of radius 0.5 m, a spot of 45 degrees from the axis. Then it gets the `settings`, as by SetEdit.
struct AddLightEdit {
    LightType type = LightType::Point;
    std::vector<Setting> settings;
    glm::vec3 position{0.0f}; // [m]
    glm::vec3 rotation{0.0f}; // see RotateEdit
    std::optional<glm::vec3> aim;
};

/// Gives a scene that has no sky a white one of 1 cd/m^2.
struct AddSkyEdit {
    std::vector<Setting> settings;
};

/// Adds a second light like the first, with the name `copy`; "": "NAME 2" or the next that is free.
struct DuplicateEdit {
    std::string name, copy;
};

/// Takes away a light or the sky.
struct DeleteEdit {
    std::string name;
};

/// Leaves an object out of the scene, or takes it in again.
struct HideEdit {
    std::string name;
    bool hidden = true;
};

using SceneEdit = std::variant<SetEdit, MoveEdit, RotateEdit, AimEdit, AddLightEdit, AddSkyEdit,
                               DuplicateEdit, DeleteEdit, HideEdit>;

/// Makes one edit; `scene` is the one that `edits` began with. Returns what it did, one line: "light 'Lamp':
/// intensity 40". Throws Error where nothing has the name or cannot be edited so, UsageError where a value is
/// out of range; `edits` are as they were then.
std::string applyEdit(const Scene& scene, const SceneEdit& edit, SceneEdits& edits);

} // namespace relume
