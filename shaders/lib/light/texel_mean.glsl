// Light without shadows that differs over a texel, of which the mean over the points that samples start from is asked.
// It is legal as GLSL and as C++ (namespace relume::shader); it comes after lib/rays/start_point.glsl.

// Farther than this many patch sizes the light in the middle is the mean to 0.3 %. Light falls with distance^-4 at most,
// and the mean over a square of edge a is off by a^2 / 24 times the Laplacian, which is 2 / 3 (a / d)^2 then.
CONST float kEvenSizes = 16.0f;
// Nearer than this many, four points say too little, and the mean is that over the samples.
CONST float kNearSizes = 2.0f;

CONST uint kLightEven = 0u;   // the middle's is the mean
CONST uint kLightCurved = 1u; // four points have the mean
CONST uint kLightUneven = 2u; // the samples have it

// This tells where a patch's samples start, by mean and spread.
struct TexelSpread {
    vec3 middle;        // [m]
    vec3 along, across; // [m], middle +- along and middle +- across have the mean and the covariance of all
    float size;         // of the patch [m], 0 where all samples start at its own point
};

struct CellSpread {
    vec2 mean;   // u, v, in units of the texel's edges
    vec3 spread; // variances of u and v, and their covariance
};

// Returns the spread of the cells that are set, each standing for its middle.
FUNCTION CellSpread cellSpread(uint cells) {
    vec2 sum = vec2(0.0f);
    vec3 squares = vec3(0.0f);
    float count = 0.0f;
    for (uint cell = 0u; cell < kCoverEdge * kCoverEdge; ++cell) {
        float here = float((cells >> cell) & 1u);
        vec2 at = cellPlace(cell);
        count += here;
        sum += here * at;
        squares += here * vec3(at.x * at.x, at.y * at.y, at.x * at.y);
    }
    CellSpread s;
    s.mean = sum / count;
    s.spread = squares / count - vec3(s.mean.x * s.mean.x, s.mean.y * s.mean.y, s.mean.x * s.mean.y);
    return s;
}

// Returns where the samples of a patch start. Sums of functions up to the third order over the four points of a whole
// texel are exact [the cross-shaped rule of degree 3, Stroud 1971, C2: 3-1].
FUNCTION TexelSpread texelSpread(Patch p, PatchCover c) {
    TexelSpread t;
    t.middle = p.position;
    t.along = t.across = vec3(0.0f);
    t.size = 0.0f;
    if ((c.cells & kCoverCells) == 0u) return t;
    CellSpread s;
    s.mean = vec2(0.5f);
    s.spread = vec3(1.0f / 12.0f, 1.0f / 12.0f, 0.0f);
    if ((c.cells & kCoverWhole) == 0u) s = cellSpread(c.cells);
    // The spread is that of two vectors at which the samples may be taken to stand [Cholesky].
    float u = sqrt(max(s.spread.x, 0.0f)), slant = u > 0.0f ? s.spread.z / u : 0.0f;
    float v = sqrt(max(s.spread.y - slant * slant, 0.0f));
    const float kOfFour = 1.41421356f; // each vector has two of the four points
    t.middle += coverWay(c, s.mean);
    t.along = kOfFour * (u * c.du + slant * c.dv);
    t.across = kOfFour * v * c.dv;
    t.size = sqrt(p.area);
    return t;
}

CONST uint kSpreadPoints = 4u;
FUNCTION vec3 spreadPoint(TexelSpread t, uint index) {
    vec3 way = index < 2u ? t.along : t.across;
    return (index & 1u) == 0u ? t.middle + way : t.middle - way;
}

// Returns how light from this distance of the middle [m] differs over the texel: kLight...
FUNCTION uint unevenness(float size, float distance) {
    return distance < kNearSizes * size ? kLightUneven : (distance < kEvenSizes * size ? kLightCurved : kLightEven);
}
