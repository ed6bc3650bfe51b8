#include "assets/gltf/file/gltf_check_extensions.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>

namespace relume::gltf {

namespace {

using nlohmann::json;

constexpr std::array kKnown = {kAreaLights,
                               "EXT_texture_webp",
                               kPunctualLights,
                               "KHR_materials_emissive_strength",
                               kSpecularGlossiness,
                               "KHR_materials_transmission",
                               "KHR_materials_unlit",
                               "KHR_materials_variants",
                               "KHR_mesh_quantization",
                               kVisibility,
                               "KHR_texture_basisu",
                               "KHR_texture_transform",
                               kDraco,
                               kMeshopt,
                               kInstancing};
constexpr std::array kCompressions = {"KHR_meshopt_compression", "MESHOPT_compression",
                                      "MPEG_mesh_compression"};
// Extensions of primitives that say something about triangles but leave them where they are.
constexpr std::array kRemarks = {"KHR_materials_variants", "EXT_mesh_features", "EXT_structural_metadata",
                                 "CESIUM_primitive_outline"};

template<size_t Size>
bool isAmong(const std::array<const char*, Size>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

bool uses(const json& holder, const std::string& extension) {
    const auto found = holder.is_object() ? holder.find("extensions") : holder.end();
    return holder.is_object() && found != holder.end() && found->is_object() && found->contains(extension);
}

bool anyUses(const json& list, const std::string& extension) {
    return list.is_array() &&
           std::any_of(list.begin(), list.end(), [&](const json& entry) { return uses(entry, extension); });
}

/// Tells whether something that vertices are read from uses an extension.
bool geometryUses(const json& root, const std::string& extension) {
    for (const char* section : {"buffers", "bufferViews", "accessors", "meshes"})
        if (const auto list = root.find(section); list != root.end() && anyUses(*list, extension))
            return true;
    const auto meshes = root.find("meshes");
    if (meshes == root.end() || !meshes->is_array() || isAmong(kRemarks, extension)) return false;
    return std::any_of(meshes->begin(), meshes->end(), [&](const json& mesh) {
        return mesh.is_object() && mesh.contains("primitives") && anyUses(mesh["primitives"], extension);
    });
}

/// Checks an object whose members all name accessors.
void checkAccessors(const JsonChecks& checks, const json& value, const std::string& where) {
    for (const auto& [name, unused] : checks.object(value, where).items())
        checks.index(value, name.c_str(), where, "accessors");
}

} // namespace

bool isKnownExtension(const std::string& name) {
    return isAmong(kKnown, name);
}

void checkRequired(const JsonChecks& checks) {
    const json* required = checks.member(checks.root(), "extensionsRequired");
    if (!required) return;
    for (const json& entry : *required) {
        const std::string name = entry.get<std::string>();
        if (isKnownExtension(name) || !geometryUses(checks.root(), name)) continue;
        throw Error(fmt::format(
            "{}: requires the extension {} for its meshes, which is not supported: export "
            "it without {}",
            checks.file().path, inQuotes(name), isAmong(kCompressions, name) ? "mesh compression" : "it"));
    }
}

bool isPlaceholder(const json& buffer) {
    const json* use = extensionOf(buffer, kMeshopt);
    if (!use || !use->is_object()) return false;
    const auto fallback = use->find("fallback");
    return fallback != use->end() && fallback->is_boolean() && fallback->get<bool>();
}

void checkCompressedView(const JsonChecks& checks, const json& view, const std::string& where) {
    const json* use = checks.extension(view, kMeshopt, where);
    if (!use) return;
    const std::string here = where + ".extensions." + kMeshopt;
    const int64_t buffer = checks.index(*use, "buffer", here, "buffers");
    if (buffer < 0) checks.fail(here + ".buffer is missing");
    const json& source = checks.root()["buffers"][static_cast<size_t>(buffer)];
    if (isPlaceholder(source)) checks.fail(here + ".buffer has no bytes of its own");
    const int64_t offset = checks.size(*use, "byteOffset", here, 0),
                  bytes = checks.size(*use, "byteLength", here, 0),
                  held = source["byteLength"].get<int64_t>();
    if (offset + bytes > held)
        checks.fail(fmt::format("{} ends at byte {}, but its buffer has {}", here, offset + bytes, held));
    constexpr int64_t kMostCount = int64_t(1) << 31; // decodeMeshopt has a closer bound, by the bytes
    const int64_t stride = checks.integer(*use, "byteStride", here, 0),
                  elements = checks.integer(*use, "count", here, 0, kMostCount);
    if (stride < 1 || stride > 256) checks.fail(here + ".byteStride is not between 1 and 256");
    if (view["byteLength"].get<int64_t>() > stride * elements)
        checks.fail(
            fmt::format("{}.byteLength is more than the {} elements of {} bytes", where, elements, stride));
    const int64_t ownStride = checks.integer(view, "byteStride", where, 0);
    if (ownStride != 0 && ownStride != stride)
        checks.fail(
            fmt::format("{}.byteStride is {}, but its elements have {} bytes", where, ownStride, stride));
    for (const char* key : {"mode", "filter"})
        checks.text(*use, key, here);
    const std::string mode = use->value("mode", ""), filter = use->value("filter", "NONE");
    constexpr std::array kModes = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
    constexpr std::array kFilters = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
    if (!isAmong(kModes, mode)) checks.fail(here + ".mode is missing or unknown");
    if (!isAmong(kFilters, filter)) checks.fail(here + ".filter is unknown");
}

void checkDraco(const JsonChecks& checks, const json& primitive, const std::string& where) {
    const json* use = checks.extension(primitive, kDraco, where);
    if (!use) return;
    const std::string here = where + ".extensions." + kDraco;
    if (checks.index(*use, "bufferView", here, "bufferViews") < 0)
        checks.fail(here + ".bufferView is missing");
    const json* attributes = checks.member(*use, "attributes");
    if (!attributes) checks.fail(here + ".attributes is missing");
    for (const auto& [name, unused] : checks.object(*attributes, here + ".attributes").items())
        checks.integer(*attributes, name.c_str(), here + ".attributes");
}

void checkTargets(const JsonChecks& checks, const json& primitive, const std::string& where) {
    const json* targets = checks.member(primitive, "targets");
    if (!targets) return;
    if (!targets->is_array()) checks.fail(where + ".targets is no array");
    for (size_t i = 0; i < targets->size(); ++i)
        checkAccessors(checks, (*targets)[i], fmt::format("{}.targets[{}]", where, i));
}

void checkInstancing(const JsonChecks& checks, const json& node, const std::string& where) {
    const json* use = checks.extension(node, kInstancing, where);
    if (!use) return;
    const std::string here = where + ".extensions." + kInstancing;
    if (const json* attributes = checks.member(*use, "attributes"))
        checkAccessors(checks, *attributes, here + ".attributes");
}

} // namespace relume::gltf
