// Low-discrepancy directions. Legal as GLSL and as C++ (namespace relume::shader).

// Integer hash with low bias [Wellons 2018, "lowbias32"].
FUNCTION uint hash32(uint x) {
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x;
}

FUNCTION uint reverseBits(uint x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 8) & 0x00ff00ffu) | ((x & 0x00ff00ffu) << 8);
    return (x >> 16) | (x << 16);
}

// Nested uniform (Owen) scrambling by hashing in bit-reversed order [Laine and Karras 2011; Burley 2020].
FUNCTION uint owenHash(uint reversed, uint seed) {
    uint x = reversed + seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

FUNCTION uint owenScramble(uint x, uint seed) { return reverseBits(owenHash(reverseBits(x), seed)); }

// Second dimension of the Sobol sequence [Sobol 1967; Kollig and Keller 2002], bit-reversed; the first one, bit-reversed, is
// the index itself. The generator matrix is Pascal's triangle modulo 2, a Kronecker power of ((1, 1), (0, 1)): one step
// for each factor.
FUNCTION uint reversedSobol2(uint index) {
    index ^= (index & 0xaaaaaaaau) >> 1;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xff00ff00u) >> 8;
    return index ^ (index >> 16);
}

// Point `index` of the sequence scrambled by `seed`, in [0, 1)^2.
FUNCTION vec2 sobolPoint(uint index, uint seed) {
    uint i = owenScramble(index, seed); // shuffles the order as well, as Burley does: aligned runs stay together
    uint x = reverseBits(owenHash(i, hash32(seed ^ 0x2c1b3c6du)));
    uint y = reverseBits(owenHash(reversedSobol2(i), hash32(seed ^ 0x297a2d39u)));
    // By way of int, which every processor converts in one instruction.
    return vec2(float(int(x >> 8)), float(int(y >> 8))) * (1.0f / 16777216.0f);
}

// Cosine-distributed direction around +z by the concentric map [Shirley and Chiu 1997]; density cos / pi. Within an eighth of
// the circle a few terms of the series for sine and cosine are exact to a float's last bit, on every device alike; no
// branches, so that compilers put patches side by side in vector registers.
FUNCTION vec3 cosineDirection(vec2 u) {
    float px = 2.0f * u.x - 1.0f, py = 2.0f * u.y - 1.0f;
    bool wide = abs(px) > abs(py);
    float r = wide ? px : py;
    float ratio = (wide ? py : px) / (r == 0.0f ? 1.0f : r);
    float a = 0.785398163f * ratio; // in [-pi/4, pi/4]
    float a2 = a * a;
    float s = a * (1.0f + a2 * (-1.6666667e-1f + a2 * (8.3333333e-3f + a2 * (-1.9841270e-4f + a2 * 2.7557319e-6f))));
    float c = 1.0f + a2 * (-0.5f + a2 * (4.1666667e-2f + a2 * (-1.3888889e-3f + a2 * 2.4801587e-5f)));
    return vec3(r * (wide ? c : s), r * (wide ? s : c), sqrt(max(0.0f, 1.0f - r * r)));
}

// A direction around unit n, from one around +z; the tangents follow n alone [Duff et al. 2017].
FUNCTION vec3 aroundNormal(vec3 n, vec3 d) {
    float s = n.z >= 0.0f ? 1.0f : -1.0f;
    float a = -1.0f / (s + n.z);
    float b = n.x * n.y * a;
    vec3 t = vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
    vec3 u = vec3(b, s + n.y * n.y * a, -n.y);
    return d.x * t + d.y * u + d.z * n;
}

FUNCTION uint seedKey(Patch p) { return p.flags >> 8; }

// Samples take turns among kReplicates sequences: which one, as a seed for the scrambling, and the place in it.
FUNCTION uint replicateSeed(uint key, uint sampleIndex) { return hash32(key * kReplicates + sampleIndex % kReplicates); }
FUNCTION uint replicateIndex(uint sampleIndex) { return sampleIndex / kReplicates; }

// Direction of sample `index` for patch p: density cos / pi around the shading normal. `key` seeds the scrambling: seedKey of
// the patch itself, or of its chunk's first patch (Rotation::Tile). Below the geometric horizon it is mirrored up, so no
// ray starts inside.
FUNCTION vec3 patchDirection(Patch p, uint key, uint index) {
    vec2 u = sobolPoint(replicateIndex(index), replicateSeed(key, index));
    vec3 d = aroundNormal(p.shading, cosineDirection(u));
    float c = dot(d, p.normal);
    return c < 0.0f ? d - 2.0f * c * p.normal : d;
}
