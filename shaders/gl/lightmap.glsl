// Reads the lightmap: lighting or another quantity in RGB, coverage in A; empty texels (A 0) are left out of
// every filter, so that a chart's edge stays as bright as its inside.

layout(binding = 3) uniform sampler2D lightmap;

// RGB is premultiplied by A, the share of the weights that fell on texels with light. With FILLED no texel
// that a filter reaches is empty, so nothing needs to look.
vec4 bilinearTap(vec2 uv) {
    vec3 light = textureLod(lightmap, uv, 0.0).rgb;
    if (FILLED != 0) return vec4(light, 1.0);
    vec2 size = vec2(textureSize(lightmap, 0));
    vec4 filled = vec4(greaterThan(textureGather(lightmap, uv, 3), vec4(0.0)));
    if (all(equal(filled, vec4(1.0)))) return vec4(light, 1.0);
    vec2 f = fract(uv * size - 0.5);
    vec4 weights = vec4((1.0 - f.x) * f.y, f.x * f.y, f.x * (1.0 - f.y), (1.0 - f.x) * (1.0 - f.y)); // textureGather
    return vec4(light, dot(filled, weights));
}

// Filters by a cubic B-spline in four bilinear taps [Sigg and Hadwiger, GPU Gems 2, chapter 20]; it reaches
// two texels, which is less than a baker's dilation.
vec4 bicubicTap(vec2 uv) {
    vec2 size = vec2(textureSize(lightmap, 0));
    vec2 texel = uv * size - 0.5;
    vec2 f = fract(texel), base = texel - f;
    vec2 f2 = f * f, f3 = f2 * f;
    vec2 w0 = (1.0 - f) * (1.0 - f) * (1.0 - f) / 6.0;
    vec2 w1 = (4.0 - 6.0 * f2 + 3.0 * f3) / 6.0;
    vec2 w3 = f3 / 6.0;
    vec2 g0 = w0 + w1, g1 = 1.0 - g0;
    vec2 p0 = (base - 0.5 + w1 / g0) / size, p1 = (base + 1.5 + w3 / g1) / size;
    return g0.y * (g0.x * bilinearTap(p0) + g1.x * bilinearTap(vec2(p1.x, p0.y))) +
           g1.y * (g0.x * bilinearTap(vec2(p0.x, p1.y)) + g1.x * bilinearTap(p1));
}

vec4 nearestTap(vec2 uv) {
    ivec2 size = textureSize(lightmap, 0);
    vec4 texel = texelFetch(lightmap, clamp(ivec2(floor(uv * vec2(size))), ivec2(0), size - 1), 0);
    return texel.a > 0.0 ? vec4(texel.rgb, 1.0) : vec4(0.0);
}

// Returns the quantity at uv; `otherwise` where no texel near has any.
vec3 sampleLightmap(vec2 uv, uint filterKind, vec3 otherwise) {
    vec4 tap = filterKind == kFilterNearest    ? nearestTap(uv)
               : filterKind == kFilterBilinear ? bilinearTap(uv)
                                               : bicubicTap(uv);
    return tap.a > 1e-4 ? tap.rgb / tap.a : otherwise;
}
