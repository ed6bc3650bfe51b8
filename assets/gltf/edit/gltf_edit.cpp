#include "assets/gltf/edit/gltf_edit.h"

#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/base/json_text.h"
#include "assets/base/warnings.h"
#include "assets/gltf/gltf_check.h"
#include "assets/gltf/edit/gltf_edit_copies.h"
#include "assets/gltf/edit/gltf_edit_light.h"
#include "assets/gltf/edit/gltf_edit_node.h"
#include "assets/gltf/edit/gltf_edit_parts.h"
#include "assets/gltf/edit/gltf_edit_visibility.h"
#include "assets/gltf/gltf_light_json.h"
#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

namespace relume {

namespace gltf {

namespace {

std::string endingOf(const std::string& path) {
    std::string ending = std::filesystem::path(path).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

void requireSameKind(const File& file, const std::string& target) {
    const std::string kind = file.binary ? ".glb" : ".gltf", ending = endingOf(target);
    const bool other = ending == (file.binary ? ".gltf" : ".glb");
    if (ending == kind || (ending == endingOf(file.path) && !other)) return;
    throw Error(fmt::format("{}: {} is saved back as the kind of file it is: name a file that ends in {}",
                            target, file.path, kind));
}

/// Returns which of a file's scenes an edit is about: the one that was read.
int editedSceneOf(const File& file, const Scene& before) {
    const auto scenes = file.json.find("scenes");
    if (before.sceneNumber < 0 || scenes == file.json.end()) return file.json.value("scene", 0);
    if (static_cast<size_t>(before.sceneNumber) >= scenes->size())
        throw Error(fmt::format("{}: has no scene {} any more: the file has changed, load it again",
                                file.path, before.sceneNumber));
    return before.sceneNumber;
}

/// Throws Error for an object that stands somewhere else than its node's transform says.
void requireMovable(const Scene& before, const Instance& instance, const std::string& target) {
    const char* why = instance.bent ? "has a skin, so that it stands where its joints are, wherever its node "
                                      "is: put it back, and move its joints in the program that made it"
                      : before.posed ? "stands as an animation has it: put it back, or read the file without "
                                       "--time"
                                     : nullptr;
    if (why) throw Error(fmt::format("{}: object {} {}", target, inQuotes(instance.name), why));
}

/// Adds what has to move; returns the node of each instance of `after`.
std::vector<int> moveInstances(const NodeTree& tree, const Scene& before, const Scene& after,
                               const std::string& target, Moves& moves) {
    std::vector<int> nodes;
    std::map<std::pair<int, int>, const Instance*> known;
    for (const Instance& instance : before.instances)
        known[{instance.node, instance.copy}] = &instance;
    for (const Instance& instance : after.instances) {
        const auto found = known.find({instance.node, instance.copy});
        if (instance.node < 0 || found == known.end() || static_cast<size_t>(instance.node) >= tree.size() ||
            !tree.node(instance.node).contains("mesh"))
            throw Error(fmt::format("{}: object {} is not in {}: objects cannot be added, remove it or load "
                                    "the file again",
                                    target, inQuotes(instance.name), before.path));
        nodes.push_back(instance.node);
        const glm::mat4 &from = found->second->transform, &to = instance.transform;
        if (from == to) continue;
        requireMovable(before, instance, target);
        for (int i = 0; i < 16; ++i)
            if (!std::isfinite(to[i / 4][i % 4]))
                throw Error(fmt::format("{}: object {} has a position that is not finite: place it again",
                                        target, inQuotes(instance.name)));
        if (instance.copy < 0) moves[instance.node][Carried::Instance] = {instance.name, from, to};
    }
    return nodes;
}

/// Throws Error for a light of an animated scene that was moved: its node's transform in the file is another
/// one.
void requireStill(const Scene& before, const Scene& after, const std::string& target) {
    std::map<std::pair<int, bool>, const Light*> known;
    for (const Light& light : before.lights)
        known[{light.node, isAreaLight(light.type)}] = &light;
    for (const Light& light : after.lights) {
        const auto found = known.find({light.node, isAreaLight(light.type)});
        if (found != known.end() && found->second->transform != light.transform)
            throw Error(
                fmt::format("{}: light {} stands as an animation has it: put it back, or read the file "
                            "without --time",
                            target, inQuotes(light.name)));
    }
}

/// Writes the density factors that differ into the nodes that carry the instances.
void editDensities(FileEdit& edit, const Scene& before, const Scene& after, const std::vector<int>& nodes) {
    const JsonPath path = {"extras", "relume", "density"};
    std::map<int, float> known;
    for (const Instance& instance : before.instances)
        known[instance.node] = instance.density;
    for (size_t i = 0; i < nodes.size(); ++i) {
        const float density = after.instances[i].density;
        if (known[after.instances[i].node] == density) continue;
        if (!(density >= kLeastDensity && density <= kMostDensity))
            throw Error(fmt::format("{}: object {} has a density of {}: give one from {:g} to {:g}",
                                    edit.file.path, inQuotes(after.instances[i].name), density, kLeastDensity,
                                    kMostDensity));
        EditedJson& node = edit.json["nodes"][static_cast<size_t>(nodes[i])];
        if (density == 1.0f)
            erase(node, path);
        else
            setNumber(make(edit, node, path, fmt::format("nodes[{}]", nodes[i])), density);
    }
}

/// Makes all changes in the JSON.
EditedNodes apply(FileEdit& edit, const Scene& before, const Scene& after, const std::string& target) {
    const NodeTree tree(edit.file, edit.scene);
    EditedNodes nodes;
    Moves moves;
    editMaterials(edit, before.materials, after.materials, target);
    editSky(edit, before.sky, after.sky, target);
    LightEdit lights(edit, tree, target);
    nodes.lights = lights.apply(before.lights, after.lights, moves);
    if (before.posed) requireStill(before, after, target);
    nodes.instances = moveInstances(tree, before, after, target, moves);
    editCopies(edit, tree, before, after, target);
    VisibilityEdit visibility(edit, tree);
    visibility.apply(before, after, moves);
    const auto children = moveCarried(edit, tree, moves);
    for (size_t i = 0; i < nodes.lights.size(); ++i) {
        const bool area = isAreaLight(after.lights[i].type);
        const auto child = children.find({nodes.lights[i], area ? Carried::AreaLight : Carried::Light});
        if (child != children.end()) nodes.lights[i] = child->second;
    }
    for (int& node : nodes.instances)
        if (const auto child = children.find({node, Carried::Instance}); child != children.end())
            node = child->second;
    visibility.finish(children);
    editDensities(edit, before, after, nodes.instances);
    lights.dropUnused();
    dropEmptyNodes(edit, lights.emptied());
    moveUris(edit, target);
    return nodes;
}

} // namespace

} // namespace gltf

EditedNodes saveEditedGltf(const std::string& source, const Scene& before, const Scene& after,
                           const std::string& target) {
    const gltf::File file = gltf::readFile(source);
    gltf::check(file);
    gltf::requireSameKind(file, target);
    const std::string_view text = gltf::jsonText(file);
    gltf::FileEdit edit(file);
    edit.scene = gltf::editedSceneOf(file, before);
    const gltf::EditedJson was = edit.json;
    EditedNodes nodes;
    try {
        nodes = gltf::apply(edit, before, after, target);
    } catch (const nlohmann::json::exception& error) { // of another type than glTF has there
        edit.fail("its JSON cannot be edited (" + inQuotes(error.what()) + ")");
    }
    std::string edited(text);
    if (edit.json != was) {
        edited = patchJsonText(text, was, edit.json);
        // This takes away a GLB's padding, which is made anew.
        if (file.binary) edited.erase(edited.find_last_of('}') + 1);
    }
    writeFileAtomically(target, gltf::withJsonText(file, edited));
    return nodes;
}

Scene partsOfEdits(const Scene& scene) {
    Scene parts;
    parts.path = scene.path;
    parts.sceneNumber = scene.sceneNumber;
    parts.posed = scene.posed;
    parts.materials = scene.materials;
    parts.instances = scene.instances;
    parts.lights = scene.lights;
    static_cast<SkySettings&>(parts.sky) = scene.sky;
    return parts;
}

} // namespace relume
