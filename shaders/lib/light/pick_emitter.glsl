// Picks one polygon out of many. It is legal as GLSL and as C++; it comes after lib/light/emitters.glsl. The
// includer supplies
//   EmitterNode emitterNode(uint index)         of the light tree; 0 is its root
//   EmitterPolygon emitterPolygon(uint index)

// For whom a polygon is picked: a texel, or one point of it.
struct PickView {
    vec3 middle;              // [m]
    vec3 n;                   // unit normal
    vec3 starts[kPickStarts]; // where the pick's points start [m]
    uint count;               // of the starts; 0: all is asked for the middle
    float near;               // light from nearer than this is unlike at the starts [m]
};

// Returns the view of one point.
FUNCTION PickView pointView(vec3 p, vec3 n) {
    PickView v;
    v.middle = p;
    v.n = n;
    v.count = 0u;
    v.near = 0.0f;
    for (uint i = 0u; i < kPickStarts; ++i) v.starts[i] = p;
    return v;
}

// Goes down the light tree [Conty Estevez and Kulla 2018] from a node that this links to, for a receiver at p
// [m] of unit normal n. u in [0, 1) is rescaled at each step, so one low-discrepancy number serves. Returns
// the polygon, and multiplies `probability` by the chance it had; kNoEmitter and 0 where the way ends at
// polygons none of which can shine on p: the sample's value is then 0, and the mean of value / probability
// still that of all. It takes at most kEmitterDepth steps.
FUNCTION uint descendEmitters(uint link, vec3 p, vec3 n, float u, INOUT(float) probability) {
    for (uint depth = 0u; depth <= kEmitterDepth && probability > 0.0f; ++depth) {
        if ((link & kEmitterLeaf) != 0u) return link & ~kEmitterLeaf;
        EmitterNode first = emitterNode(link), second = emitterNode(link + 1u);
        float share = shareOfFirst(emitterImportance(first, p, n), emitterImportance(second, p, n));
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

// Picks for a receiver from the root on.
FUNCTION uint pickEmitter(vec3 p, vec3 n, float u, INOUT(float) probability) {
    EmitterNode root = emitterNode(0u);
    probability = emitterImportance(root, p, n) > 0.0f ? 1.0f : 0.0f;
    return descendEmitters(root.link, p, n, u, probability);
}

// Tells whether a texel that reaches this far from p [m] comes close to a polygon, as far as going down to the nearer
// child finds it.
FUNCTION bool hasNearEmitter(vec3 p, float reach) {
    EmitterNode e = emitterNode(0u);
    for (uint depth = 0u; depth <= kEmitterDepth; ++depth) {
        if (nodeDistance(p, e) >= reach + kCloseReaches * 0.5f * length(e.hi - e.lo)) return false;
        if ((e.link & kEmitterLeaf) != 0u) return true;
        EmitterNode first = emitterNode(e.link), second = emitterNode(e.link + 1u);
        float a = nodeDistance(p, first), b = nodeDistance(p, second);
        // Within both, the one whose middle is nearer counts.
        bool goFirst = a < b || (a == b && length(first.lo + first.hi - 2.0f * p) <= length(second.lo + second.hi - 2.0f * p));
        if (goFirst) e = first;
        else e = second;
    }
    return false;
}

// Returns a node's importance for a view: where it is near, the mean over the view's starts.
FUNCTION float viewImportance(EmitterNode e, PickView v) {
    if (v.count == 0u || nodeDistance(v.middle, e) >= v.near) return emitterImportance(e, v.middle, v.n);
    float sum = 0.0f;
    for (uint i = 0u; i < v.count; ++i) sum += emitterImportance(e, v.starts[i], v.n);
    return sum / float(v.count);
}

// Tells whether a node is so near that its importance says little of it, as its box counts as a point there.
FUNCTION bool isClose(EmitterNode e, PickView v) {
    vec3 extent = 0.5f * (e.hi - e.lo), middle = e.lo + extent;
    float reach2 = kCloseReaches * kCloseReaches * dot(extent, extent);
    return dot(middle - v.middle, middle - v.middle) < reach2 || (v.count > 0u && nodeDistance(v.middle, e) < v.near);
}

// Returns what the importance of a leaf estimates.
FUNCTION float exactImportance(EmitterNode leaf, PickView v) {
    EmitterPolygon e = emitterPolygon(leaf.link & ~kEmitterLeaf);
    float area = 0.5f * length(emitterFront(e)), factor = v.count == 0u ? emitterFormFactor(v.middle, v.n, e) : 0.0f;
    for (uint i = 0u; i < v.count; ++i) factor += emitterFormFactor(v.starts[i], v.n, e) / float(v.count);
    // Importance has both cosines twice, and no 1 / pi.
    return area > 0.0f ? 4.0f / kInvPi * factor * leaf.power / area : 0.0f;
}

// Picks for a view beside a light, in the same way. There the tree's importances are off by up to a hundred: a polygon a
// millimetre away is a hundred times as bright as its neighbours, and a lamp's other side, which is as near, does
// not shine there at all. So nodes that are close are opened up, polygons that are close count by their form
// factors, and the choice is among all that is left then [after the light cuts of Walter et al. 2005]. Of a
// stream of weights each is taken with its share of the sum so far, and u is rescaled.
FUNCTION uint pickNearEmitter(PickView v, float u, INOUT(float) probability) {
    const uint kMostOpened = 192u; // with 64 a lamp of 440 triangles is as noisy as picked from the root
    const float kLeast = 0.001f; // importance, and not the form factor, tells who can shine on no start
    uint waiting[kEmitterDepth + 1u];
    uint count = 0u, index = 0u, link = 0u;
    float total = 0.0f, chosen = 0.0f;
    uint opened = 0u;
    for (bool done = false; !done;) {
        EmitterNode e = emitterNode(index);
        float weight = viewImportance(e, v);
        bool close = weight > 0.0f && isClose(e, v), leaf = (e.link & kEmitterLeaf) != 0u;
        if (close && !leaf && count < kEmitterDepth && opened < kMostOpened) {
            waiting[count] = e.link + 1u;
            ++count;
            ++opened;
            index = e.link;
            continue;
        }
        if (weight > 0.0f) {
            if (close && leaf) weight = kLeast * weight + exactImportance(e, v);
            total += weight;
            float share = weight / total;
            if (u < share) {
                link = e.link;
                chosen = weight;
                u /= share;
            } else {
                u = (u - share) / (1.0f - share);
            }
            u = clamp(u, 0.0f, 0.99999994f);
        }
        done = count == 0u;
        if (!done) {
            --count;
            index = waiting[count];
        }
    }
    probability = total > 0.0f ? chosen / total : 0.0f;
    return descendEmitters(link, v.middle, v.n, u, probability);
}
