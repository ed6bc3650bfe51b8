#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace relume {

/// Holds the pixels of a texture as the file has them: 8 bits, 4 channels, row 0 first. Colour is sRGB
/// encoded or linear, according to its use (base colour and emission: sRGB; metallic-roughness: linear).
struct Image {
    std::string name;
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgba; // [width * height * 4]
};

enum class Wrap : uint32_t { Repeat, MirroredRepeat, ClampToEdge };

struct Texture {
    int image = -1; // index into Scene::images
    Wrap wrapS = Wrap::Repeat, wrapT = Wrap::Repeat;
    bool nearest = false; // magnification filter
};

/// Describes a material's use of a texture: uv = (transform * (TEXCOORD_n, 1)).xy, KHR_texture_transform
/// included.
struct TextureRef {
    int texture = -1; // index into Scene::textures, -1 for none
    int texCoord = 0; // 0, 1 or 2
    glm::mat3 transform{1.0f};
};

/// A texture that only files that are written tell on: its picture is not decoded. It lies in a file of the
/// scene or beside it.
struct KeptTexture {
    int texture = -1;          // Scene::textures' that is the same; -1: what follows
    Texture sampling;          // without an image
    std::string name;          // of the picture
    std::vector<uint8_t> file; // PNG, JPEG or WebP; empty: it stands at `path`
    std::string path;
};

/// How a material uses a kept texture.
struct KeptMap {
    TextureRef use;      // into Scene::keptTextures
    float amount = 1.0f; // scale of a normal map, strength of an occlusion map
};

enum class AlphaMode : uint32_t { Opaque, Mask, Blend };

struct Material {
    std::string name;
    glm::vec4 baseColor{1.0f}; // linear
    TextureRef baseColorTexture;
    glm::vec3 emission{0.0f}; // [cd/m^2], emissive factor times KHR_materials_emissive_strength
    TextureRef emissionTexture;
    float metallic = 1.0f, roughness = 1.0f;
    TextureRef metallicRoughnessTexture; // G roughness, B metallic
    AlphaMode alphaMode = AlphaMode::Opaque;
    float alphaCutoff = 0.5f;
    bool doubleSided = false;
    float transmission = 0.0f; // of KHR_materials_transmission, the mean of its texture included
    bool pane = false; // light passes it (panes.h); decided when the scene is read, whatever is edited
    // These change how a surface looks and not what light it sends.
    KeptMap normalMap, occlusionMap;
};

/// Returns all uses of textures by a material, kept ones last.
inline std::array<TextureRef*, 5> textureUses(Material& material) {
    return {&material.baseColorTexture, &material.emissionTexture, &material.metallicRoughnessTexture,
            &material.normalMap.use, &material.occlusionMap.use};
}
inline std::array<const TextureRef*, 5> textureUses(const Material& material) {
    return {&material.baseColorTexture, &material.emissionTexture, &material.metallicRoughnessTexture,
            &material.normalMap.use, &material.occlusionMap.use};
}

/// Holds triangles of one material. Arrays other than positions may be empty where the file has none. Normals
/// never are after import: where they are missing, the triangles become flat, which splits vertices.
struct Primitive {
    std::vector<glm::vec3> positions;                       // [m], object space
    std::vector<glm::vec3> normals;                         // unit
    std::vector<glm::vec2> texCoord0, texCoord1, texCoord2; // the last only where textures read it
    std::vector<glm::vec4> colors;                          // COLOR_0, linear
    std::vector<uint32_t> indices;                          // 3 per triangle, always filled
    int material = -1; // index into Scene::materials, -1 for glTF's default material
    int movedUvs = -1; // the set that holds its textures' TEXCOORD_1, as the lightmap has that; -1: none
};

/// Returns TEXCOORD_0, TEXCOORD_1 or TEXCOORD_2.
inline const std::vector<glm::vec2>& uvSet(const Primitive& primitive, int set) {
    return set == 2 ? primitive.texCoord2 : set == 1 ? primitive.texCoord1 : primitive.texCoord0;
}
/// Returns the set of a primitive whose UVs `moved` says of (Primitive::movedUvs) that a texture reads.
inline int setOf(int moved, const TextureRef& use) {
    return use.texCoord == 1 && moved >= 0 ? moved : use.texCoord;
}
/// Returns the UVs that a texture reads.
inline const std::vector<glm::vec2>& uvsOf(const Primitive& primitive, const TextureRef& use) {
    return uvSet(primitive, setOf(primitive.movedUvs, use));
}

