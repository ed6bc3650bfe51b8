#include "assets/gltf/gltf_check.h"

#include "assets/base/error.h"
#include "assets/base/warnings.h"
#include "assets/gltf/file/gltf_check_extensions.h"
#include "assets/gltf/file/gltf_check_json.h"
#include "assets/gltf/gltf_node.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace relume::gltf {

namespace {

using nlohmann::json;

/// Checks one file's JSON.
class Checker : private JsonChecks {
public:
    explicit Checker(const File& file) : JsonChecks(file) {}
    void run() const;

private:
    using Check = void (Checker::*)(const json&, const std::string&) const;

    void each(const char* section, Check checkOne) const;

    void version() const;
    void extensions() const;
    void buffer(const json& value, const std::string& where) const;
    void view(const json& value, const std::string& where) const;
    void accessor(const json& value, const std::string& where) const;
    void sparse(const json& value, const std::string& where, int64_t elements, uint64_t elementBytes) const;
    void range(const json& holder, const std::string& where, uint64_t bytes, uint64_t elements,
               uint64_t elementBytes) const;
    void mesh(const json& value, const std::string& where) const;
    void primitive(const json& value, const std::string& where) const;
    void node(const json& value, const std::string& where) const;
    void light(const json& node, const std::string& where) const;
    void lights() const;
    const json* own(const json& holder, const char* key, const std::string& where) const;
    void scene(const json& value, const std::string& where) const;
    void textureUse(const json& holder, const char* key, const std::string& where) const;
    void material(const json& value, const std::string& where) const;
    void texture(const json& value, const std::string& where) const;
    void image(const json& value, const std::string& where) const;
    void parents() const;
    void climb(size_t root, const std::vector<int>& parentOf, std::vector<bool>& ends) const;
};

void Checker::each(const char* section, Check checkOne) const {
    const json* list = member(root_, section);
    if (!list) return;
    for (size_t i = 0; i < list->size(); ++i) {
        const std::string where = fmt::format("{}[{}]", section, i);
        const json& value = object((*list)[i], where);
        text(value, "name", where);
        (this->*checkOne)(value, where);
    }
}

void Checker::version() const {
    const json* asset = member(root_, "asset");
    const json* version = asset && asset->is_object() ? member(*asset, "version") : nullptr;
    if (!version || !version->is_string())
        throw Error(fmt::format("{}: has no asset.version: give a glTF 2.0 file", file_.path));
    if (version->get<std::string>().rfind("2.", 0) != 0)
        throw Error(fmt::format("{}: is glTF {}, only 2.0 is supported: export it as glTF 2.0", file_.path,
                                inQuotes(version->get<std::string>())));
}

void Checker::extensions() const {
    for (const char* section : {"extensionsRequired", "extensionsUsed"}) {
        const json* list = member(root_, section);
        if (!list) continue;
        const bool good = list->is_array() && std::all_of(list->begin(), list->end(),
                                                          [](const json& v) { return v.is_string(); });
        if (!good) fail(fmt::format("{} is not an array of strings", section));
    }
    checkRequired(*this);
}

void Checker::buffer(const json& value, const std::string& where) const {
    const int64_t bytes = size(value, "byteLength", where, -1);
    if (bytes < 1) fail(where + ".byteLength is missing or 0");
    text(value, "uri", where);
    if (member(value, "uri") || isPlaceholder(value)) return;
    if (!file_.binary) fail(where + " has no uri");
    if (static_cast<uint64_t>(bytes) > file_.chunkBytes + kPadding)
        fail(fmt::format("{} holds {} bytes, but the binary chunk has {}", where, bytes, file_.chunkBytes));
}

void Checker::view(const json& value, const std::string& where) const {
    const int64_t bufferIndex = index(value, "buffer", where, "buffers");
    if (bufferIndex < 0) fail(where + ".buffer is missing");
    const int64_t offset = size(value, "byteOffset", where, 0), bytes = size(value, "byteLength", where, -1);
    if (bytes < 1) fail(where + ".byteLength is missing or 0");
    const int64_t held = root_["buffers"][static_cast<size_t>(bufferIndex)]["byteLength"].get<int64_t>();
    if (offset + bytes > held)
        fail(fmt::format("{} ends at byte {}, but its buffer has {}", where, offset + bytes, held));
    const int64_t stride = integer(value, "byteStride", where, 0);
    if (stride != 0 && (stride < 4 || stride > 252 || stride % 4 != 0))
        fail(fmt::format("{}.byteStride is {}, not a multiple of 4 up to 252", where, stride));
    if (extension(value, kMeshopt, where))
        checkCompressedView(*this, value, where);
    else if (isPlaceholder(root_["buffers"][static_cast<size_t>(bufferIndex)]) &&
             !member(root_["buffers"][static_cast<size_t>(bufferIndex)], "uri"))
        fail(where + " lies in a buffer without bytes of its own");
}

/// Checks that the elements read from the view and offset that `holder` names end inside the view.
void Checker::range(const json& holder, const std::string& where, uint64_t stride, uint64_t elements,
                    uint64_t elementBytes) const {
    const int64_t viewIndex = index(holder, "bufferView", where, "bufferViews");
    if (viewIndex < 0) fail(where + ".bufferView is missing");
    const json& bufferView = root_["bufferViews"][static_cast<size_t>(viewIndex)];
    const uint64_t held = bufferView["byteLength"].get<uint64_t>();
    if (stride == 0) stride = static_cast<uint64_t>(integer(bufferView, "byteStride", where, 0));
    if (stride == 0) stride = elementBytes;
    const uint64_t offset = static_cast<uint64_t>(size(holder, "byteOffset", where, 0));
    const uint64_t end = offset + (elements - 1) * stride + elementBytes;
    if (end > held)
        fail(fmt::format("{} reads up to byte {} of bufferViews[{}], which has {}", where, end, viewIndex,
                         held));
}

void Checker::accessor(const json& value, const std::string& where) const {
    const uint32_t component = componentBytes(integer(value, "componentType", where));
    if (component == 0) fail(where + ".componentType is missing or unknown");
    text(value, "type", where);
    const json* type = member(value, "type");
    const uint32_t components = type ? componentCount(type->get<std::string>()) : 0;
    if (components == 0) fail(where + ".type is missing or unknown");
    const json* normalized = member(value, "normalized");
    if (normalized && !normalized->is_boolean()) fail(where + ".normalized is not a boolean");
    const int64_t elements = integer(value, "count", where);
    if (elements < 1) fail(where + ".count is missing or 0");
    const uint64_t elementBytes = uint64_t(component) * components;
    if (member(value, "bufferView")) range(value, where, 0, static_cast<uint64_t>(elements), elementBytes);
    const json* sparsePart = member(value, "sparse");
    if (sparsePart) sparse(object(*sparsePart, where + ".sparse"), where + ".sparse", elements, elementBytes);
    // These are zeros without a buffer: nothing in the file bounds them, so a damaged count could ask for all
    // memory. checkSizes bounds what several uses make of them.
    if (!member(value, "bufferView") && elements > int64_t(1) << 26)
        fail(where + ".count is far too large for an accessor without data");
}

void Checker::sparse(const json& value, const std::string& where, int64_t elements,
                     uint64_t elementBytes) const {
    const int64_t entries = integer(value, "count", where);
    if (entries < 1 || entries > elements) fail(where + ".count is not between 1 and the accessor's count");
    const json *indices = member(value, "indices"), *values = member(value, "values");
    if (!indices || !indices->is_object() || !values || !values->is_object())
        fail(where + " has no indices or no values");
    const int64_t type = integer(*indices, "componentType", where + ".indices");
    if (type != 5121 && type != 5123 && type != 5125) fail(where + ".indices.componentType is not unsigned");
    const uint32_t indexBytes = componentBytes(type);
    range(*indices, where + ".indices", indexBytes, static_cast<uint64_t>(entries), indexBytes);
    range(*values, where + ".values", elementBytes, static_cast<uint64_t>(entries), elementBytes);
}

void Checker::mesh(const json& value, const std::string& where) const {
    const json* primitives = member(value, "primitives");
    if (!primitives || !primitives->is_array()) fail(where + ".primitives is missing or no array");
    for (size_t i = 0; i < primitives->size(); ++i) {
        const std::string here = fmt::format("{}.primitives[{}]", where, i);
        primitive(object((*primitives)[i], here), here);
    }
}

void Checker::primitive(const json& value, const std::string& where) const {
    const json* attributes = member(value, "attributes");
    if (!attributes || !attributes->is_object()) fail(where + ".attributes is missing or no object");
    for (const auto& [name, unused] : attributes->items())
        index(*attributes, name.c_str(), where + ".attributes", "accessors");
    checkDraco(*this, value, where);
    checkTargets(*this, value, where);
    const int64_t indices = index(value, "indices", where, "accessors");
    if (indices >= 0 && !extensionOf(value, kDraco)) {
        const json& used = root_["accessors"][static_cast<size_t>(indices)];
        if (!member(used, "bufferView") && !member(used, "sparse")) fail(where + ".indices has no data");
    }
    index(value, "material", where, "materials");
    integer(value, "mode", where, 4, 6);
}

void Checker::node(const json& value, const std::string& where) const {
    index(value, "mesh", where, "meshes");
    index(value, "camera", where, "cameras");
    index(value, "skin", where, "skins");
    numbers(value, "matrix", where, 16);
    numbers(value, "rotation", where, 4);
    numbers(value, "scale", where, 3);
    numbers(value, "translation", where, 3);
    light(value, where);
    checkInstancing(*this, value, where);
    if (const json* area = own(value, "areaLight", where)) {
        text(*area, "name", where + ".extras.relume.areaLight");
        text(*area, "type", where + ".extras.relume.areaLight");
    }
    const json* children = member(value, "children");
    if (!children) return;
    if (!children->is_array()) fail(where + ".children is no array");
    for (const json& child : *children)
        if (!child.is_number_unsigned() || child.get<uint64_t>() >= count("nodes"))
            fail(fmt::format("{}.children names node {}, but there are {}", where, inQuotes(child.dump()),
                             count("nodes")));
}

void Checker::light(const json& node, const std::string& where) const {
    const json* extensions = member(node, "extensions");
    if (!extensions) return;
    object(*extensions, where + ".extensions");
    const json* use = member(*extensions, "KHR_lights_punctual");
    if (!use) return;
    const std::string here = where + ".extensions.KHR_lights_punctual";
    const int64_t value = integer(object(*use, here), "light", here);
    if (value < 0) fail(here + " names no light");
    const json::json_pointer list("/extensions/KHR_lights_punctual/lights");
    const uint64_t entries = root_.contains(list) ? root_[list].size() : 0;
    if (static_cast<uint64_t>(value) >= entries)
        fail(fmt::format("{} names light {}, but there are {}", here, value, entries));
}

void Checker::lights() const {
    const json* extensions = member(root_, "extensions");
    const json* used =
        extensions ? member(object(*extensions, "extensions"), "KHR_lights_punctual") : nullptr;
    if (!used) return;
    const std::string here = "extensions.KHR_lights_punctual";
    const json* list = member(object(*used, here), "lights");
    if (!list) return;
    if (!list->is_array()) fail(here + ".lights is no array");
    for (size_t i = 0; i < list->size(); ++i) {
        const std::string where = fmt::format("{}.lights[{}]", here, i);
        const json& value = object((*list)[i], where);
        text(value, "name", where);
        text(value, "type", where);
        if (const json* spot = member(value, "spot")) object(*spot, where + ".spot");
        own(value, nullptr, where);
    }
}

/// Returns the member `key` of extras.relume. Others' extras may be anything; ours are objects and hold
/// objects.
const json* Checker::own(const json& holder, const char* key, const std::string& where) const {
    const json* extras = member(holder, "extras");
    const json* ours = extras && extras->is_object() ? member(*extras, "relume") : nullptr;
    if (!ours) return nullptr;
    object(*ours, where + ".extras.relume");
    const json* value = key ? member(*ours, key) : nullptr;
    return value ? &object(*value, fmt::format("{}.extras.relume.{}", where, key)) : nullptr;
}

void Checker::scene(const json& value, const std::string& where) const {
    if (const json* sky = own(value, "sky", where)) text(*sky, "file", where + ".extras.relume.sky");
    const json* nodes = member(value, "nodes");
    if (!nodes) return;
    if (!nodes->is_array()) fail(where + ".nodes is no array");
    for (const json& root : *nodes)
        if (!root.is_number_unsigned() || root.get<uint64_t>() >= count("nodes"))
            fail(fmt::format("{} names node {}, but there are {}", where, inQuotes(root.dump()),
                             count("nodes")));
}

void Checker::textureUse(const json& holder, const char* key, const std::string& where) const {
    const json* use = member(holder, key);
    if (!use) return;
    const std::string here = where + "." + key;
    object(*use, here);
    if (index(*use, "index", here, "textures") < 0) fail(here + ".index is missing");
    integer(*use, "texCoord", here);
}

void Checker::material(const json& value, const std::string& where) const {
    numbers(value, "emissiveFactor", where, 3);
    number(value, "alphaCutoff", where);
    text(value, "alphaMode", where);
    textureUse(value, "emissiveTexture", where);
    textureUse(value, "normalTexture", where);
    textureUse(value, "occlusionTexture", where);
    const json* pbr = member(value, "pbrMetallicRoughness");
    if (!pbr) return;
    const std::string here = where + ".pbrMetallicRoughness";
    object(*pbr, here);
    numbers(*pbr, "baseColorFactor", here, 4);
    number(*pbr, "metallicFactor", here);
    number(*pbr, "roughnessFactor", here);
    textureUse(*pbr, "baseColorTexture", here);
    textureUse(*pbr, "metallicRoughnessTexture", here);
}

void Checker::texture(const json& value, const std::string& where) const {
    index(value, "source", where, "images");
    index(value, "sampler", where, "samplers");
}

void Checker::image(const json& value, const std::string& where) const {
    index(value, "bufferView", where, "bufferViews");
    text(value, "uri", where);
    text(value, "mimeType", where);
}

/// Checks that each node has at most one parent, and that no parents of a scene's roots stand in a circle:
/// then no walk is endless.
void Checker::parents() const {
    const json* nodes = member(root_, "nodes");
    if (!nodes) return;
    const std::vector<int> parentOf = parentsOf(*nodes, [this](size_t node) {
        throw Error(fmt::format("{}: nodes[{}] has two parents: the node hierarchy must be a tree without "
                                "cycles, export it again",
                                file_.path, node));
    });
    const json* scenes = member(root_, "scenes");
    if (!scenes) return;
    std::vector<bool> ends(nodes->size()); // the nodes from which a walk upwards is known to end
    for (const json& value : *scenes) {
        const json* roots = member(value, "nodes");
        if (!roots) continue;
        for (const json& root : *roots)
            climb(root.get<size_t>(), parentOf, ends);
    }
}

void Checker::climb(size_t root, const std::vector<int>& parentOf, std::vector<bool>& ends) const {
    std::vector<size_t> way;
    for (int node = static_cast<int>(root); node >= 0 && !ends[static_cast<size_t>(node)];
         node = parentOf[static_cast<size_t>(node)]) {
        way.push_back(static_cast<size_t>(node));
        if (way.size() > ends.size())
            throw Error(
                fmt::format("{}: nodes[{}] is its own ancestor: the node hierarchy must be a tree without "
                            "cycles, export it again",
                            file_.path, root));
    }
    for (const size_t node : way)
        ends[node] = true;
}

void Checker::run() const {
    version();
    extensions();
    for (const char* section :
         {"buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes", "materials", "textures",
          "images", "samplers", "cameras", "skins", "animations"}) {
        const json* list = member(root_, section);
        if (list && !list->is_array()) fail(fmt::format("{} is no array", section));
    }
    each("buffers", &Checker::buffer);
    each("bufferViews", &Checker::view);
    each("accessors", &Checker::accessor);
    each("meshes", &Checker::mesh);
    lights();
    each("nodes", &Checker::node);
    each("scenes", &Checker::scene);
    index(root_, "scene", "the file", "scenes");
    each("materials", &Checker::material);
    each("textures", &Checker::texture);
    each("images", &Checker::image);
    parents();
}

} // namespace

uint32_t componentBytes(int64_t componentType) {
    switch (componentType) {
    case 5120: // byte
    case 5121: // unsigned byte
        return 1;
    case 5122: // short
    case 5123: // unsigned short
        return 2;
    case 5125: // unsigned int
    case 5126: // float
        return 4;
    default:
        return 0;
    }
}

uint32_t componentCount(const std::string& type) {
    if (type == "SCALAR") return 1;
    if (type == "VEC2") return 2;
    if (type == "VEC3") return 3;
    if (type == "VEC4" || type == "MAT2") return 4;
    if (type == "MAT3") return 9;
    if (type == "MAT4") return 16;
    return 0;
}

void check(const File& file) {
    Checker(file).run();
}

std::vector<std::string> unknownExtensions(const File& file) {
    std::vector<std::string> unknown;
    for (const char* section : {"extensionsUsed", "extensionsRequired"}) {
        const auto listed = file.json.find(section);
        if (listed == file.json.end()) continue;
        for (const json& entry : *listed) {
            const std::string name = entry.get<std::string>();
            if (!isKnownExtension(name) && std::find(unknown.begin(), unknown.end(), name) == unknown.end())
                unknown.push_back(name);
        }
    }
    return unknown;
}

} // namespace relume::gltf
