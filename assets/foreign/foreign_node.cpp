#include "assets/foreign/foreign_build.h"

#include "assets/base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include <assimp/config.h>
#include <assimp/version.h>

namespace relume::foreign {
namespace {

glm::dmat4 matrixOf(const aiMatrix4x4& m) {
    glm::dmat4 matrix(1.0);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
            matrix[column][row] = m[static_cast<unsigned>(row)][column];
    return matrix; // its last row is (0 0 0 1), whatever the file says
}

bool isUsable(const glm::dmat4& matrix) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 3; ++r)
            if (!(std::abs(matrix[c][r]) <= std::numeric_limits<float>::max())) return false;
    return true;
}

double numberOf(const aiMetadata& data, const char* key, double fallback) {
    float single = 0;
    double twice = 0;
    int32_t whole = 0;
    if (data.Get(key, single)) return single;
    if (data.Get(key, twice)) return twice;
    return data.Get(key, whole) ? whole : fallback;
}

/// Tells whether libassimp has turned a .fbx file by the axes that it tells. Releases from 5.4.0 on do; since
/// 6.0 there is a switch, which is off here.
bool libraryTurnsFbx() {
#ifdef AI_CONFIG_IMPORT_FBX_IGNORE_UP_AXIS_DIRECTION
    return false;
#else
    return std::pair(aiGetVersionMajor(), aiGetVersionMinor()) >= std::pair(5u, 4u);
#endif
}

/// The rows that bring an axis of the file with its sign to X, Y and Z.
glm::dmat3 fbxAxes(const aiMetadata& data) {
    const std::array<std::pair<const char*, const char*>, 3> names = {
        {{"CoordAxis", "CoordAxisSign"}, {"UpAxis", "UpAxisSign"}, {"FrontAxis", "FrontAxisSign"}}};
    glm::dmat3 axes(0.0);
    for (int row = 0; row < 3; ++row) {
        const auto& [axisName, signName] = names[static_cast<size_t>(row)];
        const auto axis = static_cast<int>(std::clamp(numberOf(data, axisName, row), 0.0, 2.0));
        axes[axis][row] = numberOf(data, signName, 1.0) < 0.0 ? -1.0 : 1.0;
    }
    // What is no rotation is a mistake of the exporter.
    return std::abs(glm::determinant(axes) - 1.0) < 1e-6 ? axes : glm::dmat3(1.0);
}

/// Turns an axis to Y: rows are what becomes X, Y and Z.
glm::dmat3 upAxis(char up) {
    if (up == 'x') return glm::transpose(glm::dmat3({0, -1, 0}, {1, 0, 0}, {0, 0, 1}));
    if (up == 'z') return glm::transpose(glm::dmat3({1, 0, 0}, {0, 0, 1}, {0, -1, 0}));
    return glm::dmat3(1.0);
}

/// A node with its transform to the world.
struct Placed {
    const aiNode* node = nullptr;
    glm::dmat4 world{1.0};
};

std::vector<Placed> allNodes(const Build& build) {
    std::vector<Placed> nodes, open;
    if (build.source->mRootNode) open.push_back({build.source->mRootNode, toMetres(build)});
    while (!open.empty()) {
        const Placed parent = open.back();
        open.pop_back();
        const Placed placed{parent.node, parent.world * matrixOf(parent.node->mTransformation)};
        nodes.push_back(placed);
        for (unsigned i = placed.node->mNumChildren; i-- > 0;) // so that they come in their order
            open.push_back({placed.node->mChildren[i], placed.world});
    }
    return nodes;
}

/// Names that libassimp gives to what has none.
bool isMadeUp(const std::string& name) {
    return name.empty() || name.starts_with('<') || name.starts_with('$') || name.starts_with("3DSMesh_") ||
           name == "ROOT" || name == "Root" || name == "RootNode" || name == "defaultobject";
}

std::string instanceName(const Build& build, const aiNode& node) {
    std::string name = nameOf(node.mName);
    if (isMadeUp(name) && node.mMeshes[0] < build.source->mNumMeshes)
        name = nameOf(build.source->mMeshes[node.mMeshes[0]]->mName);
    return isMadeUp(name) ? std::filesystem::path(build.path).stem().string() : name;
}

/// The box around what is placed.
struct Box {
    glm::dvec3 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
};

