// Structs and constants that C++ and GLSL share, in scalar layout (GL_EXT_scalar_block_layout), without
// padding by hand. C++ includes this inside namespace relume::shader with glm's types in scope (see
// bake/base/shader_types.h).
#ifndef RELUME_SHARED_H
#define RELUME_SHARED_H

#ifdef __cplusplus
#define CONST constexpr
#else
#define CONST const
#endif
#define ADDRESS uint64_t // of a buffer on the device

// A chunk has 64 consecutive patches of the 8x8-texel tile order. A block has all pairs of two chunks, one
// bit each.
CONST uint kChunk = 64u;
// A super-block is kSuper x kSuper blocks: the unit of summation. 16 x 16 blocks are 1M pairs, 128 KiB of
// bits.
CONST uint kSuper = 16u;
CONST uint kSuperBlocks = 256u;   // kSuper * kSuper
CONST uint kBlockWords = 128u;    // 32-bit words of a block: 64 rows of 2
CONST uint kSuperWords = 32768u;  // kSuperBlocks * kBlockWords: the bits of a super-block
CONST uint kSuperPatches = 1024u; // kSuper * kChunk
// Rays are counted in slots by unit, to spread the atomics: those whose bits are kept, then the others.
CONST uint kRayCounters = 4096u;
// Samples belong in turn to so many sequences that are scrambled independently: their spread is the error.
CONST uint kReplicates = 4u;

// Patch::flags, its lowest kTexelShift bits
CONST uint kPatchSends = 1u;    // not set: inside something, sends nothing, receives nothing
CONST uint kPatchBackSide = 2u; // the back of a double-sided mesh light: sends its emission, is never shown
CONST uint kPatchThin = 4u;     // stands for a chart that covers no texel centre: no error counts it
CONST uint kTexelShift = 3u;    // above these bits stands the patch's texel
CONST uint kFlagBits = 7u;

// These say which neighbouring patches have all their directions in common: none; those in the same place of
// their 4 x 4 texels; those of one chunk; none, and neighbours' directions do not complement each other.
CONST uint kRotatePatch = 0u;
CONST uint kRotateInterleaved = 1u;
CONST uint kRotateTile = 2u;
CONST uint kRotateAlone = 3u;

// `closest` stores for a ray a patch index below kLinkFirstSpecial, or one of these.
CONST uint kLinkFirstSpecial = 0xfffffff0u;
CONST int kHitReach = 2;            // a hit whose own texel sends nothing ends at most so many texels away
CONST uint kLinkSky = 0xffffffffu;  // hit nothing
CONST uint kLinkBack = 0xfffffffeu; // hit the back of a single-sided surface
CONST uint kLinkDark =
    0xfffffffdu; // hit geometry that is no receiver (no lightmap UV), or the back of a double-sided one
// Hit nothing, in a direction that was mirrored up from below the geometric horizon, where no sky shines.
CONST uint kLinkSkyBelow = 0xfffffffcu;
FUNCTION bool linkIsSky(uint link) {
    return link == kLinkSky || link == kLinkSkyBelow;
}
CONST uint kNoPatch = 0xffffffffu; // texel -> patch map: empty
CONST uint kNoTexel = 0xffffffffu; // patch -> texel: not shown

// A patch as the tracers and the gather read it. Positions are texel centres on the surface.
struct Patch {
    vec3 position; // [m]
    float offset;  // [m] > 0, along the geometric normal: where its rays end; also the horizon's tolerance
    vec3 normal;   // geometric, unit
    float area;    // [m^2]
    vec3 shading;  // shading normal, unit
    uint flags;    // kFlagBits: kPatch...; above them its texel, row * size + column, the key of its random
                   // numbers
};

// The texel's parallelogram, for the exact form factor of close pairs.
struct PatchEdges {
    vec3 du; // [m], world-space edge along one texel of u
    vec3 dv; // [m], along one texel of v
};

