// Rays against triangles and boxes. It is legal as GLSL and as C++. In GLSL PRECISE is `precise`: what must
// come out alike in two triangles that share a vertex or an edge may not be rearranged.
#ifndef PRECISE
#ifdef __cplusplus
#define PRECISE
#else
#define PRECISE precise
#endif
#endif
#ifdef __cplusplus
#define MUL_ADD(a, b, c) ((a) * (b) + (c))
#else
#define MUL_ADD(a, b, c) fma(a, b, c)
#endif

// A ray with what all its tests need.
struct BvhRay {
    vec3 origin;    // [m]
    vec3 direction; // any length
    vec3 tangent;   // unit, with bitangent the plane that the ray pierces at right angles
    vec3 bitangent;
    vec3 inverse;   // 1 / direction, finite
    vec3 reach;     // |inverse|
    vec3 shift;     // -origin * inverse
};

// Returns 1 / d. A component of 0 becomes so small a one that the ray stays where it is in all boxes it can
// meet.
FUNCTION float safeInverse(float d) {
    return 1.0f / (abs(d) > 1e-20f ? d : (d < 0.0f ? -1e-20f : 1e-20f));
}

FUNCTION BvhRay bvhRay(vec3 origin, vec3 direction) {
    BvhRay ray;
    ray.origin = origin;
    ray.direction = direction;
    // The tangents need no square root of their own [Duff et al. 2017].
    vec3 n = normalize(direction);
    float s = n.z >= 0.0f ? 1.0f : -1.0f;
    float a = -1.0f / (s + n.z);
    float b = n.x * n.y * a;
    ray.tangent = vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
    ray.bitangent = vec3(b, s + n.y * n.y * a, -n.y);
    ray.inverse = vec3(safeInverse(direction.x), safeInverse(direction.y), safeInverse(direction.z));
    ray.reach = abs(ray.inverse);
    ray.shift = -origin * ray.inverse;
    return ray;
}

// Returns the part of [tMin, tMax] inside the box of this centre and half extent: empty when x > y. Neither
// tMin nor tMax is below 0, nor -0. It never misses a box that the ray touches: the far end is moved out by
// more than the products' rounding; that of the sums is in the extents, which the builder widens.
// Multiply-adds serve instead of sorting both planes, and bits compared as integers, three at a time: GPUs do
// the former twice as fast as a minimum. Integers order floats unless both are negative, which loses nothing
// here: tMin is one of the ends to the left, and a negative one to the right is behind the ray.
FUNCTION vec2 boxRange(vec3 centre, vec3 extent, BvhRay ray, float tMin, float tMax) {
    vec3 middle = MUL_ADD(centre, ray.inverse, ray.shift);
    ivec3 enter = floatBitsToInt(MUL_ADD(-extent, ray.reach, middle));
    ivec3 leave = floatBitsToInt(MUL_ADD(extent, ray.reach, middle));
    int x = max(max(max(enter.x, enter.y), enter.z), floatBitsToInt(tMin));
    int y = min(min(min(leave.x, leave.y), leave.z), floatBitsToInt(tMax));
    return vec2(intBitsToFloat(x), intBitsToFloat(y) * 1.000001f);
}

// Returns where on the plane across the ray a corner lies, the ray being at (0, 0). It depends on the corner
// and the ray alone.
FUNCTION vec2 acrossRay(vec3 corner, BvhRay ray) {
    PRECISE vec3 v = corner - ray.origin;
    PRECISE float x = MUL_ADD(v.x, ray.tangent.x, MUL_ADD(v.y, ray.tangent.y, v.z * ray.tangent.z));
    PRECISE float y = MUL_ADD(v.x, ray.bitangent.x, MUL_ADD(v.y, ray.bitangent.y, v.z * ray.bitangent.z));
    return vec2(x, y);
}

struct TriangleHit {
    bool hit;
    float t;      // in units of direction
    float b1, b2; // barycentrics of p1 and p2
};

// Intersects a triangle. The test is watertight: no ray passes between triangles that share edges and
// vertices. The corners are put into the plane across the ray, each by itself; there the edge functions,
// differences of two rounded products, have the sign of the exact ones or are 0, and are negated exactly when
// an edge is walked the other way [after Woop, Benthin and Wald 2013]. A 0 counts as inside on both sides.
// The distance is the plane's, which keeps it exact for rays starting close to a large triangle.
FUNCTION TriangleHit intersectTriangle(BvhTriangle triangle, BvhRay ray, float tMin, float tMax) {
    TriangleHit result;
    result.hit = false;
    result.t = 0.0f;
    result.b1 = 0.0f;
    result.b2 = 0.0f;
    vec2 a = acrossRay(triangle.p0, ray), b = acrossRay(triangle.p1, ray), c = acrossRay(triangle.p2, ray);
    PRECISE float u = c.x * b.y - c.y * b.x;
    PRECISE float v = a.x * c.y - a.y * c.x;
    PRECISE float w = b.x * a.y - b.y * a.x;
    // The greatest of the bits as unsigned ones is the lowest number, if any is below 0, and as signed ones
    // the highest.
    uvec3 bits = floatBitsToUint(vec3(u, v, w));
    ivec3 signedBits = ivec3(bits);
    bool negative = max(max(bits.x, bits.y), bits.z) > 0x80000000u;
    bool positive = max(max(signedBits.x, signedBits.y), signedBits.z) > 0;
    float sum = u + v + w;
    if ((negative && positive) || sum == 0.0f) return result;
    vec3 normal = cross(triangle.p1 - triangle.p0, triangle.p2 - triangle.p0);
    float t = dot(triangle.p0 - ray.origin, normal) / dot(ray.direction, normal);
    if (!(t >= tMin && t <= tMax)) return result;
    result.hit = true;
    result.t = intBitsToFloat(max(floatBitsToInt(t), 0)); // 0 for -0, whose bits would mislead boxRange
    result.b1 = v / sum;
    result.b2 = w / sum;
    return result;
}