struct Mesh {
    std::string name;
    std::vector<Primitive> primitives;
    bool batched = false; // saveGlb() writes many instances of it as one node, by EXT_mesh_gpu_instancing
};

struct Instance {
    std::string name; // of the node
    int mesh = -1;
    glm::mat4 transform{1.0f}; // object to world
    bool hidden = false;       // left out: blocks no light, receives and sends none
    float density = 1.0f;      // factor on the texels per metre that an unwrap gives it, > 0
    uint32_t page = 0;         // of the lightmap, in which its lightmap UVs are meant; below Scene::pages
    int node = -1;             // of the file
    int copy = -1;     // which of the node's instances (EXT_mesh_gpu_instancing); -1: the node has one
    bool bent = false; // by a skin, whose joints say where it stands: its node's transform does not
};

struct Camera {
    std::string name;
    glm::mat4 transform{1.0f}; // looks along its -Z, +Y up
    bool perspective = true;
    float yfov = 0.8f;                // [rad]
    float ymag = 1.0f;                // half height [m], orthographic only
    float aspect = 0.0f;              // width / height, 0: that of the window
    float znear = 0.01f, zfar = 0.0f; // [m], zfar 0: infinite
};

enum class LightType : uint32_t { Point, Spot, Directional, Rectangle, Disc };

/// An analytic light has no geometry: nothing sees it and it blocks nothing. Point, spot and directional
/// lights are those of KHR_lights_punctual, shining along the transform's -Z, with an extent that softens
/// their shadows. Rectangles and discs lie in the transform's XY plane around its origin and shine from the
/// side of its -Z, alike in all directions.
struct Light {
    std::string name;
    LightType type = LightType::Point;
    glm::mat4 transform{1.0f}; // light to world; its scale means nothing
    glm::vec3 color{1.0f};     // linear
    float intensity = 1.0f;    // point, spot: [cd]; directional: [lux]; rectangle, disc: [cd/m^2]
    float range = 0.0f;        // point, spot: [m], 0: infinite
    float innerConeAngle = 0.0f, outerConeAngle = 0.785398f; // spot: from the axis [rad]
    float radius = 0.0f; // point, spot: of a sphere that shines [m], 0: none; disc: of the disc [m]
    float angle = 0.0f;  // directional: across the disc in the sky that it comes from [rad], 0: one direction
    glm::vec2 size{1.0f}; // rectangle: along X and Y [m]
    int node = -1;        // of the file, whose light it is; -1: the file has it not
    bool preview = false; // of a dark level: it is shown and baked, and in no file that is written

    bool operator==(const Light&) const = default;
};

/// Holds what users set of a sky.
struct SkySettings {
    glm::vec3 radiance{0.0f}; // [cd/m^2]; of a picture: factor on it
    float rotation = 0.0f;    // of the picture about +Y, counter-clockwise from above [rad]
    std::string file;         // path of the picture, "" for none
    bool preview = false;     // as Light::preview

    bool operator==(const SkySettings&) const = default;
};

/// The sky is seen where nothing else is: one radiance, or an equirectangular picture. Its row 0 is the
/// zenith (+Y), and its middle column lies in -Z, so that +X is to the right of it.
struct Sky : SkySettings {
    uint32_t width = 0, height = 0; // of the picture
    std::vector<glm::vec3> pixels;  // [height][width] [cd/m^2], linear

    bool shines() const { return radiance != glm::vec3(0.0f); }
};

/// Holds a scene as the file tells it, with the node hierarchy resolved to world transforms. It knows of no
/// GPU and decides nothing about lightmaps.
struct Scene {
    std::string path; // as given by the user; "" for a generated scene
    std::vector<Image> images;
    std::vector<Texture> textures;
    std::vector<KeptTexture> keptTextures;
    std::vector<Material> materials;
    std::vector<Mesh> meshes;
    std::vector<Instance> instances;
    std::vector<Camera> cameras;
    std::vector<Light> lights;
    Sky sky;
    uint32_t pages = 1; // of the lightmap for which its UVs were made (lightmap_pages.h)
    // What the file offers to choose from: its scenes (a number stands for a scene without a name) and the
    // variants of its materials.
    std::vector<std::string> sceneNames, variantNames;
    int sceneNumber = -1; // of sceneNames, the one that was read; -1: the file has none
    bool posed = false;   // by an animation: nodes stand elsewhere than the file's transforms say
    std::vector<std::string> warnings; // what of the file is unsupported or was corrected, one line each
};

} // namespace relume
