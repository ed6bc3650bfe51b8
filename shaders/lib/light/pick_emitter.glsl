// Picks one polygon out of many. It is legal as GLSL and as C++; it comes after lib/light/emitters.glsl. The
// includer supplies
//   EmitterNode emitterNode(uint index)   of the light tree; 0 is its root

// Goes down the light tree [Conty Estevez and Kulla 2018] for a receiver at p [m] of unit normal n. u in [0,
// 1) is rescaled at each step, so one low-discrepancy number serves. Returns the polygon and in `probability`
// the chance it had; kNoEmitter with 0 where the way ends at polygons none of which can shine on p: the
// sample's value is then 0, and the mean of value / probability still that of all. It takes at most
// kEmitterDepth steps.
FUNCTION uint pickEmitter(vec3 p, vec3 n, float u, INOUT(float) probability) {
    EmitterNode root = emitterNode(0u);
    probability = emitterImportance(root, p, n) > 0.0f ? 1.0f : 0.0f;
    uint link = root.link;
    for (uint depth = 0u; depth <= kEmitterDepth && probability > 0.0f; ++depth) {
        if ((link & kEmitterLeaf) != 0u) return link & ~kEmitterLeaf;
        EmitterNode first = emitterNode(link), second = emitterNode(link + 1u);
        float share = emitterShare(first, second, p, n);
        if (share < 0.0f) break;
        bool goFirst = u < share;
        float chance = goFirst ? share : 1.0f - share;
        u = min((goFirst ? u : u - share) / chance, 0.99999994f);
        probability *= chance;
        link = goFirst ? first.link : second.link;
    }
    probability = 0.0f;
    return kNoEmitter;
}
