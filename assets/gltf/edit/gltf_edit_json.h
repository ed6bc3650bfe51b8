#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

#include "assets/gltf/file/gltf_file.h"

namespace relume::gltf {

using EditedJson = nlohmann::ordered_json;
using JsonPath = std::vector<const char*>; // keys from object to object

/// Holds a file while it is edited. A member that is added to an object copies all below that object
/// elsewhere, so that a reference into it lasts until then only.
struct FileEdit {
    const File& file; // as it was, checked
    EditedJson json;  // as it is to be
    int scene = 0;    // which of its scenes is edited
    /// This is true where the file may name its parts by JSON pointers, as KHR_animation_pointer does: then
    /// what they may name must not be renumbered.
    bool hasPointers = false;

    explicit FileEdit(const File& source);

    /// Throws the Error for something in the file that has another type than glTF gives it.
    [[noreturn]] void fail(const std::string& what) const;
};

/// Returns the member at the end of the path, or nullptr where there is none.
EditedJson* find(EditedJson& holder, const JsonPath& path);

/// Returns the member at the end of the path, a JSON null where it is new; objects on the way are made as
/// needed. Throws Error where something on the way is no object, naming it as `where`'s.
EditedJson& make(const FileEdit& edit, EditedJson& holder, const JsonPath& path, const std::string& where);

/// Takes away the member at the end of the path, and the objects on the way that are empty then.
void erase(EditedJson& holder, const JsonPath& path);

/// Returns the number with the fewest digits that `good` accepts, or `value` itself where it accepts none.
double shortest(double value, const std::function<bool(double)>& good);

/// Returns the number with the fewest digits that still reads as this float.
EditedJson number(float value);

/// Makes `place` read as this float; one that does already keeps its spelling.
void setNumber(EditedJson& place, float value);

/// Makes an array read as these floats in the same way.
void setNumbers(EditedJson& place, std::span<const float> values);

inline std::span<const float> numbersOf(const glm::vec3& v) {
    return {&v[0], 3};
}

/// useExtension adds to extensionsUsed; dropExtension takes away from it and from extensionsRequired.
void useExtension(FileEdit& edit, const std::string& name);
void dropExtension(FileEdit& edit, const std::string& name);

} // namespace relume::gltf
