#include "assets/decode/meshopt_stream.h"

#include "assets/base/error.h"

#include <meshoptimizer.h>
#include <spdlog/fmt/fmt.h>

#include <string>

namespace relume {

namespace {

// How many decoded bytes or elements a byte of a stream may become. Attributes: 16 values of one byte of an
// element take two bits at least. Triangles take a byte each, and so do single indices.
constexpr uint64_t kMostOfAttributes = 64, kMostOfTriangles = 3, kMostOfIndices = 1;
constexpr uint32_t kMostStride = 256; // of attributes [bytes]; glTF and the library agree

[[noreturn]] void throwBadMeshopt(const std::string& what) {
    throw Error("its meshopt stream " + what);
}

bool filterFits(const MeshoptLayout& layout) {
    switch (layout.filter) {
    case MeshoptFilter::None:
        return true;
    case MeshoptFilter::Octahedral:
        return layout.stride == 4 || layout.stride == 8;
    case MeshoptFilter::Quaternion:
        return layout.stride == 8;
    case MeshoptFilter::Exponential:
        return layout.stride % 4 == 0;
    }
    return false;
}

/// The library only asserts what is checked here.
void checkLayout(const MeshoptLayout& layout, size_t bytes) {
    const bool attributes = layout.mode == MeshoptMode::Attributes;
    const bool strideFits = attributes
                                ? layout.stride >= 4 && layout.stride <= kMostStride && layout.stride % 4 == 0
                                : layout.stride == 2 || layout.stride == 4;
    if (!strideFits) throwBadMeshopt(fmt::format("has elements of {} bytes", layout.stride));
    if (layout.filter != MeshoptFilter::None && (!attributes || !filterFits(layout)))
        throwBadMeshopt(fmt::format("has a filter that does not fit elements of {} bytes", layout.stride));
    if (layout.mode == MeshoptMode::Triangles && layout.count % 3 != 0)
        throwBadMeshopt(fmt::format("holds {} indices, which are no triangles", layout.count));
    const uint64_t most = attributes                              ? bytes * kMostOfAttributes / layout.stride
                          : layout.mode == MeshoptMode::Triangles ? bytes * kMostOfTriangles
                                                                  : bytes * kMostOfIndices;
    if (layout.count > most)
        throwBadMeshopt(fmt::format("has {} bytes, which cannot hold {} elements", bytes, layout.count));
}

void applyFilter(std::vector<uint8_t>& values, const MeshoptLayout& layout) {
    switch (layout.filter) {
    case MeshoptFilter::None:
        return;
    case MeshoptFilter::Octahedral:
        return meshopt_decodeFilterOct(values.data(), layout.count, layout.stride);
    case MeshoptFilter::Quaternion:
        return meshopt_decodeFilterQuat(values.data(), layout.count, layout.stride);
    case MeshoptFilter::Exponential:
        return meshopt_decodeFilterExp(values.data(), layout.count, layout.stride);
    }
}

} // namespace

std::vector<uint8_t> decodeMeshopt(std::span<const uint8_t> stream, const MeshoptLayout& layout) {
    checkLayout(layout, stream.size());
    std::vector<uint8_t> values(layout.count * layout.stride);
    int failed = 0;
    switch (layout.mode) {
    case MeshoptMode::Attributes:
        failed = meshopt_decodeVertexBuffer(values.data(), layout.count, layout.stride, stream.data(),
                                            stream.size());
        break;
    case MeshoptMode::Triangles:
        failed = meshopt_decodeIndexBuffer(values.data(), layout.count, layout.stride, stream.data(),
                                           stream.size());
        break;
    case MeshoptMode::Indices:
        failed = meshopt_decodeIndexSequence(values.data(), layout.count, layout.stride, stream.data(),
                                             stream.size());
        break;
    }
    if (failed != 0) throwBadMeshopt("is damaged");
    applyFilter(values, layout);
    return values;
}

} // namespace relume
