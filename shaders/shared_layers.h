// Of layers, one light's share of the lightmap each: what their kernels are told. Part of shared.h, which
// includes it.

// Of the rounds of direct light that patches in a penumbra take, the others take the first and each so many
// behind it.
const uint kPenumbraRounds = 8u;

// Adds some rounds of direct light to those before.
struct LayerDirectPush {
    ADDRESS sums;   // vec4[kReplicates][patchCount], of these rounds
    ADDRESS direct; // vec4[patchCount]: lighting, and the variance of R, G and B together
    ADDRESS parts;  // lib/penumbra.glsl
    ADDRESS penumbra;
    uint patchCount;
    // Outside penumbrae and within: from a replicate's sum to its mean, and the share of these rounds among
    // all; 0: none.
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
