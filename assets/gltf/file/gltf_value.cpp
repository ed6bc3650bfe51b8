#include "assets/gltf/file/gltf_value.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace relume::gltf {

using nlohmann::json;

const json* memberOf(const json& holder, const char* key) {
    if (!holder.is_object()) return nullptr;
    const auto found = holder.find(key);
    return found == holder.end() ? nullptr : &*found;
}

const json* extensionOf(const json& holder, const char* name) {
    const json* extensions = memberOf(holder, "extensions");
    return extensions ? memberOf(*extensions, name) : nullptr;
}

bool isVisible(const json& node) {
    const json* extension = extensionOf(node, kVisibility);
    return !extension || boolOr(*extension, "visible", true);
}

double numberOr(const json& holder, const char* key, double fallback) {
    const json* value = memberOf(holder, key);
    return value && value->is_number() ? value->get<double>() : fallback;
}

std::string textOr(const json& holder, const char* key, const std::string& fallback) {
    const json* value = memberOf(holder, key);
    return value && value->is_string() ? value->get<std::string>() : fallback;
}

int indexBelow(const json& holder, const char* key, size_t entries) {
    constexpr uint64_t kLargest = std::numeric_limits<int>::max();
    const json* value = memberOf(holder, key);
    if (!value || !value->is_number_unsigned()) return -1;
    const uint64_t index = value->get<uint64_t>();
    return index < std::min<uint64_t>(entries, kLargest) ? static_cast<int>(index) : -1;
}

bool boolOr(const json& holder, const char* key, bool fallback) {
    const json* value = memberOf(holder, key);
    return value && value->is_boolean() ? value->get<bool>() : fallback;
}

} // namespace relume::gltf
