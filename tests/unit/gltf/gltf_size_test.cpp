// What glTF files make of their bytes is bounded, and what their URIs name is looked at before it is opened.
#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "assets/images/float_image.h"
#include "assets/images/image_file.h"
#include "assets/images/layered_exr.h"
#include "tests/message_of.h"
#include "tests/peak_memory.h"
#include "tests/temporary_folder.h"
#include "tests/unit/glb_builder.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <filesystem>
#include <functional>

namespace relume {
namespace {

using nlohmann::json;
using test::GlbBuilder;
using test::squareScene;

/// Expects that loading fails with one line that names the file and holds `part`, and takes little memory.
void expectRefused(const std::string& path, const std::string& part) {
    EXPECT_LT(test::peakGrowth([&] { messageOf([&] { loadGltf(path); }); }), test::kLittleMemory) << path;
    const std::string message = messageOf([&] { loadGltf(path); });
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find(path + ": "), 0u) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

json& primitiveOf(GlbBuilder& b) {
    return b.json["meshes"][0]["primitives"][0];
}

/// Adds an accessor of zeros without data.
int zeros(GlbBuilder& b, uint64_t count, const char* type) {
    b.json["accessors"].push_back({{"componentType", 5126}, {"count", count}, {"type", type}});
    return static_cast<int>(b.json["accessors"].size()) - 1;
}

TEST(GltfSize, ZerosThatManyPrimitivesShare) {
    GlbBuilder b = squareScene();
    primitiveOf(b)["attributes"] = {{"POSITION", zeros(b, 16'000'000, "VEC3")}};
    for (int i = 0; i < 199; ++i)
        b.json["meshes"][0]["primitives"].push_back(primitiveOf(b));
    expectRefused(b.write("shared.glb"), "GiB of vertices out of");
}

TEST(GltfSize, SparseAccessorsAreNoWayAround) {
    GlbBuilder b = squareScene();
    const int positions = zeros(b, 250'000'000, "VEC3");
    b.json["accessors"][static_cast<size_t>(positions)]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", b.view<uint16_t>({1, 0})}, {"componentType", 5123}}},
        {"values", {{"bufferView", b.view<float>({7, 8, 9})}}}};
    primitiveOf(b)["attributes"] = {{"POSITION", positions}};
    expectRefused(b.write("sparse.glb"), "far too large for an accessor without data");
    b.json["accessors"][static_cast<size_t>(positions)]["count"] = 60'000'000;
    primitiveOf(b)["attributes"]["COLOR_0"] = zeros(b, 60'000'000, "VEC4");
    expectRefused(b.write("sparse.glb"), "GiB of vertices out of");
}

TEST(GltfSize, IndicesWithoutNormalsAndStripsCount) {
    GlbBuilder b = squareScene();
    const std::vector<uint8_t> many(100'000, 0);
    primitiveOf(b)["indices"] = b.accessor(many, "SCALAR");
    primitiveOf(b)["mode"] = 5;
    for (int i = 0; i < 200; ++i)
        b.json["meshes"][0]["primitives"].push_back(primitiveOf(b));
    expectRefused(b.write("strips.glb"), "GiB of vertices out of");
}

TEST(GltfSize, TrianglesOfAllInstances) {
    GlbBuilder b = squareScene();
    primitiveOf(b)["indices"] = b.accessor(std::vector<uint8_t>(3 * 10'000, 0), "SCALAR");
    for (int i = 0; i < 20'000; ++i)
        b.node({{"mesh", 0}});
    expectRefused(b.write("instances.glb"), "200010000 of triangles out of");
}

TEST(GltfSize, AForestOfOneTreeIsNoFault) {
    GlbBuilder b = squareScene();
    primitiveOf(b)["indices"] = b.accessor(std::vector<uint8_t>(3 * 1000, 0), "SCALAR");
    for (int i = 0; i < 10'000; ++i)
        b.node({{"mesh", 0}});
    EXPECT_EQ(loadGltf(b.write("forest.glb")).instances.size(), 10'001u);
}

TEST(GltfSize, NamesThatManyNodesTakeFromTheirMesh) {
    GlbBuilder b = squareScene();
    b.json["meshes"][0]["name"] = std::string(100'000, 'x');
    for (int i = 0; i < 5000; ++i)
        b.node({{"mesh", 0}});
    expectRefused(b.write("names.glb"), "MiB of names out of");
}

void useImages(GlbBuilder& b, const std::vector<json>& images) {
    for (const json& image : images) {
        const size_t index = b.json["images"].size();
        b.json["images"].push_back(image);
        b.json["textures"].push_back({{"source", index}});
        b.json["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", index}}}}}});
    }
}

TEST(GltfSize, ImagesThatShareBytes) {
    GlbBuilder b = squareScene();
    const int view = b.view(std::vector<uint8_t>(1'000'000, 0));
    useImages(b, std::vector<json>(3000, {{"bufferView", view}, {"mimeType", "image/png"}}));
    expectRefused(b.write("images.glb"), "GiB of buffers out of");
}

/// Returns the PNG of two pixels, claiming another size.
std::vector<uint8_t> claimingPng(uint8_t thousandsAcross, uint8_t thousandsDown) {
    std::vector<uint8_t> png = test::kTwoPixels;
    png[18] = static_cast<uint8_t>(4 * thousandsAcross); // times 256, near enough
    png[22] = static_cast<uint8_t>(4 * thousandsDown);
    png[25] = 0;         // shades of grey, or stb would call it too large
    png.resize(200'000); // else it could not even be packed
    return png;
}

TEST(GltfSize, PicturesThatClaimMoreThanTheyHold) {
    GlbBuilder b = squareScene();
    useImages(b, {{{"bufferView", b.view(claimingPng(30, 30))}, {"mimeType", "image/png"}}});
    expectRefused(b.write("png.glb"), "GiB of pixels out of");
    GlbBuilder c = squareScene();
    std::vector<uint8_t> small = claimingPng(30, 30);
    small.resize(100);
    useImages(c, {{{"bufferView", c.view(small)}, {"mimeType", "image/png"}}});
    Scene scene;
    EXPECT_LT(test::peakGrowth([&] { scene = loadGltf(c.write("small.glb")); }), test::kLittleMemory);
    EXPECT_TRUE(scene.images.empty());
}

/// Makes a folder with a pipe that nobody writes to and a folder.
class OddFiles : public testing::Test {
protected:
    OddFiles() {
        for (const char* ending : {"", ".exr", ".png", ".hdr", ".gltf", ".bin"}) {
            EXPECT_EQ(mkfifo(folder_.path(std::string("pipe") + ending).c_str(), 0600), 0);
            std::filesystem::create_directory(folder_.path(std::string("folder") + ending));
        }
        std::filesystem::create_symlink("/dev/zero", folder_.path("device.exr"));
        std::filesystem::create_symlink("/dev/zero", folder_.path("device.gltf"));
    }
    std::string write(GlbBuilder& b, const std::string& name) const {
        const std::vector<uint8_t> bytes = b.bytes();
        std::ofstream(folder_.path(name), std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        return folder_.path(name);
    }

    const TemporaryFolder folder_;
};

TEST_F(OddFiles, AreRefusedByNameAsScenesAndPictures) {
    for (const auto& [name, kind] : {std::pair("pipe", "is no regular file"), {"folder", "is a folder"}}) {
        const std::string path = folder_.path(name);
        EXPECT_EQ(messageOf([&] { loadGltf(path + ".gltf"); }),
                  path + ".gltf: " + kind + ": name a .gltf or .glb file");
        for (const char* ending : {".exr", ".png", ".hdr"})
            EXPECT_EQ(messageOf([&] { readImage(path + ending); }),
                      path + ending + ": " + kind + ": name an image");
        EXPECT_EQ(messageOf([&] { readLayeredExr(path + ".exr"); }),
                  path + ".exr: " + kind + ": name an image");
    }
    for (const char* name : {"device.exr", "device.gltf"}) {
        const std::string path = folder_.path(name);
        const std::string message = messageOf([&] {
            if (path.ends_with("exr"))
                readImage(path);
            else
                loadGltf(path);
        });
        EXPECT_EQ(message.find(path + ": is no regular file"), 0u) << message;
    }
}

TEST_F(OddFiles, AreRefusedByNameAsBuffers) {
    for (const auto& [uri, kind] : {std::pair("pipe.bin", "is no regular file"),
                                    {"folder.bin", "is a folder"},
                                    {".", "is a folder"},
                                    {"folder%2Ebin", "is a folder"}}) {
        GlbBuilder b = squareScene();
        b.json["buffers"] = {{{"byteLength", 1000}, {"uri", uri}}};
        const std::string path = write(b, "scene.glb");
        const std::string message = messageOf([&] { loadGltf(path); });
        EXPECT_EQ(message.find(path + ": buffers[0].uri '" + uri + "' " + kind), 0u) << message;
    }
}

TEST_F(OddFiles, AreToldByNameAsImagesThatAreUsed) {
    for (const auto& [uri, kind] : {std::pair("pipe.png", "is no regular file"),
                                    {"folder.png", "is a folder"},
                                    {".", "is a folder"},
                                    {"none.png", "is missing or empty"}}) {
        GlbBuilder b = squareScene();
        useImages(b, {{{"uri", uri}}});
        const std::string path = write(b, "scene.glb");
        const Scene scene = loadGltf(path);
        EXPECT_TRUE(scene.images.empty());
        ASSERT_EQ(scene.warnings.size(), 1u);
        EXPECT_EQ(scene.warnings[0].find(path + ": image file '" + uri + "': " + kind), 0u)
            << scene.warnings[0];
        b.json.erase("materials");
        EXPECT_EQ(messageOf([&, file = write(b, "unused.glb")] { loadGltf(file); }), "");
    }
}

TEST_F(OddFiles, AreRefusedByNameAsSkies) {
    for (const auto& [file, kind] :
         {std::pair("pipe.hdr", "is no regular file"), {"folder.exr", "is a folder"}}) {
        GlbBuilder b = squareScene();
        b.json["scenes"] = {{{"nodes", {0}}}};
        b.json["scenes"][0]["extras"]["relume"]["sky"] = {{"intensity", 1}, {"file", file}};
        const std::string path = write(b, "scene.glb");
        const std::string message = messageOf([&] { loadGltf(path); });
        EXPECT_NE(message.find(std::string(file) + ": " + kind), std::string::npos) << message;
    }
}

} // namespace
} // namespace relume
