// Shows quantities of the texture group (thesis: VIT).

#include "lib/heat.glsl"

layout(location = 11) uniform vec3 rangeLow; // of what is shown; heat: x only
layout(location = 12) uniform vec3 rangeHigh;

vec3 shareOfRange(vec3 value) {
    return clamp((value - rangeLow) / max(rangeHigh - rangeLow, vec3(1e-20)), 0.0, 1.0);
}

// Returns a leaf's colour. level is log2 of its edge in texels, warmer for larger ones; border is 1 along it;
// own, in [0, 1), tells it from its neighbours.
vec3 leafColor(float level, float border, float own) {
    vec3 color = heatColor(clamp(0.25 + level / 10.0, 0.0, 0.9)) * (0.7 + 0.3 * own);
    return mix(color, vec3(0.05), 0.75 * clamp(border, 0.0, 1.0));
}

// Returns a mask's colour; x is 1 for seen, 0 for not; y the form factor, of the largest one; z 1 where all
// is seen from.
vec3 maskColor(vec3 seen) {
    if (seen.z > 0.5) return vec3(0.95, 0.2, 0.75);
    return seen.x > 0.5 ? mix(vec3(0.45, 0.3, 0.05), vec3(1.0, 0.9, 0.45), sqrt(clamp(seen.y, 0.0, 1.0)))
                        : vec3(0.14, 0.16, 0.24);
}

// Returns the colour as displayed, for the views of a quantity that is no light.
vec3 quantityColor(vec3 value) {
    switch (uint(VIEW)) {
    case kViewInspectPosition: return shareOfRange(value);
    case kViewInspectNormal: return 0.5 * value + 0.5;
    case kViewInspectHeat: return heatColor(shareOfRange(value).x);
    case kViewInspectLeaves: return leafColor(value.x, value.y, value.z);
    case kViewInspectMask: return maskColor(value);
    default: return value;
    }
}
