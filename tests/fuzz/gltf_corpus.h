#pragma once

#include <array>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "tests/fuzz/fuzz.h"
#include "tests/unit/rich_scene.h"

namespace relume::fuzz {

inline std::string base64(const std::vector<uint8_t>& bytes) {
    const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t three = 0;
        for (size_t k = 0; k < 3; ++k)
            three = three << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
        for (int shift = 18; shift >= 0; shift -= 6)
            out += digits[three >> shift & 63];
    }
    for (size_t k = 0; k < (3 - bytes.size() % 3) % 3; ++k)
        out[out.size() - 1 - k] = '=';
    return out;
}

/// Adds a file as .glb, and as .gltf with its bytes in a URI, whose text may become longer and still be read.
inline void addBothKinds(std::vector<std::string>& corpus, test::GlbBuilder builder) {
    const std::vector<uint8_t> glb = builder.bytes();
    corpus.emplace_back(glb.begin(), glb.end());
    const std::string uri = "data:application/octet-stream;base64," + base64(builder.bin);
    nlohmann::json& buffers = builder.json["buffers"];
    if (buffers.empty()) buffers.emplace_back();
    buffers[0] = {{"byteLength", builder.bin.size()}, {"uri", uri}};
    corpus.push_back(builder.json.dump(1));
}

inline std::string endingOfGltf(const uint8_t* data, size_t size) {
    return size >= 4 && std::memcmp(data, "glTF", 4) == 0 ? ".glb" : ".gltf";
}

/// Ends the process where one of these files cannot be read: such a seed would lead nowhere.
inline void checkReadable(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
        const auto* bytes = reinterpret_cast<const uint8_t*>(file.data());
        try {
            loadGltf(asFile(bytes, file.size(), endingOfGltf(bytes, file.size())));
        } catch (const Error& error) {
            check(false, error.what());
        }
    }
}

/// Makes copies of a square by EXT_mesh_gpu_instancing, one of which is hidden.
inline test::GlbBuilder instancedScene() {
    test::GlbBuilder b;
    const int mesh = b.mesh(b.square());
    const nlohmann::json attributes = {
        {"TRANSLATION", b.accessor<float>({0, 0, 0, 5, 0, 0, 0, 7, 0}, "VEC3")},
        {"ROTATION", b.accessor<int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170, 0, 0, 0, 32767}, "VEC4", true)},
        {"SCALE", b.accessor<float>({1, 1, 1, 2, 3, 1, 0, 0, 0}, "VEC3")}};
    b.node({{"mesh", mesh},
            {"scale", {2, 2, 2}},
            {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}},
            {"extras", {{"relume", {{"hiddenCopies", {{{"copy", 2}, {"scale", {1, 1, 1}}}}}}}}}});
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    return b;
}

/// Encodes a square by Draco.
inline std::vector<uint8_t> dracoSquare(int method) {
    const std::array<std::array<float, 3>, 4> corners = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2);
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(0), corners[0].data(), corners[1].data(),
                                      corners[2].data());
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(1), corners[0].data(), corners[2].data(),
                                      corners[3].data());
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 10);
    draco::EncoderBuffer buffer;
    check(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok(), "Draco does not encode a square");
    return {buffer.data(), buffer.data() + buffer.size()};
}

inline test::GlbBuilder dracoScene(int method) {
    test::GlbBuilder b;
    const int view = b.view(dracoSquare(method));
    b.json["accessors"] = {{{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
                           {{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}}};
    const nlohmann::json draco = {{"bufferView", view}, {"attributes", {{"POSITION", 0}}}};
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", 0}}},
                             {"indices", 1},
                             {"extensions", {{"KHR_draco_mesh_compression", draco}}}})}});
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
    return b;
}

/// Makes a square whose positions and indices are compressed by EXT_meshopt_compression.
inline test::GlbBuilder meshoptScene() {
    test::GlbBuilder b;
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const std::vector<uint32_t> indices = {0, 1, 2, 0, 2, 3};
    constexpr size_t kVertices = 4, kStride = 12;
    std::vector<uint8_t> vertexBytes(meshopt_encodeVertexBufferBound(kVertices, kStride));
    vertexBytes.resize(meshopt_encodeVertexBuffer(vertexBytes.data(), vertexBytes.size(), positions.data(),
                                                  kVertices, kStride));
    std::vector<uint8_t> indexBytes(meshopt_encodeIndexBufferBound(indices.size(), kVertices));
    indexBytes.resize(
        meshopt_encodeIndexBuffer(indexBytes.data(), indexBytes.size(), indices.data(), indices.size()));
    const auto compressed = [&](const std::vector<uint8_t>& bytes, const char* mode, size_t count,
                                size_t stride) {
        const int view = b.view(bytes);
        nlohmann::json& entry = b.json["bufferViews"][static_cast<size_t>(view)];
        nlohmann::json use = entry;
        use["byteStride"] = stride;
        use["count"] = count;
        use["mode"] = mode;
        entry = {{"buffer", 1},
                 {"byteOffset", 64 * view},
                 {"byteLength", count * stride},
                 {"extensions", {{"EXT_meshopt_compression", use}}}};
        return view;
    };
    const int vertexView = compressed(vertexBytes, "ATTRIBUTES", kVertices, kStride);
    const int indexView = compressed(indexBytes, "TRIANGLES", indices.size(), sizeof(uint32_t));
    b.json["accessors"] = {
        {{"bufferView", vertexView}, {"componentType", 5126}, {"count", kVertices}, {"type", "VEC3"}},
        {{"bufferView", indexView}, {"componentType", 5125}, {"count", indices.size()}, {"type", "SCALAR"}}};
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", 1}})}});
    while (b.bin.size() % 4 != 0)
        b.bin.push_back(0);
    b.json["buffers"] = {
        {{"byteLength", b.bin.size()}},
        {{"byteLength", 128}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
    b.json["extensionsUsed"] = b.json["extensionsRequired"] = {"EXT_meshopt_compression"};
    return b;
}

inline std::vector<std::string> gltfCorpus() {
    std::vector<std::string> corpus;
    addBothKinds(corpus, test::squareScene());
    addBothKinds(corpus, test::richScene());
    addBothKinds(corpus, instancedScene());
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING})
        addBothKinds(corpus, dracoScene(method));
    addBothKinds(corpus, meshoptScene());
    checkReadable(corpus);
    // These are 250 million vertices that are nowhere, and many primitives that share some.
    test::GlbBuilder zeros = test::squareScene();
    zeros.json["accessors"].push_back({{"componentType", 5126}, {"count", 250'000'000}, {"type", "VEC3"}});
    zeros.json["accessors"].back()["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", zeros.view<uint16_t>({1, 0})}, {"componentType", 5123}}},
        {"values", {{"bufferView", zeros.view<float>({7, 8, 9})}}}};
    nlohmann::json& primitives = zeros.json["meshes"][0]["primitives"];
    primitives[0]["attributes"]["POSITION"] = zeros.json["accessors"].size() - 1;
    addBothKinds(corpus, zeros);
    zeros.json["accessors"].back() = {{"componentType", 5126}, {"count", 16'000'000}, {"type", "VEC3"}};
    for (int i = 0; i < 20; ++i)
        primitives.push_back(nlohmann::json(primitives[0]));
    addBothKinds(corpus, zeros);
    test::GlbBuilder folder = test::squareScene();
    folder.json["buffers"] = {{{"byteLength", 344}, {"uri", "."}}};
    corpus.push_back(folder.json.dump());
    return corpus;
}

} // namespace relume::fuzz
