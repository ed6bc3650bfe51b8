#pragma once

#include <string>
#include <vector>

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
    builder.json["buffers"] = {{{"byteLength", builder.bin.size()}, {"uri", uri}}};
    corpus.push_back(builder.json.dump(1));
}

inline std::vector<std::string> gltfCorpus() {
    std::vector<std::string> corpus;
    addBothKinds(corpus, test::squareScene());
    addBothKinds(corpus, test::richScene());
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

inline std::string endingOfGltf(const uint8_t* data, size_t size) {
    return size >= 4 && std::memcmp(data, "glTF", 4) == 0 ? ".glb" : ".gltf";
}

} // namespace relume::fuzz
