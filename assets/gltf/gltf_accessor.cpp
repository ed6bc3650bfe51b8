#include "assets/gltf/gltf_build.h"

#include "assets/base/error.h"

#include <algorithm>
#include <cstring>

namespace relume::gltf {

namespace {

struct Span {
    const unsigned char* data = nullptr;
    size_t stride = 0; // [bytes]
};

uint32_t bytesOf(int componentType) {
    return static_cast<uint32_t>(tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(componentType)));
}

Span viewSpan(const tinygltf::Model& model, int view, size_t offset, size_t elementBytes) {
    const tinygltf::BufferView& bufferView = model.bufferViews[static_cast<size_t>(view)];
    const std::vector<unsigned char>& data = model.buffers[static_cast<size_t>(bufferView.buffer)].data;
    return {data.data() + bufferView.byteOffset + offset,
            bufferView.byteStride != 0 ? bufferView.byteStride : elementBytes};
}

template<typename T>
T load(const unsigned char* data) {
    T value;
    std::memcpy(&value, data, sizeof(T));
    return value;
}

float component(const unsigned char* data, int type, bool normalized) {
    // Normalized integers are read as section 3.11 of the glTF 2.0 specification says.
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
        const float value = load<int8_t>(data);
        return normalized ? std::max(value / 127.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return normalized ? load<uint8_t>(data) / 255.0f : load<uint8_t>(data);
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
        const float value = load<int16_t>(data);
        return normalized ? std::max(value / 32767.0f, -1.0f) : value;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return normalized ? load<uint16_t>(data) / 65535.0f : load<uint16_t>(data);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return static_cast<float>(load<uint32_t>(data));
    default:
        return load<float>(data);
    }
}

uint32_t index(const unsigned char* data, int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return load<uint8_t>(data);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return load<uint16_t>(data);
    default:
        return load<uint32_t>(data);
    }
}

void copyElements(const Span& source, const tinygltf::Accessor& accessor, uint32_t components, float* out) {
    const uint32_t bytes = bytesOf(accessor.componentType);
    if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_FLOAT) {
        for (size_t i = 0; i < accessor.count; ++i)
            std::memcpy(out + i * components, source.data + i * source.stride, components * sizeof(float));
        return;
    }
    for (size_t i = 0; i < accessor.count; ++i)
        for (uint32_t c = 0; c < components; ++c)
            out[i * components + c] = component(source.data + i * source.stride + c * bytes,
                                                accessor.componentType, accessor.normalized);
}

/// Calls place(target, value) for each element that the accessor's sparse part replaces, if it has one: its
/// index, and the bytes of its new value.
template<typename Place>
void eachSparse(const tinygltf::Model& model, const tinygltf::Accessor& accessor, size_t elementBytes,
                Place place) {
    const auto& sparse = accessor.sparse;
    if (!sparse.isSparse) return;
    const uint32_t indexBytes = bytesOf(sparse.indices.componentType);
    const Span indices = viewSpan(model, sparse.indices.bufferView,
                                  static_cast<size_t>(sparse.indices.byteOffset), indexBytes);
    const Span values = viewSpan(model, sparse.values.bufferView,
                                 static_cast<size_t>(sparse.values.byteOffset), elementBytes);
    for (size_t i = 0; i < static_cast<size_t>(sparse.count); ++i) {
        // The views of sparse parts must be tightly packed, whatever stride they state.
        const uint32_t target = index(indices.data + i * indexBytes, sparse.indices.componentType);
        if (target >= accessor.count) throw Error("a sparse accessor's index lies past its end");
        place(target, values.data + i * elementBytes);
    }
}

} // namespace

std::vector<float> readFloats(const tinygltf::Model& model, const tinygltf::Accessor& accessor,
                              uint32_t components) {
    std::vector<float> out(accessor.count * components);
    const uint32_t bytes = bytesOf(accessor.componentType);
    const size_t elementBytes = size_t(bytes) * components;
    if (accessor.bufferView >= 0)
        copyElements(viewSpan(model, accessor.bufferView, accessor.byteOffset, elementBytes), accessor,
                     components, out.data());
    eachSparse(model, accessor, elementBytes, [&](uint32_t target, const unsigned char* value) {
        for (uint32_t c = 0; c < components; ++c)
            out[target * components + c] =
                component(value + c * bytes, accessor.componentType, accessor.normalized);
    });
    return out;
}

std::vector<uint32_t> readIndices(const tinygltf::Model& model, const tinygltf::Accessor& accessor) {
    std::vector<uint32_t> out(accessor.count);
    const uint32_t bytes = bytesOf(accessor.componentType);
    if (accessor.bufferView >= 0) {
        const Span source = viewSpan(model, accessor.bufferView, accessor.byteOffset, bytes);
        for (size_t i = 0; i < accessor.count; ++i)
            out[i] = index(source.data + i * source.stride, accessor.componentType);
    }
    eachSparse(model, accessor, bytes, [&](uint32_t target, const unsigned char* value) {
        out[target] = index(value, accessor.componentType);
    });
    return out;
}

} // namespace relume::gltf
