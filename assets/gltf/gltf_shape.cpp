#include "assets/gltf/gltf_shape.h"

#include "assets/base/error.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <optional>

namespace relume::gltf {

namespace {

using nlohmann::json;

/// Finds the joints of the skins of a file, each once.
class SkinReader {
public:
    SkinReader(Build& build, NodePlaces& places) : build_(build), places_(places) {}
    /// Returns the matrices of a skin; none where it cannot be used.
    const std::vector<glm::dmat4>& joints(size_t skin);

private:
    std::string read(const json& skin, std::vector<glm::dmat4>& joints);
    std::string readInverses(const json& skin, std::vector<glm::dmat4>& joints);

    Build& build_;
    NodePlaces& places_;
    std::map<size_t, std::vector<glm::dmat4>> known_;
    double bytes_ = 0;
};

/// Multiplies the joints' places by the inverse bind matrices, where the skin has these; returns what is
/// wrong.
std::string SkinReader::readInverses(const json& skin, std::vector<glm::dmat4>& joints) {
    const auto index = skin.find("inverseBindMatrices");
    if (index == skin.end()) return "";
    if (!index->is_number_unsigned() || index->get<uint64_t>() >= build_.model.accessors.size())
        return "names inverse bind matrices that the file lacks";
    const tinygltf::Accessor& accessor = build_.model.accessors[index->get<size_t>()];
    if (accessor.type != TINYGLTF_TYPE_MAT4 || accessor.count < joints.size() ||
        accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
        return "has no inverse bind matrix for each joint";
    constexpr uint32_t kNumbers = 16;
    bytes_ += static_cast<double>(accessor.count) * kNumbers * sizeof(float);
    build_.limit.require(Made::Vertices, bytes_);
    const std::vector<float> values = readFloats(build_.model, accessor, kNumbers);
    for (size_t i = 0; i < joints.size(); ++i) {
        glm::dmat4 inverse(1.0);
        for (int n = 0; n < 16; ++n)
            inverse[n / 4][n % 4] = double(values[i * kNumbers + static_cast<size_t>(n)]);
        joints[i] = joints[i] * inverse;
    }
    return "";
}

std::string SkinReader::read(const json& skin, std::vector<glm::dmat4>& joints) {
    const auto list = skin.is_object() ? skin.find("joints") : skin.end();
    if (!skin.is_object() || list == skin.end() || !list->is_array() || list->empty()) return "has no joints";
    bytes_ += static_cast<double>(list->size()) * sizeof(glm::dmat4);
    build_.limit.require(Made::Vertices, bytes_);
    for (const json& joint : *list) {
        if (!joint.is_number_unsigned() || joint.get<uint64_t>() >= build_.nodes.size())
            return "names a joint that is no node";
        joints.push_back(places_.world(joint.get<size_t>()));
    }
    return readInverses(skin, joints);
}

const std::vector<glm::dmat4>& SkinReader::joints(size_t skin) {
    const auto [place, isNew] = known_.try_emplace(skin);
    if (!isNew) return place->second;
    std::string problem;
    try {
        problem = read(build_.skins[skin], place->second);
    } catch (const Error& error) { // of a sparse accessor
        problem = error.what();
    }
    if (!problem.empty()) {
        place->second.clear();
        build_.warnings.add(fmt::format("skin {}", skin), problem + ", and is left out");
    }
    return place->second;
}

std::optional<std::vector<float>> weightsOf(const json& node) {
    const auto found = node.find("weights");
    if (found == node.end() || !found->is_array()) return std::nullopt;
    std::vector<float> weights;
    for (const json& weight : *found)
        weights.push_back(weight.is_number() ? weight.get<float>() : 0.0f);
    return weights;
}

bool hasTargets(const tinygltf::Mesh& mesh) {
    return std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                       [](const tinygltf::Primitive& primitive) { return !primitive.targets.empty(); });
}

bool hasJoints(const tinygltf::Mesh& mesh) {
    return std::any_of(
        mesh.primitives.begin(), mesh.primitives.end(), [](const tinygltf::Primitive& primitive) {
            return primitive.attributes.contains("JOINTS_0") && primitive.attributes.contains("WEIGHTS_0");
        });
}

Shape shapeOf(const Build& build, const json& node, const tinygltf::Mesh& mesh, const NodePose* pose,
              SkinReader& skins) {
    Shape shape;
    if (hasTargets(mesh)) {
        shape.weights.assign(mesh.weights.begin(), mesh.weights.end());
        if (std::optional<std::vector<float>> own = weightsOf(node)) shape.weights = std::move(*own);
        if (pose && !pose->weights.empty()) shape.weights = pose->weights;
    }
    if (const auto skin = node.find("skin"); skin != node.end() && hasJoints(mesh) && !build.skins.empty())
        shape.joints = skins.joints(skin->get<size_t>());
    return shape;
}

/// Blends the matrices of a vertex's joints; returns false where one is none of the skin's.
bool blend(const std::vector<glm::dmat4>& matrices, const std::vector<std::vector<glm::vec4>>& joints,
           const std::vector<std::vector<glm::vec4>>& weights, size_t vertex, glm::dmat4& out) {
    bool good = true;
    double sum = 0.0;
    out = glm::dmat4(0.0);
    for (size_t set = 0; set < joints.size(); ++set)
        for (int i = 0; i < 4; ++i) {
            const double weight = double(weights[set][vertex][i]);
            const float joint = joints[set][vertex][i];
            if (!(weight > 0.0)) continue;
            if (!(joint >= 0.0f) || static_cast<double>(joint) >= static_cast<double>(matrices.size())) {
                good = false;
                continue;
            }
            out += matrices[static_cast<size_t>(joint)] * weight;
            sum += weight;
        }
    if (sum > 0.0) {
        out /= sum;
    } else {
        const float joint = joints.front()[vertex][0];
        out = joint >= 0.0f && static_cast<double>(joint) < static_cast<double>(matrices.size())
                  ? matrices[static_cast<size_t>(joint)]
                  : matrices.front();
    }
    return good;
}

} // namespace

bool bend(const Shape& shape, const std::vector<std::vector<glm::vec4>>& joints,
          const std::vector<std::vector<glm::vec4>>& weights, Primitive& primitive) {
    bool good = true;
    for (size_t i = 0; i < primitive.positions.size(); ++i) {
        glm::dmat4 matrix;
        if (!blend(shape.joints, joints, weights, i, matrix)) good = false;
        primitive.positions[i] = glm::vec3(matrix * glm::dvec4(primitive.positions[i], 1.0));
        if (primitive.normals.empty()) continue;
        // The cofactors are the inverse transposed times the determinant, and exist for every matrix.
        const glm::dmat3 m(matrix);
        const glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
        const double side = glm::dot(m[0], cofactors[0]) < 0.0 ? -1.0 : 1.0; // of the determinant
        primitive.normals[i] = glm::vec3(cofactors * glm::dvec3(primitive.normals[i]) * side);
    }
    return good;
}

ShapePlan planShapes(Build& build, NodePlaces& places) {
    const std::vector<tinygltf::Mesh>& meshes = build.model.meshes;
    SkinReader skins(build, places);
    ShapePlan plan;
    std::vector<bool> used(meshes.size());
    double bytes = 0; // of the joints of all entries
    for (size_t mesh = 0; mesh < meshes.size(); ++mesh) {
        plan.entries.push_back({mesh, {}});
        if (hasTargets(meshes[mesh]))
            plan.entries.back().shape.weights.assign(meshes[mesh].weights.begin(),
                                                     meshes[mesh].weights.end());
    }
    for (const bool plain : {true, false}) // a mesh's own shape first, so that it keeps its place
        for (size_t i = 0; i < build.nodes.size(); ++i) {
            const json& node = build.nodes[i];
            const auto named = node.find("mesh");
            if (named == node.end()) continue;
            const size_t mesh = named->get<size_t>();
            const bool skinned = node.contains("skin") && hasJoints(meshes[mesh]);
            if (!skinned && !hasTargets(meshes[mesh])) {
                used[mesh] = true;
                continue;
            }
            Shape shape = shapeOf(build, node, meshes[mesh], places.pose(i), skins);
            if (!shape.joints.empty()) plan.skinned.insert(i);
            const bool own = shape == plan.entries[mesh].shape;
            if (own) used[mesh] = true;
            if (plain || own) continue;
            bytes += static_cast<double>(shape.joints.size() * sizeof(glm::dmat4));
            build.limit.require(Made::Vertices, bytes);
            if (used[mesh]) {
                plan.ofNode[i] = static_cast<int>(plan.entries.size());
                plan.entries.push_back({mesh, std::move(shape)});
            } else { // nobody shows the mesh as it is
                used[mesh] = true;
                plan.entries[mesh].shape = std::move(shape);
            }
        }
    return plan;
}

} // namespace relume::gltf
