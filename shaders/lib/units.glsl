// Functions of blocks and sender lists. It is legal as GLSL and as C++ (namespace relume::shader).

// Returns which of a sender's patches stands for it: drawn by (receiving chunk, sender) alone, so it is the
// same in every bounce. The hash is one of integers with low bias [Wellons 2018, "lowbias32"]; the
// remainder's bias is below count / 2^32.
FUNCTION uint drawMember(Sender s, uint rowKey) {
    if (s.count == 1u) return 0u;
    uint x = rowKey * 0x9e3779b9u ^ s.key;
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return x % s.count;
}

// Tells whether a unit of a super-block has its bits already.
FUNCTION bool unitKnown(SuperBlock super, uint local) {
    uvec4 words = local < 128u ? super.known0 : super.known1;
    return ((words[int(local / 32u % 4u)] >> (local % 32u)) & 1u) != 0u;
}
