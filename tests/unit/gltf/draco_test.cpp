#include "assets/decode/draco_stream.h"

#include "assets/base/error.h"
#include "assets/gltf/gltf.h"
#include "tests/message_of.h"
#include "tests/unit/glb_builder.h"
#include "tests/unit/guarded_bytes.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>

namespace relume {
namespace {

std::string dataFile(const std::string& name) {
    return RELUME_SOURCE_DIR "/tests/data/" + name;
}

constexpr int kGrid = 8;      // vertices along an edge of the encoded mesh
constexpr int kSpread = 1000; // between the numbers of two vertices

glm::vec3 gridPoint(int i) {
    const float x = static_cast<float>(i % kGrid), y = static_cast<float>(i / kGrid);
    return {x, y, 0.25f * x * y};
}

/// Encodes a grid with positions (number 0) and a number for each vertex (number 1).
std::vector<uint8_t> encodedGrid(int method) {
    constexpr int kCells = kGrid - 1;
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2 * kCells * kCells);
    const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int number = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 1, draco::DT_UINT16);
    int face = 0;
    for (int y = 0; y < kCells; ++y)
        for (int x = 0; x < kCells; ++x) {
            const int a = y * kGrid + x;
            for (const std::array<int, 3>& t :
                 {std::array{a, a + 1, a + kGrid + 1}, std::array{a, a + kGrid + 1, a + kGrid}}) {
                std::array<glm::vec3, 3> points;
                std::array<uint16_t, 3> numbers;
                for (size_t k = 0; k < 3; ++k) {
                    points[k] = gridPoint(t[k]);
                    numbers[k] = static_cast<uint16_t>(kSpread * t[k]);
                }
                const draco::FaceIndex at(static_cast<uint32_t>(face++));
                builder.SetAttributeValuesForFace(position, at, &points[0], &points[1], &points[2]);
                builder.SetAttributeValuesForFace(number, at, &numbers[0], &numbers[1], &numbers[2]);
            }
        }
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    encoder.SetEncodingMethod(method);
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
    draco::EncoderBuffer buffer;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
    return {buffer.data(), buffer.data() + buffer.size()};
}

const std::vector<DracoWish> kWishes = {{.id = 0, .type = NumberType::Float, .components = 3},
                                        {.id = 1, .type = NumberType::Uint16, .components = 1}};
constexpr DracoBounds kBounds = {.points = kGrid * kGrid, .triangles = 2 * (kGrid - 1) * (kGrid - 1)};

template<typename T>
T valueAt(const std::vector<uint8_t>& bytes, size_t i) {
    T value;
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    return value;
}

TEST(Draco, BothMethodsGiveTheMeshBackWithinItsQuantization) {
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const std::vector<uint8_t> stream = encodedGrid(method);
        const DracoMesh mesh = decodeDraco(stream, kWishes, kBounds);
        ASSERT_EQ(mesh.points, kBounds.points);
        ASSERT_EQ(mesh.indices.size(), 3 * kBounds.triangles);
        const float step = 0.25f * (kGrid - 1) * (kGrid - 1) / (1 << 14); // of 14 bits over the longest edge
        double area = 0;
        for (uint32_t i = 0; i < mesh.points; ++i) {
            const glm::vec3 point = gridPoint(valueAt<uint16_t>(mesh.attributes[1], i) / kSpread);
            for (size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(valueAt<float>(mesh.attributes[0], 3 * i + c), point[static_cast<int>(c)], step);
        }
        for (size_t t = 0; t < mesh.indices.size(); t += 3) {
            std::array<glm::vec3, 3> p;
            for (size_t k = 0; k < 3; ++k)
                p[k] = gridPoint(valueAt<uint16_t>(mesh.attributes[1], mesh.indices[t + k]) / kSpread);
            area += 0.5 * double(glm::cross(p[1] - p[0], p[2] - p[0]).z);
        }
        EXPECT_NEAR(area, (kGrid - 1) * (kGrid - 1), 1e-4); // of all triangles, seen from above: they face up
    }
}

