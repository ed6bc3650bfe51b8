// How quantities of the texture group are shown (thesis: VIT).

#include "lib/heat.glsl"

layout(location = 11) uniform vec3 rangeLow; // of what is shown; heat: x only
layout(location = 12) uniform vec3 rangeHigh;

vec3 shareOfRange(vec3 value) {
    return clamp((value - rangeLow) / max(rangeHigh - rangeLow, vec3(1e-20)), 0.0, 1.0);
}

// A leaf of 2^level texels along each edge, brighter the more it weighs, told apart from its neighbours by a border.
vec3 leafColor(float level, float weight, vec2 texel) {
    float edge = exp2(floor(level + 0.5));
    vec2 inside = fract(texel / edge) * edge; // [texels] from the leaf's corner
    float border = min(min(inside.x, inside.y), min(edge - inside.x, edge - inside.y));
    vec3 color = heatColor(clamp(0.2 + level / 8.0, 0.0, 0.9)) * mix(0.35, 1.0, clamp(weight, 0.0, 1.0));
    return border < min(0.35, 0.15 * edge) ? 0.3 * color : color;
}

// x: 1 seen, 0 not; y: form factor, of the largest one.
vec3 maskColor(vec2 seen) {
    return seen.x > 0.5 ? mix(vec3(0.45, 0.3, 0.05), vec3(1.0, 0.9, 0.45), sqrt(clamp(seen.y, 0.0, 1.0)))
                        : vec3(0.14, 0.16, 0.24);
}

// As displayed; of the views of a quantity that is no light. texel: lightmap uv x size.
vec3 quantityColor(vec3 value, vec2 texel) {
    switch (uint(VIEW)) {
    case kViewInspectPosition: return shareOfRange(value);
    case kViewInspectNormal: return 0.5 * value + 0.5;
    case kViewInspectHeat: return heatColor(shareOfRange(value).x);
    case kViewInspectLeaves: return leafColor(value.x, value.y, texel);
    case kViewInspectMask: return maskColor(value.xy);
    default: return value;
    }
}
