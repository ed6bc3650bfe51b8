#pragma once

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace relume::test {

/// Returns a path in a folder of this process's own, which ends with it.
inline std::string tempPath(const std::string& name) {
    struct Folder {
        std::filesystem::path path =
            std::filesystem::path(testing::TempDir()) / ("relume_gltf_" + std::to_string(getpid()));
        Folder() { std::filesystem::create_directories(path); }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    };
    static const Folder folder;
    return (folder.path / name).string();
}

inline std::string writeBytes(const std::string& name, const std::vector<uint8_t>& bytes) {
    const std::string path = tempPath(name);
    std::ofstream stream(path, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path;
}

inline std::string writeText(const std::string& name, const std::string& text) {
    return writeBytes(name, {text.begin(), text.end()});
}

/// This is a PNG of 2 x 1 pixels: red beside half-transparent azure.
inline const std::vector<uint8_t> kTwoPixels = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44,
    0x52, 0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0xf4,
    0x22, 0x7f, 0x8a, 0x00, 0x00, 0x00, 0x11, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8,
    0xcf, 0xc0, 0xf0, 0x9f, 0xa1, 0xe1, 0xbf, 0x03, 0x00, 0x10, 0xba, 0x03, 0xbe, 0x3a, 0x79,
    0xbf, 0xbe, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

/// Makes small glTF files, right or wrong; whatever it has no function for is changed in `json` and `bin`.
struct GlbBuilder {
    nlohmann::json json = {{"asset", {{"version", "2.0"}}},          {"buffers", nlohmann::json::array()},
                           {"bufferViews", nlohmann::json::array()}, {"accessors", nlohmann::json::array()},
                           {"meshes", nlohmann::json::array()},      {"nodes", nlohmann::json::array()}};
    std::vector<uint8_t> bin;

    template<typename T>
    int view(const std::vector<T>& values) {
        while (bin.size() % 4 != 0)
            bin.push_back(0);
        const size_t offset = bin.size(), bytes = values.size() * sizeof(T);
        bin.resize(offset + bytes);
        std::memcpy(bin.data() + offset, values.data(), bytes);
        json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}});
        return static_cast<int>(json["bufferViews"].size()) - 1;
    }

    template<typename T>
    static int componentType() {
        if constexpr (std::is_same_v<T, int8_t>) return 5120;
        if constexpr (std::is_same_v<T, uint8_t>) return 5121;
        if constexpr (std::is_same_v<T, int16_t>) return 5122;
        if constexpr (std::is_same_v<T, uint16_t>) return 5123;
        if constexpr (std::is_same_v<T, uint32_t>) return 5125;
        if constexpr (std::is_same_v<T, float>) return 5126;
        return 0;
    }

    template<typename T>
    int accessor(const std::vector<T>& values, const char* type, bool normalized = false) {
        const size_t components = type[0] == 'S' ? 1 : static_cast<size_t>(type[3] - '0');
        nlohmann::json entry = {{"bufferView", view(values)},
                                {"componentType", componentType<T>()},
                                {"count", values.size() / components},
                                {"type", type}};
        if (normalized) entry["normalized"] = true;
        json["accessors"].push_back(entry);
        return static_cast<int>(json["accessors"].size()) - 1;
    }

    /// Adds a primitive of the unit square in z = 0, facing +z, without normals, UVs or indices of its own.
    nlohmann::json square() {
        const int positions = accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
        return {{"attributes", {{"POSITION", positions}}},
                {"indices", accessor<uint16_t>({0, 1, 2, 0, 2, 3}, "SCALAR")}};
    }
    int squareUvs() { return accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2"); }

    int mesh(const nlohmann::json& primitive, const std::string& name = "Mesh") {
        json["meshes"].push_back({{"name", name}, {"primitives", {primitive}}});
        return static_cast<int>(json["meshes"].size()) - 1;
    }
    int node(const nlohmann::json& value) {
        json["nodes"].push_back(value);
        return static_cast<int>(json["nodes"].size()) - 1;
    }

    std::vector<uint8_t> bytes() {
        while (bin.size() % 4 != 0)
            bin.push_back(0);
        nlohmann::json document = json;
        if (document["buffers"].is_array() && document["buffers"].empty() && !bin.empty())
            document["buffers"].push_back({{"byteLength", bin.size()}});
        std::string text = document.dump();
        while (text.size() % 4 != 0)
            text += ' ';
        std::vector<uint8_t> out;
        const auto word = [&](size_t value) {
            for (int i = 0; i < 4; ++i)
                out.push_back(static_cast<uint8_t>(value >> (8 * i)));
        };
        word(0x46546c67);
        word(2);
        word(12 + 8 + text.size() + (bin.empty() ? 0 : 8 + bin.size()));
        word(text.size());
        word(0x4e4f534a);
        out.insert(out.end(), text.begin(), text.end());
        if (bin.empty()) return out;
        word(bin.size());
        word(0x004e4942);
        out.insert(out.end(), bin.begin(), bin.end());
        return out;
    }
    std::string write(const std::string& name) { return writeBytes(name, bytes()); }
};

/// Makes a square with lightmap UVs on one node.
inline GlbBuilder squareScene() {
    GlbBuilder builder;
    nlohmann::json square = builder.square();
    square["attributes"]["TEXCOORD_1"] = builder.squareUvs();
    builder.node({{"mesh", builder.mesh(square)}});
    return builder;
}

} // namespace relume::test
