#include "assets/gltf/file/gltf_size.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/uri.h"
#include "assets/base/warnings.h"
#include "assets/gltf/file/gltf_check_extensions.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

namespace relume::gltf {

namespace {

using nlohmann::json;

constexpr double kMi = 1 << 20, kGi = 1 << 30;

struct Bound {
    const char* what;
    double free;    // for every file
    double perByte; // of the file
    bool isCount;
};

// The bounds allow for these cases. Vertices: a hundred primitives may share 100,000 vertices, each of which
// takes 56 bytes here and 20 to 40 in the file. Texels: JPEG's best case, a picture of one colour, makes 1400
// bytes of one; photographs make 10 to 60. Triangles: a forest is thousands of instances of few trees.
constexpr std::array<Bound, 5> kBounds = {{{"buffers", kGi, 16, false},
                                           {"vertices", kGi, 64, false},
                                           {"pixels", 2 * kGi, 256, false},
                                           {"names", kGi / 4, 16, false},
                                           {"triangles", 16 * kMi, 4, true}}};

std::string bytesText(double bytes) {
    if (bytes < 1024) return fmt::format("{:.0f} bytes", bytes);
    if (bytes < kMi) return fmt::format("{:.1f} KiB", bytes / 1024);
    return bytes < kGi ? fmt::format("{:.1f} MiB", bytes / kMi) : fmt::format("{:.1f} GiB", bytes / kGi);
}

const json* find(const json& object, const char* key) {
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

const json& section(const json& root, const char* key) {
    static const json none = json::array();
    const json* list = find(root, key);
    return list ? *list : none;
}

uint64_t numberOf(const json& object, const char* key) {
    const json* value = find(object, key);
    return value ? value->get<uint64_t>() : 0;
}

/// Returns the entry of a section that a member of `object` names, or nullptr where it has none.
const json* entry(const json& root, const json& object, const char* key, const char* section) {
    const json* index = find(object, key);
    return index ? &root[section][index->get<size_t>()] : nullptr;
}

double lengthOf(const json* named) {
    const json* name = named ? find(*named, "name") : nullptr;
    return name ? static_cast<double>(name->get_ref<const std::string&>().size()) : 0.0;
}

double countOf(const json& accessor) {
    return static_cast<double>(accessor["count"].get<uint64_t>());
}

/// Returns what the importer makes of a primitive [bytes]: floats of what it uses, and vertices for each
/// corner where it has no normals.
double primitiveBytes(const json& root, const json& primitive) {
    constexpr double kNormal = 12, kIndex = 4;
    constexpr std::array<std::pair<const char*, double>, 5> kUsed = {
        {{"POSITION", 12}, {"NORMAL", kNormal}, {"TEXCOORD_0", 8}, {"TEXCOORD_1", 8}, {"COLOR_0", 16}}};
    const json& attributes = primitive["attributes"];
    const uint64_t mode = find(primitive, "mode") ? numberOf(primitive, "mode") : 4;
    const json* positions = entry(root, attributes, "POSITION", "accessors");
    if (mode < 4 || !positions) return 0;
    double bytes = 0, vertexBytes = 0;
    for (const auto& [name, size] : kUsed)
        if (const json* accessor = entry(root, attributes, name, "accessors")) {
            bytes += size * countOf(*accessor);
            vertexBytes += size;
        }
    const json* indices = entry(root, primitive, "indices", "accessors");
    // Strips and fans have a triangle for each index but two.
    const double corners = countOf(indices ? *indices : *positions) * (mode == 4 ? 1 : 3);
    bytes += corners * kIndex;
    if (!find(attributes, "NORMAL")) bytes += corners * (vertexBytes + kNormal);
    return bytes;
}

double vertexBytes(const json& root) {
    double bytes = 0;
    std::vector<double> ofBent; // of each mesh that a node may bend, which takes vertices of its own
    for (const json& mesh : section(root, "meshes")) {
        double ofMesh = 0;
        bool bends = false;
        for (const json& primitive : mesh["primitives"]) {
            ofMesh += primitiveBytes(root, primitive);
            bends = bends || find(primitive, "targets") || find(primitive["attributes"], "JOINTS_0");
        }
        bytes += ofMesh;
        ofBent.push_back(bends ? ofMesh : 0);
    }
    for (const json& node : section(root, "nodes"))
        if (const json* mesh = find(node, "mesh")) bytes += ofBent[mesh->get<size_t>()];
    return bytes;
}

/// Returns the size of the buffer views that are compressed, as they are when they are decoded [bytes].
double decodedBytes(const json& root) {
    double bytes = 0;
    for (const json& view : section(root, "bufferViews"))
        if (const json* use = extensionOf(view, kMeshopt))
            bytes += static_cast<double>(numberOf(*use, "count")) *
                     static_cast<double>(numberOf(*use, "byteStride"));
    return bytes;
}

/// Returns how many copies of its mesh a node places; 0 where it is one object.
uint64_t copiesOf(const json& root, const json& node) {
    const json* use = extensionOf(node, kInstancing);
    const json* attributes = use ? find(*use, "attributes") : nullptr;
    uint64_t copies = 0;
    if (!attributes) return 0;
    for (const char* key : {"TRANSLATION", "ROTATION", "SCALE"})
        if (const json* accessor = entry(root, *attributes, key, "accessors"))
            copies = std::max(copies, numberOf(*accessor, "count"));
    return copies;
}

/// Returns the size of the names of objects, lights and cameras, which have that of their mesh or node where
/// they have none [bytes].
double nameBytes(const json& root) {
    const json::json_pointer use("/extensions/KHR_lights_punctual/light");
    const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
    constexpr double kCopy = 128; // what an object of its own takes beside its name
    double bytes = 0;
    for (const json& node : section(root, "nodes")) {
        if (find(node, "mesh"))
            bytes += static_cast<double>(copiesOf(root, node)) *
                     (kCopy + lengthOf(&node) + lengthOf(entry(root, node, "mesh", "meshes")));
        bytes += lengthOf(&node) + lengthOf(entry(root, node, "mesh", "meshes")) +
                 lengthOf(entry(root, node, "camera", "cameras"));
        if (node.contains(use)) bytes += lengthOf(&root[lights][node[use].get<size_t>()]);
    }
    return bytes;
}

class StoredBytes {
public:
    explicit StoredBytes(const File& file) : file_(file) {}

    /// Returns the size of a file that a URI names, which is read once for each use; 0 for data and where
    /// none can be read.
    double external(const json& holder) {
        const json* uri = find(holder, "uri");
        const std::string path = uri ? pathOfUri(file_, uri->get<std::string>()) : "";
        std::error_code code;
        if (path.empty() || !oddKindOf(path).empty()) return 0;
        const auto size = std::filesystem::file_size(path, code);
        if (code) return 0;
        if (known_.insert(path).second) bytes_ += size;
        return static_cast<double>(size);
    }
    uint64_t bytes() const { return file_.bytes.size() + bytes_; }

private:
    const File& file_;
    std::set<std::string> known_;
    uint64_t bytes_ = 0;
};

void refuseOddBuffers(const File& file) {
    size_t index = 0;
    for (const json& buffer : section(file.json, "buffers")) {
        const json* uri = find(buffer, "uri");
        const std::string path = uri ? pathOfUri(file, uri->get<std::string>()) : "";
        const std::string kind = path.empty() ? "" : oddKindOf(path);
        if (!kind.empty())
            throw Error(fmt::format("{}: buffers[{}].uri {} {}: put the scene's own file there, or export it "
                                    "again",
                                    file.path, index, inQuotes(uri->get<std::string>()), kind));
        ++index;
    }
}

} // namespace

void SizeLimit::require(Made made, double amount) const {
    const Bound& bound = kBounds[static_cast<size_t>(made)];
    const double most = bound.free + bound.perByte * static_cast<double>(bytes_);
    if (amount <= most) return;
    const auto text = [&](double value) {
        return bound.isCount ? fmt::format("{:.0f}", value) : bytesText(value);
    };
    throw Error(
        fmt::format("{}: makes {} of {} out of {}, of which {} are allowed: the file is damaged, export "
                    "it again or split it",
                    path_, text(amount), bound.what, bytesText(static_cast<double>(bytes_)), text(most)));
}

void SizeLimit::addTexels(uint64_t bytes) {
    texels_ += static_cast<double>(bytes);
    require(Made::Texels, texels_);
}

SizeLimit checkSizes(const File& file) {
    refuseOddBuffers(file);
    const json& root = file.json;
    StoredBytes stored(file);
    double buffers = 0;
    for (const json& buffer : section(root, "buffers")) {
        if (isPlaceholder(buffer)) continue;
        stored.external(buffer);
        buffers += static_cast<double>(numberOf(buffer, "byteLength"));
    }
    buffers += decodedBytes(root);
    for (const json& image : section(root, "images")) {
        const json* view = entry(root, image, "bufferView", "bufferViews");
        buffers += view ? static_cast<double>(numberOf(*view, "byteLength")) : stored.external(image);
    }
    const SizeLimit limit(file.path, stored.bytes());
    limit.require(Made::Buffers, buffers);
    limit.require(Made::Vertices, vertexBytes(root));
    limit.require(Made::Names, nameBytes(root));
    return limit;
}

std::string pathOfUri(const std::string& gltfPath, const std::string& uri) {
    if (uri.starts_with("data:")) return "";
    const std::string folder = std::filesystem::path(gltfPath).parent_path().string();
    return folder.empty() ? decodedUri(uri) : folder + "/" + decodedUri(uri);
}

std::string pathOfUri(const File& file, const std::string& uri) {
    return pathOfUri(file.path, uri);
}

} // namespace relume::gltf
