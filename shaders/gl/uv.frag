// Draws the lightmap's texture itself, in view VIEW with filter FILTER and tone mapping TONE; row 0 is on
// top, as images have it.

#include "lib/scene_material.glsl"
#include "gl/light.glsl"
#include "gl/lightmap.glsl"
#include "gl/inspect.glsl"

layout(location = 0) uniform vec4 window;     // uv at the target's upper left corner, uv per pixel
layout(location = 1) uniform vec2 targetSize; // [pixels]
layout(location = 2) uniform uint masked;     // 1: empty texels are hatched
layout(location = 3) uniform vec3 background; // as displayed
layout(location = 10) uniform float unit;     // of the lightmap's light [cd/m^2]

out vec4 result;

const uint view = VIEW;

vec3 hatch(vec2 pixel) {
    return vec3(mod(pixel.x + pixel.y, 16.0) < 8.0 ? 0.2 : 0.26);
}

vec3 coverageColor(float coverage) {
    return coverage > 0.75  ? vec3(0.35, 0.7, 0.4)  // a patch
           : coverage > 0.0 ? vec3(0.95, 0.75, 0.2) // filled from its neighbours
                            : vec3(0.25, 0.08, 0.08);
}

void main() {
    vec2 pixel = vec2(gl_FragCoord.x, targetSize.y - gl_FragCoord.y);
    vec2 uv = window.xy + window.zw * pixel;
    bool outside = any(lessThan(uv, vec2(0.0))) || any(greaterThanEqual(uv, vec2(1.0)));
    float coverage = texelFetch(lightmap, ivec2(clamp(uv, 0.0, 0.9999999) * vec2(textureSize(lightmap, 0))), 0).a;
    vec3 value = sampleLightmap(uv, FILTER, vec3(0.0));
    vec3 color;
    if (view == kViewCoverage) color = coverageColor(coverage);
    else if (view == kViewInspectColor) color = displayedLight(unit * value).rgb;
    else color = quantityColor(value);
    if (masked != 0u && coverage <= 0.0) color = hatch(pixel);
    result = vec4(outside ? background : color, 1.0);
}
