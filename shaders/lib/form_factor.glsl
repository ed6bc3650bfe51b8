// Form factors from a point to a patch. It is legal as GLSL and as C++ (namespace relume::shader). Occlusion
// is left to the caller. Every function returns a number in [0, 1] for finite input, never NaN; lengths may
// be 1e-9 m to 1e9 m.

CONST float kInvPi = 0.318309886f;
// Pairs nearer than this many patch sizes (sqrt of the area) take the exact form factor: beyond, the disc
// form is within 2 % of it whatever the angle.
CONST float kClosePair = 4.0f;

// Returns the form factor from a point at r to a small patch at s by the disc approximation [Wallace et al.
// 1989]: cos_r cos_s A / (pi d^2 + A). r, s [m]; nr, ns unit; area [m^2]; returns [1], 0 if either faces
// away.
FUNCTION float discFormFactor(vec3 r, vec3 nr, vec3 s, vec3 ns, float area) {
    vec3 d = s - r;
    float d2 = dot(d, d);
    float cr = dot(nr, d), cs = -dot(ns, d); // cosines times distance
    if (!(cr > 0.0f && cs > 0.0f && d2 > 0.0f)) return 0.0f;
    return min(1.0f, cr * cs / d2 * (area / (3.14159265f * d2 + area)));
}

// Returns RTRad's: min(1, A cos_r cos_s / (pi (distanceFactor d)^2)), with arguments as above; it is not
// linear in the area where it clamps.
FUNCTION float rtradFormFactor(vec3 r, vec3 nr, vec3 s, vec3 ns, float area, float distanceFactor) {
    vec3 d = s - r;
    float d2 = dot(d, d);
    float cr = dot(nr, d), cs = -dot(ns, d);
    if (!(cr > 0.0f && cs > 0.0f && d2 > 0.0f && area > 0.0f)) return 0.0f;
    float cosines = cr * cs / d2;
    float far = 3.14159265f * distanceFactor * distanceFactor * d2;
    return far > area * cosines ? area * cosines / far : 1.0f;
}

// Returns the angle in [0, pi] with sine k s and cosine k c, s >= 0, any k > 0; 0 where both are 0. It has a
// series of its own because Vulkan allows atan an error of 4096 units in the last place. Error 2e-8 rad
// [Abramowitz and Stegun, 4.4.49].
FUNCTION float arcAngle(float s, float c) {
    float a = abs(c);
    float high = max(s, a);
    if (!(high > 0.0f)) return 0.0f;
    float q = min(s, a) / high;
    float x = q * q;
    float sum = 0.0028662257f;
    sum = sum * x - 0.0161657367f;
    sum = sum * x + 0.0429096138f;
    sum = sum * x - 0.0752896400f;
    sum = sum * x + 0.1065626393f;
    sum = sum * x - 0.1420889944f;
    sum = sum * x + 0.1999355085f;
    sum = sum * x - 0.3333314528f;
    float angle = q + q * x * sum;
    if (s > a) angle = 1.57079633f - angle;
    return c < 0.0f ? 3.14159265f - angle : angle;
}

// A plane convex quadrilateral seen from the origin: corners in order and the edges from each to the next.
// The edges are kept because differences of far corners have lost their digits.
struct SeenQuad {
    vec3 a, b, c, d;
    vec3 ab, bc, cd, da;
};

// Returns one edge's term of Lambert's formula, for the part of the edge a .. a + e above the horizon: the
// angle it spans times the cosine between n and the normal of its plane through the origin. za and zb are the
// heights of its ends.
FUNCTION float lambertEdge(vec3 n, vec3 a, vec3 e, float za, float zb) {
    if (za <= 0.0f && zb <= 0.0f) return 0.0f;
    vec3 m = cross(e, a);
    float sine = length(m);
    if (!(sine > 0.0f)) return 0.0f; // seen end on, or of no length: spans no area
    float from = za > 0.0f ? 0.0f : za / (za - zb);
    float to = zb > 0.0f ? 1.0f : za / (za - zb);
    return arcAngle((to - from) * sine, dot(a + from * e, a + to * e)) * (dot(n, m) / sine);
}

