#include "assets/base/numbering.h"
#include "assets/foreign/foreign_build.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace relume::foreign {
namespace {

// Where a file has no normals, faces that meet at less than this angle become one smooth surface [cos of 30
// degrees]: a sphere of 16 segments is smooth and a box is not.
constexpr double kSmoothBelow = 0.8660254037844386;
// Where more corners than this meet in a point, each keeps the normal of its face: all pairs would be looked
// at.
constexpr size_t kMostAround = 256;

/// A vertex as it will be. Two of them are one where all of their bits are alike.
struct Vertex {
    glm::vec3 position{}, normal{};
    glm::vec2 uv[2]{};
    glm::vec4 color{1.0f};

    bool operator==(const Vertex& other) const { return std::memcmp(this, &other, sizeof(Vertex)) == 0; }
};
static_assert(sizeof(Vertex) == 14 * sizeof(float), "no padding is compared");

template<typename Key>
uint64_t hashOf(const Key& key) {
    static_assert(sizeof(Key) % sizeof(uint32_t) == 0);
    std::array<uint32_t, sizeof(Key) / sizeof(uint32_t)> words{};
    std::memcpy(words.data(), &key, sizeof(Key));
    uint64_t hash = 0;
    for (const uint32_t word : words)
        hash = mixBits(hash ^ word);
    return hash;
}

bool isFinite(const aiVector3D& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The triangles of a mesh whose corners are there and finite, as three indices each.
std::vector<unsigned> usableCorners(Build& build, const aiMesh& mesh, const std::string& name) {
    std::vector<unsigned> corners;
    size_t bad = 0;
    for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
        const aiFace& face = mesh.mFaces[i];
        if (face.mNumIndices != 3) continue;
        const bool good = std::all_of(face.mIndices, face.mIndices + 3, [&](unsigned index) {
            return index < mesh.mNumVertices && isFinite(mesh.mVertices[index]);
        });
        if (good)
            corners.insert(corners.end(), face.mIndices, face.mIndices + 3);
        else
            ++bad;
    }
    if (bad > 0)
        build.warnings.add("mesh " + inQuotes(name), "has triangles without finite positions, left out");
    return corners;
}

/// Computes normals for corners that have none: those of the faces that meet in a point of the surface,
/// weighted by area, as far as they are within kSmoothBelow of the corner's own face.
class CornerNormals {
public:
    CornerNormals(const aiMesh& mesh, const std::vector<unsigned>& corners) {
        Numbering<glm::vec3> points(corners.size());
        for (const unsigned corner : corners) {
            // Zeros of both signs are one place.
            const glm::vec3 place = vec3Of(mesh.mVertices[corner]) + 0.0f;
            pointOf_.push_back(points(place, hashOf(place)));
        }
        begins_.assign(points.size() + 1, 0);
        for (const uint32_t point : pointOf_)
            ++begins_[point + 1];
        for (size_t i = 1; i < begins_.size(); ++i)
            begins_[i] += begins_[i - 1];
        std::vector<uint32_t> next(begins_.begin(), begins_.end() - 1);
        around_.resize(pointOf_.size());
        for (uint32_t i = 0; i < pointOf_.size(); ++i)
            around_[next[pointOf_[i]]++] = i / 3;
        for (size_t i = 0; i < corners.size(); i += 3) {
            const glm::dvec3 a = points.key(pointOf_[i]), b = points.key(pointOf_[i + 1]);
            faces_.push_back(glm::cross(b - a, glm::dvec3(points.key(pointOf_[i + 2])) - a));
        }
    }

    /// Returns the normal of a corner, not of unit length; of a triangle without area it is zero.
    glm::vec3 operator()(size_t corner) const {
        const glm::dvec3 own = faces_[corner / 3];
        const uint32_t point = pointOf_[corner], begin = begins_[point], end = begins_[point + 1];
        const double length = glm::length(own);
        glm::dvec3 sum(0.0);
        if (end - begin <= kMostAround)
            for (uint32_t i = begin; i < end; ++i) {
                const glm::dvec3& face = faces_[around_[i]];
                if (glm::dot(face, own) >= kSmoothBelow * length * glm::length(face)) sum += face;
            }
        if (glm::dot(sum, sum) == 0.0) sum = own;
        const double size = glm::length(sum);
        return size > 0.0 ? glm::vec3(sum / size) : glm::vec3(0.0f);
    }

private:
    std::vector<uint32_t> pointOf_;         // of each corner
    std::vector<uint32_t> begins_, around_; // the triangles around each point
    std::vector<glm::dvec3> faces_;         // normals of the triangles, twice their area long
};

/// A file that has colours of vertices and leaves all of them black means none.
bool hasColors(const aiMesh& mesh) {
    if (!mesh.mColors[0]) return false;
    return std::any_of(mesh.mColors[0], mesh.mColors[0] + mesh.mNumVertices,
                       [](const aiColor4D& c) { return c.r > 0 || c.g > 0 || c.b > 0; });
}

float linearOf(float encoded) {
    const float c = std::clamp(encoded, 0.0f, 1.0f); // of NaN: NaN, which is mended on reading
    return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f);
}

