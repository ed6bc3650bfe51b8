// Turns a hit triangle into a link. It is legal as GLSL and as C++; the includer supplies
//   uint texelPatch(uint texel)   the texel -> patch map, kNoPatch where empty
//   uint chartOfPatch(uint patch)

// Returns the nearest patch of the triangle's chart: the hit texel's own, else the nearest within two texels,
// else the triangle's representative. It is never nothing, which would lose energy at every chart edge.
FUNCTION uint patchAtHit(HitTriangle t, float b1, float b2, uint size) {
    vec2 uv = t.uv0 * (1.0f - b1 - b2) + t.uv1 * b1 + t.uv2 * b2;
    float x = uv.x * float(size), y = uv.y * float(size);
    int column = clamp(int(floor(x)), 0, int(size) - 1), row = clamp(int(floor(y)), 0, int(size) - 1);
    uint own = texelPatch(uint(row) * size + uint(column));
    if (own != kNoPatch && chartOfPatch(own) == t.chart) return own;
    uint best = t.representative;
    float bestDistance = 1e30f;
    for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) {
            int c = column + dx, r = row + dy;
            if (c < 0 || r < 0 || c >= int(size) || r >= int(size)) continue;
            uint p = texelPatch(uint(r) * size + uint(c));
            if (p == kNoPatch || chartOfPatch(p) != t.chart) continue;
            float ex = float(c) + 0.5f - x, ey = float(r) + 0.5f - y;
            float d = ex * ex + ey * ey;
            if (d < bestDistance) {
                bestDistance = d;
                best = p;
            }
        }
    }
    return best;
}