// Applies Lambert's formula to the part of a front-facing quadrilateral above the horizon of n: F = 1 / (2
// pi) sum of the edges' terms [Lambert 1760; Baum et al. 1989]. A convex outline crosses the horizon at most
// once downwards (at `sets`) and once upwards (at `rises`); the edge that joins these lies in the horizon
// itself.
FUNCTION float lambertQuad(vec3 n, SeenQuad q) {
    float za = dot(n, q.a), zb = dot(n, q.b), zc = dot(n, q.c), zd = dot(n, q.d);
    float sum = lambertEdge(n, q.a, q.ab, za, zb);
    sum += lambertEdge(n, q.b, q.bc, zb, zc);
    sum += lambertEdge(n, q.c, q.cd, zc, zd);
    sum += lambertEdge(n, q.d, q.da, zd, za);

    vec3 sets = vec3(0.0f, 0.0f, 0.0f), rises = vec3(0.0f, 0.0f, 0.0f);
    if (za > 0.0f && zb <= 0.0f) sets = q.a + za / (za - zb) * q.ab;
    if (zb > 0.0f && zc <= 0.0f) sets = q.b + zb / (zb - zc) * q.bc;
    if (zc > 0.0f && zd <= 0.0f) sets = q.c + zc / (zc - zd) * q.cd;
    if (zd > 0.0f && za <= 0.0f) sets = q.d + zd / (zd - za) * q.da;
    if (za <= 0.0f && zb > 0.0f) rises = q.a + za / (za - zb) * q.ab;
    if (zb <= 0.0f && zc > 0.0f) rises = q.b + zb / (zb - zc) * q.bc;
    if (zc <= 0.0f && zd > 0.0f) rises = q.c + zc / (zc - zd) * q.cd;
    if (zd <= 0.0f && za > 0.0f) rises = q.d + zd / (zd - za) * q.da;
    sum += arcAngle(length(cross(sets, rises)), dot(sets, rises));
    return clamp(0.5f * kInvPi * sum, 0.0f, 1.0f);
}

// Returns the exact form factor from a point p with unit normal n to the plane convex quadrilateral c0 c1 c2
// c3, clipped to the horizon of n. It is counter-clockwise seen from its front; the factor is 0 from its back
// and from its own plane, and for a degenerate one.
FUNCTION float polygonFormFactor(vec3 p, vec3 n, vec3 c0, vec3 c1, vec3 c2, vec3 c3) {
    SeenQuad q;
    q.a = c0 - p;
    q.b = c1 - p;
    q.c = c2 - p;
    q.d = c3 - p;
    q.ab = c1 - c0;
    q.bc = c2 - c1;
    q.cd = c3 - c2;
    q.da = c0 - c3;
    vec3 front = cross(c2 - c0, c3 - c1);
    if (!(dot(front, q.a + q.b + q.c + q.d) < 0.0f)) return 0.0f;
    return lambertQuad(n, q);
}

// Returns the same for the parallelogram centre +- du / 2 +- dv / 2 (a texel: PatchEdges), whose front is the
// side of sNormal whichever handedness du, dv have.
FUNCTION float parallelogramFormFactor(vec3 p, vec3 n, vec3 centre, vec3 du, vec3 dv, vec3 sNormal) {
    vec3 r = centre - p;
    vec3 front = cross(du, dv);
    float side = dot(front, sNormal), height = dot(front, r);
    if (!(side > 0.0f ? height < 0.0f : side < 0.0f && height > 0.0f)) return 0.0f;
    vec3 u = side > 0.0f ? du : dv;
    vec3 v = side > 0.0f ? dv : du;
    SeenQuad q;
    q.a = r - 0.5f * u - 0.5f * v;
    q.b = r + 0.5f * u - 0.5f * v;
    q.c = r + 0.5f * u + 0.5f * v;
    q.d = r - 0.5f * u + 0.5f * v;
    q.ab = u;
    q.bc = v;
    q.cd = -u;
    q.da = -v;
    return lambertQuad(n, q);
}
