// Light in 8 bytes, as links read it: the gather waits for memory. It is legal as GLSL and as C++ (namespace
// relume::shader).

// Each of R, G and B is the upper bits of a float: no sign, 7 bits of exponent, 14 of mantissa, rounded to
// nearest: within 2^-15 of it from 2^-62 to 2^64; less is 0 or close to it, more is the largest there is. 0
// stays 0.
CONST float kPackScale = 5.42101086e-20f; // 2^-64: exponents from -63 to 64 then have their highest bit clear
CONST float kPackInverse = 1.84467441e19f;
CONST uint kPackMask = 0x1fffffu;

FUNCTION uint packChannel(float light) {
    uint bits = floatBitsToUint(min(max(light, 0.0f) * kPackScale, 1.9999f));
    return (bits + 0xffu + ((bits >> 9) & 1u)) >> 9;
}

FUNCTION uvec2 packLight(vec3 light) {
    uint r = packChannel(light.x), g = packChannel(light.y), b = packChannel(light.z);
    return uvec2(r | (g << 21), (g >> 11) | (b << 10));
}

FUNCTION float unpackChannel(uint bits) { return uintBitsToFloat(bits << 9); }

// Unpacks light times kPackScale: sums of many are made of these as they are, and scaled once, which is
// exact.
FUNCTION vec3 unpackScaled(uvec2 p) {
    return vec3(unpackChannel(p.x & kPackMask), unpackChannel(((p.x >> 21) | (p.y << 11)) & kPackMask),
                unpackChannel((p.y >> 10) & kPackMask));
}

FUNCTION vec3 unpackLight(uvec2 p) { return kPackInverse * unpackScaled(p); }
