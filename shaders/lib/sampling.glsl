// Low-discrepancy directions. It is legal as GLSL and as C++ (namespace relume::shader).

// Hashes integers with low bias [Wellons 2018, "lowbias32"].
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

// Does nested uniform (Owen) scrambling by hashing in bit-reversed order [Laine and Karras 2011; Burley
// 2020].
FUNCTION uint owenHash(uint reversed, uint seed) {
    uint x = reversed + seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

FUNCTION uint owenScramble(uint x, uint seed) { return reverseBits(owenHash(reverseBits(x), seed)); }

// Returns the second dimension of the Sobol sequence [Sobol 1967; Kollig and Keller 2002], bit-reversed; the
// first one, bit-reversed, is the index itself. The generator matrix is Pascal's triangle modulo 2, a
// Kronecker power of ((1, 1), (0, 1)): one step for each factor.
FUNCTION uint reversedSobol2(uint index) {
    index ^= (index & 0xaaaaaaaau) >> 1;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xff00ff00u) >> 8;
    return index ^ (index >> 16);
}

// Returns point `index` of the sequence scrambled by `seed`, in [0, 1)^2. `shift`, bit-reversed, is added modulo 2
// to both dimensions before they are scrambled: a sequence so shifted is as even as the one before.
FUNCTION vec2 sobolPoint(uint index, uint seed, uvec2 shift) {
    uint i = owenScramble(index, seed); // shuffles the order, too, as Burley does: aligned runs stay together
    uint x = reverseBits(owenHash(i ^ shift.x, hash32(seed ^ 0x2c1b3c6du)));
    uint y = reverseBits(owenHash(reversedSobol2(i) ^ shift.y, hash32(seed ^ 0x297a2d39u)));
    // The numbers go by way of int, which every processor converts in one instruction.
    return vec2(float(int(x >> 8)), float(int(y >> 8))) * (1.0f / 16777216.0f);
}

FUNCTION vec2 sobolPoint(uint index, uint seed) { return sobolPoint(index, seed, uvec2(0u)); }

// Returns a cosine-distributed direction around +z by the concentric map [Shirley and Chiu 1997]; density cos
// / pi. Within an eighth of the circle a few terms of the series for sine and cosine are exact to a float's
// last bit, on every device alike; there are no branches, so that compilers put patches side by side in
// vector registers.
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

// Returns a direction around unit n, from one around +z; the tangents follow n alone [Duff et al. 2017].
FUNCTION vec3 aroundNormal(vec3 n, vec3 d) {
    float s = n.z >= 0.0f ? 1.0f : -1.0f;
    float a = -1.0f / (s + n.z);
    float b = n.x * n.y * a;
    vec3 t = vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
    vec3 u = vec3(b, s + n.y * n.y * a, -n.y);
    return d.x * t + d.y * u + d.z * n;
}

FUNCTION uint seedKey(Patch p) { return patchTexel(p.flags); }

// Samples take turns among kReplicates sequences: these return which one, as a seed for the scrambling, and
// the place in it.
FUNCTION uint replicateSeed(uint key, uint sampleIndex) { return hash32(key * kReplicates + sampleIndex % kReplicates); }
FUNCTION uint replicateIndex(uint sampleIndex) { return sampleIndex / kReplicates; }

// Patches of a block of 4 x 4 texels have one scrambling, and a shift of their own each, so that their points
// together are about as even as the points of one patch are: what smoothing takes the mean of is then less noisy
// than the mean of points that know nothing of each other, and the blotches that it leaves are fainter.
CONST uint kBlockEdge = 4u;  // [texels]
CONST uint kMemberBits = 4u; // tell a block's texels apart

// Returns the shift of a block's member, whose bits are those of its column and row in turn. The first two
// numbers are for a step of one texel, the last two for one of two. They were found by a search: with 2 to 2,048
// points per texel those of 2 x 2 and of 4 x 4 texels are (t, m, 2)-nets [Niederreiter 1987], with t = 2 at most,
// mostly 1.
FUNCTION uvec2 memberShift(uint member) {
    uvec2 shift = uvec2(0u);
    if ((member & 1u) != 0u) shift = uvec2(0x1bcb8u, 0x1653bu);
    if ((member & 2u) != 0u) shift = shift ^ uvec2(0x1a15bu, 0x3bbfbu);
    if ((member & 4u) != 0u) shift = shift ^ uvec2(0x09685u, 0x18727u);
    if ((member & 8u) != 0u) shift = shift ^ uvec2(0x0ce4du, 0x2b455u);
    return shift;
}

// Returns the key of a texel: its block, then its member's bits.
FUNCTION uint blockKey(uint texel, uint size) {
    uint x = texel % size, y = texel / size;
    uint member = (x & 1u) | ((y & 1u) << 1) | ((x & 2u) << 1) | ((y & 2u) << 2);
    return ((y / kBlockEdge * ((size + kBlockEdge - 1u) / kBlockEdge) + x / kBlockEdge) << kMemberBits) | member;
}

