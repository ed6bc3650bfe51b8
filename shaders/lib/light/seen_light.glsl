// The light of a source of which some points are seen. It is legal as GLSL and as C++ (namespace relume::shader).

// Returns what one replicate says: `whole` is the source's light without shadows, known from elsewhere, `count` the
// replicate's points, `part` and `seen` the sums of what its points would bring and of what those bring that
// are seen; `all` and `visible` are these sums over all replicates. The share that is seen comes from the
// other replicates, which know nothing of this one's points, so that the mean is exact for any number of points: a
// control variate. The share of all points together, sum(V f) / sum(f), would be off by what numerator and
// denominator have in common: by a tenth in a penumbra with four points [Cochran 1977, Sampling Techniques, 6.8].
// A source that is seen as a whole, or not at all, is exact; but where all of the others' points lie below the
// receiver's horizon, a replicate is left to its own.
FUNCTION float seenLight(float whole, float count, float part, float seen, float all, float visible) {
    float rest = all - part;
    float share = rest > 0.0f ? (visible - seen) / rest : 0.0f;
    return whole * share + (seen - share * part) / count;
}

// Returns the same for a source whose points are drawn, from picks with the chance that each had: `whole` is the
// lighting by all of it without shadows, `count` the replicate's picks, `part` and `seen` the sums over these of what each
// pick would bring over its chance and of the part of that which is seen. The share is one number for all colours,
// and right in the mean whichever it is.
FUNCTION vec3 seenPicks(vec3 whole, float count, vec3 part, vec3 seen, vec3 all, vec3 visible) {
    vec3 others = all - part, othersSeen = visible - seen;
    float rest = others.r + others.g + others.b;
    float share = rest > 0.0f ? (othersSeen.r + othersSeen.g + othersSeen.b) / rest : 0.0f;
    return whole * share + (seen - share * part) / count;
}
