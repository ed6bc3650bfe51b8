// These are the push constants of the kernels of layers, one light's share of the lightmap each. The file is
// part of shared.h, which includes it.

// Patches in a penumbra take all sample passes of direct light, the others the first one, the one in the
// middle of these and then one in so many.
const uint kPenumbraSamplePasses = 8u;
FUNCTION bool allTakeSamplePass(uint samplePass) {
    return samplePass % kPenumbraSamplePasses == 0u || samplePass == kPenumbraSamplePasses / 2u;
}
// So many sample passes are taken together, where the step has as many, from as many on: replicates then tell
// each other the share that is seen by four times as many points (lib/light/seen_light.glsl). The first of
// them alone is for all.
const uint kSamplePassesTogether = 4u;

// Adds some sample passes of direct light to those before.
struct LayerDirectPush {
    ADDRESS sums;   // vec4[kReplicates][patchCount], of these sample passes
    ADDRESS direct; // vec4[patchCount]: lighting, and the variance of R, G and B together
    ADDRESS parts;  // lib/light/penumbra.glsl
    ADDRESS penumbra;
    uint patchCount;
    // These are for patches outside penumbrae and within: the factor from a replicate's sum to its mean, and
    // the share of these sample passes among all; 0 means none.
    vec2 scale;
    vec2 share;
};
struct LayerResultPush {
    ADDRESS patches;
    ADDRESS direct;    // as above
    ADDRESS indirect;  // vec4[patchCount]: lighting, standard error; 0: none
    ADDRESS result;    // vec4[patchCount]: lighting, standard error
    ADDRESS chunkSums; // vec4[chunkCount]: light, variance of direct light, patches; R, G and B together
    uint chunkCount;
};
// Every kSketchStride-th chunk goes into the same group of entries, one for each half of its patches.
const uint kSketchStride = 512u, kSketchParts = 2u;
struct SketchPush {
    ADDRESS patches;
    ADDRESS sums;   // vec4[kReplicates][patchCount], over links
    ADDRESS sketch; // vec3[kSketchStride][kSketchParts][kReplicates]: how far each replicate is from the mean
    uint chunkCount;
};
struct LayerWeight {
    ADDRESS light; // vec4[]: lighting, standard error
    vec3 weight;
};
struct LayerMixPush {
    ADDRESS layers; // LayerWeight[layerCount]
    ADDRESS base;   // vec4[], added; 0: nothing
    ADDRESS light;  // vec4[], written: lighting, its standard error if those of layers are independent
    uint layerCount;
    uint patchCount;
};

// A layer that bounces beside others.
struct BounceLane {
    ADDRESS direct; // vec4[patchCount]
    ADDRESS lightA; // vec4[patchCount]: what bounces and what comes of it, in turns
    ADDRESS lightB;
    ADDRESS sums; // vec4[kReplicates][patchCount]
    vec3 sky;     // radiance that kLinkSky brings [cd/m^2]
};
// Says what becomes of sums over links.
const uint kNoSums = 0u, kNewSums = 1u, kMoreSums = 2u;
struct BouncePush {
    ADDRESS lanes;    // BounceLane[LANES]
    ADDRESS links[4]; // of a sample pass each: uint[chunkCount][sampleCount][64]
    ADDRESS packed;   // uvec2[patchCount][LANES], radiance by packLight
    ADDRESS sent;     // as packed, of the light that is made; 0: the pass goes on
    ADDRESS patches;
    ADDRESS albedo;
    ADDRESS changes; // vec4[LANES][allChunks], as ChangePush; 0: not told
    uint firstChunk;
    uint chunkCount;
    uint allChunks;
    uint samplePasses; // 0: light as it is
    uint sampleCount;  // of a sample pass; a multiple of kReplicates
    uint patchCount;
    uint live; // a bit per lane: its light and sums are written
    uint from; // a bit per lane: it is its light B that bounces
    uint sums;
    float scale; // from the sum of all sums to the mean
    float reflectivity;
};
// A layer's variance where it makes the composite's local error.
struct LayerWorthPush {
    ADDRESS patches;
    ADDRESS composite; // vec4[patchCount]: light, what is proportional to its standard error
    ADDRESS direct;    // as of LayerResultPush
    ADDRESS result;    // likewise
    ADDRESS
    chunkSums;       // vec4[chunkCount]: variance of direct and of indirect light by its worth, and as it is
    float deviation; // standard error over the composite's
    float least;     // what is darker is off relative to this [cd/m^2]
    float aim;       // that 95 % of all texels are to come within
    uint chunkCount;
};
// The composite's texels, counted.
struct LayerLocalPush {
    ADDRESS patches;
    ADDRESS composite; // vec4[patchCount]: light, what is proportional to its standard error
    ADDRESS bins;      // uint[kBinCopies][kBinsOfCopy], as lib/local_error.glsl says: counts are added
    ADDRESS chunkSums; // vec4[chunkCount]: texels; their light, or the squares of how far they are off; w^2
    float deviation;   // standard error over the composite's w; 0: texels are counted by their light
    float least;       // what is darker is off relative to this [cd/m^2]
    uint chunkCount;
    uint size; // edge of the lightmap [texels]
};
struct ChunkSumPush {
    ADDRESS values; // float[groups][chunkCount][width]
    ADDRESS sums;   // float[groups][width]
    uint chunkCount;
    uint width;
};
