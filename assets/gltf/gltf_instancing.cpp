#include "assets/gltf/gltf_instancing.h"

#include "assets/base/error.h"
#include "assets/gltf/file/gltf_check_extensions.h"
#include "assets/gltf/file/gltf_file.h"
#include "assets/gltf/file/gltf_value.h"

#include <glm/gtc/quaternion.hpp>
#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace relume::gltf {

namespace {

using nlohmann::json;

/// Reads one of the attributes; empty where it is missing or does not fit.
std::vector<float> readAttribute(Build& build, const json& attributes, const char* name, uint32_t components,
                                 const std::string& where) {
    const auto found = attributes.find(name);
    if (found == attributes.end()) return {};
    tinygltf::Accessor accessor = build.model.accessors[found->get<size_t>()];
    if (tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)) !=
        static_cast<int32_t>(components)) {
        build.warnings.add(where,
                           fmt::format("places its instances by a {} with a wrong number of components, "
                                       "which is left out",
                                       name));
        return {};
    }
    try {
        return readFloats(build.model, accessor, components);
    } catch (const Error& error) {
        throw Error(
            fmt::format("{}: {}: {}: the file is damaged, export it again", build.path, where, error.what()));
    }
}

glm::dvec3 vectorAt(const std::vector<float>& values, size_t i) {
    return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

} // namespace

size_t CopyNumbers::most() const {
    return std::max({translations.size() / 3, rotations.size() / 4, scales.size() / 3});
}

size_t CopyNumbers::count() const {
    size_t least = most();
    for (const size_t count : {translations.size() / 3, rotations.size() / 4, scales.size() / 3})
        if (count > 0) least = std::min(least, count);
    return least;
}

CopyNumbers copyNumbersOf(Build& build, const json& node, const std::string& where) {
    const json* use = extensionOf(node, kInstancing);
    if (!use || !use->contains("attributes")) return {};
    const json& attributes = (*use)["attributes"];
    return {readAttribute(build, attributes, "TRANSLATION", 3, where),
            readAttribute(build, attributes, "ROTATION", 4, where),
            readAttribute(build, attributes, "SCALE", 3, where)};
}

std::map<size_t, glm::vec3> hiddenCopiesOf(const json& node, const CopyNumbers& numbers) {
    std::map<size_t, glm::vec3> hidden;
    const json* list = ownExtra(node, "hiddenCopies");
    if (!list || !list->is_array()) return hidden;
    for (const json& entry : *list) {
        const int copy = indexBelow(entry, "copy", numbers.scales.size() / 3);
        const json* scale = memberOf(entry, "scale");
        if (copy < 0 || !scale || !scale->is_array() || scale->size() != 3) continue;
        const auto k = static_cast<size_t>(copy);
        if (vectorAt(numbers.scales, k) != glm::dvec3(0.0)) continue;
        glm::vec3 value(0.0f);
        for (int i = 0; i < 3; ++i) {
            const json& number = (*scale)[static_cast<size_t>(i)];
            if (number.is_number()) value[i] = number.get<float>();
        }
        hidden[k] = value;
    }
    return hidden;
}

std::vector<NodeCopy> copiesOf(Build& build, const json& node, const std::string& where) {
    const CopyNumbers numbers = copyNumbersOf(build, node, where);
    if (numbers.most() == 0) return {};
    if (numbers.count() != numbers.most())
        build.warnings.add(where,
                           fmt::format("has {} instances with all they need, and {} without, which are left "
                                       "out",
                                       numbers.count(), numbers.most() - numbers.count()));
    std::vector<NodeCopy> copies(numbers.count());
    const std::map<size_t, glm::vec3> hidden = hiddenCopiesOf(node, numbers);
    for (size_t i = 0; i < copies.size(); ++i) {
        glm::dmat4& copy = copies[i].transform;
        if (!numbers.rotations.empty()) {
            const float* r = &numbers.rotations[4 * i];
            const glm::dquat q(r[3], r[0], r[1], r[2]);
            if (const double length = glm::length(q); length > 0.0) copy = glm::mat4_cast(q / length);
        }
        const auto found = hidden.find(i);
        copies[i].hidden = found != hidden.end();
        if (!numbers.scales.empty()) {
            const glm::dvec3 scale =
                copies[i].hidden ? glm::dvec3(found->second) : vectorAt(numbers.scales, i);
            for (int c = 0; c < 3; ++c)
                copy[c] *= scale[c];
        }
        if (!numbers.translations.empty()) copy[3] = glm::dvec4(vectorAt(numbers.translations, i), 1.0);
    }
    return copies;
}

} // namespace relume::gltf
