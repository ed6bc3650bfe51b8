#include "assets/gltf/gltf_instancing.h"

#include "assets/base/error.h"
#include "assets/gltf/gltf_check_extensions.h"

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

std::vector<glm::dmat4> copiesOf(Build& build, const json& node, const std::string& where) {
    const json* use = extensionOf(node, kInstancing);
    if (!use || !use->contains("attributes")) return {};
    const json& attributes = (*use)["attributes"];
    const std::vector<float> translations = readAttribute(build, attributes, "TRANSLATION", 3, where),
                             rotations = readAttribute(build, attributes, "ROTATION", 4, where),
                             scales = readAttribute(build, attributes, "SCALE", 3, where);
    size_t most = 0, least = SIZE_MAX;
    for (const size_t count : {translations.size() / 3, rotations.size() / 4, scales.size() / 3}) {
        most = std::max(most, count);
        if (count > 0) least = std::min(least, count);
    }
    if (most == 0) return {};
    if (least != most)
        build.warnings.add(where,
                           fmt::format("has {} instances with all they need, and {} without, which are left "
                                       "out",
                                       least, most - least));
    std::vector<glm::dmat4> copies(least, glm::dmat4(1.0));
    for (size_t i = 0; i < least; ++i) {
        glm::dmat4& copy = copies[i];
        if (!rotations.empty()) {
            const float* r = &rotations[4 * i];
            const glm::dquat q(r[3], r[0], r[1], r[2]);
            if (const double length = glm::length(q); length > 0.0) copy = glm::mat4_cast(q / length);
        }
        if (!scales.empty())
            for (int c = 0; c < 3; ++c)
                copy[c] *= vectorAt(scales, i)[c];
        if (!translations.empty()) copy[3] = glm::dvec4(vectorAt(translations, i), 1.0);
    }
    return copies;
}

} // namespace relume::gltf
