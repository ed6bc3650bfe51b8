// Smooths indirect light within a chart along one direction; the smoothing is separable. The includer's push
// constants hold patches, patchChart, texelToPatch, distances, size, sigma and reach.


const uint kMaxReach = 8u; // texels
// Indirect light changes over lengths like the distance of what it comes from: beside an edge of a
// room it is hardly smoothed across that.
const float kDistanceShare = 0.3;
const float kLeastSigma = 0.1; // texels: what is to be smoothed less is left as it is

// Returns the patch of this chart that is seen at a texel, or kNoPatch.
uint tapAt(uint chart, ivec2 texel) {
    if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(push.size)))) return kNoPatch;
    uint index = WORD_AT(push.texelToPatch, uint(texel.y) * push.size + uint(texel.x));
    if (index == kNoPatch || WORD_AT(push.patchChart, index) != chart) return kNoPatch;
    return (loadPatch(push.patches, index).flags & kPatchSends) != 0u ? index : kNoPatch;
}

// Returns by how much the square of a distance counts: over twice the variance of the weights [1/m^2].
float tapFalloff(uint index, ivec2 axis) {
    float area = max(loadPatch(push.patches, index).area, 1e-30);
    float distance = FLOAT_AT(push.distances, 2u * index + uint(axis.y));
    float sigma = min(push.sigma, kDistanceShare * distance / sqrt(area));
    return 0.5 / max(sigma * sigma * area, 1e-38);
}

// Returns how much a patch counts: by distance in the world, by how far it lies off the receiver's plane, and
// by its normal.
float tapWeight(Patch centre, float falloff, uint index) {
    Patch other = loadPatch(push.patches, index);
    vec3 d = other.position - centre.position;
    float height = dot(d, centre.normal);
    // The distance off the plane counts four times: a step or a fold within the chart parts what lies side by
    // side in the atlas.
    float distance2 = dot(d, d) + 15.0 * height * height;
    float facing = max(dot(centre.shading, other.shading), 0.0);
    facing *= facing;
    facing *= facing;
    return exp(-falloff * distance2) * facing * facing;
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
    float falloff = tapFalloff(own, axis);
    placed = placed && falloff * max(centre.area, 1e-30) < 0.5 / (kLeastSigma * kLeastSigma);
    int reach = int(push.reach);
    Taps taps;
    for (int t = -reach; t <= reach; ++t) {
        taps.index[t + reach] = own;
        taps.weight[t + reach] = t == 0 ? 1.0 : 0.0;
    }
    // A wall upon a floor that is one chart parts the light of patches on both sides. It hides texels, or the
    // patches at its foot have it near: nothing counts beyond them, nor more than they allow.
    float s0 = 1.0, s1 = 0.0, s2 = 0.0;
    for (int way = placed ? -1 : 3; way <= 1; way += 2) {
        float narrowest = falloff;
        for (int step = 1; step <= reach; ++step) {
            int t = way * step;
            uint index = tapAt(chart, texel + t * axis);
            if (index == kNoPatch) break;
            narrowest = max(narrowest, tapFalloff(index, axis));
            float w = tapWeight(centre, narrowest, index);
            if (w == 0.0) continue;
            taps.index[t + reach] = index;
            taps.weight[t + reach] = w;
            s0 += w;
            s1 += w * float(t);
            s2 += w * float(t * t);
        }
    }
    float det = s0 * s2 - s1 * s1;
    bool line = det > 1e-3 * s0 * s0;
    for (int t = -reach; t <= reach; ++t) {
        float w = taps.weight[t + reach];
        taps.weight[t + reach] = line ? w * (s2 - s1 * float(t)) / det : w / s0;
    }
    return taps;
}
