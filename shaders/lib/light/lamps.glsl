// Analytic lights: points, spheres, suns, rectangles and discs. It is legal as GLSL and as C++ (namespace
// relume::shader); it comes after lib/light/polygon_sample.glsl and lib/light/texel_mean.glsl. Factors are lighting
// (irradiance / pi) per unit of the light's colour; occlusion is left to the caller.

// Rays end this share of their length before a light: one that is fixed to a surface must not be hidden by
// it.
CONST float kLampGap = 1e-4f;

// This distance is squared [m^2]: a light without extent that is nearer than a micrometre counts as if it
// were as far away. What is at a surface is there by rounding, and 1 / d^2 has no bound.
CONST float kNearestLamp2 = 1e-12f;

// The salt keeps the numbers of analytic lights apart from those of directions and of mesh lights.
CONST uint kLampSalt = 0x85ebca6bu;

// A kernel may say of which types its lights can be, a bit each: it is compiled for no others then.
#ifndef LAMP_TYPES
#define LAMP_TYPES 0x3fu
#endif
FUNCTION bool isLamp(Lamp l, uint type) {
    return LAMP_TYPES == (1u << type) || (((LAMP_TYPES >> type) & 1u) != 0u && l.type == type);
}

// Returns the seed that scrambles sample `number` of all sample passes; key is seedKey of the patch.
FUNCTION uint lampSeed(Lamp l, uint key, uint number) { return hash32((replicateSeed(key, number) ^ kLampSalt) + l.seed); }

// Returns what is left of the light by KHR_lights_punctual: the recommended end at the range, and the spot's
// smooth edge. d leads from the patch to the light [m].
FUNCTION float lampFade(Lamp l, vec3 d) {
    float distance2 = dot(d, d), fade = 1.0f;
    if (l.range > 0.0f) {
        float share = distance2 / (l.range * l.range);
        fade = max(0.0f, 1.0f - share * share);
    }
    if (!isLamp(l, kLampSpot)) return fade;
    float cone = clamp(-dot(l.axis, d) / sqrt(max(distance2, 1e-30f)) * l.coneScale + l.coneOffset, 0.0f, 1.0f);
    return fade * cone * cone;
}

// Returns a direction within the cone around unit `axis` whose half angle has this squared sine, uniform in
// solid angle.
FUNCTION vec3 coneDirection(vec3 axis, float sine2, vec2 u) {
    vec3 c = cosineDirection(u); // whose x and y are uniform in the unit disc
    float r2 = c.x * c.x + c.y * c.y;
    float drop = r2 * sine2 / (1.0f + sqrt(1.0f - sine2)); // 1 - cosine
    float scale = sqrt(drop * (2.0f - drop) / max(r2, 1e-30f));
    return aroundNormal(axis, vec3(c.x * scale, c.y * scale, 1.0f - drop));
}

FUNCTION vec3 rectangleCorner(Lamp l, float u, float v) { return l.position + (u - 0.5f) * l.edgeU + (v - 0.5f) * l.edgeV; }

FUNCTION PolygonPart rectanglePart(Lamp l) {
    PolygonPart q;
    q.a = rectangleCorner(l, 0.0f, 0.0f);
    q.b = rectangleCorner(l, 1.0f, 0.0f);
    q.c = rectangleCorner(l, 1.0f, 1.0f);
    q.d = rectangleCorner(l, 0.0f, 1.0f);
    q.shape = kEmitterParallelogram;
    q.split = 0.5f;
    return q;
}

// Returns the distance of a rectangle from the point that lies d behind its middle [m].
FUNCTION float rectangleDistance(Lamp l, vec3 d) {
    float u = clamp(-dot(d, l.edgeU) / max(dot(l.edgeU, l.edgeU), 1e-30f), -0.5f, 0.5f);
    float v = clamp(-dot(d, l.edgeV) / max(dot(l.edgeV, l.edgeV), 1e-30f), -0.5f, 0.5f);
    return length(d + u * l.edgeU + v * l.edgeV);
}

// Returns how the edge of a spot differs over a texel of this size [m], to whose middle d leads from it: by so much of
// its height it rises from edge to edge of the texel.
FUNCTION uint spotUnevenness(Lamp l, vec3 d, float size) {
    float away = max(length(d), 1e-15f), wide = size / away, cosine = -dot(l.axis, d) / away;
    float sine = sqrt(max(1.0f - cosine * cosine, 0.0f));
    float rise = l.coneScale * wide * min(sine + 0.5f * wide, 1.0f);
    if (abs(cosine * l.coneScale + l.coneOffset - 0.5f) > 0.5f + 0.75f * rise) return kLightEven; // it is elsewhere
    return rise > 0.25f ? kLightUneven : (rise > 0.03f ? kLightCurved : kLightEven);
}

