// Turns light into what a screen shows. It is legal as GLSL and as C++ (namespace relume::shader).

CONST uint kToneNone = 0u;
CONST uint kToneAces = 1u;
CONST uint kToneAgx = 2u;

FUNCTION float luminance(vec3 linear) { // of Rec. 709 primaries [ITU-R BT.709-6, item 3.2]
    return dot(linear, vec3(0.2126f, 0.7152f, 0.0722f));
}

// Applies the transfer function of sRGB [IEC 61966-2-1] to values in [0, 1].
FUNCTION vec3 srgbEncode(vec3 linear) {
    vec3 low = 12.92f * linear;
    vec3 high = 1.055f * pow(max(linear, vec3(0.0031308f)), vec3(1.0f / 2.4f)) - 0.055f;
    return mix(high, low, vec3(lessThanEqual(linear, vec3(0.0031308f))));
}

// Applies the Academy's reference rendering and output transforms (ACES 1.0, sRGB at 100 cd/m^2) as two
// matrices and a rational curve [the fit of S. Hill 2015, given in "BakingLab", ACES.hlsl], linear to linear.
FUNCTION vec3 toneAces(vec3 linear) {
    const mat3 toRrt = mat3(0.59719f, 0.07600f, 0.02840f, 0.35458f, 0.90834f, 0.13383f, 0.04823f, 0.01566f, 0.83777f);
    const mat3 fromOdt =
        mat3(1.60475f, -0.10208f, -0.00327f, -0.53108f, 1.10813f, -0.07276f, -0.07367f, -0.00605f, 1.07602f);
    vec3 v = toRrt * linear;
    vec3 curve = (v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f);
    return clamp(fromOdt * curve, 0.0f, 1.0f);
}

// Applies AgX, base look [T. Sobotka 2022]: a log encoding from 2^-12.47393 to 2^4.026069 in inset primaries
// and a sigmoid, here the polynomial of degree six that B. Wrensch fitted ["Minimal AgX Implementation"
// 2023]. Bright colours fade to white without a change of hue. It turns linear values into ones encoded by a
// power of 2.2.
FUNCTION vec3 agxEncoded(vec3 linear) {
    const mat3 inset = mat3(0.842479062f, 0.042328242f, 0.042375655f, 0.078433600f, 0.878468636f, 0.078433600f,
                            0.079223745f, 0.079166127f, 0.879142974f);
    const mat3 outset = mat3(1.196879005f, -0.052896852f, -0.052971636f, -0.098020881f, 1.151903130f, -0.098043450f,
                             -0.099029744f, -0.098961177f, 1.151073673f);
    const float lowest = -12.47393f, highest = 4.026069f; // [EV]
    vec3 v = max(inset * linear, vec3(1e-10f));
    vec3 x = clamp((log2(v) - lowest) / (highest - lowest), 0.0f, 1.0f);
    vec3 curve =
        (((((15.5f * x - 40.14f) * x + 31.96f) * x - 6.868f) * x + 0.4298f) * x + 0.1191f) * x - 0.00232f;
    return clamp(outset * curve, 0.0f, 1.0f);
}

// Applies AgX, linear to linear.
FUNCTION vec3 toneAgx(vec3 linear) {
    return pow(agxEncoded(linear), vec3(2.2f));
}

// Does toneAgx in sRGB encoding with one power instead of two. Where sRGB is linear, below 10 of 255, a
// square stands for the power of 2.2: within 0.4 of one step of 8 bits.
FUNCTION vec3 toneAgxAsSrgb(vec3 linear) {
    const float limit = 0.0727f; // its power of 2.2 is sRGB's limit, 0.0031308
    vec3 encoded = agxEncoded(linear);
    vec3 low = 12.92f * 0.5923f * encoded * encoded; // 0.5923: limit to the power of 0.2
    vec3 high = 1.055f * pow(max(encoded, vec3(limit)), vec3(2.2f / 2.4f)) - 0.055f;
    return mix(high, low, vec3(lessThanEqual(encoded, vec3(limit))));
}

// Turns light times exposure into linear values in [0, 1].
FUNCTION vec3 toneMap(vec3 linear, uint tone) {
    if (tone == kToneAces) return toneAces(linear);
    if (tone == kToneAgx) return toneAgx(linear);
    return clamp(linear, 0.0f, 1.0f);
}

// Does the same, sRGB encoded: what a screen takes.
FUNCTION vec3 toneMapAsSrgb(vec3 linear, uint tone) {
    return tone == kToneAgx ? toneAgxAsSrgb(linear) : srgbEncode(toneMap(linear, tone));
}

// Encodes brightness in a picture's 8 bits for the meter: 0 is no light, 1 to 255 an eighth of an EV each,
// from 2^-20 to 2^12.
CONST float kMeterLowest = -20.0f, kMeterSteps = 8.0f;
FUNCTION float meterCode(float light) {
    return light > 1e-6f ? clamp(1.0f + kMeterSteps * (log2(light) - kMeterLowest), 1.0f, 254.5f) : 0.0f;
}
FUNCTION float meterLog2(float code) { // of one above 0
    return (code - 1.0f) / kMeterSteps + kMeterLowest;
}
