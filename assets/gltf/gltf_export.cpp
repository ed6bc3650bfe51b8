#include "assets/gltf/gltf.h"

#include "assets/base/error.h"
#include "assets/base/file_write.h"
#include "assets/gltf/gltf_batches.h"
#include "assets/gltf/gltf_kept.h"
#include "assets/gltf/gltf_light_json.h"
#include "assets/gltf/gltf_material_json.h"
#include "assets/gltf/gltf_png.h"
#include "assets/gltf/gltf_sky_file.h"
#include "assets/gltf/file/gltf_value.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>

#include <glm/gtc/type_ptr.hpp>
#include <nlohmann/json.hpp>

namespace relume {
namespace {

using Json = nlohmann::ordered_json;
using gltf::jsonArray;
static_assert(std::endian::native == std::endian::little,
              "glTF buffers are little-endian and written by memcpy");

// These values are those of the glTF 2.0 specification.
constexpr int kUnsignedShort = 5123, kUnsignedInt = 5125, kFloat = 5126;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr uint32_t kGlbMagic = 0x46546C67, kChunkJson = 0x4E4F534A, kChunkBin = 0x004E4942;
constexpr uint8_t kPngBegin = 0x89;
// 0xffff is the primitive restart value and must not appear as an index.
constexpr size_t kMaxShortIndexedVertices = 65535;

// All arrays of one kind go into one buffer view, and accessors differ by offset. This keeps the JSON of a
// scene with hundreds of meshes small.
struct Stream {
    std::vector<uint8_t> bytes;
    int stride = 0; // 0: tightly packed, no byteStride in the file
    int target = 0;
};

enum StreamId {
    kPositions,
    kNormals,
    kTexCoords,
    kColors,
    kPlaces,
    kTurns,
    kShortIndices,
    kIntIndices,
    kStreamCount
};

class GlbWriter {
public:
    /// Takes as `skyFile` the path of the sky's picture from the folder of the file to be written, and
    /// `pictures` as glbBytes() does.
    GlbWriter(const Scene& scene, std::string skyFile, std::span<const std::vector<uint8_t>> pictures = {},
              GlbLook look = {})
        : scene_(scene), skyFile_(std::move(skyFile)), pictures_(pictures), look_(std::move(look)) {
        const int strides[kStreamCount] = {12, 12, 8, 16, 12, 16, 0, 0};
        for (int i = 0; i < kStreamCount; ++i) {
            streams_[i].stride = strides[i];
            streams_[i].target = strides[i] ? kArrayBuffer : kElementArrayBuffer;
            // What instances have is neither.
            if (i == kPlaces || i == kTurns) streams_[i].target = 0;
        }
    }

    /// Returns the whole file.
    std::vector<uint8_t> write();

private:
    Json primitive(const Primitive& primitive);
    /// Returns the number of a material's copy whose textures read another set than TEXCOORD_1.
    int movedMaterial(int material, int set);
    void addMeshes();
    int addPicture(std::vector<uint8_t> picture, const std::string& name);
    void addTexture(const Texture& texture, int image, bool mipmaps);
    void addTextures();
    void addNodes();
    Json addBatch(const gltf::Batch& batch);
    Json addCamera(const Camera& camera);
    Json addLight(const Light& light);
    void addBuffers();
    int addAccessor(StreamId stream, const void* data, size_t count, int componentType, const char* type);
    void use(const char* extension) { extensions_[extension] = true; }