// PatchCover::cells: bit row * kCoverEdge + column is set where a point may lie in the middle of this cell of
// the texel; with kCoverWhole it may lie anywhere in it. 0: it stays at the patch's own point.
CONST uint kCoverEdge = 5u;
CONST uint kCoverCells = 0x01ffffffu; // kCoverEdge * kCoverEdge bits
CONST uint kCoverWhole = 0x80000000u;

// The part of a texel that its patch's surface covers, for samples that start all over it.
struct PatchCover {
    vec3 du;    // [m], along the texel's u, a little shortened so that no point lies on the edge
    uint cells; // kCover...
    vec3 dv;    // [m], likewise
    uint place; // where the patch's own point lies in the texel, from 0 to kCoverPlaces: u | v << 16
};
CONST uint kCoverPlaces = 65534u; // its half is the texel's middle

// Bounds of a chunk's patches, to tell whether two chunks have close pairs.
struct ChunkBounds {
    vec3 lo;    // [m]
    vec3 hi;    // [m]
    float size; // [m], the largest patch edge
};

// The receivers of a coarser grid that a patch's light is made of. Weight 0 means none.
struct CoarseTaps {
    uint receiver0, receiver1, receiver2, receiver3;
    vec4 weights;
};

// A receiver of the coarser grid and those before and after it in the chart: patches, `own` where there are
// not both. A share is that of the one before in the light that both say is between them.
struct CoarseNeighbours {
    uint own;
    uint left, right, below, above;
    float shareX, shareY;
};

// Patches of one chart side by side in the lightmap, as one sender of links. It has indices of what it is
// made of, and of what it is part of: patches, behind them nodes, as in the radiance buffer.
struct PyramidNode {
    vec3 position;  // [m], mean over its area
    float size;     // [m^2], its area; of what is stretched or scattered the square as wide as it is
    uvec4 children; // the first one again where there are fewer
    vec4 shares;    // of its area; sum 1
    uint parent;    // kNoPatch: none
};

// EmitterPolygon::shape
CONST uint kEmitterTriangle = 3u; // c3 repeats c2
CONST uint kEmitterQuad = 4u;     // convex
CONST uint kEmitterParallelogram = 5u;

// A plane convex light of one radiance, counter-clockwise seen from its front, where it shines.
struct EmitterPolygon {
    vec3 c0;    // [m]
    float area; // [m^2]
    vec3 c1;
    float offset; // [m], along the normal: where rays to it end
    vec3 c2;
    float split; // share of the area that the triangle c0 c1 c2 has; 1 for a triangle
    vec3 c3;
    uint shape;
    vec3 radiance; // [cd/m^2]
    uint triangle; // the WorldMesh triangle it was made from, or the first one of two
};

// An edge of one polygon, and of its neighbour where there is one, which walks it the other way. A point sees
// a polygon's front where dot(normal, point) > height.
struct EmitterEdge {
    vec3 from;          // [m]
    float height;       // of the polygon's plane along its normal [m]
    vec3 along;         // to where it ends [m]
    float heightBeyond; // of the neighbour's
    vec3 normal;        // of the polygon
    uint polygon;
    vec3 normalBeyond;  // of the neighbour, zero where there is none
    uint polygonBeyond; // itself where there is none
};

// EmitterNode::link is the first of two children that lie side by side, or the polygon of a leaf with this
// bit.
CONST uint kEmitterLeaf = 0x80000000u;
CONST uint kNoEmitter = 0xffffffffu;

// These are the values of Lamp::type; a point may be a sphere.
CONST uint kLampPoint = 0u, kLampSpot = 1u, kLampSun = 2u, kLampRectangle = 3u, kLampDisc = 4u, kLampSky = 5u;