Box boundsOf(const Scene& scene) {
    std::vector<Box> ofMesh;
    for (const Mesh& mesh : scene.meshes) {
        Box box;
        for (const Primitive& primitive : mesh.primitives)
            for (const glm::vec3& position : primitive.positions) {
                box.low = glm::min(box.low, glm::dvec3(position));
                box.high = glm::max(box.high, glm::dvec3(position));
            }
        ofMesh.push_back(box);
    }
    Box all;
    for (const Instance& instance : scene.instances) {
        const Box& box = ofMesh[static_cast<size_t>(instance.mesh)];
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec4 at(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                                corner & 4 ? box.high.z : box.low.z, 1.0);
            const glm::dvec3 placed(glm::dmat4(instance.transform) * at);
            all.low = glm::min(all.low, placed);
            all.high = glm::max(all.high, placed);
        }
    }
    return all;
}

void addInstances(Build& build, const std::vector<Placed>& nodes) {
    Scene& scene = build.made.scene;
    std::map<std::vector<unsigned>, int>
        known; // the mesh made of these meshes of the file, -1: nothing usable
    for (const auto& [node, world] : nodes) {
        if (node->mNumMeshes == 0) continue;
        const std::string name = instanceName(build, *node);
        if (!isUsable(world)) {
            build.warnings.add("object " + inQuotes(name), "has no finite position, left out");
            continue;
        }
        const std::vector<unsigned> meshes(node->mMeshes, node->mMeshes + node->mNumMeshes);
        const auto [entry, isNew] = known.try_emplace(meshes, -1);
        if (isNew) {
            Mesh mesh = makeMesh(build, meshes, name);
            if (!mesh.primitives.empty()) {
                entry->second = static_cast<int>(scene.meshes.size());
                scene.meshes.push_back(std::move(mesh));
            }
        }
        if (entry->second >= 0)
            scene.instances.push_back({.name = name, .mesh = entry->second, .transform = glm::mat4(world)});
    }
}

} // namespace

glm::dmat4 toMetres(const Build& build) {
    glm::dmat3 axes = upAxis(build.choice.up);
    double scale = build.choice.scale;
    if (build.ending == ".blend") axes = axes * upAxis('z');
    if (build.ending == ".fbx" && build.source->mMetaData) {
        constexpr double kCentimetre = 0.01; // [m], in which .fbx files tell their unit
        const aiMetadata& data = *build.source->mMetaData;
        const double unit = numberOf(data, "UnitScaleFactor", 1.0);
        if (std::isfinite(unit) && unit > 0.0) scale *= unit * kCentimetre;
        if (!libraryTurnsFbx()) axes = axes * fbxAxes(data);
    }
    return glm::dmat4(axes * scale);
}

void buildNodes(Build& build) {
    const std::vector<Placed> nodes = allNodes(build);
    addInstances(build, nodes);
    if (build.made.scene.instances.empty()) return; // which is an error
    std::map<std::string, glm::dmat4> named;        // the first node of each name, as libassimp finds it
    for (const auto& [node, world] : nodes)
        named.try_emplace(std::string(node->mName.data, node->mName.length), world);

    constexpr double kReach = 0.25; // of the diagonal: about from a lamp to the walls of its room
    const Box box = boundsOf(build.made.scene);
    const double diagonal = glm::length(box.high - box.low);
    // The unit by which lengths of lights and cameras are told is that of the root.
    const glm::dmat4 root = toMetres(build) * matrixOf(build.source->mRootNode->mTransformation);
    const double scale = std::cbrt(std::abs(glm::determinant(glm::dmat3(root))));
    Placing placing{.scale = std::isfinite(scale) && scale > 0.0 ? scale : 1.0};
    if (std::isfinite(diagonal) && diagonal > 0.0) placing.reach = static_cast<float>(kReach * diagonal);
    const auto worldOf = [&](const aiString& name) {
        // In .3ds files they have their places in the world, which libassimp tells again as those of nodes.
        if (build.ending == ".3ds") return root;
        const auto found = named.find(std::string(name.data, name.length));
        return found == named.end() ? root : found->second;
    };
    for (unsigned i = 0; i < build.source->mNumCameras; ++i) {
        placing.world = worldOf(build.source->mCameras[i]->mName);
        addCamera(build, *build.source->mCameras[i], placing);
    }
    for (unsigned i = 0; i < build.source->mNumLights; ++i) {
        placing.world = worldOf(build.source->mLights[i]->mName);
        addLight(build, *build.source->mLights[i], placing);
    }
}

} // namespace relume::foreign