    const Scene& scene_;
    std::string skyFile_;
    std::span<const std::vector<uint8_t>> pictures_;
    GlbLook look_;
    Json json_ = Json::object();
    Stream streams_[kStreamCount];
    Json samplers_ = Json::array();
    std::vector<std::vector<uint8_t>> pngs_; // or JPEG, as it came
    std::vector<int> kept_;                  // textures of the file by Scene::keptTextures
    std::vector<std::pair<int, int>> moved_; // materials and sets of such copies behind all materials
    std::vector<int> meshIndices_;           // of the file by Scene::meshes, -1 for one without triangles
    gltf::UsedExtensions extensions_;
};

Json nodeOf(const std::string& name, const glm::mat4& transform) {
    Json node = Json::object();
    if (!name.empty()) node["name"] = name;
    if (transform != glm::mat4(1.0f)) {
        const float* m = glm::value_ptr(transform);
        node["matrix"] = std::vector<float>(m, m + 16);
    }
    return node;
}

int GlbWriter::addAccessor(StreamId id, const void* data, size_t count, int componentType, const char* type) {
    Stream& stream = streams_[id];
    const size_t indexSize = componentType == kUnsignedShort ? 2 : 4;
    const size_t elementSize = stream.stride ? static_cast<size_t>(stream.stride) : indexSize;
    Json accessor;
    accessor["bufferView"] = static_cast<int>(id); // renumbered once it is known which streams are empty
    accessor["byteOffset"] = stream.bytes.size();
    accessor["componentType"] = componentType;
    accessor["count"] = count;
    accessor["type"] = type;
    const auto* first = static_cast<const uint8_t*>(data);
    stream.bytes.insert(stream.bytes.end(), first, first + count * elementSize);
    json_["accessors"].push_back(std::move(accessor));
    return static_cast<int>(json_["accessors"].size()) - 1;
}

Json GlbWriter::primitive(const Primitive& p) {
    const size_t count = p.positions.size();
    ASSERT(p.normals.empty() || p.normals.size() == count);
    ASSERT(p.texCoord0.empty() || p.texCoord0.size() == count);
    ASSERT(p.texCoord1.empty() || p.texCoord1.size() == count);
    ASSERT(p.texCoord2.empty() || p.texCoord2.size() == count);
    ASSERT(p.colors.empty() || p.colors.size() == count);

    Json attributes;
    attributes["POSITION"] = addAccessor(kPositions, p.positions.data(), count, kFloat, "VEC3");
    glm::vec3 low = p.positions[0], high = low;
    for (const glm::vec3& position : p.positions) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    json_["accessors"].back()["min"] = jsonArray(low);
    json_["accessors"].back()["max"] = jsonArray(high);
    if (!p.normals.empty())
        attributes["NORMAL"] = addAccessor(kNormals, p.normals.data(), count, kFloat, "VEC3");
    if (!p.texCoord0.empty())
        attributes["TEXCOORD_0"] = addAccessor(kTexCoords, p.texCoord0.data(), count, kFloat, "VEC2");
    if (!p.texCoord1.empty()) {
        const int accessor = addAccessor(kTexCoords, p.texCoord1.data(), count, kFloat, "VEC2");
        // Sets are numbered without gaps: a lone TEXCOORD_1 is offered as TEXCOORD_0 too, from the same
        // bytes.
        if (p.texCoord0.empty()) attributes["TEXCOORD_0"] = accessor;
        attributes["TEXCOORD_1"] = accessor;
    }
    if (!p.texCoord2.empty()) {
        const int accessor = addAccessor(kTexCoords, p.texCoord2.data(), count, kFloat, "VEC2");
        for (const char* set : {"TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2"})
            if (!attributes.contains(set)) attributes[set] = accessor;
    }
    if (!p.colors.empty())
        attributes["COLOR_0"] = addAccessor(kColors, p.colors.data(), count, kFloat, "VEC4");

    Json out;
    out["attributes"] = std::move(attributes);
    if (count <= kMaxShortIndexedVertices) {
        const std::vector<uint16_t> narrow(p.indices.begin(), p.indices.end());
        out["indices"] = addAccessor(kShortIndices, narrow.data(), narrow.size(), kUnsignedShort, "SCALAR");
    } else {
        out["indices"] = addAccessor(kIntIndices, p.indices.data(), p.indices.size(), kUnsignedInt, "SCALAR");
    }
    if (p.material >= 0)
        out["material"] = p.movedUvs >= 0 ? movedMaterial(p.material, p.movedUvs) : p.material;
    return out;
}

void GlbWriter::addMeshes() {
    meshIndices_.assign(scene_.meshes.size(), -1);
    for (size_t i = 0; i < scene_.meshes.size(); ++i) {
        const Mesh& mesh = scene_.meshes[i];
        Json primitives = Json::array();
        for (const Primitive& p : mesh.primitives)
            if (!p.indices.empty() && !p.positions.empty()) primitives.push_back(primitive(p));
        if (primitives.empty()) continue; // glTF has no empty mesh
        Json out;
        if (!mesh.name.empty()) out["name"] = mesh.name;
        out["primitives"] = std::move(primitives);
        meshIndices_[i] = static_cast<int>(json_["meshes"].size());
        json_["meshes"].push_back(std::move(out));
    }
}

int GlbWriter::movedMaterial(int material, int set) {
    const std::pair<int, int> copy{material, set};
    const auto found = std::find(moved_.begin(), moved_.end(), copy);
    const auto place = found - moved_.begin();
    if (found == moved_.end()) moved_.push_back(copy);
    return static_cast<int>(scene_.materials.size()) + static_cast<int>(place);
}

int GlbWriter::addPicture(std::vector<uint8_t> picture, const std::string& name) {
    Json out; // its bufferView comes with the buffers
    if (!name.empty()) out["name"] = name;
    out["mimeType"] = picture.front() == kPngBegin ? "image/png" : "image/jpeg";
    json_["images"].push_back(std::move(out));
    pngs_.push_back(std::move(picture));
    return static_cast<int>(pngs_.size()) - 1;
}

void GlbWriter::addTexture(const Texture& texture, int image, bool mipmaps) {
    Json sampler = gltf::samplerJson(texture, mipmaps);
    size_t index = 0;
    while (index < samplers_.size() && samplers_[index] != sampler)
        ++index;
    if (index == samplers_.size()) samplers_.push_back(std::move(sampler));
    Json out;
    out["sampler"] = index;
    if (image >= 0) out["source"] = image;
    json_["textures"].push_back(std::move(out));
}

void GlbWriter::addTextures() {
    for (size_t i = 0; i < scene_.images.size(); ++i) {
        const Image& image = scene_.images[i];
        const bool ready = i < pictures_.size() && !pictures_[i].empty();
        addPicture(ready ? pictures_[i] : gltf::encodePng(image), image.name);
    }
    for (const Texture& texture : scene_.textures) {
        const auto number = static_cast<int>(&texture - scene_.textures.data());
        const bool isMap = std::find(look_.maps.begin(), look_.maps.end(), number) != look_.maps.end();
        addTexture(texture, texture.image, !isMap);
    }
    for (const KeptTexture& texture : scene_.keptTextures) {
        kept_.push_back(texture.texture >= 0 ? texture.texture : static_cast<int>(json_["textures"].size()));
        if (texture.texture < 0)
            addTexture(texture.sampling, addPicture(gltf::keptPicture(texture), texture.name), true);
    }
    if (!samplers_.empty()) json_["samplers"] = samplers_;
}

Json GlbWriter::addBatch(const gltf::Batch& batch) {
    Json node = nodeOf(scene_.meshes[batch.mesh].name, glm::mat4(1.0f));
    node["mesh"] = meshIndices_[batch.mesh];
    Json attributes;
    const size_t count = batch.translations.size();
    attributes["TRANSLATION"] = addAccessor(kPlaces, batch.translations.data(), count, kFloat, "VEC3");
    if (batch.isTurned)
        attributes["ROTATION"] = addAccessor(kTurns, batch.rotations.data(), count, kFloat, "VEC4");
    if (batch.isScaled)
        attributes["SCALE"] = addAccessor(kPlaces, batch.scales.data(), count, kFloat, "VEC3");
    node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = std::move(attributes);
    use("EXT_mesh_gpu_instancing");
    return node;
}

Json GlbWriter::addCamera(const Camera& camera) {
    Json lens, out;
    if (!camera.name.empty()) out["name"] = camera.name;
    if (camera.perspective) {
        out["type"] = "perspective";
        if (camera.aspect > 0.0f) lens["aspectRatio"] = camera.aspect;
        lens["yfov"] = camera.yfov;
        if (camera.zfar > 0.0f) lens["zfar"] = camera.zfar;
        lens["znear"] = camera.znear;
        out["perspective"] = std::move(lens);
    } else {
        out["type"] = "orthographic";
        lens["xmag"] = camera.ymag * (camera.aspect > 0.0f ? camera.aspect : 1.0f);
        lens["ymag"] = camera.ymag;
        // glTF wants a far plane here; where there is none, it is far enough for anything that stands on a
        // planet.
        lens["zfar"] = camera.zfar > camera.znear ? camera.zfar : camera.znear + 1e6f;
        lens["znear"] = camera.znear;
        out["orthographic"] = std::move(lens);
    }
    json_["cameras"].push_back(std::move(out));
    Json node = nodeOf(camera.name, camera.transform);
    node["camera"] = json_["cameras"].size() - 1;
    return node;
}

Json GlbWriter::addLight(const Light& light) {
    Json node = nodeOf(light.name, light.transform);
    const bool area = gltf::isAreaLight(light.type);
    if (area) node["extras"]["relume"]["areaLight"] = gltf::areaLightJson(light);
    const char* extension = area ? gltf::kAreaLights : gltf::kPunctualLights;
    Json& lights = json_["extensions"][extension]["lights"];
    lights.push_back(area ? gltf::areaExtensionJson(light) : gltf::punctualLightJson(light));
    use(extension);
    node["extensions"][extension]["light"] = lights.size() - 1;
    return node;
}

void GlbWriter::addNodes() {
    Json nodes = Json::array();
    const gltf::Batches batches = gltf::batchesOf(scene_);
    for (size_t i = 0; i < scene_.instances.size(); ++i) {
        if (batches.isBatched[i]) continue;
        const Instance& instance = scene_.instances[i];
        Json node = nodeOf(instance.name, instance.transform);
        if (instance.mesh >= 0 && meshIndices_[instance.mesh] >= 0)
            node["mesh"] = meshIndices_[instance.mesh];
        if (instance.hidden) {
            node["extensions"][gltf::kVisibility]["visible"] = false;
            use(gltf::kVisibility);
        }
        if (instance.density != 1.0f) node["extras"]["relume"]["density"] = instance.density;
        if (scene_.pages > 1) node["extras"]["relume"]["page"] = instance.page;
        nodes.push_back(std::move(node));
    }
    for (const gltf::Batch& batch : batches.batches)
        if (meshIndices_[batch.mesh] >= 0) nodes.push_back(addBatch(batch));
    for (const Camera& camera : scene_.cameras)
        nodes.push_back(addCamera(camera));
    for (const Light& light : scene_.lights)
        if (!light.preview) nodes.push_back(addLight(light));

    json_["scene"] = 0;
    Json roots = Json::array();
    for (size_t i = 0; i < nodes.size(); ++i)
        roots.push_back(i);
    Json root = Json::object();
    if (!nodes.empty()) root["nodes"] = std::move(roots);
    if (!scene_.sky.preview && (scene_.sky.shines() || !skyFile_.empty()))
        root["extras"]["relume"]["sky"] = gltf::skyJson(scene_.sky, skyFile_);
    if (scene_.pages > 1) root["extras"]["relume"]["pages"] = scene_.pages;
    json_["scenes"].push_back(std::move(root));
    if (!nodes.empty()) json_["nodes"] = std::move(nodes);
}

// Lays the streams and pictures one behind the other, as the file's only buffer.
void GlbWriter::addBuffers() {
    int viewOf[kStreamCount];
    size_t offset = 0;
    Json views = Json::array();
    const auto addView = [&](size_t size) -> Json& {
        Json view;
        view["buffer"] = 0;
        view["byteOffset"] = offset;
        view["byteLength"] = size;
        offset += (size + 3) / 4 * 4;
        views.push_back(std::move(view));
        return views.back();
    };
    for (int i = 0; i < kStreamCount; ++i) {
        if (streams_[i].bytes.empty()) continue;
        viewOf[i] = static_cast<int>(views.size());
        Json& view = addView(streams_[i].bytes.size());
        if (streams_[i].target == kArrayBuffer) view["byteStride"] = streams_[i].stride;
        if (streams_[i].target != 0) view["target"] = streams_[i].target;
    }
    if (json_.contains("accessors"))
        for (Json& accessor : json_["accessors"]) {
            const int stream = accessor["bufferView"].get<int>();
            accessor["bufferView"] = viewOf[stream];
        }
    for (size_t i = 0; i < pngs_.size(); ++i) {
        json_["images"][i]["bufferView"] = views.size();
        addView(pngs_[i].size());
    }
    if (views.empty()) return;
    json_["bufferViews"] = std::move(views);
    json_["buffers"].push_back(Json{{"byteLength", offset}});
}

std::vector<uint8_t> GlbWriter::write() {
    // No version stands here: the same scene is the same file, whichever release wrote it.
    json_["asset"]["version"] = "2.0";
    json_["asset"]["generator"] = "Relume";
    addMeshes();
    addTextures();
    for (const Material& m : scene_.materials)
        json_["materials"].push_back(gltf::materialJson(m, kept_, extensions_));
    for (const auto& [original, set] : moved_) {
        Material copy = scene_.materials[static_cast<size_t>(original)];
        for (TextureRef* use : textureUses(copy))
            use->texCoord = setOf(set, *use);
        json_["materials"].push_back(gltf::materialJson(copy, kept_, extensions_));
    }
    const size_t ownMaterials = scene_.materials.size();
    for (size_t i = 0; i < ownMaterials + moved_.size(); ++i)
        gltf::addLook(json_["materials"][i], look_,
                      i < ownMaterials ? i : static_cast<size_t>(moved_[i - ownMaterials].first),
                      extensions_);
    addNodes();
    addBuffers();
    for (const auto& [extension, used] : extensions_)
        json_["extensionsUsed"].push_back(extension);

    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::vector<uint8_t> out;
    const auto put = [&](const void* data, size_t size) {
        const auto* first = static_cast<const uint8_t*>(data);
        out.insert(out.end(), first, first + size);
        out.resize((out.size() + 3) / 4 * 4, 0);
    };
    const auto word = [&](uint64_t value) {
        if (value > 0xffffffffu) throw Error("the scene is larger than a GLB's 4 GiB: split it");
        const auto narrow = static_cast<uint32_t>(value);
        put(&narrow, 4);
    };
    const uint64_t binSize =
        json_.contains("buffers") ? json_["buffers"][0]["byteLength"].get<uint64_t>() : 0;
    out.reserve(28 + text.size() + binSize);
    word(kGlbMagic);
    word(2);
    word(12 + 8 + text.size() + (binSize ? 8 + binSize : 0));
    word(text.size());
    word(kChunkJson);
    put(text.data(), text.size());
    if (binSize) {
        word(binSize);
        word(kChunkBin);
        for (const Stream& stream : streams_)
            put(stream.bytes.data(), stream.bytes.size());
        for (const std::vector<uint8_t>& png : pngs_)
            put(png.data(), png.size());
    }
    return out;
}

} // namespace

void checkGlb(const Scene& scene, const std::string& path) {
    const std::string skyFile = gltf::skyPathFrom(scene.sky, path);
    if (gltf::skyIsHomeless(scene.sky))
        checkFileWritable((std::filesystem::path(path).parent_path() / skyFile).string(), 0);
}

std::vector<uint8_t> glbBytes(const Scene& scene, std::span<const std::vector<uint8_t>> pictures,
                              const GlbLook& look) {
    return GlbWriter(scene, "", pictures, look).write();
}

void saveGlb(const Scene& scene, const std::string& path) {
    const std::string skyFile = gltf::skyPathFrom(scene.sky, path);
    if (gltf::skyIsHomeless(scene.sky))
        gltf::writeSkyPicture(scene.sky, (std::filesystem::path(path).parent_path() / skyFile).string());
    std::vector<uint8_t> bytes;
    try {
        bytes = GlbWriter(scene, skyFile).write();
    } catch (const Error& error) {
        throw Error(path + ": " + error.what());
    }
    writeFileAtomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

} // namespace relume
