#include "assets/gltf/gltf.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/watch.h"
#include "assets/gltf/gltf_animation.h"
#include "assets/gltf/gltf_build.h"
#include "assets/gltf/gltf_check.h"
#include "assets/gltf/gltf_compression.h"
#include "assets/gltf/file/gltf_file.h"
#include "assets/gltf/gltf_node.h"
#include "assets/gltf/file/gltf_value.h"
#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>

namespace relume {

namespace gltf {

namespace {

using nlohmann::json;

/// Returns the first line of a message: the parser's are several lines long and quote whole data URIs.
std::string firstLine(const std::string& text) {
    return inQuotes(text.substr(0, text.find('\n')));
}

/// Says which names there are, as far as they fit into a line.
std::string listed(const char* begin, const std::vector<std::string>& names) {
    constexpr size_t kMost = 20; // names that a line takes
    if (names.empty()) return fmt::format("{} none", begin);
    std::string text = begin;
    for (size_t i = 0; i < std::min(names.size(), kMost); ++i)
        text += (i == 0 ? " " : ", ") + inQuotes(names[i]);
    if (names.size() > kMost) text += fmt::format(" and {} more", names.size() - kMost);
    return text;
}

/// Tells whether a scene lists a node among its roots that is a child of another node.
bool listsChildAsRoot(const json& document) {
    const auto nodes = document.find("nodes"), scenes = document.find("scenes");
    if (nodes == document.end() || scenes == document.end()) return false;
    const std::vector<int> parents = parentsOf(*nodes);
    return std::any_of(scenes->begin(), scenes->end(), [&](const json& scene) {
        const auto roots = scene.find("nodes");
        return roots != scene.end() && std::any_of(roots->begin(), roots->end(), [&](const json& root) {
                   return parents[root.get<size_t>()] >= 0;
               });
    });
}

json takeArray(json& document, const char* section) {
    const auto found = document.find(section);
    if (found == document.end()) return json::array();
    json taken = std::move(*found);
    document.erase(found);
    return taken;
}

/// Takes the list of lights of an extension; it is empty where there is none, or none that is a list.
json takeLights(json& document, const char* name) {
    const auto extensions = document.find("extensions");
    if (extensions == document.end() || !extensionOf(document, name)) return json::array();
    json& extension = (*extensions)[name];
    json lights = extension.is_object() ? takeArray(extension, "lights") : json::array();
    extensions->erase(name);
    return lights.is_array() ? lights : json::array();
}

/// Lends accessors that have a sparse part alone the view of its indices: the parser refuses indices without
/// a view. Returns which accessors these are; takeLentViews() takes the views back.
std::vector<size_t> lendViews(json& document) {
    std::vector<size_t> lent;
    const auto accessors = document.find("accessors");
    if (accessors == document.end()) return lent;
    for (size_t i = 0; i < accessors->size(); ++i) {
        json& accessor = (*accessors)[i];
        const auto sparse = accessor.find("sparse");
        if (sparse == accessor.end() || accessor.contains("bufferView")) continue;
        const json view = (*sparse)["indices"]["bufferView"];
        accessor["bufferView"] = view;
        lent.push_back(i);
    }
    return lent;
}

void takeLentViews(tinygltf::Model& model, const std::vector<size_t>& lent) {
    for (const size_t accessor : lent)
        model.accessors[accessor].bufferView = -1;
}

/// Tells whether a path names a regular file, by its name alone; the parser's own function would wait for
/// pipes.
bool isFile(const std::string& path, void*) {
    std::error_code code;
    return std::filesystem::is_regular_file(path, code);
}

std::string sameName(const std::string& path, void*) {
    return path;
}

/// Holds what the parser is to get of a file: glTF lets several buffers name one, each with a size of its
/// own.
struct BufferFile {
    std::vector<uint64_t> sizes;      // that these buffers have by the JSON, in its order
    size_t given = 0;                 // so many of them the parser has
    std::vector<unsigned char> bytes; // the whole file, until its last buffer takes it
};

/// Holds the files of buffers by their paths.
struct BufferFiles {
    std::map<std::string, BufferFile> files;
    std::vector<std::string> padded; // the files that were a little short
};

BufferFiles bufferFilesOf(const File& file) {
    BufferFiles found;
    const auto buffers = file.json.find("buffers");
    if (buffers == file.json.end()) return found;
    for (const json& buffer : *buffers)
        if (const auto uri = buffer.find("uri"); uri != buffer.end())
            if (const std::string path = pathOfUri(file, uri->get<std::string>()); !path.empty())
                found.files[path].sizes.push_back(buffer["byteLength"].get<uint64_t>());
    return found;
}

std::vector<unsigned char> bytesOfFile(const std::string& path) {
    RegularFile file(path, "name a file");
    std::vector<unsigned char> bytes(file.size());
    file.read(bytes.data(), bytes.size());
    return bytes;
}

/// Returns what the next buffer of the file that the parser reads gets of it.
std::vector<unsigned char> nextBuffer(BufferFile& file, const std::string& path) {
    if (file.given == 0) file.bytes = bytesOfFile(path);
    const uint64_t size = file.sizes[file.given];
    if (++file.given == file.sizes.size()) return std::move(file.bytes);
    const uint64_t held = std::min<uint64_t>(size, file.bytes.size());
    return {file.bytes.begin(), file.bytes.begin() + static_cast<std::ptrdiff_t>(held)};
}

/// Reads a buffer's bytes for the parser, which wants exactly as many as the JSON tells. glTF allows a longer
/// file, and some exporters leave out the padding at the end. The parser reads buffers in their order.
bool readAll(std::vector<unsigned char>* out, std::string* error, const std::string& path, void* user) {
    BufferFiles& files = *static_cast<BufferFiles*>(user);
    const auto known = files.files.find(path);
    try {
        if (known == files.files.end() || known->second.given == known->second.sizes.size()) {
            *out = bytesOfFile(path);
            return true;
        }
        const uint64_t size = known->second.sizes[known->second.given];
        *out = nextBuffer(known->second, path);
        if (out->size() + kPadding < size) return true; // the parser tells of it
        if (out->size() < size) files.padded.push_back(path);
        out->resize(size);
    } catch (const Error& reason) {
        *error = reason.what();
        return false;
    }
    return true;
}

bool writesNothing(std::string* error, const std::string&, const std::vector<unsigned char>&, void*) {
    *error = "nothing is written here";
    return false;
}

/// Has the parser read files by the functions above. Since version 2.9 it asks for the size of each, too,
/// takes functions only if all are there, and bounds a file's size if it is not told otherwise.
template<typename Parser, typename Callbacks>
void readBy(Parser& parser, Callbacks callbacks, BufferFiles& files) {
    callbacks.FileExists = isFile;
    callbacks.ExpandFilePath = sameName;
    callbacks.ReadWholeFile = readAll;
    callbacks.WriteWholeFile = writesNothing;
    callbacks.user_data = &files;
    if constexpr (requires { callbacks.GetFileSizeInBytes; })
        callbacks.GetFileSizeInBytes = [](size_t* size, std::string* error, const std::string& path, void*) {
            std::error_code code;
            *size = static_cast<size_t>(std::filesystem::file_size(path, code));
            if (code) *error = code.message();
            return !code;
        };
    if constexpr (requires { parser.SetMaxExternalFileSize(size_t{}); })
        parser.SetMaxExternalFileSize(std::numeric_limits<size_t>::max());
    parser.SetFsCallbacks(std::move(callbacks));
}

void warnPadded(Build& build, const std::string& what) {
    build.warnings.add(what, "ends a few bytes too early, which are taken as padding: export it again");
}

} // namespace

void parse(File file, Build& build) {
    build.nodes = takeArray(file.json, "nodes");
    build.scenes = takeArray(file.json, "scenes");
    build.materials = takeArray(file.json, "materials");
    build.textures = takeArray(file.json, "textures");
    build.samplers = takeArray(file.json, "samplers");
    build.images = takeArray(file.json, "images");
    build.skins = takeArray(file.json, "skins");
    build.animations = takeArray(file.json, "animations");
    build.lights = takeLights(file.json, kPunctualLights);
    build.areaLights = takeLights(file.json, kAreaLights);
    file.json.erase("scene");
    hideDracoIndices(file.json);
    const std::vector<CompressedView> compressed = takeCompressedViews(file.json);
    const std::vector<size_t> lent = lendViews(file.json);
    if (file.isShort || (file.binary && chunkBytesOf(file.json) > file.chunkBytes))
        warnPadded(build, "the binary chunk");
    BufferFiles files = bufferFilesOf(file);
    const std::vector<uint8_t> bytes = withJson(file, file.json);
    file.json = nullptr;
    file.bytes = {};

    tinygltf::TinyGLTF parser;
    readBy(parser, tinygltf::FsCallbacks{}, files);
    const std::string folder = std::filesystem::path(file.path).parent_path().string();
    const unsigned int size = static_cast<unsigned int>(bytes.size());
    std::string error, warning;
    bool good = false;
    try {
        good = file.binary
                   ? parser.LoadBinaryFromMemory(&build.model, &error, &warning, bytes.data(), size, folder)
                   : parser.LoadASCIIFromString(&build.model, &error, &warning,
                                                reinterpret_cast<const char*>(bytes.data()), size, folder);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& exception) {
        error = exception.what();
    }
    if (!good)
        throw Error(
            fmt::format("{}: cannot be read ({}): check that its files are beside it or export it again",
                        file.path, firstLine(error)));
    for (const std::string& path : files.padded)
        warnPadded(build, "file " + inQuotes(path));
    takeLentViews(build.model, lent);
    decodeViews(build, compressed);
}

namespace {

/// Chooses the scene that is read, and tells which there are.
void chooseScene(const File& file, Build& build) {
    const auto scenes = file.json.find("scenes");
    const size_t count = scenes == file.json.end() ? 0 : scenes->size();
    std::vector<std::string>& names = build.scene.sceneNames;
    for (size_t i = 0; i < count; ++i) {
        const std::string name = (*scenes)[i].value("name", "");
        names.push_back(name.empty() ? std::to_string(i) : name);
    }
    if (count == 0 && build.choice.scene.empty()) return;
    build.sceneNumber = file.json.value("scene", 0);
    if (!build.choice.scene.empty()) {
        auto found = std::find(names.begin(), names.end(), build.choice.scene);
        for (size_t i = 0; i < count && found == names.end(); ++i)
            if (build.choice.scene == std::to_string(i))
                found = names.begin() + static_cast<std::ptrdiff_t>(i);
        if (found == names.end())
            throw Error(fmt::format("{}: has no scene {}: {}", build.path, inQuotes(build.choice.scene),
                                    listed("it has", names)));
        build.sceneNumber = static_cast<int>(found - names.begin());
    }
    build.scene.sceneNumber = build.sceneNumber;
    if (count > 1 && build.choice.scene.empty())
        build.warnings.add("scene " + inQuotes(names[static_cast<size_t>(build.sceneNumber)]),
                           fmt::format("is one of {}, and is read: choose another by --scene ({})", count,
                                       listed("there are", names)));
}

void warnUnsupported(const File& file, Build& build) {
    for (const std::string& name : unknownExtensions(file))
        build.warnings.add("extension " + inQuotes(name), "is not supported and ignored");
    if (const auto animations = file.json.find("animations");
        animations != file.json.end() && !animations->empty() && !build.choice.time)
        build.warnings.add("animations",
                           "are not played, and the scene stands in its rest pose: pass --time to "
                           "pose it by the first one");
    if (listsChildAsRoot(file.json))
        build.warnings.add("scene",
                           "lists nodes as roots that are children of others, which are placed once, below "
                           "their parents");
}

/// Returns the number of triangles of all instances.
double triangleCount(const Scene& scene) {
    std::vector<double> ofMesh;
    for (const Mesh& mesh : scene.meshes) {
        double corners = 0;
        for (const Primitive& primitive : mesh.primitives)
            corners += static_cast<double>(primitive.indices.size());
        ofMesh.push_back(corners / 3);
    }
    double triangles = 0;
    for (const Instance& instance : scene.instances)
        triangles += ofMesh[static_cast<size_t>(instance.mesh)];
    return triangles;
}

} // namespace

} // namespace gltf

Scene loadGltf(const std::string& path, const GltfChoice& choice) {
    gltf::Build build;
    build.path = path;
    build.choice = choice;
    tellWatch("loading");
    gltf::File file = gltf::readFile(path);
    tellWatch("loading");
    gltf::check(file);
    build.limit = gltf::checkSizes(file);
    tellWatch("loading");
    gltf::chooseScene(file, build);
    gltf::warnUnsupported(file, build);
    gltf::chooseVariant(build, file.json);
    gltf::parse(std::move(file), build);
    build.scene.path = path;
    gltf::buildMaterials(build);
    const gltf::Poses poses = choice.time ? gltf::posesAt(build, *choice.time) : gltf::Poses{};
    build.scene.posed = choice.time.has_value();
    gltf::NodePlaces places(build.nodes, poses);
    gltf::buildMeshes(build, places);
    gltf::buildNodes(build, places);
    gltf::markPanes(build);
    build.limit.require(gltf::Made::Triangles, gltf::triangleCount(build.scene));
    gltf::buildSky(build);
    if (build.scene.instances.empty())
        throw Error(
            fmt::format("{}: has no mesh with triangles in its scene: export it with its geometry", path));
    dropFarTriangles(build.scene, build.warnings);
    if (build.scene.instances.empty())
        throw Error(fmt::format("{}: all its triangles reach beyond {:g} m: make it smaller or move it", path,
                                kFarthest));
    if (const std::string far = coarsePlaces(build.scene); !far.empty()) build.warnings.add("the scene", far);
    build.scene.warnings = build.warnings.lines(path);
    return std::move(build.scene);
}

} // namespace relume
