// The picture holds colours as displayed, and in A how bright the light was, for the meter.

#include "lib/tone.glsl"

layout(location = 7) uniform float meterScale; // brings the scene's light near 1, whatever its unit
layout(location = 9) uniform float exposure;   // factor
layout(location = 15) uniform float dither;    // of colours: 1, or 0 for none

// Light is mapped as it is drawn, not in a pass of its own: a picture in half floats with all its samples is
// what a software device would spend most of its time on. The samples are then averaged as displayed, which
// keeps edges beside lights smooth.
//
// Both are dithered: between two steps of 8 bits the share of pixels decides, so dark walls show no contours, and
// the meter is finer than an eighth of an EV [Jimenez 2014, interleaved gradient noise]. As noise stays below half
// a step, colours that are steps already stay as they are. Both are rounded here: what some GPUs round by themselves
// is off by a twentieth of a step.
vec4 displayedLight(vec3 light) {
    float noise = 0.998 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715)))) - 0.499;
    float code = meterCode(luminance(light) * meterScale);
    vec3 steps = 255.0 * toneMapAsSrgb(light * exposure, TONE) + dither * noise;
    return floor(vec4(steps, code > 0.0 ? code + noise : 0.0) + 0.5) / 255.0;
}