// An analytic light. Samples never depend on the colour.
struct Lamp {
    vec3 position; // [m], of its centre
    uint type;     // kLamp...
    vec3 axis;     // unit, where it shines to; sky: none
    float radius;  // point, spot: of the sphere, disc: [m]; sun: sine of half the angle across
    vec3 edgeU;    // rectangle: a side [m]; disc: unit, in its plane
    float range;   // point, spot: [m]; 0: infinite
    vec3 edgeV;    // edgeU x edgeV is along the axis
    float coneScale;
    vec3 color;       // [cd]; sun: [lux]; rectangle, disc, sky: [cd/m^2], or a factor on its picture
    float coneOffset; // spot: its share is the square of cosine * coneScale + coneOffset, clamped
    uint firstTarget; // the first of its group's targets
    uint samples;     // per patch and sample pass: 1, or a multiple of 2 * kReplicates
    uint seed;
};
CONST uint kEmitterDepth = 48u; // inner nodes on the longest way down, at most

// A node of the tree over the mesh lights; 0 is the root. Every normal below it is within the cone.
struct EmitterNode {
    vec3 lo;       // [m]
    float power;   // area times mean of the radiance's components, as a share of all polygons'
    vec3 hi;       // [m]
    float cosCone; // cosine of the cone's half angle; 1: all normals are the axis
    vec3 axis;     // unit
    uint link;
};

// Blocks (row * 16 + r, column * 16 + c), r, c in 0..15: the pairs of 1024 receivers and 1024 senders.
struct SuperBlock {
    uint row;     // of receiving chunks
    uint column;  // of sending chunks
    ADDRESS bits; // uint[kSuperWords]; RTRad's symmetric ones: as many more, traced from the other end
    uvec4 known0, known1; // bit u % 32 of word u / 32: unit u has its bits already
    uint counters;        // 0 or kRayCounters: the first of the words in which its rays are counted
};

// One sender of a list: a run of patches, one of which stands for all.
struct Sender {
    uint first; // of its patches in the list's members
    uint count; // of patches to draw from; 0: padding
    uint key;   // of its random numbers
};

// One triangle of the tracers' scene, in WorldMesh order.
struct HitTriangle {
    vec2 uv0, uv1, uv2;  // lightmap UVs
    uint chart;          // kNoChart (0xffffffff): no receiver
    uint representative; // a patch of the chart near the triangle; kNoPatch without chart
    vec3 normal;         // geometric, unit
    uint doubleSided;    // 1 if its material is
};

// The alpha test of masked triangles, alike in all tracers.
struct AlphaTriangle {
    vec2 uv0, uv1, uv2; // of the base colour texture
    float a0, a1, a2;   // COLOR_0 alpha at the corners
    uint material;      // index into AlphaMaterial
};
struct AlphaMaterial {
    float factor; // baseColor.a
    float cutoff;
    uint texels; // offset into the alpha bytes, 0xffffffff: no texture
    uint width, height;
    uint wrapS, wrapT; // enum Wrap
};

// The longest way down has at most so many inner nodes: the stack of a traversal.
CONST uint kBvhDepth = 48u;
// Our own binary BVH has both children's boxes in one node of 48 bytes: their centres [m] and half of their
// extents [m], for which the upper half of a float is enough: child 0's in the upper 16 bits, child 1's in
// the lower ones, both rounded up. A child >= 0 is an inner node; one < 0 is a leaf, and ~child holds first
// triangle << 3 | count (1..7).
struct BvhNode {
    vec3 centre0;
    int child0;
    vec3 centre1;
    int child1;
    uvec3 extents;
    uint unused;
};
// The corners of a triangle for the watertight test, in 48 bytes; the id is the index in WorldMesh order,
// with bit 31 for alpha-masked.
struct BvhTriangle {
    vec3 p0;
    uint id;
    vec3 p1;
    uint unused0;
    vec3 p2;
    uint unused1;
};