// Returns the key of what has no block. Beyond 2^28 two numbers may have one key, which does no harm.
FUNCTION uint keyAlone(uint number) { return number << kMemberBits; }

// Returns what seeds the directions of a patch: its own key in its block or without one, that of its texel's place
// in its 4 x 4, or of the texel of its chunk's first patch. size is the lightmap edge [texels].
FUNCTION uint rotationKey(Patch p, Patch firstOfChunk, uint rotation, uint size) {
    uint texel = seedKey(p);
    if (rotation == kRotateInterleaved) return keyAlone(texel / size % 4u * 4u + texel % size % 4u);
    if (rotation == kRotateTile) return keyAlone(seedKey(firstOfChunk));
    return rotation == kRotateAlone ? keyAlone(texel) : blockKey(texel, size);
}

// Turns a direction around +z to the patch's shading normal. Below the geometric horizon it is mirrored up,
// so no ray starts inside.
FUNCTION vec3 aroundPatch(Patch p, vec3 local) {
    vec3 d = aroundNormal(p.shading, local);
    float c = dot(d, p.normal);
    return c < 0.0f ? d - 2.0f * c * p.normal : d;
}

// Tells whether it was mirrored.
FUNCTION bool mirroredUp(Patch p, vec3 local) { return dot(aroundNormal(p.shading, local), p.normal) < 0.0f; }

// Return the seed of a patch's sample `index`, whose key is rotationKey or keyAlone, and its point of the unit
// square.
FUNCTION uint directionSeed(uint key, uint index) { return replicateSeed(key >> kMemberBits, index); }
FUNCTION vec2 directionPoint(uint key, uint index) {
    return sobolPoint(replicateIndex(index), directionSeed(key, index), memberShift(key));
}

// Returns the direction of that sample around +z: density cos / pi; and around the patch's shading normal.
FUNCTION vec3 localDirection(uint key, uint index) { return cosineDirection(directionPoint(key, index)); }
FUNCTION vec3 patchDirection(Patch p, uint key, uint index) { return aroundPatch(p, localDirection(key, index)); }

// Returns cosine and sine of bits / 2^32 of a full turn, by the same series as above.
FUNCTION vec2 turnBy(uint bits) {
    float a = (float(int((bits & 0x3fffffffu) >> 6)) * (1.0f / 16777216.0f) - 0.5f) * 1.57079633f;
    float a2 = a * a;
    float s = a * (1.0f + a2 * (-1.6666667e-1f + a2 * (8.3333333e-3f + a2 * (-1.9841270e-4f + a2 * 2.7557319e-6f))));
    float c = 1.0f + a2 * (-0.5f + a2 * (4.1666667e-2f + a2 * (-1.3888889e-3f + a2 * 2.4801587e-5f)));
    bool odd = (bits & 0x40000000u) != 0u, back = (bits & 0x80000000u) != 0u;
    float x = odd ? -s : c, y = odd ? c : s;
    return vec2(back ? -x : x, back ? -y : y);
}

// Returns the point of a set of `count`, each in the middle of a ring of its own (bake/links/directions.h),
// as a direction around +z: the set is turned by a random angle and all points are moved by one random share
// of their rings. So each is distributed like the cosine, whatever the set, and the set as a whole stays as
// even as it is.
FUNCTION vec3 discDirection(vec2 point, uint count, uint seed) {
    uint bits = hash32(seed);
    vec2 turn = turnBy(bits);
    float r2 = point.x * point.x + point.y * point.y;
    float share = float(int(hash32(bits ^ 0x68bc21ebu) >> 8)) * (1.0f / 16777216.0f);
    float ring = clamp(r2 + (share - 0.5f) / float(int(count)), 0.0f, 1.0f);
    float scale = sqrt(ring / r2);
    return vec3(scale * (point.x * turn.x - point.y * turn.y), scale * (point.x * turn.y + point.y * turn.x),
                sqrt(1.0f - ring));
}

// Each replicate goes through the set; every time that it begins again, all is turned anew.
FUNCTION uint discTurn(uint index, uint count) { return replicateIndex(index) / count * 0x9e3779b9u; }
FUNCTION uint discSeed(uint key, uint index, uint count) { return replicateSeed(key, index) + discTurn(index, count); }

// Returns which point of a disc's set sample `index` takes. Patches begin anywhere in the set: each single
// sample may then have any ring, and sample passes of a few samples are unbiased by themselves, on which the
// products of their bounces depend.
FUNCTION uint discPoint(uint index, uint count, uint seed) {
    return (replicateIndex(index) % count + hash32(seed ^ 0x02e5be93u) % count) % count;
}
