// Points on plane convex polygons that shine on a receiver. It is legal as GLSL and as C++ (namespace
// relume::shader); it comes after lib/form_factor.glsl.
//
// A point's own form factor goes with 1 / distance^2, so seen from nearby it differs a thousandfold over the
// polygon. The share of the light that some such points say is seen, sum(V f) / sum(f), then hangs on one of
// them: its mean over any number of sample passes stays off, by what the few points of one pass have to do
// with each other. So a polygon that is near is halved, again and again, and each half is taken as often as
// it lights the receiver, which its exact form factor tells: a hierarchical warp [Clarberg et al. 2005,
// Wavelet Importance Sampling] that keeps the strata of the numbers that go in.

// A polygon whose reach (from its centre to the farthest corner) is less than this share of its distance
// counts as even: f differs by a factor of 4.3 at most over it because of the distance, and by .2 of its mean
// as a rule.
CONST float kEvenReach = 0.35f;
// A part is no longer halved whose reach is this share of its distance from the origin: floats know no places
// between its corners.
CONST float kLeastReach = 1e-6f;
// There are at most so many halvings: from a hundred-thousandth of the polygon's size away on it is cut until
// it is even. Rays start all over their texels, so where a texel ends at the polygon some start as close as
// one likes, and what is not even there has no bound on its variance.
CONST uint kMostHalvings = 36u;
// No half that may light the receiver is taken less often: rounding could have made nothing of its form
// factor.
CONST float kLeastHalf = 0.001f;

struct PolygonPoint {
    vec3 point;
    float weight; // density of points that are uniform in area, over that of these; its mean is 1
};

// Maps the unit square onto a triangle, keeping areas and, better than square roots do, neighbours [Heitz
// 2019].
FUNCTION vec3 trianglePoint(vec3 a, vec3 b, vec3 c, vec2 u) {
    float s, t;
    if (u.y > u.x) {
        s = 0.5f * u.x;
        t = u.y - s;
    } else {
        t = 0.5f * u.y;
        s = u.x - t;
    }
    return a + s * (b - a) + t * (c - a);
}

// A part of a polygon: corners in order, d repeats c for a triangle.
struct PolygonPart {
    vec3 a, b, c, d;
    uint shape;  // kEmitter...
    float split; // share of the area that the triangle a b c has
};

// Returns a point of the part, uniform in area for uniform u in [0, 1)^2; stratified where u is.
FUNCTION vec3 partPoint(PolygonPart q, vec2 u) {
    if (q.shape == kEmitterParallelogram) return q.a + u.x * (q.b - q.a) + u.y * (q.d - q.a);
    if (u.x < q.split) return trianglePoint(q.a, q.b, q.c, vec2(u.x / q.split, u.y));
    return trianglePoint(q.a, q.c, q.d, vec2((u.x - q.split) / (1.0f - q.split), u.y));
}

// Tells whether a part need not be halved, or cannot be.
FUNCTION bool isEven(vec3 p, PolygonPart q) {
    vec3 centre = 0.25f * (q.a + q.b + q.c + q.d);
    vec3 a = q.a - centre, b = q.b - centre, c = q.c - centre, d = q.d - centre, away = centre - p;
    float reach2 = max(max(dot(a, a), dot(b, b)), max(dot(c, c), dot(d, d)));
    return reach2 <= max(kEvenReach * kEvenReach * dot(away, away), kLeastReach * kLeastReach * dot(centre, centre));
}

// Turns a triangle so that its longest edge is that from a to b.
FUNCTION PolygonPart longestFirst(PolygonPart q) {
    vec3 ab = q.b - q.a, bc = q.c - q.b, ca = q.a - q.c, a = q.a;
    float x = dot(ab, ab), y = dot(bc, bc), z = dot(ca, ca);
    if (y > x && y >= z) {
        q.a = q.b;
        q.b = q.c;
        q.c = a;
    } else if (z > x && z > y) {
        q.a = q.c;
        q.c = q.b;
        q.b = a;
    }
    q.d = q.c;
    return q;
}

// Returns one of the two halves of a part; alongX says which of the two numbers chooses. A quadrilateral
// falls into its triangles, whose areas are `split` and the rest.
FUNCTION PolygonPart halfOf(PolygonPart q, bool first, bool alongX) {
    PolygonPart h = q;
    if (q.shape == kEmitterParallelogram) {
        if (alongX) {
            vec3 low = 0.5f * (q.a + q.b), high = 0.5f * (q.d + q.c);
            if (first) {
                h.b = low;
                h.c = high;
            } else {
                h.a = low;
                h.d = high;
            }
        } else {
            vec3 left = 0.5f * (q.a + q.d), right = 0.5f * (q.b + q.c);
            if (first) {
                h.c = right;
                h.d = left;
            } else {
                h.a = left;
                h.b = right;
            }
        }
        return h;
    }
    h.shape = kEmitterTriangle;
    h.split = 1.0f;
    if (q.shape == kEmitterQuad) {
        if (!first) h.b = q.c;
        h.c = first ? q.c : q.d;
    } else {
        vec3 middle = 0.5f * (q.a + q.b);
        if (first) h.b = middle;
        else h.a = middle;
    }
    h.d = h.c;
    return h;
}

// What is left of a polygon after some halvings, and the numbers that say where in it the point lies.
struct PolygonRest {
    PolygonPart part;
    vec2 u;       // in [0, 1)^2
    float weight; // as of PolygonPoint
    float whole;  // form factor of the part, > 0
};

// Halves the part once; level says how many halvings there were before.
FUNCTION void halve(vec3 p, vec3 n, uint level, INOUT(PolygonRest) r) {
    PolygonPart q = r.part;
    float area = 0.5f; // the first half's share
    bool alongX = (level & 1u) == 0u;
    if (q.shape == kEmitterParallelogram) {
        vec3 x = q.b - q.a, y = q.d - q.a;
        alongX = dot(x, x) >= dot(y, y);
    } else if (q.shape == kEmitterQuad) {
        area = q.split;
    } else {
        q = longestFirst(q);
    }
    PolygonPart half1 = halfOf(q, true, alongX);
    float lit = polygonFormFactor(p, n, half1.a, half1.b, half1.c, half1.d);
    float share = clamp(lit / r.whole, kLeastHalf, 1.0f - kLeastHalf);
    float v = alongX ? r.u.x : r.u.y;
    bool first = v < share;
    float chance = first ? share : 1.0f - share;
    v = min((first ? v : v - share) / chance, 0.99999994f);
    if (alongX) r.u.x = v;
    else r.u.y = v;
    r.weight *= (first ? area : 1.0f - area) / chance;
    r.whole = first ? lit : max(r.whole - lit, 0.0f);
    if (first) r.part = half1;
    else r.part = halfOf(q, false, alongX);
}

// Returns a point for the receiver at p [m] of unit normal n, for uniform u in [0, 1)^2.
FUNCTION PolygonPoint polygonPoint(vec3 p, vec3 n, PolygonPart q, vec2 u) {
    PolygonRest r;
    r.part = q;
    r.u = u;
    r.weight = 1.0f;
    r.whole = -1.0f;
    for (uint level = 0u; level < kMostHalvings && !isEven(p, r.part); ++level) {
        if (r.whole < 0.0f) r.whole = polygonFormFactor(p, n, q.a, q.b, q.c, q.d);
        if (!(r.whole > 0.0f)) break;
        halve(p, n, level, r);
    }
    PolygonPoint result;
    result.weight = r.weight;
    result.point = partPoint(r.part, r.u);
    return result;
}
