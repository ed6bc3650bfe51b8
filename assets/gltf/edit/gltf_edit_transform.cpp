#include "assets/gltf/edit/gltf_edit_transform.h"

#include "assets/gltf/gltf_node.h"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace relume::gltf {

namespace {

// Two values that differ by less than this, relative to the whole, are the same: transforms are floats.
constexpr double kFloatStep = 1.2e-7;
// Axes that are that far from perpendicular [cosine] are sheared; less is what floats and exporters round.
constexpr double kShear = 1e-5;

/// Tells whether node coordinates give the world position to the last bit.
bool reaches(const TransformEdit& edit, const glm::dvec3& local) {
    return glm::vec3(edit.parent * glm::dvec4(local, 1.0)) == glm::vec3(edit.to[3]);
}

/// Returns the new translation, in numbers as short as the world position allows; what does not change stays.
glm::dvec3 translationOf(const TransformEdit& edit, const glm::dvec3& was) {
    const glm::dmat4 toLocal = glm::inverse(edit.parent);
    const glm::dvec3 whole = glm::dvec3(toLocal * glm::dvec4(edit.to[3]));
    const glm::dvec3 step = glm::dmat3(toLocal) * (glm::dvec3(edit.to[3]) - glm::dvec3(edit.from[3]));
    const double longest = std::max({std::abs(step.x), std::abs(step.y), std::abs(step.z)});
    glm::dvec3 local = was, best = was;
    std::array<bool, 3> moves{};
    for (int i = 0; i < 3; ++i) {
        moves[static_cast<size_t>(i)] = std::abs(step[i]) > kFloatStep * longest;
        if (moves[static_cast<size_t>(i)])
            best[i] = shortest(whole[i], [&](double v) { return float(v) == float(whole[i]); });
    }
    // Digits are tried for all three at once, as a rotated parent mixes them.
    constexpr int kDecimals = 12; // a picometre; what is smaller gets the digits of a float
    for (int decimals = 1; decimals <= kDecimals; ++decimals) {
        const double unit = std::pow(10.0, decimals);
        for (int i = 0; i < 3; ++i)
            if (moves[static_cast<size_t>(i)]) local[i] = std::round(whole[i] * unit) / unit;
        if (reaches(edit, local)) return local;
    }
    return best;
}

void setTranslation(EditedJson& node, const glm::dvec3& value, const glm::dvec3& was) {
    if (value == was) return;
    if (value == glm::dvec3(0.0)) {
        node.erase("translation");
        return;
    }
    EditedJson& place = node["translation"];
    if (place.is_null()) place = {0.0, 0.0, 0.0};
    for (int i = 0; i < 3; ++i)
        if (value[i] != was[i]) place[static_cast<size_t>(i)] = value[i] + 0.0; // not -0
}

void setRotation(EditedJson& node, const glm::dmat3& rotation, const nlohmann::json& was) {
    glm::dquat q = glm::normalize(glm::quat_cast(rotation)), old(1.0, 0.0, 0.0, 0.0);
    const auto found = was.find("rotation");
    if (found != was.end()) {
        const auto at = [&](size_t i) { return (*found)[i].get<double>(); };
        const glm::dquat read(at(3), at(0), at(1), at(2));
        if (glm::length(read) > 0.0) old = glm::normalize(read);
    }
    if (glm::dot(q, old) < 0.0) q = -q;
    double difference = 0.0;
    for (int i = 0; i < 4; ++i) {
        difference = std::max(difference, std::abs(q[i] - old[i]));
        if (std::abs(q[i]) < kFloatStep) q[i] = 0.0;
    }
    if (difference <= kFloatStep) return;
    if (q.x == 0.0 && q.y == 0.0 && q.z == 0.0) {
        node.erase("rotation");
        return;
    }
    const std::array<float, 4> values = {float(q.x), float(q.y), float(q.z), float(q.w)};
    setNumbers(node["rotation"], values);
}

glm::dvec3 scaleOf(const nlohmann::json& was) {
    glm::dvec3 scale(1.0);
    const auto found = was.find("scale");
    if (found != was.end())
        for (int i = 0; i < 3; ++i)
            scale[i] = (*found)[static_cast<size_t>(i)].get<double>();
    return scale;
}

void setScale(EditedJson& node, const glm::dvec3& value, const glm::dvec3& was) {
    if (value == was) return;
    if (value == glm::dvec3(1.0)) {
        node.erase("scale");
        return;
    }
    const std::array<float, 3> values = {float(value.x), float(value.y), float(value.z)};
    setNumbers(node["scale"], values);
}

void writeMatrix(EditedJson& node, const glm::dmat4& local) {
    for (const char* key : {"translation", "rotation", "scale"})
        node.erase(key);
    std::array<float, 16> values;
    for (int i = 0; i < 16; ++i)
        values[static_cast<size_t>(i)] = float(local[i / 4][i % 4]);
    setNumbers(node["matrix"], values);
}

} // namespace

