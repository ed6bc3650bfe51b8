#include "assets/decode/draco_stream.h"

#include "assets/base/error.h"

#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <spdlog/fmt/fmt.h>

#include <new>

namespace relume {

namespace {

constexpr uint32_t kMostComponents = 16; // glTF's largest element is a MAT4

[[noreturn]] void throwBad(const std::string& what) {
    throw Error("its Draco stream " + what);
}

draco::DecoderBuffer bufferOf(std::span<const uint8_t> stream) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(stream.data()), stream.size());
    return buffer;
}

/// Reads the head of a stream up to the number of its triangles: the library takes memory for them before it
/// has seen any.
uint64_t claimedTriangles(std::span<const uint8_t> stream) {
    constexpr uint16_t kMetadata = 0x8000;
    draco::DecoderBuffer buffer = bufferOf(stream);
    draco::DracoHeader header;
    if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) throwBad("has no good header");
    if (header.encoder_type != draco::TRIANGULAR_MESH) throwBad("holds no mesh");
    if (header.version_major != 2 || header.version_minor != 2)
        throwBad(fmt::format("is of version {}.{}, and only 2.2 is read", header.version_major,
                             header.version_minor));
    buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
    if ((header.flags & kMetadata) != 0) {
        draco::GeometryMetadata unused;
        if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &unused)) throwBad("is damaged");
    }
    uint32_t triangles = 0, vertices = 0;
    bool good = true;
    if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING) {
        uint8_t traversal = 0;
        good = buffer.Decode(&traversal) && draco::DecodeVarint(&vertices, &buffer);
    }
    if (!good || !draco::DecodeVarint(&triangles, &buffer)) throwBad("ends too early");
    return triangles;
}

template<typename T>
bool convert(const draco::PointAttribute& attribute, uint32_t points, uint32_t components,
             std::vector<uint8_t>& out) {
    std::vector<T> element(components);
    const size_t bytes = components * sizeof(T);
    out.resize(points * bytes);
    for (uint32_t i = 0; i < points; ++i) {
        const draco::AttributeValueIndex value = attribute.mapped_index(draco::PointIndex(i));
        if (value.value() >= attribute.size() ||
            !attribute.ConvertValue<T>(value, static_cast<int8_t>(components), element.data()))
            return false;
        std::memcpy(out.data() + i * bytes, element.data(), bytes);
    }
    return true;
}

bool convertTo(NumberType type, const draco::PointAttribute& attribute, uint32_t points, uint32_t components,
               std::vector<uint8_t>& out) {
    switch (type) {
    case NumberType::Int8:
        return convert<int8_t>(attribute, points, components, out);
    case NumberType::Uint8:
        return convert<uint8_t>(attribute, points, components, out);
    case NumberType::Int16:
        return convert<int16_t>(attribute, points, components, out);
    case NumberType::Uint16:
        return convert<uint16_t>(attribute, points, components, out);
    case NumberType::Uint32:
        return convert<uint32_t>(attribute, points, components, out);
    case NumberType::Float:
        return convert<float>(attribute, points, components, out);
    }
    return false;
}

std::unique_ptr<draco::Mesh> decode(std::span<const uint8_t> stream) {
    draco::DecoderBuffer buffer = bufferOf(stream);
    draco::Decoder decoder;
    draco::StatusOr<std::unique_ptr<draco::Mesh>> result = decoder.DecodeMeshFromBuffer(&buffer);
    if (!result.ok()) throwBad("cannot be decoded");
    return std::move(result).value();
}

DracoMesh meshOf(const draco::Mesh& decoded, std::span<const DracoWish> wishes) {
    DracoMesh mesh;
    mesh.points = decoded.num_points();
    mesh.indices.reserve(size_t{3} * decoded.num_faces());
    for (draco::FaceIndex face(0); face < decoded.num_faces(); ++face)
        for (const draco::PointIndex& point : decoded.face(face)) {
            if (point.value() >= mesh.points) throwBad("has a triangle of a vertex that it lacks");
            mesh.indices.push_back(point.value());
        }
    for (const DracoWish& wish : wishes) {
        ASSERT(wish.components > 0 && wish.components <= kMostComponents);
        const draco::PointAttribute* attribute = decoded.GetAttributeByUniqueId(wish.id);
        if (!attribute) throwBad(fmt::format("has no attribute {}", wish.id));
        if (!convertTo(wish.type, *attribute, mesh.points, wish.components, mesh.attributes.emplace_back()))
            throwBad(fmt::format("has an attribute {} whose values do not fit its accessor", wish.id));
    }
    return mesh;
}

} // namespace

uint32_t bytesOf(NumberType type) {
    switch (type) {
    case NumberType::Int8:
    case NumberType::Uint8:
        return 1;
    case NumberType::Int16:
    case NumberType::Uint16:
        return 2;
    case NumberType::Uint32:
    case NumberType::Float:
        return 4;
    }
    return 0;
}

DracoMesh decodeDraco(std::span<const uint8_t> stream, std::span<const DracoWish> wishes,
                      const DracoBounds& bounds) {
    const uint64_t triangles = claimedTriangles(stream);
    if (triangles > bounds.triangles)
        throwBad(fmt::format("claims {} triangles, but the file tells of {}", triangles, bounds.triangles));
    try {
        const std::unique_ptr<draco::Mesh> decoded = decode(stream);
        if (decoded->num_points() > bounds.points)
            throwBad(fmt::format("has {} vertices, but the file tells of {}", decoded->num_points(),
                                 bounds.points));
        return meshOf(*decoded, wishes);
    } catch (const std::bad_alloc&) {
        throwBad("asks for more memory than there is");
    } catch (const std::length_error&) { // a vector's, of a size that no memory has
        throwBad("asks for more memory than there is");
    }
}

} // namespace relume
