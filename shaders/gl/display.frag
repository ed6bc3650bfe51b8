// From the picture's samples to the screen: exposure, resolve, tone mapping, sRGB.

#include "lib/tone.glsl"
#include "gl/picture.glsl"

layout(location = 0) uniform float exposure; // factor
layout(location = 1) uniform uint tone;
layout(location = 2) uniform uint linear;    // 1: light, 0: colours as they are to be displayed
layout(location = 3) uniform vec3 background; // as displayed

out vec4 result;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 sum = vec3(0.0);
    float weights = 0.0, covered = 0.0;
    for (int i = 0; i < kSamples; ++i) {
        vec4 texel = fetchSample(pixel, i);
        vec3 color = texel.rgb * (linear != 0u ? exposure : 1.0);
        // A lamp's samples weigh less: else one of four whitens the pixel and its edge is not smooth any more.
        float weight = texel.a * (linear != 0u ? 1.0 / (1.0 + luminance(color)) : 1.0);
        sum += weight * color;
        weights += weight;
        covered += texel.a;
    }
    vec3 color = weights > 0.0 ? sum / weights : vec3(0.0);
    if (linear != 0u) color = srgbEncode(toneMap(color, tone));
    result = vec4(mix(background, color, covered / float(kSamples)), 1.0);
}