bool splitLinear(const glm::dmat3& linear, glm::dmat3& rotation, glm::dvec3& scale) {
    glm::dvec3 lengths;
    for (int i = 0; i < 3; ++i) {
        lengths[i] = glm::length(linear[i]);
        if (!(lengths[i] > 0.0)) return false;
        if (scale[i] < 0.0) lengths[i] = -lengths[i];
        rotation[i] = linear[i] / lengths[i];
    }
    for (int i = 0; i < 3; ++i)
        if (std::abs(glm::dot(rotation[i], rotation[(i + 1) % 3])) > kShear) return false;
    if (glm::determinant(rotation) < 0.0) {
        rotation[0] = -rotation[0];
        lengths[0] = -lengths[0];
    }
    for (int i = 0; i < 3; ++i) // a rotation alone leaves the scale as it is
        if (std::abs(lengths[i] - scale[i]) > 1e-6 * std::abs(lengths[i])) scale[i] = lengths[i];
    return true;
}

bool invertible(const glm::dmat4& transform) {
    const glm::dmat3 linear(transform);
    const double volume = glm::length(linear[0]) * glm::length(linear[1]) * glm::length(linear[2]);
    // Flatter axes than this leave no digits of a float.
    return volume > 0.0 && std::isfinite(volume) && std::abs(glm::determinant(linear)) > 1e-9 * volume;
}

glm::dmat3 frame(const glm::dmat3& axes) {
    const double length = glm::length(axes[2]);
    if (!(length > 0.0)) return glm::dmat3(1.0);
    const glm::dvec3 z = axes[2] / length;
    glm::dvec3 x = axes[0] - z * glm::dot(axes[0], z);
    if (!(glm::length(x) > 1e-9 * glm::length(axes[0])))
        x = glm::cross(std::abs(z.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0), z);
    x = glm::normalize(x);
    return {x, glm::cross(z, x), z};
}

void writeRigid(EditedJson& node, const glm::mat4& transform) {
    const nlohmann::json none = nlohmann::json::object();
    TransformEdit edit;
    edit.to = transform;
    setTranslation(node, translationOf(edit, glm::dvec3(0.0)), glm::dvec3(0.0));
    setRotation(node, frame(glm::dmat3(glm::mat3(transform))), none);
}

bool editTransform(EditedJson& node, const nlohmann::json& was, const TransformEdit& edit) {
    const glm::dmat4 old = localTransform(was);
    const glm::dvec3 translation = translationOf(edit, glm::dvec3(old[3]));
    const bool turned = glm::mat3(edit.from) != glm::mat3(edit.to);
    const glm::dmat3 linear = glm::inverse(glm::dmat3(edit.parent)) * glm::dmat3(glm::mat3(edit.to));
    glm::dmat4 local(linear);
    local[3] = glm::dvec4(translation, 1.0);
    if (was.contains("matrix")) {
        if (!turned || edit.rigid) {
            const glm::dmat3 axes = turned ? frame(linear) : glm::dmat3(old);
            for (int i = 0; i < 3; ++i)
                local[i] = glm::dvec4(turned ? axes[i] * glm::length(old[i]) : axes[i], 0.0);
        }
        writeMatrix(node, local);
        return true;
    }
    if (turned) {
        const glm::dvec3 oldScale = scaleOf(was);
        glm::dvec3 scale = oldScale;
        glm::dmat3 rotation = linear;
        if (edit.rigid) {
            for (int i = 0; i < 3; ++i)
                if (scale[i] < 0.0) rotation[i] = -rotation[i];
        } else if (!splitLinear(linear, rotation, scale)) {
            if (edit.mayBeMatrix) writeMatrix(node, local);
            return edit.mayBeMatrix;
        }
        setRotation(node, frame(rotation), was);
        setScale(node, scale, oldScale);
    }
    setTranslation(node, translation, glm::dvec3(old[3]));
    return true;
}

} // namespace relume::gltf
