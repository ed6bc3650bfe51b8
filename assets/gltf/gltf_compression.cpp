#include "assets/gltf/gltf_compression.h"

#include "assets/base/error.h"
#include "assets/base/watch.h"
#include "assets/decode/draco_stream.h"
#include "assets/gltf/file/gltf_check_extensions.h"

#include <spdlog/fmt/fmt.h>

#include <span>

namespace relume::gltf {

namespace {

using nlohmann::json;

constexpr const char* kIndices = "indices"; // see hideDracoIndices

MeshoptLayout layoutOf(const json& use) {
    const std::string mode = use["mode"].get<std::string>(), filter = use.value("filter", "NONE");
    return {.count = use.value("count", uint64_t{0}),
            .stride = use["byteStride"].get<uint32_t>(),
            .mode = mode == "TRIANGLES" ? MeshoptMode::Triangles
                    : mode == "INDICES" ? MeshoptMode::Indices
                                        : MeshoptMode::Attributes,
            .filter = filter == "OCTAHEDRAL"    ? MeshoptFilter::Octahedral
                      : filter == "QUATERNION"  ? MeshoptFilter::Quaternion
                      : filter == "EXPONENTIAL" ? MeshoptFilter::Exponential
                                                : MeshoptFilter::None};
}

NumberType numberTypeOf(int componentType) {
    switch (componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return NumberType::Int8;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return NumberType::Uint8;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return NumberType::Int16;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return NumberType::Uint16;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return NumberType::Uint32;
    default:
        return NumberType::Float;
    }
}

std::span<const uint8_t> bytesOfView(const tinygltf::Model& model, size_t view) {
    const tinygltf::BufferView& place = model.bufferViews[view];
    const std::vector<unsigned char>& data = model.buffers[static_cast<size_t>(place.buffer)].data;
    return std::span(data).subspan(place.byteOffset, place.byteLength);
}

} // namespace

void hideDracoIndices(json& document) {
    const auto meshes = document.find("meshes");
    if (meshes == document.end()) return;
    for (json& mesh : *meshes)
        for (json& primitive : mesh["primitives"]) {
            if (!extensionOf(primitive, kDraco)) continue;
            json& use = primitive["extensions"][kDraco];
            use.erase(kIndices);
            if (const auto indices = primitive.find("indices"); indices != primitive.end()) {
                use[kIndices] = *indices;
                primitive.erase(indices);
            }
        }
}

std::vector<CompressedView> takeCompressedViews(json& document) {
    std::vector<CompressedView> taken;
    const auto buffers = document.find("buffers"), views = document.find("bufferViews");
    if (buffers == document.end() || views == document.end()) return taken;
    const json smallBuffer = {{"byteLength", 1}, {"uri", "data:application/octet-stream;base64,AA=="}};
    const size_t small = buffers->size();
    for (size_t i = 0; i < views->size(); ++i) {
        const json* use = extensionOf((*views)[i], kMeshopt);
        if (!use) continue;
        taken.push_back({.view = i,
                         .buffer = (*use)["buffer"].get<size_t>(),
                         .offset = use->value("byteOffset", uint64_t{0}),
                         .bytes = use->value("byteLength", uint64_t{0}),
                         .stride = (*views)[i].value("byteStride", size_t{0}),
                         .layout = layoutOf(*use)});
        (*views)[i] = {{"buffer", small}, {"byteLength", 1}};
    }
    if (!taken.empty()) buffers->push_back(smallBuffer);
    std::vector<bool> isRead(buffers->size());
    for (const json& view : *views)
        isRead[view["buffer"].get<size_t>()] = true;
    for (size_t i = 0; i < buffers->size();
         ++i) // whose file may be missing: it is for programs without decoder
        if (isPlaceholder((*buffers)[i]) && !isRead[i]) (*buffers)[i] = smallBuffer;
    return taken;
}

void decodeViews(Build& build, const std::vector<CompressedView>& views) {
    tinygltf::Model& model = build.model;
    WatchedLoop loop("loading", static_cast<double>(views.size()));
    for (const CompressedView& view : views) {
        const std::vector<unsigned char>& source = model.buffers[view.buffer].data;
        tinygltf::BufferView& target = model.bufferViews[view.view];
        tinygltf::Buffer decoded;
        try {
            if (view.offset > source.size() || view.bytes > source.size() - view.offset)
                throw Error("its meshopt stream ends behind its buffer");
            decoded.data = decodeMeshopt(std::span(source).subspan(view.offset, view.bytes), view.layout);
        } catch (const Error& error) {
            throw Error(fmt::format("{}: bufferViews[{}]: {}: the file is damaged, export it again",
                                    build.path, view.view, error.what()));
        }
        target.buffer = static_cast<int>(model.buffers.size());
        target.byteOffset = 0;
        target.byteLength = decoded.data.size();
        target.byteStride = view.stride;
        model.buffers.push_back(std::move(decoded));
        loop.step();
    }
}

DecodedPrimitive::DecodedPrimitive(Build& build, const std::string& where, const tinygltf::Primitive& source)
    : build_(build), primitive_(source), buffers_(build.model.buffers.size()),
      views_(build.model.bufferViews.size()), accessors_(build.model.accessors.size()) {
    const auto extension = source.extensions.find(kDraco);
    if (extension == source.extensions.end() || source.mode < TINYGLTF_MODE_TRIANGLES) return;
    if (!source.attributes.contains("POSITION")) return;
    try {
        decode(where, extension->second);
    } catch (const Error& error) {
        throw Error(
            fmt::format("{}: {}: {}: the file is damaged, export it again", build.path, where, error.what()));
    }
}

DecodedPrimitive::~DecodedPrimitive() {
    build_.model.buffers.resize(buffers_);
    build_.model.bufferViews.resize(views_);
    build_.model.accessors.resize(accessors_);
}

void DecodedPrimitive::decode(const std::string& where, const tinygltf::Value& extension) {
    const tinygltf::Model& model = build_.model;
    const auto accessorOf = [&](int index) { return model.accessors[static_cast<size_t>(index)]; };
    const tinygltf::Value& ids = extension.Get("attributes");
    std::vector<std::string> names;
    std::vector<DracoWish> wishes;
    for (const auto& [name, index] : primitive_.attributes) {
        if (!ids.Has(name)) continue; // it has bytes of its own
        const tinygltf::Accessor accessor = accessorOf(index);
        names.push_back(name);
        wishes.push_back({.id = static_cast<uint32_t>(ids.Get(name).GetNumberAsInt()),
                          .type = numberTypeOf(accessor.componentType),
                          .components = static_cast<uint32_t>(
                              tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)))});
    }
    const uint64_t points = accessorOf(primitive_.attributes.at("POSITION")).count;
    const uint64_t corners =
        extension.Has(kIndices) ? accessorOf(extension.Get(kIndices).GetNumberAsInt()).count : points;
    const size_t view = static_cast<size_t>(extension.Get("bufferView").GetNumberAsInt());
    // A strip of so many indices has two triangles less than it has indices.
    const bool list = primitive_.mode == TINYGLTF_MODE_TRIANGLES;
    DracoMesh mesh = decodeDraco(bytesOfView(model, view), wishes,
                                 {.points = points, .triangles = list ? corners / 3 : corners});
    for (size_t i = 0; i < names.size(); ++i) {
        const tinygltf::Accessor accessor = accessorOf(primitive_.attributes[names[i]]);
        primitive_.attributes[names[i]] = addAccessor(std::move(mesh.attributes[i]), accessor.componentType,
                                                      accessor.type, mesh.points, accessor.normalized);
    }
    if (mesh.indices.empty()) throw Error("its Draco stream has no triangles");
    std::vector<unsigned char> indices(mesh.indices.size() * sizeof(uint32_t));
    std::memcpy(indices.data(), mesh.indices.data(), indices.size());
    primitive_.indices = addAccessor(std::move(indices), TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT,
                                     TINYGLTF_TYPE_SCALAR, mesh.indices.size(), false);
    primitive_.mode = TINYGLTF_MODE_TRIANGLES;
    tellWatch("loading");
    if (!ids.Has("POSITION")) build_.warnings.add(where, "has positions outside of its Draco stream");
}

int DecodedPrimitive::addAccessor(std::vector<unsigned char> bytes, int componentType, int type, size_t count,
                                  bool normalized) {
    tinygltf::Model& model = build_.model;
    tinygltf::Buffer buffer;
    tinygltf::BufferView view;
    tinygltf::Accessor accessor;
    view.buffer = static_cast<int>(model.buffers.size());
    view.byteLength = bytes.size();
    buffer.data = std::move(bytes);
    accessor.bufferView = static_cast<int>(model.bufferViews.size());
    accessor.componentType = componentType;
    accessor.type = type;
    accessor.count = count;
    accessor.normalized = normalized;
    model.buffers.push_back(std::move(buffer));
    model.bufferViews.push_back(view);
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
}

} // namespace relume::gltf
