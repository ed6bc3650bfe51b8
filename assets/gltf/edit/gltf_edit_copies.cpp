#include "assets/gltf/edit/gltf_edit_copies.h"

#include "assets/base/error.h"
#include "assets/base/uri.h"
#include "assets/base/warnings.h"
#include "assets/gltf/edit/gltf_edit_transform.h"
#include "assets/gltf/file/gltf_check_extensions.h"
#include "assets/gltf/gltf_instancing.h"

#include <glm/gtc/quaternion.hpp>
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace relume::gltf {

namespace {

using nlohmann::json;

constexpr const char* kOwnName = "Relume: copies"; // of accessors, views and buffers that are made here

/// Says what is to become of the copies of a node.
struct NodeChange {
    std::map<size_t, std::pair<const Instance*, const Instance*>> moved; // by copy: as it was, as it is to be
    std::set<size_t> hidden;
    bool hides = false; // which are hidden differs
    bool all = true;    // are hidden, which the node does
};

std::map<int, NodeChange> changesOf(const Scene& before, const Scene& after) {
    std::map<std::pair<int, int>, const Instance*> known;
    for (const Instance& instance : before.instances)
        known[{instance.node, instance.copy}] = &instance;
    std::map<int, NodeChange> changes;
    for (const Instance& instance : after.instances) {
        const auto was = known.find({instance.node, instance.copy});
        if (instance.copy < 0 || instance.bent || was == known.end()) continue;
        NodeChange& change = changes[instance.node];
        const auto copy = static_cast<size_t>(instance.copy);
        if (was->second->transform != instance.transform) change.moved[copy] = {was->second, &instance};
        change.hides = change.hides || was->second->hidden != instance.hidden;
        if (instance.hidden)
            change.hidden.insert(copy);
        else
            change.all = false;
    }
    std::erase_if(changes, [](const auto& change) {
        return change.second.moved.empty() && (!change.second.hides || change.second.all);
    });
    return changes;
}

/// Tells whether only one place in a section of the file names an entry of another: a view names its buffer.
bool isNamedOnce(EditedJson& root, const char* section, const char* key, size_t index) {
    size_t names = 0;
    for (const EditedJson& entry : root[section])
        names += entry.value(key, EditedJson()) == index ? 1 : 0;
    return names == 1;
}

bool isOwn(const EditedJson& entry) {
    const auto name = entry.find("name");
    return name != entry.end() && *name == kOwnName;
}

/// Holds the index of an accessor with its view and its buffer.
struct OwnAccessor {
    size_t accessor, view, buffer;
};

/// Returns the accessor of an attribute where it was made by an earlier edit for this attribute alone.
std::optional<OwnAccessor> ownAccessorOf(EditedJson& root, const EditedJson& attributes, const char* name) {
    if (!attributes.contains(name)) return std::nullopt;
    OwnAccessor own{attributes[name].get<size_t>(), 0, 0};
    size_t users = 0;
    for (EditedJson& node : root["nodes"])
        if (const EditedJson* others = find(node, {"extensions", kInstancing, "attributes"}))
            for (const EditedJson& other : *others)
                users += other == own.accessor ? 1 : 0;
    const EditedJson& accessor = root["accessors"][own.accessor];
    if (users != 1 || !isOwn(accessor) || !accessor.contains("bufferView")) return std::nullopt;
    own.view = accessor["bufferView"].get<size_t>();
    const EditedJson& view = root["bufferViews"][own.view];
    if (!isOwn(view) || !isNamedOnce(root, "accessors", "bufferView", own.view)) return std::nullopt;
    own.buffer = view["buffer"].get<size_t>();
    if (!isOwn(root["buffers"][own.buffer]) || !isNamedOnce(root, "bufferViews", "buffer", own.buffer))
        return std::nullopt;
    return own;
}

size_t append(EditedJson& root, const char* section, EditedJson entry) {
    EditedJson& list = root[section];
    if (list.is_null()) list = EditedJson::array();
    list.push_back(std::move(entry));
    return list.size() - 1;
}

void setAttribute(FileEdit& edit, size_t node, const char* name, const std::vector<float>& values,
                  size_t components) {
    const std::string_view bytes(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    EditedJson& root = edit.json;
    const auto attributes = [&]() -> EditedJson& {
        return root["nodes"][node]["extensions"][kInstancing]["attributes"];
    };
    if (const std::optional<OwnAccessor> own = ownAccessorOf(root, attributes(), name)) {
        root["buffers"][own->buffer]["byteLength"] = bytes.size();
        root["buffers"][own->buffer]["uri"] = dataUriOf(bytes);
        root["bufferViews"][own->view]["byteLength"] = bytes.size();
        root["accessors"][own->accessor]["count"] = values.size() / components;
        return;
    }
    constexpr int kFloat = 5126;
    const size_t buffer = append(
        root, "buffers", {{"name", kOwnName}, {"byteLength", bytes.size()}, {"uri", dataUriOf(bytes)}});
    const size_t view =
        append(root, "bufferViews", {{"name", kOwnName}, {"buffer", buffer}, {"byteLength", bytes.size()}});
    const size_t accessor = append(root, "accessors",
                                   {{"name", kOwnName},
                                    {"bufferView", view},
                                    {"componentType", kFloat},
                                    {"count", values.size() / components},
                                    {"type", components == 3 ? "VEC3" : "VEC4"}});
    attributes()[name] = accessor;
}

/// The numbers of a node's copies while they are edited, each list filled up to all copies.
class CopyLists {
public:
    explicit CopyLists(const CopyNumbers& numbers) : is_(numbers) {
        const size_t copies = numbers.most();
        if (is_.translations.empty()) is_.translations.assign(3 * copies, 0.0f);
        if (is_.scales.empty()) is_.scales.assign(3 * copies, 1.0f);
        if (is_.rotations.empty())
            for (size_t i = 0; i < copies; ++i)
                is_.rotations.insert(is_.rotations.end(), {0.0f, 0.0f, 0.0f, 1.0f});
        filled_ = is_;
    }

    glm::vec3 scale(size_t copy) const {
        return {is_.scales[3 * copy], is_.scales[3 * copy + 1], is_.scales[3 * copy + 2]};
    }
    void setScale(size_t copy, const glm::vec3& scale) { set(is_.scales, copy, &scale[0], 3); }
    void setTranslation(size_t copy, const glm::vec3& place) { set(is_.translations, copy, &place[0], 3); }
    void setRotation(size_t copy, const glm::dquat& q) {
        const std::array<float, 4> values = {float(q.x), float(q.y), float(q.z), float(q.w)};
        set(is_.rotations, copy, values.data(), 4);
    }
    void write(FileEdit& edit, size_t node) const {
        if (is_.translations != filled_.translations)
            setAttribute(edit, node, "TRANSLATION", is_.translations, 3);
        if (is_.rotations != filled_.rotations) setAttribute(edit, node, "ROTATION", is_.rotations, 4);
        if (is_.scales != filled_.scales) setAttribute(edit, node, "SCALE", is_.scales, 3);
    }

private:
    static void set(std::vector<float>& list, size_t copy, const float* values, size_t components) {
        for (size_t i = 0; i < components; ++i)
            list[components * copy + i] = values[i] + 0.0f; // not -0
    }
    CopyNumbers is_, filled_; // filled_: as it was, with what is usual where there was none
};

/// Edits the copies of one node.
class NodeCopies {
public:
    NodeCopies(FileEdit& edit, const NodeTree& tree, int node, const std::string& target)
        : edit_(edit), world_(tree.world(node)), source_(tree.node(node)), node_(static_cast<size_t>(node)),
          target_(target) {}

    void apply(Build& build, const NodeChange& change) {
        const CopyNumbers numbers = copyNumbersOf(build, source_, fmt::format("nodes[{}]", node_));
        std::map<size_t, glm::vec3> hidden = hiddenCopiesOf(source_, numbers);
        CopyLists lists(numbers);
        // Scales are edited as they are when all is shown.
        for (const auto& [copy, scale] : hidden)
            lists.setScale(copy, scale);
        for (const auto& [copy, move] : change.moved) {
            if (copy >= numbers.count()) edit_.fail(fmt::format("nodes[{}] has no copy {}", node_, copy));
            place(lists, copy, *move.first, *move.second);
        }
        std::set<size_t> wanted;
        for (const auto& [copy, scale] : hidden)
            wanted.insert(copy);
        if (!change.all) wanted = change.hidden;
        hidden.clear();
        for (const size_t copy : wanted) {
            hidden[copy] = lists.scale(copy);
            lists.setScale(copy, glm::vec3(0.0f));
        }
        lists.write(edit_, node_);
        writeHidden(hidden);
    }

private:
    void place(CopyLists& lists, size_t copy, const Instance& was, const Instance& is) const {
        if (!invertible(world_))
            fail(is, "cannot be moved, as its node or one above it has a scale of 0: give that node a scale");
        const glm::dmat4 local = glm::inverse(world_) * glm::dmat4(is.transform);
        for (int i = 0; i < 16; ++i)
            if (!std::isfinite(static_cast<float>(local[i / 4][i % 4])))
                fail(is, "stands too far away for its node: place it again");
        if (was.transform[3] != is.transform[3]) lists.setTranslation(copy, glm::vec3(local[3]));
        if (glm::mat3(was.transform) == glm::mat3(is.transform)) return;
        glm::dmat3 rotation(1.0);
        glm::dvec3 scale(lists.scale(copy));
        if (!splitLinear(glm::dmat3(local), rotation, scale))
            fail(is,
                 "gets a shear or no size in its node, which EXT_mesh_gpu_instancing cannot hold: turn or "
                 "scale it otherwise");
        lists.setRotation(copy, glm::normalize(glm::quat_cast(frame(rotation))));
        lists.setScale(copy, glm::vec3(scale));
    }
    [[noreturn]] void fail(const Instance& instance, const char* what) const {
        throw Error(fmt::format("{}: object {} {}", target_, inQuotes(instance.name), what));
    }
    void writeHidden(const std::map<size_t, glm::vec3>& hidden) {
        EditedJson& node = edit_.json["nodes"][node_];
        const JsonPath path = {"extras", "relume", "hiddenCopies"};
        if (hidden.empty()) return erase(node, path);
        EditedJson list = EditedJson::array();
        for (const auto& [copy, scale] : hidden) {
            EditedJson entry = {{"copy", copy}, {"scale", EditedJson::array()}};
            setNumbers(entry["scale"], numbersOf(scale));
            list.push_back(std::move(entry));
        }
        make(edit_, node, path, fmt::format("nodes[{}]", node_)) = std::move(list);
    }

    FileEdit& edit_;
    glm::dmat4 world_;
    const json& source_;
    size_t node_;
    const std::string& target_;
};

} // namespace

void editCopies(FileEdit& edit, const NodeTree& tree, const Scene& before, const Scene& after,
                const std::string& target) {
    const std::map<int, NodeChange> changes = changesOf(before, after);
    if (changes.empty()) return;
    Build build;
    build.path = edit.file.path;
    parse(edit.file, build);
    for (const auto& [node, change] : changes)
        NodeCopies(edit, tree, node, target).apply(build, change);
}

} // namespace relume::gltf