// A voxel keeps patches by these sides: +x, -x, +y, -y, +z, -z.
CONST uint kVoxelSides = 6u;
// A voxel map. Point p lies in voxel floor((p - origin) * scale).
struct VoxelGrid {
    ADDRESS bits;    // uint[], 1 bit per voxel, x runs fastest, then y: set where a triangle touches it
    ADDRESS ranks;   // uint[], per word of bits: set bits before it
    ADDRESS patches; // uint[kVoxelSides] per set voxel, by the side that the surface faces: a patch,
                     // kLinkDark or kNoPatch for none
    ADDRESS scene;   // Patch[], what these are
    vec3 origin;     // [m]
    vec3 scale;      // [voxels / m]
    uint resolution; // voxels along each axis
    uint ratio;      // one sender (group of samples) in `ratio` marches voxels; 1: all
};

// The push constants of the kernels follow. Buffers come by address.

// The geometry that rays are traced against; the first member of every tracing kernel's push constants.
struct TraceGeometry {
    ADDRESS accel;          // top level acceleration structure, BvhNode[] or VoxelGrid
    ADDRESS triangles;      // BvhTriangle[] (bvh), corners as vec3[] (voxel map while it is made)
    ADDRESS alphaTriangles; // AlphaTriangle[]
    ADDRESS alphaMaterials; // AlphaMaterial[]
    ADDRESS alphaTexels;    // bytes
    uint opaqueCount;       // triangles before the first masked one
    uint triangleCount;
};
CONST uint kOcclusionRtrad = 1u;    // RTRad's ray intervals
CONST uint kOcclusionReversed = 2u; // rays start at the column's patches, bits go behind the others
struct OcclusionPush {
    TraceGeometry geometry;
    ADDRESS patches; // Patch[]
    ADDRESS supers;  // SuperBlock[]
    ADDRESS sends;   // uint[], of the columns' chunks
    ADDRESS senders; // Sender[]; 0: columns are chunks of patches, as rows are
    ADDRESS members; // uint[]
    ADDRESS rays;    // uint[], rays traced are added
    uint firstUnit;
    uint unitCount;
    uint rowCount;    // chunks
    uint columnCount; // chunks
    uint flags;       // kOcclusion...
    uint groupsX;     // workgroups in x; y counts on
};
struct ClosestPush {
    TraceGeometry geometry;
    ADDRESS patches;      // Patch[]: the scene's, or receivers of a coarser grid
    ADDRESS links;        // uint[]
    ADDRESS hitTriangles; // HitTriangle[]
    ADDRESS texelToPatch; // uint[]
    ADDRESS patchChart;   // uint[], kNoChart for patches that send nothing
    ADDRESS covers;       // PatchCover[]; 0: rays start at the patches' own points
    ADDRESS disc;         // vec2[discCount], even points of the unit disc
    uint firstChunk;
    uint firstSample;
    uint sampleCount;
    uint size;      // lightmap edge [texels]
    uint rotation;  // kRotate...
    uint discCount; // 0: Sobol points
};
struct SegmentPush {
    TraceGeometry geometry;
    ADDRESS patches; // Patch[]
    ADDRESS targets; // vec4[chunkCount][targetCount][64]
    ADDRESS bits;    // uint[chunkCount][ceil(targetCount / 32)][64]
    ADDRESS rays;    // uint[kRayCounters], rays traced are added
    ADDRESS covers;  // as of ClosestPush
    ADDRESS chunks;  // uint[]: which chunks are meant from firstChunk on (lib/listed_chunk.glsl); 0: those
    uint firstChunk;
    uint targetCount;
    uint samplePass, turn, run; // which sample a target is: startNumber (lib/rays/start_point.glsl)
};
struct TransposePush {
    ADDRESS supers;
    ADDRESS transposed; // uint[kSuperWords] per super-block, rows and columns exchanged
    uint chunkCount;
    uint reversed; // 1: of the bits that were traced from the other end
};
struct GatherPush {
    ADDRESS supers;
    ADDRESS sends;         // uint[], of the senders' chunks
    ADDRESS transposed;    // symmetric only
    ADDRESS patches;       // Patch[], the receivers
    ADDRESS bounds;        // ChunkBounds[] of the receivers
    ADDRESS senderPatches; // Patch[]; drawn: those to draw from
    ADDRESS senderEdges;   // PatchEdges[], likewise
    ADDRESS senderBounds;  // ChunkBounds[]
    ADDRESS radiance;      // vec4[] of senderPatches
    ADDRESS senders;       // Sender[] (drawn only)
    ADDRESS members;       // uint[] (drawn only)
    ADDRESS albedo;        // vec4[] of the receivers (RTRad's clamp only)
    ADDRESS partial;       // vec4[superCount][2][kSuperPatches]
    uint rowCount;         // chunks
    uint columnCount;      // chunks
    float reflectivity;
    float distanceFactor;
    uint window; // RTRad: senders less than so many texels to the right and below are skipped
    uint size;   // lightmap edge [texels]
};
struct ReducePush {
    ADDRESS supers;
    ADDRESS partial;
    ADDRESS ligOut; // vec4[]
    uint superCount;
    uint patchCount;
    uint symmetric; // 1: the columns' patches have partial sums too
};
struct RadiancePush {
    ADDRESS patches;
    ADDRESS albedo;   // vec4[]
    ADDRESS emission; // vec4[]
    ADDRESS ligIn;    // vec4[]
    ADDRESS radiance; // vec4[]
    ADDRESS chunkSends;
    uint chunkCount;
    float reflectivity;
    uint rtrad;
    uint all;       // 1: chunks without light count as senders too
    uint reflected; // 1: without emission
};
// Texels that are shown are copied in regions of kRegion x kRegion texels: 32 KiB of halves each.
CONST uint kRegion = 64u;
struct PublishPush {
    ADDRESS values;      // vec4[], per patch
    ADDRESS patchTexels; // uint[], per patch: where it is shown; kNoTexel
    ADDRESS fills;       // uvec2[]: texel, and bits of the neighbours that it is filled from
    ADDRESS starts;      // uint[rings * chunkCount + 1]: where the fills of a ring and chunk begin
    ADDRESS chunks;      // uint[]: those that changed
    ADDRESS texels;      // uvec2[size * size]: four halves
    ADDRESS changed;     // uint[], per region: set to 1 where a texel is another one than before
    ADDRESS sums;        // vec4[chunkCount]: values of shown patches, and their number
    uint first;          // of chunks
    uint count;
    uint chunkCount; // of all
    uint size;       // lightmap edge [texels]
    uint ring;       // 0: patches; else texels that are filled
    float scale;     // on values
};
struct FinishPush {
    ADDRESS emission;
    ADDRESS ligIn;
    ADDRESS ligOut;
    uint patchCount;
    uint rtrad;
};
struct CitPush {
    ADDRESS positions;  // vec3[], 3 per triangle
    ADDRESS normals;    // vec3[]
    ADDRESS lightmapUv; // vec2[]
    ADDRESS baseUv;     // vec2[]
    ADDRESS emissionUv; // vec2[]
    ADDRESS metallicUv; // vec2[]
    ADDRESS colors;     // vec4[]
    ADDRESS material;   // uint[], per triangle
    ADDRESS materials;  // CitMaterial[]
    uint size;          // lightmap edge [texels]
    uint grownCount;    // this many triangles are first drawn grown to all texels they touch
    uint rtrad;
};
struct CvmPush {
    TraceGeometry geometry;
    ADDRESS hitTriangles; // HitTriangle[]
    ADDRESS texelToPatch; // uint[]
    ADDRESS patchChart;   // uint[], kNoChart for patches that send nothing
    uint firstTriangle;
    uint size;    // lightmap edge [texels]
    uint patches; // 1: stores the voxels' patches, 0: sets their bits
    uint rtrad;   // 1: one voxel per pixel, as RTRad
};
struct CitMaterial {
    vec4 baseColor;
    vec3 emission; // [cd/m^2]
    float metallic;
    float roughness;
    int baseTexture; // into the texture array, -1: none
    int emissionTexture;
    int metallicTexture;
};

// These lie beside this file, as C++ and GLSL see different roots.
#include "shared_links.h"
#include "shared_layers.h"

#endif
