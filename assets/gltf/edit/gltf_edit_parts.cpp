#include "assets/gltf/edit/gltf_edit_parts.h"

#include "assets/base/error.h"
#include "assets/base/uri.h"
#include "assets/base/warnings.h"
#include "assets/gltf/edit/gltf_edit_node.h"
#include "assets/gltf/file/gltf_value.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace relume::gltf {

namespace {

namespace fs = std::filesystem;

constexpr const char* kStrength = "KHR_materials_emissive_strength";

float largest(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// Tells whether a colour became brighter or darker and is the same one otherwise.
bool sameHue(const glm::vec3& before, const glm::vec3& after) {
    const float from = largest(before), to = largest(after);
    if (!(from > 0.0f) || !(to > 0.0f)) return false;
    const glm::vec3 difference = glm::abs(before / from - after / to);
    return largest(difference) <= 1e-6f; // what floats round
}

/// Returns three factors that give `color` when multiplied by `strength`, in as few digits as that takes.
EditedJson factors(const glm::vec3& color, double strength) {
    EditedJson list = EditedJson::array();
    for (int c = 0; c < 3; ++c)
        list.push_back(color[c] == 0.0f ? 0.0 : shortest(color[c] / strength, [&](double v) {
            return static_cast<float>(v * strength) == color[c];
        }));
    return list;
}

/// Returns what the importer makes of a sky's intensity: a float, while it keeps an emission's strength a
/// double.
double asFloat(double strength) {
    return static_cast<float>(strength);
}

double asIs(double strength) {
    return strength;
}

/// Returns a strength that gives `color` with the factors there are, once it is read, or none where roundings
/// leave no such number.
std::optional<double> strengthFor(const glm::vec3& color, const EditedJson& factors, double guess,
                                  double (*read)(double)) {
    const auto good = [&](double strength) {
        for (int c = 0; c < 3; ++c)
            if (float(factors[static_cast<size_t>(c)].get<double>() * read(strength)) != color[c])
                return false;
        return true;
    };
    const double strength = shortest(guess, good);
    return good(strength) ? std::optional(strength) : std::nullopt;
}

bool isColor(const EditedJson* value) {
    return value && value->is_array() && value->size() == 3 &&
           std::all_of(value->begin(), value->end(), [](const EditedJson& v) { return v.is_number(); });
}

void requireFinite(const std::string& target, const std::string& thing, const glm::vec3& value) {
    for (int c = 0; c < 3; ++c)
        if (!std::isfinite(value[c]) || value[c] < 0.0f)
            throw Error(fmt::format("{}: {} of {}: give finite numbers that are not negative", target, thing,
                                    value[c]));
}

/// Writes an emission. Up to 1 it is a plain factor; above it, the factor is a colour and the extension has
/// the strength. The split that a file has stays where only the brightness changed.
void editEmission(FileEdit& edit, EditedJson& material, const glm::vec3& before, const glm::vec3& after,
                  const std::string& where) {
    const JsonPath path = {"extensions", kStrength, "emissiveStrength"};
    const float brightest = largest(after);
    EditedJson* strength = find(material, path);
    EditedJson* factor = find(material, {"emissiveFactor"});
    if (brightest > 1.0f) {
        if (strength && strength->is_number() && isColor(factor) && sameHue(before, after)) {
            const double guess = strength->get<double>() * double(brightest) / double(largest(before));
            if (const auto found = strengthFor(after, *factor, guess, asIs)) {
                *strength = *found;
                return;
            }
        }
        EditedJson& place = make(edit, material, path, where);
        setNumber(place, brightest);
        material["emissiveFactor"] = factors(after, place.get<double>());
        useExtension(edit, kStrength);
        return;
    }
    if (brightest > 0.0f) {
        setNumbers(material["emissiveFactor"], numbersOf(after));
    } else {
        material.erase("emissiveFactor");
    }
    if (!strength) return;
    erase(material, path);
    for (EditedJson& other : edit.json["materials"])
        if (find(other, {"extensions", kStrength})) return;
    dropExtension(edit, kStrength);
}

void editBaseColor(FileEdit& edit, EditedJson& material, const glm::vec4& color, const std::string& where) {
    const JsonPath unlit = {"extensions", "KHR_materials_unlit"};
    const JsonPath diffuse = {"extensions", kSpecularGlossiness, "diffuseFactor"};
    const JsonPath path = {"pbrMetallicRoughness", "baseColorFactor"};
    if (find(material, {"extensions", kSpecularGlossiness}) && !find(material, unlit)) {
        setNumbers(make(edit, material, diffuse, where), {&color[0], 4});
    } else if (color == glm::vec4(1.0f)) {
        erase(material, path);
    } else {
        setNumbers(make(edit, material, path, where), {&color[0], 4});
    }
}

void moveUrisIn(EditedJson& value, const fs::path& from, const fs::path& to) {
    if (value.is_array())
        for (EditedJson& element : value)
            moveUrisIn(element, from, to);
    if (!value.is_object()) return;
    for (auto& [key, member] : value.items()) {
        if (key == "uri" && member.is_string() && isRelativeUri(member.get<std::string>())) {
            member = encodedUri(pathFrom(to, from / decodedUri(member.get<std::string>())));
        } else if (key != "extras") { // what is in those only their owner knows
            moveUrisIn(member, from, to);
        }
    }
}

} // namespace

void editMaterials(FileEdit& edit, const std::vector<Material>& before, const std::vector<Material>& after,
                   const std::string& target) {
    const EditedJson* list = find(edit.json, {"materials"});
    if (before.size() != (list ? list->size() : 0))
        throw Error(fmt::format("{}: has other materials than before: the file has changed, load it again",
                                edit.file.path));
    if (after.size() != before.size())
        throw Error(fmt::format("{}: materials were added or removed, which cannot be saved back: keep those "
                                "of {}",
                                target, edit.file.path));
    for (size_t i = 0; i < after.size(); ++i) {
        const auto material = [&]() -> EditedJson& { return edit.json["materials"][i]; };
        const std::string where = fmt::format("materials[{}]", i);
        const std::string thing = fmt::format("material {} has ", inQuotes(after[i].name));
        if (before[i].emission != after[i].emission) {
            requireFinite(target, thing + "an emission", after[i].emission);
            editEmission(edit, material(), before[i].emission, after[i].emission, where);
        }
        if (before[i].baseColor != after[i].baseColor) {
            const glm::vec4 color = after[i].baseColor;
            for (int c = 0; c < 4; ++c)
                if (!(color[c] >= 0.0f && color[c] <= 1.0f))
                    throw Error(fmt::format("{}: {}a base colour of {}: give numbers from 0 to 1", target,
                                            thing, color[c]));
            editBaseColor(edit, material(), color, where);
        }
    }
}

void editSky(FileEdit& edit, const Sky& before, const Sky& after, const std::string& target) {
    const fs::path folder = folderOf(target);
    const bool elsewhere = !after.file.empty() && folder != folderOf(edit.file.path);
    const bool recolored = before.radiance != after.radiance;
    if (!recolored && before.rotation == after.rotation && before.file == after.file && !elsewhere) return;
    requireFinite(target, "the sky has a radiance", after.radiance);
    if (!std::isfinite(after.rotation))
        throw Error(
            fmt::format("{}: the sky has a rotation of {}: give a finite number", target, after.rotation));
    EditedJson& scene = editedScene(edit);
    const JsonPath path = {"extras", "relume", "sky"};
    const auto part = [&path](const char* key) { return JsonPath{path[0], path[1], path[2], key}; };
    if (!after.shines() && after.file.empty()) {
        for (const char* key : {"color", "intensity", "file", "rotation"})
            erase(scene, part(key));
        return;
    }
    EditedJson& sky = make(edit, scene, path, "the scene");
    if (sky.is_null()) sky = EditedJson::object();
    if (!sky.is_object()) edit.fail("the sky in the scene's extras is no object");
    const float brightest = largest(after.radiance);
    EditedJson *color = find(sky, {"color"}), *intensity = find(sky, {"intensity"});
    std::optional<double> brighter;
    if (recolored && isColor(color) && intensity && intensity->is_number() &&
        sameHue(before.radiance, after.radiance))
        brighter =
            strengthFor(after.radiance, *color,
                        intensity->get<double>() * double(brightest) / largest(before.radiance), asFloat);
    if (brighter) {
        *intensity = *brighter;
    } else if (recolored) {
        EditedJson& strength = sky["intensity"];
        setNumber(strength, brightest);
        if (brightest > 0.0f) sky["color"] = factors(after.radiance, asFloat(strength.get<double>()));
    }
    if (after.file.empty()) {
        sky.erase("file");
    } else if (before.file != after.file || elsewhere) {
        const std::string file = pathFrom(folder, after.file);
        if (!isUtf8(file))
            throw Error(fmt::format("{}: the path of the sky's picture {} is no UTF-8, as which glTF would "
                                    "hold it: rename it",
                                    target, after.file));
        sky["file"] = file;
    }
    if (after.rotation == 0.0f) {
        sky.erase("rotation");
    } else if (before.rotation != after.rotation) {
        setNumber(sky["rotation"], after.rotation);
    }
}

fs::path folderOf(const std::string& path) {
    std::error_code code;
    const fs::path folder = fs::path(path).parent_path();
    const fs::path canonical = fs::weakly_canonical(folder.empty() ? "." : folder, code);
    return code ? fs::absolute(folder, code).lexically_normal() : canonical;
}

std::string pathFrom(const fs::path& folder, const fs::path& path) {
    // Only the folder of what is named is followed: a link keeps its name.
    const fs::path whole = folderOf(path.string()) / path.filename();
    const fs::path relative = whole.lexically_relative(folder);
    return relative.empty() ? whole.generic_string() : relative.generic_string();
}

void moveUris(FileEdit& edit, const std::string& target) {
    const fs::path from = folderOf(edit.file.path), to = folderOf(target);
    if (from != to) moveUrisIn(edit.json, from, to);
}

} // namespace relume::gltf
