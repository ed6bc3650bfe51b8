// Structs and constants that C++ and GLSL share, scalar layout (GL_EXT_scalar_block_layout), no padding by hand.
// C++ includes this inside namespace relume::shader with glm's types in scope (see bake/shader_types.h).
#ifndef RELUME_SHARED_H
#define RELUME_SHARED_H

#ifdef __cplusplus
#define CONST constexpr
#else
#define CONST const
#endif

// A chunk: 64 consecutive patches of the 8x8-texel tile order. A block: all pairs of two chunks, one bit each.
CONST uint kChunk = 64u;
// A super-block is kSuper x kSuper blocks: the unit of summation. 16 x 16 blocks are 1M pairs, 128 KiB of bits.
CONST uint kSuper = 16u;
CONST uint kSuperBlocks = 256u;     // kSuper * kSuper
CONST uint kBlockWords = 128u;      // 32-bit words of a block: 64 rows of 2
CONST uint kSuperPatches = 1024u;   // kSuper * kChunk

// Patch::flags, bits 0..7
CONST uint kPatchSends = 1u;        // not set: inside something, sends nothing, receives nothing
CONST uint kPatchBackSide = 2u;     // the back of a double-sided emitter: sends its emission, is never shown

// What `closest` stores for a ray: a patch index below kLinkFirstSpecial, or
CONST uint kLinkFirstSpecial = 0xfffffff0u;
CONST uint kLinkSky = 0xffffffffu;  // hit nothing
CONST uint kLinkBack = 0xfffffffeu; // hit the back of a single-sided surface
CONST uint kLinkDark = 0xfffffffdu; // hit geometry that is no receiver (no lightmap UV), or the back of a double-sided one
CONST uint kNoPatch = 0xffffffffu;  // texel -> patch map: empty

// What the tracers and the gather read of a patch. Positions are texel centres on the surface.
struct Patch {
    vec3 position;  // [m]
    float offset;   // [m] > 0, along the geometric normal: where its rays end; also the horizon's tolerance
    vec3 normal;    // geometric, unit
    float area;     // [m^2]
    vec3 shading;   // shading normal, unit
    uint flags;     // bits 0..7: kPatch...; bits 8..31: its texel, row * size + column, the key of its random numbers
};

// The texel's parallelogram, for the exact form factor of close pairs.
struct PatchEdges {
    vec3 du; // [m], world-space edge along one texel of u
    vec3 dv; // [m], along one texel of v
};

// Bounds of a chunk's patches, to tell whether two chunks have close pairs.
struct ChunkBounds {
    vec3 lo;     // [m]
    vec3 hi;     // [m]
    float size;  // [m], the largest patch edge
};

// One triangle of the tracers' scene, in WorldMesh order.
struct HitTriangle {
    vec2 uv0, uv1, uv2;   // lightmap UVs
    uint chart;           // kNoChart (0xffffffff): no receiver
    uint representative;  // a patch of the chart near the triangle; kNoPatch without chart
    uint material;
};

// Alpha test of masked triangles, all tracers alike.
struct AlphaTriangle {
    vec2 uv0, uv1, uv2;      // of the base colour texture
    float a0, a1, a2;        // COLOR_0 alpha at the corners
    uint material;           // index into AlphaMaterial
};
struct AlphaMaterial {
    float factor;   // baseColor.a
    float cutoff;
    uint texels;    // offset into the alpha bytes, 0xffffffff: no texture
    uint width, height;
    uint wrapS, wrapT; // enum Wrap
};

// Our own binary BVH. Both children's boxes in one node of 64 bytes. child >= 0: inner node; < 0: leaf, ~child holds
// first triangle << 3 | count (1..7).
struct BvhNode {
    vec3 lo0;
    int child0;
    vec3 hi0;
    int child1;
    vec3 lo1;
    uint unused0;
    vec3 hi1;
    uint unused1;
};
// Corners of a triangle for the watertight test, 48 bytes; the id is the index in WorldMesh order, bit 31: alpha-masked.
struct BvhTriangle {
    vec3 p0;
    uint id;
    vec3 p1;
    uint unused0;
    vec3 p2;
    uint unused1;
};

#endif
