// The picture holds colours as displayed, and in A how bright the light was, for the meter.

#include "lib/tone.glsl"

layout(location = 7) uniform float meterScale; // brings the scene's light near 1, whatever its unit
layout(location = 9) uniform float exposure;   // factor

// Light is mapped as it is drawn, not in a pass of its own: a picture in half floats with all its samples is
// what a software device would spend most of its time on. The samples are then averaged as displayed, which
// keeps edges beside lights smooth.
vec4 displayedLight(vec3 light) {
    // Between two of the meter's 8-bit steps of an eighth of an EV the share of pixels decides [Jimenez 2014,
    // interleaved gradient noise].
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.5;
    float code = meterCode(luminance(light) * meterScale);
    return vec4(toneMapAsSrgb(light * exposure, TONE), code > 0.0 ? (code + noise) / 255.0 : 0.0);
}
