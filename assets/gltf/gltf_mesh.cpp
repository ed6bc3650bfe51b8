#include "assets/gltf/gltf_build.h"

#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "assets/gltf/gltf_compression.h"
#include "assets/gltf/gltf_shape.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace relume::gltf {

namespace {

/// Reads one primitive; corrects what can be corrected and warns about it.
class PrimitiveBuilder {
public:
    PrimitiveBuilder(Build& build, std::string where, const tinygltf::Primitive& source, const Shape& shape)
        : build_(build), where_(std::move(where)), source_(source), shape_(shape) {}
    bool run(Primitive& primitive); // false: nothing usable

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(
            fmt::format("{}: {} {}: the file is damaged, export it again", build_.path, where_, what));
    }
    void warn(const std::string& problem) const { build_.warnings.add(where_, problem); }
    const tinygltf::Accessor* attribute(const std::string& name) const;
    template<typename Vec>
    std::vector<Vec> read(const std::string& name) const;
    template<typename Vec>
    std::vector<Vec> read(const std::string& name, const tinygltf::Accessor& accessor) const;
    std::vector<glm::vec4> readColors() const;
    void readIndices(Primitive& primitive) const;
    void dropBadTriangles(Primitive& primitive) const;
    void mendTexCoords(std::vector<glm::vec2>& uvs, const char* name) const;
    void mendNormals(Primitive& primitive) const;
    void morph(Primitive& primitive) const;
    void bendBySkin(Primitive& primitive) const;
    bool readsThirdSet(const Primitive& primitive) const;
    void warnUnused(const Primitive& primitive) const;

    Build& build_;
    std::string where_;
    const tinygltf::Primitive& source_;
    const Shape& shape_;
};

template<typename Vec>
bool finite(const Vec& v) {
    for (glm::length_t i = 0; i < v.length(); ++i)
        if (!std::isfinite(v[i])) return false;
    return true;
}

const glm::vec3 kAnyNormal(0.0f, 0.0f, 1.0f); // for triangles without area, which flatten() drops

glm::vec3 unitOr(const glm::dvec3& v, const glm::vec3& fallback) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? glm::vec3(v / length) : fallback;
}

const tinygltf::Accessor* PrimitiveBuilder::attribute(const std::string& name) const {
    const auto found = source_.attributes.find(name);
    return found == source_.attributes.end() ? nullptr
                                             : &build_.model.accessors[static_cast<size_t>(found->second)];
}

template<typename Vec>
std::vector<Vec> PrimitiveBuilder::read(const std::string& name) const {
    const tinygltf::Accessor* accessor = attribute(name);
    return accessor ? read<Vec>(name, *accessor) : std::vector<Vec>{};
}

template<typename Vec>
std::vector<Vec> PrimitiveBuilder::read(const std::string& name, const tinygltf::Accessor& accessor) const {
    constexpr uint32_t kComponents = sizeof(Vec) / sizeof(float);
    if (tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)) != kComponents)
        fail(fmt::format("has {} with a wrong number of components", name));
    const tinygltf::Accessor* positions = attribute("POSITION");
    if (accessor.count != positions->count)
        fail(fmt::format("has {} positions but {} of {}", positions->count, accessor.count, name));
    std::vector<Vec> out(accessor.count);
    try {
        const std::vector<float> values = readFloats(build_.model, accessor, kComponents);
        std::memcpy(out.data(), values.data(), values.size() * sizeof(float));
    } catch (const Error& error) {
        fail(fmt::format("{}: {}", name, error.what()));
    }
    return out;
}

std::vector<glm::vec4> PrimitiveBuilder::readColors() const {
    const tinygltf::Accessor* accessor = attribute("COLOR_0");
    if (!accessor) return {};
    std::vector<glm::vec4> colors;
    if (accessor->type == TINYGLTF_TYPE_VEC3) {
        for (const glm::vec3& color : read<glm::vec3>("COLOR_0"))
            colors.emplace_back(color, 1.0f);
    } else {
        colors = read<glm::vec4>("COLOR_0");
    }
    // Integer colours are normalized, whether or not the file says so.
    const int type = accessor->componentType;
    const float full = type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? 255.0f
                       : type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? 65535.0f
                                                                        : 1.0f;
    const bool scale = !accessor->normalized && full != 1.0f;
    for (glm::vec4& color : colors) {
        if (scale)
            color = glm::vec4(glm::vec3(color) / full,
                              accessor->type == TINYGLTF_TYPE_VEC3 ? 1.0f : color.a / full);
        if (!finite(color)) color = glm::vec4(1.0f);
        color = glm::max(color, glm::vec4(0.0f));
    }
    return colors;
}

