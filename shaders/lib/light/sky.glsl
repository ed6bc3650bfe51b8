// The sky as a light: one radiance, or an equirectangular picture, sampled by itself and by the cosine alike.
// It comes after lib/light/lamps.glsl, and after vec4 skyPixel(uint) - radiance [cd/m^2] and the share of its row
// up to and with the pixel - and float skyRow(uint), the share of all rows up to and with this one, weighted
// by luminance and solid angle.

#include "sky_place.glsl"

// Returns the first of `count` whose share is above u, and where in it u lies.
FUNCTION uint skyFind(uint first, uint count, bool row, float u, INOUT(float) within) {
    uint low = 0u, high = count - 1u;
    while (low < high) {
        uint middle = (low + high) / 2u;
        float share = row ? skyRow(middle) : skyPixel(first + middle).w;
        if (share > u) high = middle;
        else low = middle + 1u;
    }
    float before = low == 0u ? 0.0f : row ? skyRow(low - 1u) : skyPixel(first + low - 1u).w;
    float after = row ? skyRow(low) : skyPixel(first + low).w;
    within = after > before ? clamp((u - before) / (after - before), 0.0f, 0.99999994f) : 0.5f;
    return low;
}

// Returns the density over solid angle with which skyFind takes a direction in this pixel [1/sr].
FUNCTION float skyDensity(uint row, uint column, uvec2 size, float cosPolar) {
    uint first = row * size.x;
    float rows = skyRow(row) - (row == 0u ? 0.0f : skyRow(row - 1u));
    float columns = skyPixel(first + column).w - (column == 0u ? 0.0f : skyPixel(first + column - 1u).w);
    float sine = sqrt(max(1.0f - cosPolar * cosPolar, 1e-12f));
    return rows * columns * float(size.x) * float(size.y) / (0.5f * kTurn * kTurn * sine);
}

struct SkySample {
    vec3 direction;
    vec3 light; // its mean over samples is the unshadowed lighting, per unit of the light's colour
};

// Samples the sky. With byPicture the direction is drawn by the picture's brightness, else by the cosine; the
// balance heuristic [Veach and Guibas 1995] weighs both. size 0 means one radiance.
FUNCTION SkySample skySample(Patch p, vec2 u, bool byPicture, uvec2 size, float rotation) {
    SkySample s;
    s.light = vec3(0.0f, 0.0f, 0.0f);
    s.direction = aroundNormal(p.shading, cosineDirection(u));
    if (size.x == 0u) {
        if (dot(s.direction, p.normal) > 0.0f) s.light = vec3(1.0f, 1.0f, 1.0f);
        return s;
    }
    if (byPicture) {
        float x, y;
        uint row = skyFind(0u, size.y, true, u.y, y);
        uint column = skyFind(row * size.x, size.x, false, u.x, x);
        s.direction = skyDirection(vec2((float(column) + x) / float(size.x), (float(row) + y) / float(size.y)), rotation);
    }
    float cosine = dot(s.direction, p.shading);
    if (!(cosine > 0.0f && dot(s.direction, p.normal) > 0.0f)) return s;
    vec2 place = skyPlace(s.direction, rotation);
    uint row = min(uint(place.y * float(size.y)), size.y - 1u), column = min(uint(place.x * float(size.x)), size.x - 1u);
    vec4 pixel = skyPixel(row * size.x + column);
    float density = skyDensity(row, column, size, s.direction.y), byCosine = kInvPi * cosine;
    s.light = pixel.rgb * (byCosine / (0.5f * (density + byCosine)));
    return s;
}
