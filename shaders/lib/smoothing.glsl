// Smooths indirect light within a chart along one direction; the smoothing is separable. The includer's push
// constants hold patches, patchChart, texelToPatch, distances, size, sigma and reach.


const uint kMaxReach = 8u; // texels
// Indirect light changes over lengths like the distance of what it comes from: beside an edge of a
// room it is hardly smoothed across that.
const float kDistanceShare = 0.3;

// Finds the patch of the same chart so many texels away along `axis`, and how much it counts: by distance in
// the world, measured in texels of the receiver, by how far it lies off its plane, and by its normal.
float tapWeight(Patch centre, float sigma, uint chart, ivec2 texel, out uint index) {
    index = kNoPatch;
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(push.size)))) return 0.0;
    index = WORD_AT(push.texelToPatch, uint(texel.y) * push.size + uint(texel.x));
    if (index == kNoPatch || WORD_AT(push.patchChart, index) != chart) return 0.0;
    Patch other = loadPatch(push.patches, index);
    if ((other.flags & kPatchSends) == 0u) return 0.0;
    vec3 d = other.position - centre.position;
    float height = dot(d, centre.normal);
    // The distance off the plane counts four times: a step or a fold within the chart parts what lies side by
    // side in the atlas.
    float distance2 = (dot(d, d) + 15.0 * height * height) / max(centre.area, 1e-30);
    float facing = max(dot(centre.shading, other.shading), 0.0);
    facing *= facing;
    facing *= facing;
    return exp(-0.5 * distance2 / (sigma * sigma)) * facing * facing;
}

// The weights of the taps from -reach to reach that make a local straight-line fit at the centre: at a
// chart's edge, where all taps lie on one side, a mean would be pulled along the gradient [Fan and Gijbels
// 1996].
struct Taps {
    uint index[2u * kMaxReach + 1u];
    float weight[2u * kMaxReach + 1u];
};

Taps smoothingTaps(uint own, ivec2 axis) {
    Patch centre = loadPatch(push.patches, own);
    uint chart = WORD_AT(push.patchChart, own), texelIndex = patchTexel(centre.flags);
    ivec2 texel = ivec2(texelIndex % push.size, texelIndex / push.size);
    bool placed = WORD_AT(push.texelToPatch, texelIndex) == own; // else it stands for a whole thin chart
    float distance = FLOAT_AT(push.distances, 2u * own + uint(axis.y));
    float sigma = min(push.sigma, kDistanceShare * distance / sqrt(max(centre.area, 1e-30)));
    placed = placed && sigma > 0.1;
    Taps taps;
    float s0 = 0.0, s1 = 0.0, s2 = 0.0;
    int reach = int(push.reach);
    for (int t = -reach; t <= reach; ++t) {
        uint index = own;
        float w = t == 0 ? 1.0 : placed ? tapWeight(centre, sigma, chart, texel + t * axis, index) : 0.0;
        taps.index[t + reach] = w > 0.0 ? index : own;
        taps.weight[t + reach] = w;
        s0 += w;
        s1 += w * float(t);
        s2 += w * float(t * t);
    }
    float det = s0 * s2 - s1 * s1;
    bool line = det > 1e-3 * s0 * s0;
    for (int t = -reach; t <= reach; ++t) {
        float w = taps.weight[t + reach];
        taps.weight[t + reach] = line ? w * (s2 - s1 * float(t)) / det : w / s0;
    }
    return taps;
}