TEST(Draco, WhatAStreamClaimsIsBoundedByTheFile) {
    const std::vector<uint8_t> stream = encodedGrid(draco::MESH_EDGEBREAKER_ENCODING);
    const auto message = [&](DracoBounds bounds) {
        return messageOf([&] { decodeDraco(stream, kWishes, bounds); });
    };
    EXPECT_NE(message({.points = kBounds.points, .triangles = 97}).find("claims 98 triangles"),
              std::string::npos);
    EXPECT_NE(message({.points = 63, .triangles = 98}).find("has 64 vertices"), std::string::npos);
    const std::vector<DracoWish> other = {{.id = 7, .type = NumberType::Float, .components = 3}};
    EXPECT_NE(messageOf([&] { decodeDraco(stream, other, kBounds); }).find("no attribute 7"),
              std::string::npos);
    const std::vector<DracoWish> narrow = {{.id = 1, .type = NumberType::Uint8, .components = 1}};
    EXPECT_NE(messageOf([&] { decodeDraco(stream, narrow, kBounds); }).find("do not fit"), std::string::npos);
    EXPECT_NE(messageOf([&] { decodeDraco(std::vector<uint8_t>{}, kWishes, kBounds); }), "");
}

TEST(Draco, AThousandMutatedStreamsNeverReadPastTheirEnd) {
    int decoded = 0, refused = 0;
    for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
        const std::vector<uint8_t> stream = encodedGrid(method);
        for (uint32_t i = 0; i < 500; ++i) {
            const test::GuardedBytes bytes(test::mutated(stream, i));
            const std::string message = messageOf([&] { decodeDraco(bytes.span(), kWishes, kBounds); });
            EXPECT_EQ(message.find('\n'), std::string::npos);
            ++(message.empty() ? decoded : refused);
        }
    }
    EXPECT_GT(decoded, 50);
    EXPECT_GT(refused, 200);
}

TEST(Draco, AToolsFileIsThePlainOneWithinItsQuantization) {
    const Scene plain = loadGltf(dataFile("plain.glb")), packed = loadGltf(dataFile("draco.glb"));
    ASSERT_EQ(packed.instances.size(), plain.instances.size());
    ASSERT_EQ(packed.meshes.size(), plain.meshes.size());
    const Primitive &a = plain.meshes[0].primitives[0], &b = packed.meshes[0].primitives[0];
    ASSERT_EQ(b.positions.size(), a.positions.size());
    ASSERT_EQ(b.indices.size(), a.indices.size());
    ASSERT_EQ(b.normals.size(), a.normals.size());
    ASSERT_EQ(b.texCoord1.size(), a.texCoord1.size());
    const float step = 2.0f / (1 << 14); // positions have 14 bits by default, texture coordinates 12
    for (size_t i = 0; i < a.positions.size(); ++i) {
        const auto nearest = std::min_element(b.positions.begin(), b.positions.end(), [&](auto& p, auto& q) {
            return glm::distance(p, a.positions[i]) < glm::distance(q, a.positions[i]);
        });
        const size_t j = static_cast<size_t>(nearest - b.positions.begin());
        EXPECT_LT(glm::distance(*nearest, a.positions[i]), step * std::sqrt(3.0f) / 2);
        EXPECT_GT(glm::dot(b.normals[j], a.normals[i]), 0.9999f);
        EXPECT_LT(glm::distance(b.texCoord1[j], a.texCoord1[i]), 1.0f / (1 << 12));
    }
}

TEST(Draco, AThousandMutatedFilesNeverCrash) {
    int loaded = 0, refused = 0;
    for (const char* name : {"draco.glb", "meshopt.glb"}) {
        std::ifstream stream(dataFile(name), std::ios::binary);
        const std::vector<uint8_t> whole{std::istreambuf_iterator<char>(stream), {}};
        uint32_t json = 0;
        std::memcpy(&json, whole.data() + 12, sizeof(json));
        const auto chunk = whole.begin() + 20 + json + 8; // what is mutated is compressed, not JSON
        for (uint32_t i = 1; i <= 500; ++i) {
            std::vector<uint8_t> bytes = test::mutated({chunk, whole.end()}, i % 5 == 0 ? i + 1000001 : i);
            bytes.resize(static_cast<size_t>(whole.end() - chunk));
            bytes.insert(bytes.begin(), whole.begin(), chunk);
            const std::string path = test::writeBytes("mutated.glb", bytes);
            const std::string message = messageOf([&] { loadGltf(path, {.time = 0.5}); });
            EXPECT_EQ(message.find('\n'), std::string::npos);
            ++(message.empty() ? loaded : refused);
        }
    }
    EXPECT_GT(loaded, 50);
    EXPECT_GT(refused, 200);
}

} // namespace
} // namespace relume
