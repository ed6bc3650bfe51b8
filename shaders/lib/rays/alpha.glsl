// The alpha test of masked triangles, alike for all tracers. It is legal as GLSL and as C++; the includer
// supplies
//   float alphaTexel(uint offset)   one 8-bit alpha / 255

FUNCTION uint wrapTexel(float u, uint n, uint mode) {
    int i = int(floor(u * float(n)));
    int m = int(n);
    if (mode == 2u) return uint(clamp(i, 0, m - 1));
    int period = mode == 1u ? 2 * m : m;
    int k = i - period * int(floor(float(i) / float(period)));
    k = clamp(k, 0, period - 1);
    return uint(k < m ? k : period - 1 - k);
}

// Tells whether the hit is solid: alpha (nearest texel) >= cutoff.
FUNCTION bool alphaSolid(AlphaTriangle t, AlphaMaterial m, float b1, float b2) {
    float b0 = 1.0f - b1 - b2;
    float alpha = m.factor * (t.a0 * b0 + t.a1 * b1 + t.a2 * b2);
    if (m.texels != 0xffffffffu) {
        vec2 uv = t.uv0 * b0 + t.uv1 * b1 + t.uv2 * b2;
        alpha *= alphaTexel(m.texels + wrapTexel(uv.y, m.height, m.wrapT) * m.width + wrapTexel(uv.x, m.width, m.wrapS));
    }
    return alpha >= m.cutoff;
}
