// These are the push constants of the kernels of the methods that follow links. The file is part of shared.h,
// which includes it.
struct EmitterSamplesPush {
    ADDRESS patches;
    ADDRESS polygons; // EmitterPolygon[]
    ADDRESS nodes;    // EmitterNode[]
    ADDRESS targets;  // vec4[chunkCount][pickCount][pointCount][64]: end of the segment, +- its form factor
    // vec4[chunkCount][pickCount][64]: unshadowed lighting over the pick's chance, form factor (with `all`
    // negative where it is near: those of the replicates' starts lie behind `firstNear` chunks); with wholes
    // radiance over it
    ADDRESS picks;
    ADDRESS parts;    // lib/light/penumbra.glsl, as penumbra
    ADDRESS penumbra; // 0: every patch takes every sample pass
    ADDRESS covers;   // as of ClosestPush
    ADDRESS edges;    // EmitterEdge[]
    // vec4[patchCount]: lighting by all polygons without shadows, 0; or 1 where the light is so near that
    // each point has its own, behind the picks of `firstNear` chunks; 0: it is not asked for
    ADDRESS wholes;
    ADDRESS chunks; // as of SegmentPush
    uint firstChunk;
    uint samplePass; // where several are taken together, the first one over their number
    uint together;   // sample passes
    uint pickCount;  // where they are drawn of all these sample passes, and a multiple of kReplicates in each
    uint pointCount; // per pick: a multiple of kReplicates, with `all` of all these sample passes; wholes: 1
    uint all;        // 1: pick i is mesh light i; 0: picks are drawn
    uint polygonCount, edgeCount, firstNear;
};
struct DirectPush {
    ADDRESS targets;
    ADDRESS picks;
    ADDRESS bits;
    ADDRESS sums;   // vec4[kReplicates][patchCount]
    ADDRESS direct; // vec4[patchCount]: the mean so far
    ADDRESS parts;
    ADDRESS penumbra, wholes; // as of EmitterSamplesPush
    ADDRESS chunks;           // as of SegmentPush
    uint firstChunk;
    uint samplePass, together, pickCount, pointCount, all, firstNear; // as of EmitterSamplesPush
    uint patchCount;
    float scale; // from the sum of all sums to the mean
};
struct LampPush {
    ADDRESS patches;
    ADDRESS lamps;   // Lamp[]
    ADDRESS targets; // vec4[chunkCount][targetCount][64]: end of the segment; w > 0: to be traced
    ADDRESS bits;    // as SegmentPush
    ADDRESS sums;    // vec4[kReplicates][patchCount], added to
    ADDRESS direct;  // vec4[patchCount]: the mean so far
    ADDRESS sky;     // vec4[height][width] and float[height] behind it: lib/light/sky.glsl
    ADDRESS parts;
    ADDRESS penumbra;  // as of EmitterSamplesPush
    ADDRESS covers;    // as of ClosestPush
    ADDRESS chunks;    // as of SegmentPush
    uint skySize;      // [pixels], width | height << 16; 0: one radiance
    float skyRotation; // [rad]
    float reach;       // [m], out of the scene from anywhere in it
    uint firstChunk;
    uint firstLamp;
    uint counts;               // of the group: lights | targets per patch << 16
    uint samplePass, together; // as of EmitterSamplesPush
    uint patchCount;
    float scale; // from the sum of all sums to the mean
};
struct LinkPush {
    ADDRESS links;  // uint[chunkCount][sampleCount][64]
    ADDRESS packed; // uvec2[], radiance by packLight
    ADDRESS direct; // vec4[] added to ligOut; 0: nothing
    ADDRESS ligOut; // vec4[]; 0: not written
    ADDRESS sums;   // vec4[kReplicates][patchCount], added to; 0: not
    uint firstChunk;
    uint chunkCount;
    uint sampleCount; // a multiple of kReplicates
    uint patchCount;
    vec3 sky; // radiance that kLinkSky brings [cd/m^2]
};
struct PackPush {
    ADDRESS radiance; // vec4[count]
    ADDRESS packed;   // uvec2[count]
    uint count;
};
struct LinkDistancePush {
    ADDRESS patches;
    ADDRESS links;     // uint[chunkCount][sampleCount][64]
    ADDRESS receivers; // Patch[] that the links start at: patches, or of a coarser grid
    ADDRESS nodes;     // PyramidNode[], what links from patchCount on mean
    ADDRESS distances; // float[][2], per receiver, along rows and columns of texels [m]
    ADDRESS patchChart;
    ADDRESS texelToPatch;
    uint firstChunk;
    uint chunkCount;
    uint sampleCount;
    uint patchCount;
    uint size; // lightmap edge [texels]; 0: receivers are not the patches, and both distances are the same
};
struct PyramidPush {
    ADDRESS nodes;    // PyramidNode[]
    ADDRESS radiance; // vec4[]: read below, written at patchCount + node
    uint firstNode;
    uint nodeCount;
    uint patchCount;
};
struct FootprintPush {
    ADDRESS patches;
    ADDRESS receivers; // Patch[] that the links start at
    ADDRESS steps;     // uvec2[]: of each patch and node its parent and the bits of that one's size
    ADDRESS links;     // uint[chunkCount][sampleCount][64], patches become nodes
    uint firstChunk;
    uint chunkCount;
    uint sampleCount;
    uint samples; // directions of each receiver that the result is made of
};
struct InterpolatePush {
    ADDRESS taps;            // CoarseTaps[]
    ADDRESS coarse;          // vec4[kReplicates][receiverCount], this bounce's sums over links
    ADDRESS direct;          // vec4[] added to ligOut; 0: nothing
    ADDRESS ligOut;          // vec4[]
    ADDRESS sums;            // vec4[kReplicates][patchCount], added to; 0: not
    ADDRESS coarseDistances; // float[receiverCount][2] [m]
    ADDRESS distances;       // float[patchCount][2], written; 0: not
    uint firstChunk;
    uint chunkCount;
    uint patchCount;
    uint receiverCount;
    float scale; // from the sum of all sums to the mean
};
struct CoarseErrorPush {
    ADDRESS neighbours; // CoarseNeighbours[]
    ADDRESS sums;       // vec4[kReplicates][patchCount]
    ADDRESS chunkSums;  // vec4[chunkCount]
    uint chunkCount;    // of receivers
    uint patchCount;
    float scale; // from a replicate's sum to its mean
};
struct ComposePush {
    ADDRESS sums;
    ADDRESS direct;              // 0: nothing
    ADDRESS light;               // vec4[], written
    ADDRESS scales;              // vec2[chunkCount], as of SmoothPush; 0: `scale` holds for all
    uint sampled;                // 0: the sums are of links; 1: of direct light
    uint firstChunk, chunkCount; // that are made
    uint patchCount;             // of all
    float scale;                 // from the sum of all sums to the mean
};
struct CarryPush {
    ADDRESS carried; // vec4[], of links alone
    ADDRESS direct;  // 0: nothing
    ADDRESS light;   // vec4[]: with a share what a sample pass has brought, else written
    float share;     // of the sample pass in what is carried from now on; 0: light is made
    uint patchCount;
};
struct ChangePush {
    ADDRESS patches;
    ADDRESS ligIn;
    ADDRESS ligOut;
    ADDRESS sums; // vec4[chunkCount]
    uint chunkCount;
    uint isFirst; // 1: it is the first bounce
};
// Sums over a chunk's patches: light and variances of the mean, R, G and B together.
struct ResolveSums {
    float light;
    float direct;   // variance
    float indirect; // variance
    float raw;      // variance, not smoothed
    float bias;     // squares of what smoothing moves, less what noise explains of it
    float count;
};
// Sums over a chunk's patches: squares relative to the square of what local error is relative to. They are of
// light as the mean of R, G and B.
struct LocalSums {
    float direct;   // variance
    float indirect; // variance, smoothed
    float bias;     // as of ResolveSums
    float fourth;   // powers of the bias, not its square: how unevenly it lies
};
struct SmoothPush {
    ADDRESS patches;
    ADDRESS patchChart;
    ADDRESS texelToPatch;
    ADDRESS sums;       // vec4[kReplicates][patchCount], of links
    ADDRESS rows;       // vec4[kReplicates][patchCount], smoothed along rows
    ADDRESS directSums; // vec4[kReplicates][patchCount]; 0: none
    ADDRESS result;     // vec4[patchCount]: lighting, standard error
    ADDRESS chunkSums;  // ResolveSums[chunkCount]
    ADDRESS distances;  // float[patchCount][2] [m], of what lights a patch, along rows and columns
    ADDRESS scales;     // vec2[chunkCount]: in place of scale and directScale; 0: these hold for all
    ADDRESS
    local; // uint[kBinCopies][kBinsOfCopy], then LocalSums[chunkCount] (lib/local_error.glsl); 0: none
    uint firstChunk, chunkCount; // that are made
    uint patchCount;             // of all
    uint size;                   // lightmap edge [texels]
    uint reach;                  // [texels], 0: no smoothing
    float sigma;                 // [texels]
    float scale, directScale;    // from a replicate's sum to its mean
    float floor;                 // light below which local error is not relative to it any more [cd/m^2]
};
