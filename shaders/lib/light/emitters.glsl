// Lights with an area, sampled as lights. It is legal as GLSL and as C++ (namespace relume::shader); it comes
// after lib/light/polygon_sample.glsl and lib/light/texel_mean.glsl. Occlusion is left to the caller.

// Beside a light a pick is drawn for so many of its points' starts, at most.
CONST uint kPickStarts = 4u;
// A node is close within so many times its box's reach, from the middle.
CONST float kCloseReaches = 1.4f;

// The salt keeps the numbers of points apart from those of directions, which start from the same seeds.
CONST uint kPointSalt = 0x1b873593u;

// Returns the exact form factor from a point p [m] of unit normal n to the whole polygon, clipped to the
// horizon of n. It is in [0, 1], and 0 behind the polygon.
FUNCTION float emitterFormFactor(vec3 p, vec3 n, EmitterPolygon e) {
    return polygonFormFactor(p, n, e.c0, e.c1, e.c2, e.c3);
}

// Returns twice the area along the normal: the product of the diagonals, whichever shape it is.
FUNCTION vec3 emitterFront(EmitterPolygon e) { return cross(e.c2 - e.c0, e.c3 - e.c1); }

// Returns the unit normal, where it shines; zero for a polygon whose corners have run together.
FUNCTION vec3 emitterNormal(EmitterPolygon e) {
    vec3 front = emitterFront(e);
    float size = length(front);
    return size > 0.0f ? front / size : vec3(0.0f, 0.0f, 0.0f);
}

FUNCTION float segmentDistance(vec3 p, vec3 a, vec3 b) {
    vec3 along = b - a;
    float length2 = dot(along, along);
    float t = length2 > 0.0f ? clamp(dot(p - a, along) / length2, 0.0f, 1.0f) : 0.0f;
    return length(a + t * along - p);
}

// Returns the distance of a point from the polygon [m].
FUNCTION float polygonDistance(vec3 p, EmitterPolygon e) {
    vec3 n = emitterNormal(e);
    bool above = dot(cross(e.c1 - e.c0, p - e.c0), n) >= 0.0f && dot(cross(e.c2 - e.c1, p - e.c1), n) >= 0.0f &&
                 dot(cross(e.c3 - e.c2, p - e.c2), n) >= 0.0f && dot(cross(e.c0 - e.c3, p - e.c3), n) >= 0.0f;
    if (above) return abs(dot(p - e.c0, n));
    return min(min(segmentDistance(p, e.c0, e.c1), segmentDistance(p, e.c1, e.c2)),
               min(segmentDistance(p, e.c2, e.c3), segmentDistance(p, e.c3, e.c0)));
}

// Tells whether the polygon may shine on some point of the texel that its spread leaves out: where light is uneven, that
// of four points may be 0 and the mean not.
FUNCTION bool mayShineOn(TexelSpread t, vec3 n, EmitterPolygon e) {
    const float kEdge = 1.2247449f; // from the spread of a whole texel to its edge
    vec3 front = emitterFront(e), from = t.middle - e.c0;
    float reach = kEdge * (abs(dot(front, t.along)) + abs(dot(front, t.across)));
    float highest = max(max(dot(n, e.c0 - t.middle), dot(n, e.c1 - t.middle)), max(dot(n, e.c2 - t.middle), dot(n, e.c3 - t.middle)));
    return dot(front, from) + reach > 0.0f && highest > 0.0f;
}

// Returns the mean of the form factor over a texel, by the points of its spread.
FUNCTION float spreadFormFactor(TexelSpread t, vec3 n, EmitterPolygon e) {
    float sum = 0.0f;
    for (uint i = 0u; i < kSpreadPoints; ++i) sum += emitterFormFactor(spreadPoint(t, i), n, e);
    return sum / float(kSpreadPoints);
}

// Tells whether the node's box is above the horizon of a receiver at p [m] of unit normal n: 1, or below it: -1; 0 where
// it may lie across it.
FUNCTION int sideOfHorizon(EmitterNode e, vec3 p, vec3 n) {
    vec3 extent = 0.5f * (e.hi - e.lo), d = e.lo + extent - p;
    float slack = 1e-5f * (length(d) + length(extent)); // of rounding
    float height = dot(n, d), reach = dot(abs(n), extent) + slack;
    return height > reach ? 1 : (height < -reach ? -1 : 0);
}

// Returns how far a point is from the node's box [m].
FUNCTION float nodeDistance(vec3 p, EmitterNode e) {
    return length(max(abs(p - 0.5f * (e.lo + e.hi)) - 0.5f * (e.hi - e.lo), vec3(0.0f, 0.0f, 0.0f)));
}

FUNCTION PolygonPart emitterPart(EmitterPolygon e) {
    PolygonPart q;
    q.a = e.c0;
    q.b = e.c1;
    q.c = e.c2;
    q.d = e.c3;
    q.shape = e.shape;
    q.split = e.split;
    return q;
}

