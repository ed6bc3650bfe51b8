#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "assets/decode/meshopt_stream.h"
#include "assets/gltf/gltf_build.h"

namespace relume::gltf {

/// Names a buffer view whose bytes are compressed by EXT_meshopt_compression, and where they lie.
struct CompressedView {
    size_t view = 0, buffer = 0;
    uint64_t offset = 0, bytes = 0;
    size_t stride = 0; // of the view itself [bytes], by which its accessors were checked; 0: none
    MeshoptLayout layout;
};

/// Takes the compressed views out of a checked file's JSON: the parser sees small ones in their place, and
/// small buffers where the file has none.
std::vector<CompressedView> takeCompressedViews(nlohmann::json& document);

/// Takes the indices of primitives that Draco compressed out of a checked file's JSON: the parser refuses
/// indices without bytes. DecodedPrimitive finds their number in the extension.
void hideDracoIndices(nlohmann::json& document);

/// Decodes these views into buffers of their own. Throws Error.
void decodeViews(Build& build, const std::vector<CompressedView>& views);

/// Decodes a primitive that KHR_draco_mesh_compression compressed, as long as it lives: its accessors are at
/// the end of the model's lists. Throws Error. Other primitives stay as they are.
class DecodedPrimitive {
public:
    DecodedPrimitive(Build& build, const std::string& where, const tinygltf::Primitive& source);
    ~DecodedPrimitive();
    DecodedPrimitive(const DecodedPrimitive&) = delete;
    DecodedPrimitive& operator=(const DecodedPrimitive&) = delete;

    const tinygltf::Primitive& primitive() const { return primitive_; }

private:
    void decode(const std::string& where, const tinygltf::Value& extension);
    int addAccessor(std::vector<unsigned char> bytes, int componentType, int type, size_t count,
                    bool normalized);

    Build& build_;
    tinygltf::Primitive primitive_;
    size_t buffers_, views_, accessors_; // of the file
};

} // namespace relume::gltf