/// Tells which set of texture coordinates the base colour wants; others come behind it.
unsigned firstUvSet(const Build& build, const aiMesh& mesh) {
    int set = 0;
    if (mesh.mMaterialIndex >= build.source->mNumMaterials) return 0;
    build.source->mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_UVWSRC(aiTextureType_DIFFUSE, 0), set);
    return set > 0 && set < AI_MAX_NUMBER_OF_TEXTURECOORDS && mesh.mTextureCoords[set]
               ? static_cast<unsigned>(set)
               : 0;
}

/// Says what a mesh of the file has beside positions.
struct Streams {
    const aiVector3D* uv[2] = {nullptr, nullptr};
    bool colors = false;
};

Streams streamsOf(const Build& build, const aiMesh& mesh, bool textured) {
    Streams streams;
    const unsigned first = firstUvSet(build, mesh), second = first == 0 ? 1 : 0;
    streams.uv[0] = mesh.mTextureCoords[first];
    streams.uv[1] = mesh.mTextureCoords[second];
    streams.colors = !textured && hasColors(mesh);
    return streams;
}

Vertex vertexAt(const aiMesh& mesh, const Streams& streams, unsigned index) {
    Vertex vertex;
    vertex.position = vec3Of(mesh.mVertices[index]) + 0.0f;
    if (mesh.mNormals) vertex.normal = vec3Of(mesh.mNormals[index]) + 0.0f;
    for (int set = 0; set < 2; ++set)
        // In libassimp v points up.
        if (streams.uv[set]) vertex.uv[set] = {streams.uv[set][index].x, 1.0f - streams.uv[set][index].y};
    if (streams.colors) {
        const aiColor4D& c = mesh.mColors[0][index];
        vertex.color = {linearOf(c.r), linearOf(c.g), linearOf(c.b), 1.0f};
    }
    return vertex;
}

void fill(Primitive& primitive, const Numbering<Vertex>& vertices, const Streams& streams) {
    const size_t count = vertices.size();
    primitive.positions.resize(count);
    primitive.normals.resize(count);
    if (streams.uv[0]) primitive.texCoord0.resize(count);
    if (streams.uv[1]) primitive.texCoord1.resize(count);
    if (streams.colors) primitive.colors.resize(count);
    for (uint32_t i = 0; i < count; ++i) {
        const Vertex& vertex = vertices.key(i);
        primitive.positions[i] = vertex.position;
        primitive.normals[i] = vertex.normal;
        if (streams.uv[0]) primitive.texCoord0[i] = vertex.uv[0];
        if (streams.uv[1]) primitive.texCoord1[i] = vertex.uv[1];
        if (streams.colors) primitive.colors[i] = vertex.color;
    }
}

Primitive makePrimitive(Build& build, const aiMesh& mesh, const std::string& name) {
    Primitive primitive;
    if (mesh.mMaterialIndex < build.materials.size())
        primitive.material = build.materials[mesh.mMaterialIndex];
    const bool textured =
        primitive.material >= 0 &&
        build.made.scene.materials[static_cast<size_t>(primitive.material)].baseColorTexture.texture >= 0;
    const std::vector<unsigned> corners = usableCorners(build, mesh, name);
    const Streams streams = streamsOf(build, mesh, textured);
    std::optional<CornerNormals> normals;
    if (!mesh.mNormals) normals.emplace(mesh, corners);
    Numbering<Vertex> vertices(corners.size());
    primitive.indices.reserve(corners.size());
    for (size_t i = 0; i < corners.size(); ++i) {
        Vertex vertex = vertexAt(mesh, streams, corners[i]);
        if (normals) vertex.normal = (*normals)(i) + 0.0f;
        primitive.indices.push_back(vertices(vertex, hashOf(vertex)));
    }
    fill(primitive, vertices, streams);
    return primitive;
}

} // namespace

Mesh makeMesh(Build& build, const std::vector<unsigned>& meshes, const std::string& name) {
    Mesh mesh;
    mesh.name = name;
    for (const unsigned index : meshes) {
        if (index >= build.source->mNumMeshes) continue;
        const aiMesh& source = *build.source->mMeshes[index];
        if (!source.mVertices) continue;
        Primitive primitive = makePrimitive(build, source, name);
        if (!primitive.indices.empty()) mesh.primitives.push_back(std::move(primitive));
    }
    return mesh;
}

} // namespace relume::foreign