// Returns a point on the polygon, uniform in area for uniform u in [0, 1)^2; stratified where u is.
FUNCTION vec3 emitterPoint(EmitterPolygon e, vec2 u) { return partPoint(emitterPart(e), u); }

// Returns what the point y of the polygon says about its form factor: cos cos A / (pi r^2), 0 below the
// horizon and behind. Its mean over emitterPoint is emitterFormFactor.
FUNCTION float emitterPointFactor(vec3 p, vec3 n, EmitterPolygon e, vec3 y) {
    vec3 d = y - p;
    float d2 = dot(d, d);
    float received = dot(n, d), sent = -0.5f * dot(emitterFront(e), d); // cosines times distance; times area
    if (!(received > 0.0f && sent > 0.0f && d2 > 0.0f)) return 0.0f;
    return kInvPi * (received / d2) * (sent / d2);
}

// Returns the seed of point `number` of a patch, whose key is this, on a polygon that all patches sample; of picks the
// emitter is 0.
FUNCTION uint emitterPointSeed(uint key, uint number, uint emitter) {
    return hash32((replicateSeed(key, number) ^ kPointSalt) + emitter);
}

struct EmitterSample {
    vec3 point;
    float factor; // its mean over u is emitterFormFactor
};

// Samples as emitterPoint does, but on a near polygon more points lie where most of its light comes from.
FUNCTION EmitterSample emitterSample(vec3 p, vec3 n, EmitterPolygon e, vec2 u) {
    PolygonPoint y = polygonPoint(p, n, emitterPart(e), u);
    EmitterSample s;
    s.point = y.point;
    s.factor = emitterPointFactor(p, n, e, y.point) * y.weight;
    return s;
}

// Returns the largest cosine that a direction to p can have with a normal of the node's cone. cosAxis is that
// with its axis, from the box's centre; sinBox the sine of the angle that half the box's diagonal spans from
// p, 1 or more from inside.
FUNCTION float coneCosine(float cosCone, float cosAxis, float sinBox) {
    if (!(sinBox < 1.0f)) return 1.0f;
    float cosBox = sqrt(1.0f - sinBox * sinBox);
    float sinCone = sqrt(max(0.0f, 1.0f - cosCone * cosCone));
    float cosSum = cosCone * cosBox - sinCone * sinBox, sinSum = sinCone * cosBox + cosCone * sinBox;
    if (sinSum <= 0.0f || cosAxis >= cosSum) return 1.0f;
    return cosAxis * cosSum + sqrt(max(0.0f, 1.0f - cosAxis * cosAxis)) * sinSum;
}

// Estimates how much of the node's light p receives, in any one unit: power over distance^2, times for both
// ends the mean of the cosine towards the box's centre and of a bound that no part of the box exceeds [after
// Conty Estevez and Kulla 2018]. The bounds alone give what is turned away too much: with the means one pick
// among 1000 lights has half the variance. It is 0 only where no polygon of the node can shine on p.
FUNCTION float emitterImportance(EmitterNode e, vec3 p, vec3 n) {
    vec3 extent = 0.5f * (e.hi - e.lo), d = e.lo + extent - p;
    // This covers rounding of coordinates; a node whose normals agree within 1e-5 rad counts as flat.
    vec3 sizes = 1e-6f * (abs(p) + abs(d)) + 2e-5f * extent;
    float slack = sizes.x + sizes.y + sizes.z, height = dot(n, d);
    float highest = height + dot(abs(n), extent) + slack; // of the box, above p's horizon
    if (highest <= 0.0f) return 0.0f;
    vec3 gap = max(abs(d) - extent, vec3(0.0f, 0.0f, 0.0f));
    float near = 1.0f / max(length(gap), 1e-15f);
    float reach2 = dot(extent, extent), d2 = max(dot(d, d), 1e-30f);
    float away = 1.0f / sqrt(d2), along = -dot(e.axis, d), cosAxis = along * away;
    float sent;
    if (e.cosCone >= 1.0f) sent = (along + dot(abs(e.axis), extent) + slack) * near;
    else sent = coneCosine(e.cosCone, cosAxis, sqrt(reach2) * away) + 1e-5f; // rounding
    if (sent <= 0.0f) return 0.0f;
    sent = min(sent, 1.0f);
    sent += e.cosCone < 0.0f ? sent : max(0.0f, cosAxis); // the axis of a wide cone says little
    float received = min(highest * near, 1.0f) + max(0.0f, height * away);
    // Within half its reach a box is not one point any more.
    return e.power * received * sent / max(d2, 0.25f * reach2);
}

// Returns the chance of going to the first of two children of these importances; negative when neither can
// shine. One that can is never given less than a thousandth: importance is an estimate, and where it is far
// off this bounds the noise, at next to no cost.
FUNCTION float shareOfFirst(float a, float b) {
    const float kLeast = 0.001f;
    if (!(a + b > 0.0f)) return -1.0f;
    float share = a / (a + b);
    if (a > 0.0f) share = max(share, kLeast);
    if (b > 0.0f) share = min(share, 1.0f - kLeast);
    return share;
}
