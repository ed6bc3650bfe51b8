#include "assets/gltf/gltf_batches.h"

#include <glm/gtc/quaternion.hpp>

#include <cmath>

namespace relume::gltf {
namespace {

// Beyond this cosine between two axes a transform is sheared, and no rotation and scale say the same.
constexpr double kMostShear = 1e-5;

struct Parts {
    glm::dvec3 translation{0.0}, scale{1.0};
    glm::dquat rotation{1.0, 0.0, 0.0, 0.0};
};

// Splits a transform into its parts; returns false where it is sheared or flat.
bool split(const glm::dmat4& transform, Parts& parts) {
    glm::dmat3 axes(transform);
    for (int i = 0; i < 3; ++i) {
        parts.scale[i] = glm::length(axes[i]);
        if (!(parts.scale[i] > 0.0)) return false;
        axes[i] /= parts.scale[i];
    }
    for (int i = 0; i < 3; ++i)
        if (std::abs(glm::dot(axes[i], axes[(i + 1) % 3])) > kMostShear) return false;
    if (glm::determinant(axes) < 0.0) { // mirrored
        parts.scale.x = -parts.scale.x;
        axes[0] = -axes[0];
    }
    parts.rotation = glm::normalize(glm::quat_cast(axes));
    parts.translation = glm::dvec3(transform[3]);
    return true;
}

void append(Batch& batch, const Parts& parts) {
    const glm::dquat& q = parts.rotation;
    batch.translations.emplace_back(parts.translation);
    batch.rotations.emplace_back(glm::dvec4(q.x, q.y, q.z, q.w));
    batch.scales.emplace_back(parts.scale);
    batch.isTurned = batch.isTurned || batch.rotations.back() != glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
    batch.isScaled = batch.isScaled || batch.scales.back() != glm::vec3(1.0f);
}

} // namespace

Batches batchesOf(const Scene& scene) {
    std::vector<std::vector<size_t>> members(scene.meshes.size());
    std::vector<Parts> parts(scene.instances.size());
    for (size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (instance.mesh < 0 || !scene.meshes[instance.mesh].batched || instance.hidden) continue;
        if (split(glm::dmat4(instance.transform), parts[i])) members[instance.mesh].push_back(i);
    }
    Batches out;
    out.isBatched.resize(scene.instances.size());
    for (size_t mesh = 0; mesh < members.size(); ++mesh) {
        if (members[mesh].size() < kLeastBatch) continue;
        Batch& batch = out.batches.emplace_back();
        batch.mesh = static_cast<int>(mesh);
        for (size_t i : members[mesh]) {
            append(batch, parts[i]);
            out.isBatched[i] = true;
        }
    }
    return out;
}

} // namespace relume::gltf
