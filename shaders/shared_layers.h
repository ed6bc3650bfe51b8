// Of layers, one light's share of the lightmap each: what their kernels are told. Part of shared.h, which
// includes it.

// Adds some rounds of direct light to those before.
struct LayerDirectPush {
    ADDRESS sums;   // vec4[kReplicates][patchCount], of these rounds
    ADDRESS direct; // vec4[patchCount]: lighting, and the variance of R, G and B together
    uint patchCount;
    float scale; // from a replicate's sum to its mean
    float share; // of these rounds among all
};
struct LayerResultPush {
    ADDRESS patches;
    ADDRESS direct;    // as above
    ADDRESS indirect;  // vec4[patchCount]: lighting, standard error; 0: none
    ADDRESS result;    // vec4[patchCount]: lighting, standard error
    ADDRESS chunkSums; // vec4[chunkCount]: light, variance of direct light, patches; R, G and B together
    uint chunkCount;
};
struct LayerWeight {
    ADDRESS light; // vec4[]: lighting, standard error
    vec3 weight;
};
struct LayerMixPush {
    ADDRESS layers; // LayerWeight[layerCount]
    ADDRESS base;   // vec4[], added; 0: nothing
    ADDRESS light;  // vec4[], written: lighting, at most its standard error
    uint layerCount;
    uint patchCount;
};