void PrimitiveBuilder::readIndices(Primitive& primitive) const {
    const uint32_t vertices = static_cast<uint32_t>(primitive.positions.size());
    std::vector<uint32_t> order;
    if (source_.indices >= 0) {
        const tinygltf::Accessor& accessor = build_.model.accessors[static_cast<size_t>(source_.indices)];
        const int type = accessor.componentType;
        if (accessor.type != TINYGLTF_TYPE_SCALAR ||
            (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
             type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
            fail("has indices that are no unsigned integers");
        try {
            order = gltf::readIndices(build_.model, accessor);
        } catch (const Error& error) {
            fail(fmt::format("indices: {}", error.what()));
        }
        for (uint32_t index : order)
            if (index >= vertices) fail(fmt::format("has index {}, but {} vertices", index, vertices));
    } else {
        order.resize(vertices);
        for (uint32_t i = 0; i < vertices; ++i)
            order[i] = i;
    }
    std::vector<uint32_t>& out = primitive.indices;
    if (source_.mode == TINYGLTF_MODE_TRIANGLES) {
        if (order.size() % 3 != 0) warn("has an index count that is no multiple of 3, the rest is ignored");
        order.resize(order.size() / 3 * 3);
        out = std::move(order);
        return;
    }
    // Strips repeat indices to jump; such triangles are no faults of the file.
    for (size_t i = 0; i + 2 < order.size(); ++i) {
        const uint32_t a = source_.mode == TINYGLTF_MODE_TRIANGLE_FAN ? order[0] : order[i];
        uint32_t b = order[i + 1], c = order[i + 2];
        if (source_.mode == TINYGLTF_MODE_TRIANGLE_STRIP && i % 2 == 1) std::swap(b, c);
        if (a != b && b != c && c != a) out.insert(out.end(), {a, b, c});
    }
}

void PrimitiveBuilder::dropBadTriangles(Primitive& primitive) const {
    std::vector<bool> bad(primitive.positions.size());
    bool any = false;
    for (size_t i = 0; i < bad.size(); ++i) {
        if (finite(primitive.positions[i])) continue;
        bad[i] = any = true;
        primitive.positions[i] = glm::vec3(0.0f); // no triangle uses it from here on
    }
    if (!any) return;
    std::vector<uint32_t> kept;
    for (size_t i = 0; i < primitive.indices.size(); i += 3) {
        const uint32_t* t = &primitive.indices[i];
        if (!bad[t[0]] && !bad[t[1]] && !bad[t[2]]) kept.insert(kept.end(), t, t + 3);
    }
    if (kept.size() != primitive.indices.size())
        warn("has positions that are not finite (NaN), their triangles are dropped: mend the mesh");
    primitive.indices = std::move(kept);
}

void PrimitiveBuilder::mendTexCoords(std::vector<glm::vec2>& uvs, const char* name) const {
    bool any = false;
    for (glm::vec2& uv : uvs) {
        if (finite(uv)) continue;
        uv = glm::vec2(0.0f);
        any = true;
    }
    if (any) warn(fmt::format("has {} that is not finite (NaN), set to 0", name));
}

template<typename T>
void gather(std::vector<T>& values, const std::vector<uint32_t>& indices) {
    if (values.empty()) return;
    std::vector<T> out(indices.size());
    for (size_t i = 0; i < indices.size(); ++i)
        out[i] = values[indices[i]];
    values = std::move(out);
}

/// Makes each triangle flat, as glTF wants where there are no normals. That needs vertices of its own for
/// each corner.
void makeFlat(Primitive& primitive) {
    gather(primitive.positions, primitive.indices);
    gather(primitive.texCoord0, primitive.indices);
    gather(primitive.texCoord1, primitive.indices);
    gather(primitive.texCoord2, primitive.indices);
    gather(primitive.colors, primitive.indices);
    primitive.normals.resize(primitive.positions.size());
    for (uint32_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        const glm::vec3* p = &primitive.positions[i];
        const glm::dvec3 a(p[0]), b(p[1]), c(p[2]);
        const glm::vec3 normal = unitOr(glm::cross(b - a, c - a), kAnyNormal);
        for (uint32_t k = 0; k < 3; ++k) {
            primitive.normals[i + k] = normal;
            primitive.indices[i + k] = i + k;
        }
    }
}

void PrimitiveBuilder::mendNormals(Primitive& primitive) const {
    if (primitive.normals.empty()) {
        makeFlat(primitive);
        return;
    }
    std::vector<uint32_t> broken;
    for (uint32_t i = 0; i < primitive.normals.size(); ++i) {
        const glm::vec3 unit = unitOr(primitive.normals[i], glm::vec3(0.0f));
        if (unit == glm::vec3(0.0f)) broken.push_back(i);
        primitive.normals[i] = unit;
    }
    if (broken.empty()) return;
    std::vector<glm::dvec3> sums(primitive.normals.size());
    for (size_t i = 0; i < primitive.indices.size(); i += 3) {
        const uint32_t* t = &primitive.indices[i];
        const glm::dvec3 a(primitive.positions[t[0]]), b(primitive.positions[t[1]]),
            c(primitive.positions[t[2]]);
        for (int k = 0; k < 3; ++k)
            sums[t[k]] += glm::cross(b - a, c - a);
    }
    for (uint32_t i : broken)
        primitive.normals[i] = unitOr(sums[i], kAnyNormal);
    warn("has normals without a direction, replaced by those of their triangles");
}

/// Tells whether a texture reads TEXCOORD_2, as it does where a lightmap has taken TEXCOORD_1.
bool PrimitiveBuilder::readsThirdSet(const Primitive& primitive) const {
    if (primitive.material < 0) return false;
    const Material& material = build_.scene.materials[static_cast<size_t>(primitive.material)];
    const auto uses = textureUses(material);
    return std::any_of(uses.begin(), uses.end(),
                       [](const TextureRef* use) { return use->texture >= 0 && use->texCoord == 2; });
}

void PrimitiveBuilder::warnUnused(const Primitive& primitive) const {
    if (attribute("TEXCOORD_2") && !readsThirdSet(primitive))
        warn("TEXCOORD_2 and higher are read by no texture, and ignored");
    if (attribute("COLOR_1")) warn("COLOR_1 and higher are ignored");
}

/// Adds the displacements of the morph targets, each times its weight (glTF 2.0, section 3.7.2.2).
void PrimitiveBuilder::morph(Primitive& primitive) const {
    for (size_t i = 0; i < std::min(source_.targets.size(), shape_.weights.size()); ++i) {
        const float weight = shape_.weights[i];
        if (weight == 0.0f || !std::isfinite(weight)) continue;
        for (const auto& [name, index] : source_.targets[i]) {
            const bool position = name == "POSITION";
            if (!position && name != "NORMAL") {
                if (name != "TANGENT") warn("has morph targets of " + name + ", which are left out");
                continue;
            }
            std::vector<glm::vec3>& values = position ? primitive.positions : primitive.normals;
            if (values.empty()) continue;
            const std::vector<glm::vec3> steps = read<glm::vec3>(
                "a morph target's " + name, build_.model.accessors[static_cast<size_t>(index)]);
            for (size_t v = 0; v < values.size(); ++v)
                values[v] += weight * steps[v];
        }
    }
}

void PrimitiveBuilder::bendBySkin(Primitive& primitive) const {
    if (shape_.joints.empty()) return;
    std::vector<std::vector<glm::vec4>> joints, weights;
    for (size_t set = 0;; ++set) {
        const std::string number = std::to_string(set);
        if (!attribute("JOINTS_" + number) || !attribute("WEIGHTS_" + number)) break;
        joints.push_back(read<glm::vec4>("JOINTS_" + number));
        weights.push_back(read<glm::vec4>("WEIGHTS_" + number));
    }
    if (joints.empty())
        warn("has no joints for its skin, and stays where it is");
    else if (!bend(shape_, joints, weights, primitive))
        warn("hangs at joints that its skin lacks, which count nothing");
}

bool PrimitiveBuilder::run(Primitive& primitive) {
    if (source_.mode < TINYGLTF_MODE_TRIANGLES) {
        warn("has points or lines, which are skipped");
        return false;
    }
    if (!attribute("POSITION")) {
        warn("has no POSITION and is skipped");
        return false;
    }
    primitive.material = materialOf(build_, source_);
    warnUnused(primitive);
    primitive.positions = read<glm::vec3>("POSITION");
    primitive.normals = read<glm::vec3>("NORMAL");
    primitive.texCoord0 = read<glm::vec2>("TEXCOORD_0");
    primitive.texCoord1 = read<glm::vec2>("TEXCOORD_1");
    if (readsThirdSet(primitive)) primitive.texCoord2 = read<glm::vec2>("TEXCOORD_2");
    primitive.colors = readColors();
    morph(primitive);
    bendBySkin(primitive);
    readIndices(primitive);
    dropBadTriangles(primitive);
    mendTexCoords(primitive.texCoord0, "TEXCOORD_0");
    mendTexCoords(primitive.texCoord1, "TEXCOORD_1");
    mendTexCoords(primitive.texCoord2, "TEXCOORD_2");
    if (primitive.indices.empty()) return false;
    mendNormals(primitive);
    return true;
}

} // namespace

void buildMeshes(Build& build, NodePlaces& places) {
    ShapePlan plan = planShapes(build, places);
    WatchedLoop loop("loading", static_cast<double>(plan.entries.size()));
    for (const ShapePlan::Entry& entry : plan.entries) {
        const tinygltf::Mesh& source = build.model.meshes[entry.mesh];
        const std::string where =
            source.name.empty() ? fmt::format("mesh {}", entry.mesh) : "mesh " + inQuotes(source.name);
        Mesh mesh;
        mesh.name = source.name;
        for (const tinygltf::Primitive& part : source.primitives) {
            const DecodedPrimitive decoded(build, where, part);
            Primitive primitive;
            if (PrimitiveBuilder(build, where, decoded.primitive(), entry.shape).run(primitive))
                mesh.primitives.push_back(std::move(primitive));
        }
        build.scene.meshes.push_back(std::move(mesh));
        loop.step();
    }
    build.bentMeshes = std::move(plan.ofNode);
    build.skinnedNodes = std::move(plan.skinned);
}

} // namespace relume::gltf
