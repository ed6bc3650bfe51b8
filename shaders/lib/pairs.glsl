// Geometry of a pair of patches. It is legal as GLSL and as C++ (namespace relume::shader).

struct Segment {
    vec3 origin;    // [m]
    vec3 direction; // not normalised unless rtrad
    float tMin;     // in units of direction
    float tMax;
};

// Tells whether both patches take part and each one's centre lies above the other one's plane, by more than
// its offset so that rounding never lets patches of one plane see each other.
FUNCTION bool pairFaces(Patch a, Patch b) {
    vec3 d = b.position - a.position;
    return (a.flags & b.flags & kPatchSends) != 0u && dot(d, a.normal) > a.offset && dot(d, b.normal) < -b.offset;
}

// Returns the segment that decides whether two patches see each other, `lower` being the one of the lower
// index: both ends are shifted along their normals, so the whole open segment counts. With `rtrad` it goes
// from position to position along the unit direction, t in [0.001, distance - 0.002] (RTRad's absolute rule).
// tMax <= tMin means empty, and counts as visible.
FUNCTION Segment pairSegment(Patch lower, Patch higher, bool rtrad) {
    Segment s;
    if (rtrad) {
        vec3 d = higher.position - lower.position;
        float distance = length(d);
        s.origin = lower.position;
        s.direction = d / distance;
        s.tMin = 0.001f;
        s.tMax = distance - 0.002f;
    } else {
        s.origin = lower.position + lower.offset * lower.normal;
        s.direction = higher.position + higher.offset * higher.normal - s.origin;
        s.tMin = 0.0f;
        s.tMax = 1.0f;
    }
    return s;
}
