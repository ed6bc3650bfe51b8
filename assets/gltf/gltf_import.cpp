#include "assets/gltf/gltf.h"

#include "assets/base/error.h"
#include "assets/base/file_read.h"
#include "assets/base/watch.h"
#include "assets/gltf/gltf_build.h"
#include "assets/gltf/gltf_check.h"
#include "assets/gltf/gltf_value.h"
#include "assets/gltf/gltf_file.h"
#include "assets/model/scene_limits.h"

#include <spdlog/fmt/fmt.h>

#include <filesystem>

namespace relume {

namespace gltf {

namespace {

using nlohmann::json;

/// Returns the first line of a message: the parser's are several lines long and quote whole data URIs.
std::string firstLine(const std::string& text) {
    return inQuotes(text.substr(0, text.find('\n')));
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
    json lights = takeArray((*extensions)[name], "lights");
    extensions->erase(name);
    return lights.is_array() ? lights : json::array();
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

bool readAll(std::vector<unsigned char>* out, std::string* error, const std::string& path, void*) {
    try {
        RegularFile file(path, "name a file");
        out->resize(file.size());
        file.read(out->data(), out->size());
        return true;
    } catch (const Error& reason) {
        *error = reason.what();
        return false;
    }
}

/// Hands the parser all but what the checked JSON tells already.
void parse(File file, Build& build) {
    build.nodes = takeArray(file.json, "nodes");
    build.scenes = takeArray(file.json, "scenes");
    build.materials = takeArray(file.json, "materials");
    build.textures = takeArray(file.json, "textures");
    build.samplers = takeArray(file.json, "samplers");
    build.images = takeArray(file.json, "images");
    build.lights = takeLights(file.json, kPunctualLights);
    build.areaLights = takeLights(file.json, kAreaLights);
    build.defaultScene = file.json.value("scene", 0);
    file.json.erase("scene");
    const std::vector<uint8_t> bytes = withJson(file, file.json);
    file.json = nullptr;
    file.bytes = {};

    tinygltf::TinyGLTF parser;
    parser.SetFsCallbacks({isFile, sameName, readAll, nullptr, nullptr});
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
}

void warnUnsupported(const File& file, Build& build) {
    for (const std::string& name : unknownExtensions(file))
        build.warnings.add("extension " + inQuotes(name), "is not supported and ignored");
    if (file.json.contains("animations") && !file.json["animations"].empty())
        build.warnings.add("animations", "are not supported, the scene stands as stored");
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
    gltf::warnUnsupported(file, build);
    gltf::chooseVariant(build, file.json);
    gltf::parse(std::move(file), build);
    build.scene.path = path;
    gltf::buildMaterials(build);
    gltf::buildMeshes(build);
    gltf::buildNodes(build);
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
    build.scene.warnings = build.warnings.lines(path);
    return std::move(build.scene);
}

} // namespace relume
