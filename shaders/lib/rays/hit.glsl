// Turns a hit triangle into a link. It is legal as GLSL and as C++; the includer supplies
//   uint texelPatch(uint texel)   the texel -> patch map, kNoPatch where empty
//   uint chartOfPatch(uint patch)  kNoChart for a patch that sends nothing

// Returns the nearest patch of the triangle's chart that sends: the hit texel's own, else the nearest within
// kHitReach, else the triangle's representative, which may send nothing. Without that energy would be lost at every
// chart edge; and where the middle of a texel lies inside something, what is seen of the texel would be black.
FUNCTION uint patchAtHit(HitTriangle t, float b1, float b2, uint size) {
    vec2 uv = t.uv0 * (1.0f - b1 - b2) + t.uv1 * b1 + t.uv2 * b2;
    float x = uv.x * float(size), y = uv.y * float(size);
    int column = clamp(int(floor(x)), 0, int(size) - 1), row = clamp(int(floor(y)), 0, int(size) - 1);
    uint own = texelPatch(uint(row) * size + uint(column));
    if (own != kNoPatch && chartOfPatch(own) == t.chart) return own;
    const float kWithinOne = 1.5f * 1.5f; // what is farther than one texel away is no nearer than this
    uint best = t.representative;
    float bestDistance = 1e30f;
    for (int reach = 1; reach <= kHitReach && bestDistance > kWithinOne; ++reach) {
        for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
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
    }
    return best;
}
