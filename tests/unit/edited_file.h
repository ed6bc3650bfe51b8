#pragma once

#include "assets/gltf/gltf.h"
#include "assets/gltf/edit/gltf_edit.h"
#include "tests/message_of.h"
#include "tests/temporary_folder.h"
#include "tests/unit/glb_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <utility>

namespace relume::test {

using nlohmann::json;

inline std::string readAll(const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline uint32_t wordAt(const std::string& bytes, size_t offset) {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof(value));
    return value;
}

/// Returns the JSON text of a .gltf or .glb.
inline std::string jsonTextOf(const std::string& path) {
    const std::string bytes = readAll(path);
    return bytes.rfind("glTF", 0) == 0 ? bytes.substr(20, wordAt(bytes, 12)) : bytes;
}

inline json jsonOf(const std::string& path) {
    return json::parse(jsonTextOf(path));
}

/// Returns what is behind the JSON chunk of a .glb.
inline std::string chunksOf(const std::string& path) {
    const std::string bytes = readAll(path);
    return bytes.substr(20 + wordAt(bytes, 12));
}

/// Makes the files of one test, each in a folder of its own.
class EditedFile : public testing::Test {
protected:
    using Edit = std::function<void(Scene&)>;

    std::string write(const GlbBuilder& builder, const std::string& name = "scene.glb") const {
        GlbBuilder copy = builder;
        const std::vector<uint8_t> bytes = copy.bytes();
        return write(std::string(bytes.begin(), bytes.end()), name);
    }
    std::string write(const std::string& text, const std::string& name) const {
        std::ofstream(folder_.path(name), std::ios::binary) << text;
        return folder_.path(name);
    }
    /// Saves the file at `path` over itself with an edit.
    static EditedNodes save(const std::string& path, const Edit& edit) {
        const Scene before = loadGltf(path);
        Scene after = before;
        edit(after);
        return saveEditedGltf(path, before, after, path);
    }

    const TemporaryFolder folder_;
};

inline void expectNear(const glm::mat4& a, const glm::mat4& b, float tolerance = 1e-5f) {
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r)
            EXPECT_NEAR(a[c][r], b[c][r], tolerance) << "column " << c << " row " << r;
}

/// Makes a scene of a square, with the nodes and lights that are added to it.
struct LitScene : GlbBuilder {
    LitScene() : GlbBuilder(squareScene()) {
        json["scenes"] = nlohmann::json::array({{{"nodes", nlohmann::json::array({0})}}});
    }

    int light(const nlohmann::json& value) {
        nlohmann::json& lights = json["extensions"]["KHR_lights_punctual"]["lights"];
        lights.push_back(value);
        json["extensionsUsed"] = nlohmann::json::array({"KHR_lights_punctual"});
        return static_cast<int>(lights.size()) - 1;
    }
    int lamp(nlohmann::json node, int entry, bool root = true) {
        node["extensions"]["KHR_lights_punctual"]["light"] = entry;
        const int index = this->node(node);
        if (root) json["scenes"][0]["nodes"].push_back(index);
        return index;
    }
};

} // namespace relume::test
