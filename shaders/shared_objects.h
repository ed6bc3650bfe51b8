// These are the push constants of the kernels for objects that move and surfaces of other colours. The file
// goes with shared.h, which must be included before.

// A box in which an object was or is, axis-parallel [m].
struct TraceBox {
    vec3 lo;
    vec3 hi;
};
// Lists links whose rays meet a box, all links of patches that have changed, and those that end at certain
// patches.
struct RetraceMarkPush {
    ADDRESS patches; // Patch[]
    ADDRESS boxes;   // TraceBox[boxCount]
    ADDRESS changed; // uvec2[] per chunk, a bit for each patch
    ADDRESS links;   // uint[], counted as in the list
    ADDRESS ends;    // as `changed`: what ends there is listed; 0: nothing for that
    ADDRESS list;    // uint[]: how many, then which, as (chunk * sampleCount + sample) * 64 + patch, counted
                     // from firstChunk and firstSample on
    ADDRESS rays;    // uint[kRayCounters], to which the listed ones are added
    ADDRESS covers;  // as of ClosestPush
    uint boxCount;
    uint firstChunk;
    uint firstSample;
    uint sampleCount;
    uint size;     // lightmap edge [texels]
    uint rotation; // kRotate...
    uint silent;   // 1: of patches that send nothing, too
};
struct RetracePush {
    TraceGeometry geometry;
    ADDRESS patches;      // Patch[]
    ADDRESS links;        // uint[]
    ADDRESS hitTriangles; // HitTriangle[]
    ADDRESS texelToPatch; // uint[]
    ADDRESS patchChart;   // uint[], kNoChart for patches that send nothing
    ADDRESS list;         // as above
    ADDRESS covers;       // as of ClosestPush
    uint firstChunk;
    uint firstSample;
    uint sampleCount;
    uint size;     // lightmap edge [texels]
    uint rotation; // kRotate...
    uint silent;   // 1: of patches that send nothing, too
};

// Makes segments to places in texels, for patches that ask whether their own points see these.
struct PlacesPush {
    ADDRESS patches; // Patch[]
    ADDRESS covers;  // PatchCover[]
    ADDRESS asks;    // uvec2[chunkCount], a bit for each patch
    ADDRESS targets; // vec4[chunkCount][places][64], written: as SegmentPush has them
    ADDRESS here;    // uint[chunkCount][64], written: bits of the places that need no segment
    uint firstChunk;
    uint places; // kRimPlaces: the rim's; else the cells' middles
};
// Follows base colours of materials that have changed.
struct RecolourPush {
    ADDRESS materials;  // uint[patchCount]
    ADDRESS baseColors; // vec4[] per material; a < 0: as it was
    ADDRESS pattern;    // vec4[patchCount]: albedo for a base colour of 1
    ADDRESS albedo;     // vec4[patchCount]
    uint patchCount;
    float maxAlbedo;
};