// Returns how the light differs over a texel of this middle and size [m]: kLight...; even where samples tell all.
FUNCTION uint lampUnevenness(Lamp l, vec3 middle, float size) {
    if (isLamp(l, kLampSun) || isLamp(l, kLampSky) || isLamp(l, kLampDisc)) return kLightEven;
    vec3 d = l.position - middle;
    if (isLamp(l, kLampRectangle)) return unevenness(size, rectangleDistance(l, d));
    uint uneven = unevenness(size, max(length(d) - l.radius, 0.0f));
    if (isLamp(l, kLampSpot)) uneven = max(uneven, spotUnevenness(l, d, size));
    return uneven;
}

// Returns the factor of the whole light at a point p [m] of unit normal n, unshadowed; negative where only samples tell. A
// sphere or sun that stands above the horizon as a whole lights like its centre.
FUNCTION float lampWholeAt(Lamp l, vec3 p, vec3 n) {
    if (isLamp(l, kLampDisc) || isLamp(l, kLampSky)) return -1.0f;
    if (isLamp(l, kLampRectangle)) {
        PolygonPart q = rectanglePart(l);
        return polygonFormFactor(p, n, q.a, q.b, q.c, q.d);
    }
    if (isLamp(l, kLampSun)) {
        float c = -dot(n, l.axis);
        if (l.radius > 0.0f && abs(c) < l.radius) return -1.0f;
        return kInvPi * max(c, 0.0f);
    }
    vec3 d = l.position - p;
    float height = dot(n, d), d2 = max(dot(d, d), kNearestLamp2);
    if (l.radius > 0.0f && abs(height) < l.radius) return -1.0f;
    if (!(height > 0.0f)) return 0.0f;
    return kInvPi * height / (d2 * sqrt(d2)) * lampFade(l, d);
}

// Returns its mean over a texel of unit normal n; negative where only samples tell.
FUNCTION float lampWhole(Lamp l, TexelSpread t, vec3 n) {
    uint uneven = lampUnevenness(l, t.middle, t.size);
    if (uneven == kLightUneven) return -1.0f;
    if (uneven == kLightEven) return lampWholeAt(l, t.middle, n);
    float sum = 0.0f;
    for (uint i = 0u; i < kSpreadPoints; ++i) {
        float whole = lampWholeAt(l, spreadPoint(t, i), n);
        if (whole < 0.0f) return -1.0f;
        sum += whole;
    }
    return sum / float(kSpreadPoints);
}

struct LampSample {
    vec3 target;  // end of the ray [m]
    float factor; // its mean over u is the whole light's
};

// Returns where the light fades as it does for a sample from `start`: in the middle of the texel where that alone
// tells the whole light, so that a share of it is one of what is seen alone.
FUNCTION vec3 fadingPlace(uint uneven, vec3 middle, vec3 start) { return uneven == kLightEven ? middle : start; }

// Samples a light other than the sky from p for uniform u in [0, 1)^2; it fades as at `fading`. reach is far outside the
// scene [m].
FUNCTION LampSample lampSample(Lamp l, Patch p, vec3 fading, vec2 u, float reach) {
    LampSample s;
    s.target = l.position;
    s.factor = 0.0f;
    if (isLamp(l, kLampSun)) {
        float sine2 = l.radius * l.radius;
        vec3 w = coneDirection(-l.axis, sine2, u);
        s.target = p.position + reach * w;
        s.factor = kInvPi * max(dot(p.shading, w), 0.0f) * 2.0f / (1.0f + sqrt(1.0f - sine2));
        return s;
    }
    if (isLamp(l, kLampRectangle) || isLamp(l, kLampDisc)) {
        float area = length(cross(l.edgeU, l.edgeV));
        if (isLamp(l, kLampDisc)) {
            vec3 c = cosineDirection(u);
            s.target = l.position + l.radius * (c.x * l.edgeU + c.y * l.edgeV);
            area = 3.14159265f * l.radius * l.radius;
        } else {
            PolygonPoint y = polygonPoint(p.position, p.shading, rectanglePart(l), u);
            s.target = y.point;
            area *= y.weight;
        }
        vec3 d = s.target - p.position;
        float d2 = dot(d, d), received = dot(p.shading, d), sent = -dot(l.axis, d);
        if (received > 0.0f && sent > 0.0f) s.factor = kInvPi * area * (received / d2) * (sent / d2);
    } else {
        vec3 d = l.position - p.position;
        float d2 = dot(d, d), r2 = l.radius * l.radius;
        if (!(d2 > 0.0f)) return s;
        float sine2 = min(r2 / d2, 1.0f), away = sqrt(d2);
        vec3 w = coneDirection(d / away, sine2, u);
        float along = dot(w, d);
        float within = r2 - (d2 - along * along);
        s.target = p.position + max(0.0f, along - sqrt(max(within, 0.0f))) * w;
        s.factor = kInvPi * max(dot(p.shading, w), 0.0f) * 2.0f / (max(max(d2, r2), kNearestLamp2) * (1.0f + sqrt(1.0f - sine2))) * lampFade(l, l.position - fading);
    }
    s.target += kLampGap * (p.position - s.target);
    return s;
}
