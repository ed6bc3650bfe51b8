#include "assets/gltf/gltf_build.h"

#include "assets/base/error.h"
#include "assets/gltf/file/gltf_value.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace relume::gltf {

namespace {

constexpr const char* kVariants = "KHR_materials_variants";

std::string listOf(const std::vector<std::string>& names) {
    std::string list;
    for (const std::string& name : names)
        list += (list.empty() ? "" : ", ") + inQuotes(name);
    return list;
}

/// Tells whether a mapping of a primitive is meant for a variant.
bool isFor(const tinygltf::Value& mapping, int variant) {
    if (!mapping.IsObject() || !mapping.Has("variants")) return false;
    const tinygltf::Value& variants = mapping.Get("variants");
    if (!variants.IsArray()) return false;
    for (size_t i = 0; i < variants.ArrayLen(); ++i)
        if (variants.Get(static_cast<int>(i)).IsInt() &&
            variants.Get(static_cast<int>(i)).Get<int>() == variant)
            return true;
    return false;
}

} // namespace

void chooseVariant(Build& build, const nlohmann::json& root) {
    std::vector<std::string>& names = build.scene.variantNames;
    const nlohmann::json* extension = extensionOf(root, kVariants);
    const nlohmann::json* list = extension ? memberOf(*extension, "variants") : nullptr;
    if (list && list->is_array())
        for (const nlohmann::json& variant : *list)
            names.push_back(textOr(variant, "name", std::to_string(names.size())));
    if (build.choice.variant.empty()) return;
    const auto found = std::find(names.begin(), names.end(), build.choice.variant);
    if (found == names.end())
        throw Error(fmt::format(
            "{}: has no variant {} of its materials: {}", build.path, inQuotes(build.choice.variant),
            names.empty() ? "it has no variants, leave the choice out" : "choose one of " + listOf(names)));
    build.variant = static_cast<int>(found - names.begin());
}

int materialOf(const Build& build, const tinygltf::Primitive& primitive) {
    const auto extension = primitive.extensions.find(kVariants);
    if (build.variant < 0 || extension == primitive.extensions.end() || !extension->second.IsObject() ||
        !extension->second.Has("mappings"))
        return primitive.material;
    const tinygltf::Value& mappings = extension->second.Get("mappings");
    for (size_t i = 0; mappings.IsArray() && i < mappings.ArrayLen(); ++i) {
        const tinygltf::Value& mapping = mappings.Get(static_cast<int>(i));
        if (!isFor(mapping, build.variant) || !mapping.Has("material") || !mapping.Get("material").IsInt())
            continue;
        const int material = mapping.Get("material").Get<int>();
        if (material >= 0 && static_cast<size_t>(material) < build.materials.size()) return material;
    }
    return primitive.material;
}

} // namespace relume::gltf
