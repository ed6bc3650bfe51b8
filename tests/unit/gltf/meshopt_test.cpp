#include "assets/decode/meshopt_stream.h"

#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "tests/fuzz/gltf_corpus.h"
#include "tests/temporary_folder.h"
#include "tests/unit/guarded_bytes.h"

#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <tuple>

namespace relume {
namespace {

std::string meshoptFile(const std::string& name) {
    return RELUME_SOURCE_DIR "/tests/data/" + name;
}

std::string refusal(std::span<const uint8_t> stream, const MeshoptLayout& layout) {
    try {
        decodeMeshopt(stream, layout);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

template<typename T>
std::vector<T> valuesOf(const std::vector<uint8_t>& bytes) {
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

template<typename T>
std::vector<uint8_t> encodedVertices(const std::vector<T>& values, size_t stride) {
    const size_t count = values.size() * sizeof(T) / stride;
    std::vector<uint8_t> out(meshopt_encodeVertexBufferBound(count, stride));
    out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), values.data(), count, stride));
    return out;
}

// Since meshoptimizer 0.20 the encoder asks whose exponent is shared; before, it was that of a vector.
template<typename... Parameters>
void encodeExponents(void (*encode)(Parameters...), void* out, size_t count, size_t stride, int bits,
                     const float* values) {
    if constexpr (sizeof...(Parameters) == 5) {
        encode(out, count, stride, bits, values);
    } else {
        using Mode = std::tuple_element_t<5, std::tuple<Parameters...>>;
        encode(out, count, stride, bits, values, static_cast<Mode>(1));
    }
}

std::vector<uint32_t> gridTriangles(uint32_t edge) {
    std::vector<uint32_t> indices;
    for (uint32_t y = 0; y + 1 < edge; ++y)
        for (uint32_t x = 0; x + 1 < edge; ++x) {
            const uint32_t a = y * edge + x;
            indices.insert(indices.end(), {a, a + 1, a + edge + 1, a, a + edge + 1, a + edge});
        }
    return indices;
}

std::vector<uint8_t> encodedTriangles(const std::vector<uint32_t>& indices, size_t vertices) {
    std::vector<uint8_t> out(meshopt_encodeIndexBufferBound(indices.size(), vertices));
    out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
    return out;
}

std::vector<uint8_t> encodedSequence(const std::vector<uint32_t>& indices, size_t vertices) {
    std::vector<uint8_t> out(meshopt_encodeIndexSequenceBound(indices.size(), vertices));
    out.resize(meshopt_encodeIndexSequence(out.data(), out.size(), indices.data(), indices.size()));
    return out;
}

/// Returns the smallest rotation of a triangle's corners: the encoder may begin at any of them.
std::vector<std::array<uint32_t, 3>> sortedTriangles(const std::vector<uint32_t>& indices) {
    std::vector<std::array<uint32_t, 3>> out;
    for (size_t i = 0; i < indices.size(); i += 3) {
        std::array<uint32_t, 3> t = {indices[i], indices[i + 1], indices[i + 2]};
        std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
        out.push_back(t);
    }
    return out;
}

TEST(Meshopt, AttributesComeBackToTheByte) {
    std::vector<float> values;
    for (int i = 0; i < 300 * 5; ++i)
        values.push_back(std::sin(0.1f * static_cast<float>(i)));
    const auto out = decodeMeshopt(encodedVertices(values, 20), {.count = 300, .stride = 20});
    EXPECT_EQ(valuesOf<float>(out), values);
}

TEST(Meshopt, TrianglesAndIndicesComeBack) {
    const std::vector<uint32_t> indices = gridTriangles(12);
    const std::vector<uint8_t> stream = encodedTriangles(indices, 144);
    const MeshoptLayout layout = {.count = indices.size(), .stride = 4, .mode = MeshoptMode::Triangles};
    EXPECT_EQ(sortedTriangles(valuesOf<uint32_t>(decodeMeshopt(stream, layout))), sortedTriangles(indices));
    MeshoptLayout narrow = layout;
    narrow.stride = 2;
    const std::vector<uint16_t> shorts = valuesOf<uint16_t>(decodeMeshopt(stream, narrow));
    EXPECT_EQ(sortedTriangles({shorts.begin(), shorts.end()}), sortedTriangles(indices));
    const std::vector<uint8_t> sequence = encodedSequence(indices, 144);
    EXPECT_EQ(valuesOf<uint32_t>(decodeMeshopt(
                  sequence, {.count = indices.size(), .stride = 4, .mode = MeshoptMode::Indices})),
              indices);
}

// What comes out of each filter is compared with what went into its encoder.
TEST(Meshopt, EachFilterGivesItsNumbersBack) {
    constexpr size_t kCount = 64;
    std::vector<float> normals, quaternions, numbers;
    for (size_t i = 0; i < kCount; ++i) {
        const float a = 0.1f * static_cast<float>(i), z = -0.9f + 1.8f * static_cast<float>(i) / kCount,
                    r = std::sqrt(1 - z * z);
        normals.insert(normals.end(), {r * std::cos(a), r * std::sin(a), z, 1.0f});
        const float s = std::sin(a / 2);
        quaternions.insert(quaternions.end(), {0.6f * s, 0.0f, 0.8f * s, std::cos(a / 2)});
        numbers.insert(numbers.end(), {a * 1000, -a, 1e-3f * a});
    }
    std::vector<uint8_t> bytes(kCount * 4);
    meshopt_encodeFilterOct(bytes.data(), kCount, 4, 8, normals.data());
    auto out = decodeMeshopt(encodedVertices(bytes, 4),
                             {.count = kCount, .stride = 4, .filter = MeshoptFilter::Octahedral});
    const std::vector<int8_t> octahedral = valuesOf<int8_t>(out);
    for (size_t i = 0; i < 4 * kCount; ++i)
        if (i % 4 != 3) {
            EXPECT_NEAR(octahedral[i] / 127.0f, normals[i], 0.02f);
        }
    bytes.resize(kCount * 8);
    meshopt_encodeFilterQuat(bytes.data(), kCount, 8, 16, quaternions.data());
    out = decodeMeshopt(encodedVertices(bytes, 8),
                        {.count = kCount, .stride = 8, .filter = MeshoptFilter::Quaternion});
    const std::vector<int16_t> rotations = valuesOf<int16_t>(out);
    for (size_t i = 0; i < kCount; ++i) {
        float along = 0;
        for (size_t c = 0; c < 4; ++c)
            along += static_cast<float>(rotations[4 * i + c]) / 32767.0f * quaternions[4 * i + c];
        EXPECT_NEAR(std::abs(along), 1.0f, 1e-3f); // q and -q are one rotation
    }
    bytes.resize(kCount * 12);
    encodeExponents(meshopt_encodeFilterExp, bytes.data(), kCount, 12, 15, numbers.data());
    out = decodeMeshopt(encodedVertices(bytes, 12),
                        {.count = kCount, .stride = 12, .filter = MeshoptFilter::Exponential});
    const std::vector<float> exponential = valuesOf<float>(out);
    for (size_t i = 0; i < kCount; ++i)
        for (size_t c = 0; c < 3; ++c) { // the exponent is that of the element's largest number
            const float most = std::max(std::abs(numbers[3 * i]), 1e-3f);
            EXPECT_NEAR(exponential[3 * i + c], numbers[3 * i + c], most / (1 << 13));
        }
}

TEST(Meshopt, ALayoutThatTheLibraryWouldOnlyAssertIsRefused) {
    const std::vector<uint8_t> stream(64, 0xa0);
    const auto bad = [&](const MeshoptLayout& layout) { return refusal(stream, layout); };
    EXPECT_NE(bad({.count = 4, .stride = 6}).find("elements of 6 bytes"), std::string::npos);
    EXPECT_NE(bad({.count = 4, .stride = 260}).find("elements of 260 bytes"), std::string::npos);
    EXPECT_NE(bad({.count = 4, .stride = 8, .mode = MeshoptMode::Triangles}), "");
    EXPECT_NE(bad({.count = 4, .stride = 4, .mode = MeshoptMode::Triangles}).find("no triangles"),
              std::string::npos);
    EXPECT_NE(bad({.count = 4, .stride = 12, .filter = MeshoptFilter::Octahedral}).find("filter"),
              std::string::npos);
    EXPECT_NE(
        bad({.count = 3, .stride = 4, .mode = MeshoptMode::Indices, .filter = MeshoptFilter::Exponential}),
        "");
    EXPECT_NE(bad({.count = uint64_t(1) << 40, .stride = 16}).find("cannot hold"), std::string::npos);
    EXPECT_NE(bad({.count = 300, .stride = 4, .mode = MeshoptMode::Triangles}).find("cannot hold"),
              std::string::npos);
}

TEST(Meshopt, AThousandMutatedStreamsNeverReadPastTheirEnd) {
    std::vector<float> values;
    for (int i = 0; i < 200; ++i)
        values.push_back(static_cast<float>(i) * 0.37f);
    const std::vector<uint32_t> indices = gridTriangles(8);
    const struct {
        std::vector<uint8_t> stream;
        MeshoptLayout layout;
    } kinds[] = {
        {encodedVertices(values, 8), {.count = 100, .stride = 8}},
        {encodedVertices(values, 8), {.count = 100, .stride = 8, .filter = MeshoptFilter::Octahedral}},
        {encodedVertices(values, 8), {.count = 100, .stride = 8, .filter = MeshoptFilter::Quaternion}},
        {encodedVertices(values, 8), {.count = 100, .stride = 8, .filter = MeshoptFilter::Exponential}},
        {encodedTriangles(indices, 64),
         {.count = indices.size(), .stride = 2, .mode = MeshoptMode::Triangles}},
        {encodedSequence(indices, 64), {.count = indices.size(), .stride = 4, .mode = MeshoptMode::Indices}}};
    int decoded = 0, refused = 0;
    for (const auto& [stream, layout] : kinds) {
        ASSERT_EQ(refusal(stream, layout), "");
        for (uint32_t i = 0; i < 200; ++i) {
            const test::GuardedBytes bytes(test::mutated(stream, i));
            ++(refusal(bytes.span(), layout).empty() ? decoded : refused);
        }
    }
    EXPECT_GT(decoded, 100);
    EXPECT_GT(refused, 100);
}

// A view without a stride of its own is read tightly, as its accessors are checked: by the stride of its
// stream the last of these would lie behind it.
TEST(Meshopt, IndicesThatNameAViewOfVerticesEndWithIt) {
    const TemporaryFolder folder;
    test::GlbBuilder file = fuzz::meshoptScene();
    file.json["accessors"][1]["bufferView"] = 0;
    file.json["accessors"][1]["count"] = 12;
    const std::vector<uint8_t> bytes = file.bytes();
    std::ofstream(folder.path("a.glb"), std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    EXPECT_THROW(loadGltf(folder.path("a.glb")), Error); // coordinates are no indices
}

glm::vec3 worldPoint(const Scene& scene, size_t instance, size_t vertex) {
    const Instance& it = scene.instances[instance];
    const Mesh& mesh = scene.meshes[static_cast<size_t>(it.mesh)];
    return glm::vec3(it.transform * glm::vec4(mesh.primitives[0].positions[vertex], 1.0f));
}

// The tool quantizes positions to 14 bits, puts the scale into the nodes and sorts the vertices anew.
TEST(Meshopt, AToolsFileIsThePlainOneWithinItsQuantization) {
    const Scene plain = loadGltf(meshoptFile("plain.glb")), packed = loadGltf(meshoptFile("meshopt.glb"));
    ASSERT_EQ(packed.instances.size(), plain.instances.size());
    const Primitive &a = plain.meshes[0].primitives[0], &b = packed.meshes[0].primitives[0];
    ASSERT_EQ(b.positions.size(), a.positions.size());
    ASSERT_EQ(b.indices.size(), a.indices.size());
    for (size_t i = 0; i < a.positions.size(); ++i)
        for (size_t k = 0; k < plain.instances.size(); ++k) {
            const glm::vec3 wanted = worldPoint(plain, k, i);
            float least = std::numeric_limits<float>::max();
            for (size_t j = 0; j < b.positions.size(); ++j)
                least = std::min(least, glm::distance(worldPoint(packed, k, j), wanted));
            EXPECT_LT(least, 3e-4f); // 2 m over 14 bits, times the largest scale
        }
    for (const glm::vec2& uv : b.texCoord1) {
        EXPECT_GE(uv.x, 0.049f);
        EXPECT_LE(uv.x, 0.951f);
    }
}

} // namespace
} // namespace relume
