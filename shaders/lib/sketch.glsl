// The sketch of an error: sums over many patches, each with a sign of its own, so that two patches' errors have
// nothing in common there but by chance.

// Returns the sign of a patch: 1 or -1.
FUNCTION float sketchSign(uint index) { return (hash32(index) & 1u) != 0u ? 1.0f : -1.0f; }
